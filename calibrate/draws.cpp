#include "calibrate/draws.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kParameterDraws{50};

/// Rows without their mean.
Eigen::MatrixXd centred(const std::vector<std::vector<double>>& rows) {
  Eigen::MatrixXd m(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows.front().size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].size() != rows.front().size()) throw InputError("draws of unequal lengths");
    for (std::size_t c = 0; c < rows[r].size(); ++c)
      m(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r][c];
  }
  return m.rowwise() - m.colwise().mean();
}

}  // namespace

EffectComponents effect_components(const std::vector<std::vector<double>>& parameters,
                                   const std::vector<std::vector<double>>& effects, std::size_t most, double share) {
  if (parameters.size() < 3 || effects.size() != parameters.size())
    throw InputError("components of a scatter need three draws or more");
  const Eigen::MatrixXd x = centred(parameters);
  const Eigen::MatrixXd y = centred(effects);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(y, Eigen::ComputeThinU);
  const Eigen::VectorXd variance = svd.singularValues().array().square();
  const double all = variance.sum();
  const auto draws = static_cast<double>(parameters.size());
  EffectComponents out;
  out.scores.resize(parameters.size());
  double held = 0.0;
  for (Eigen::Index k = 0; k < variance.size() && out.direction.size() < most && variance[k] > 0.0; ++k) {
    if (held >= share * all) break;
    held += variance[k];
    const Eigen::VectorXd score = svd.matrixU().col(k) * std::sqrt(draws - 1.0);
    const Eigen::VectorXd direction = x.transpose() * score / (draws - 1.0);
    out.direction.emplace_back(direction.data(), direction.data() + direction.size());
    for (std::size_t r = 0; r < parameters.size(); ++r) out.scores[r].push_back(score[static_cast<Eigen::Index>(r)]);
  }
  out.explained = all > 0.0 ? held / all : 1.0;
  return out;
}

std::vector<double> correlations_of(const std::vector<double>& covariance, std::size_t size) {
  std::vector<double> out(size * size, 0.0);
  for (std::size_t a = 0; a < size; ++a)
    for (std::size_t b = 0; b < size; ++b) {
      const double norm = std::sqrt(covariance[a * size + a] * covariance[b * size + b]);
      const bool known = norm > 0.0 && std::isfinite(norm);
      out[a * size + b] = a == b  ? 1.0
                          : known ? std::clamp(covariance[std::min(a, b) * size + std::max(a, b)] / norm, -1.0, 1.0)
                                  : 0.0;
    }
  return out;
}

std::vector<double> correlations(const std::vector<std::vector<double>>& draws, std::size_t size) {
  std::vector<double> mean(size, 0.0);
  std::vector<double> product(size * size, 0.0);
  for (const auto& u : draws)
    for (std::size_t a = 0; a < size; ++a) mean[a] += u[a] / static_cast<double>(draws.size());
  for (const auto& u : draws)
    for (std::size_t a = 0; a < size; ++a)
      for (std::size_t b = 0; b < size; ++b) product[a * size + b] += (u[a] - mean[a]) * (u[b] - mean[b]);
  return correlations_of(product, size);
}

NormalNumbers updated(const NormalNumbers& before, const std::vector<std::size_t>& which,
                      const NormalNumbers& measured) {
  const std::size_t n = before.mean.size();
  const auto all = static_cast<Eigen::Index>(n);
  const auto some = static_cast<Eigen::Index>(which.size());
  Eigen::MatrixXd across(all, some);
  Eigen::MatrixXd sum(some, some);
  Eigen::VectorXd off(some);
  for (Eigen::Index b = 0; b < some; ++b) {
    const std::size_t k = which[static_cast<std::size_t>(b)];
    off[b] = measured.mean[k] - before.mean[k];
    for (Eigen::Index a = 0; a < all; ++a) across(a, b) = before.covariance[static_cast<std::size_t>(a) * n + k];
    for (Eigen::Index a = 0; a < some; ++a) {
      const std::size_t at = which[static_cast<std::size_t>(a)] * n + k;
      sum(a, b) = before.covariance[at] + measured.covariance[at];
    }
  }
  const Eigen::MatrixXd gain = sum.completeOrthogonalDecomposition().solve(across.transpose()).transpose();
  const Eigen::VectorXd moved = gain * off;
  const Eigen::MatrixXd lost = gain * across.transpose();
  NormalNumbers out = before;
  for (Eigen::Index a = 0; a < all; ++a) {
    out.mean[static_cast<std::size_t>(a)] += moved[a];
    for (Eigen::Index b = 0; b < all; ++b)
      out.covariance[static_cast<std::size_t>(a) * n + static_cast<std::size_t>(b)] -= lost(a, b);
  }
  return out;
}

std::vector<std::vector<double>> normal_draws(const std::vector<double>& mean, const std::vector<double>& covariance,
                                              std::int64_t count, std::uint64_t seed) {
  const auto n = static_cast<Eigen::Index>(mean.size());
  if (covariance.size() != mean.size() * mean.size() ||
      !std::all_of(covariance.begin(), covariance.end(), [](double c) { return std::isfinite(c); }))
    throw InputError("the covariance of the parameters is not known");
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> c(covariance.data(), n,
                                                                                                   n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(c);
  constexpr double kRounding = 1e-9;  // of the largest eigenvalue: below zero by no more than that is zero
  if (axes.eigenvalues().minCoeff() < -kRounding * axes.eigenvalues().maxCoeff())
    throw InputError("the covariance of the parameters is not positive");
  const Eigen::MatrixXd root = axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  std::vector<std::vector<double>> out;
  for (std::int64_t r = 0; r < count; ++r) {
    RandomStream random(seed, kParameterDraws, static_cast<std::uint64_t>(r));
    Eigen::VectorXd z(n);
    for (Eigen::Index k = 0; k < n; ++k) z[k] = random.normal();
    const Eigen::VectorXd moved = root * z;
    std::vector<double>& row = out.emplace_back(mean);
    for (std::size_t k = 0; k < row.size(); ++k) row[k] += moved[static_cast<Eigen::Index>(k)];
  }
  return out;
}

}  // namespace softgrain

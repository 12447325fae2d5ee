#include "calibrate/gaussian_process.h"

#include <gsl/gsl_multimin.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kTrend = 100.0;  ///< prior variance of the trend over that of the values: vague
constexpr double kJitter = 1e-8;  ///< variance that keeps equal points solvable

/// Normal prior of the logarithm of a number.
struct LogPrior {
  double mean;
  double deviation;
};
const LogPrior kAmplitude{std::log(0.5), 1.0};
const LogPrior kLength{std::log(1.0), 0.7};
const LogPrior kScatter{std::log(0.1), 1.0};

double penalty(const LogPrior& prior, double value) {
  const double z = (std::log(value) - prior.mean) / prior.deviation;
  return 0.5 * z * z;
}

Eigen::Map<const Eigen::VectorXd> vector_of(const std::vector<double>& x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

Eigen::Map<const RowMatrix> square_of(const std::vector<double>& x, std::size_t n) {
  return {x.data(), static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n)};
}

void require_values(const std::vector<std::vector<double>>& points, const std::vector<double>& values,
                    const std::vector<double>& errors) {
  const std::size_t variables = points.empty() ? 0 : points.front().size();
  if (points.size() != values.size() || errors.size() != values.size() ||
      !std::ranges::all_of(points, [&](const auto& u) { return u.size() == variables; }))
    throw InputError("Gaussian process: points, values and errors do not go together");
  if (variables == 0 || values.size() < GaussianProcess::least_values(variables))
    throw InputError("Gaussian process: fewer values than its trend needs");
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(values, finite) ||
      !std::ranges::all_of(errors, [](double e) { return std::isfinite(e) && e >= 0.0; }) ||
      !std::ranges::all_of(points, [&](const auto& u) { return std::ranges::all_of(u, finite); }))
    throw InputError("Gaussian process: a number is not finite, or an error is below 0");
}

/// Nelder and Mead's simplex from `start`; returns the value at the end, which it puts into `start`.
template <class Cost>
double minimise(const Cost& cost, std::vector<double>& start) {
  const std::size_t n = start.size();
  gsl_multimin_function f{[](const gsl_vector* x, void* p) {
                            return (*static_cast<const Cost*>(p))({x->data, x->data + x->size});
                          },
                          n, const_cast<Cost*>(&cost)};
  const std::unique_ptr<gsl_multimin_fminimizer, decltype(&gsl_multimin_fminimizer_free)> search(
      gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, n), gsl_multimin_fminimizer_free);
  std::vector<double> step(n, 0.7);
  const gsl_vector_view x = gsl_vector_view_array(start.data(), n);
  const gsl_vector_view s = gsl_vector_view_array(step.data(), n);
  gsl_multimin_fminimizer_set(search.get(), &f, &x.vector, &s.vector);
  constexpr int kMost = 600;
  constexpr double kSmall = 1e-3;  // of logarithms
  for (int k = 0; k < kMost && gsl_multimin_fminimizer_iterate(search.get()) == 0; ++k)
    if (gsl_multimin_fminimizer_size(search.get()) < kSmall) break;
  std::copy_n(search->x->data, n, start.begin());
  return search->fval;
}

/// Least squares with x >= 0.
class NonNegative {
 public:
  NonNegative(Eigen::MatrixXd a, Eigen::VectorXd b)
      : a_(std::move(a)), b_(std::move(b)), x_(Eigen::VectorXd::Zero(a_.cols())) {}

  Eigen::VectorXd solve() {
    constexpr double kRounding = 1e-12;
    for (Eigen::Index round = 0; round < 3 * a_.cols(); ++round) {
      const Eigen::VectorXd slope = a_.transpose() * (b_ - a_ * x_);
      Eigen::Index best = -1;
      for (Eigen::Index k = 0; k < slope.size(); ++k)
        if (std::ranges::find(free_, k) == free_.end() && slope[k] > kRounding && (best < 0 || slope[k] > slope[best]))
          best = k;
      if (best < 0) break;
      free_.push_back(best);
      settle();
    }
    return x_;
  }

 private:
  /// Minimum over the free components, those that would become negative taken out one after the other.
  void settle() {
    while (!free_.empty()) {
      Eigen::MatrixXd part(a_.rows(), static_cast<Eigen::Index>(free_.size()));
      for (std::size_t k = 0; k < free_.size(); ++k) part.col(static_cast<Eigen::Index>(k)) = a_.col(free_[k]);
      const Eigen::VectorXd wanted = part.completeOrthogonalDecomposition().solve(b_);
      if (wanted.minCoeff() > 0.0) {
        x_.setZero();
        for (std::size_t k = 0; k < free_.size(); ++k) x_[free_[k]] = wanted[static_cast<Eigen::Index>(k)];
        return;
      }
      double way = 1.0;
      for (std::size_t k = 0; k < free_.size(); ++k) {
        const double now = x_[free_[k]];
        const double then = wanted[static_cast<Eigen::Index>(k)];
        if (then <= 0.0) way = std::min(way, now > then ? now / (now - then) : 0.0);
      }
      for (std::size_t k = 0; k < free_.size(); ++k)
        x_[free_[k]] += way * (wanted[static_cast<Eigen::Index>(k)] - x_[free_[k]]);
      constexpr double kZero = 1e-14;
      std::erase_if(free_, [&](Eigen::Index k) {
        if (x_[k] > kZero) return false;
        x_[k] = 0.0;
        return true;
      });
    }
  }

  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
  Eigen::VectorXd x_;
  std::vector<Eigen::Index> free_;
};

}  // namespace

GaussianProcess::GaussianProcess(std::vector<std::vector<double>> points, std::vector<double> values,
                                 std::vector<double> errors)
    : points_(std::move(points)), values_(std::move(values)), errors_(std::move(errors)) {
  require_values(points_, values_, errors_);
  const MeanError all = mean_error(values_);
  mean_ = all.mean;
  unit_ = all.deviation > 0.0 ? all.deviation : 1.0;
  for (double& z : values_) z = (z - mean_) / unit_;
  for (double& e : errors_) e /= unit_;
  fit();
  solve();
}

double GaussianProcess::covariance(const Shape& shape, const std::vector<double>& u,
                                   const std::vector<double>& v) const {
  double trend = 1.0;
  double square = 0.0;
  for (std::size_t a = 0; a < u.size(); ++a) {
    const double apart = (u[a] - v[a]) / shape.lengths[a];
    square += apart * apart;
    trend += (u[a] - 0.5) * (v[a] - 0.5);
  }
  return kTrend * trend + shape.amplitude * shape.amplitude * std::exp(-0.5 * square);
}

std::vector<double> GaussianProcess::matrix(const Shape& shape) const {
  const std::size_t n = points_.size();
  std::vector<double> out(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      out[i * n + j] = covariance(shape, points_[i], points_[j]);
      if (i == j) out[i * n + j] += errors_[i] * errors_[i] + shape.scatter * shape.scatter + kJitter;
      out[j * n + i] = out[i * n + j];
    }
  return out;
}

double GaussianProcess::cost(const Shape& shape) const {
  const std::size_t n = points_.size();
  const std::vector<double> k = matrix(shape);
  const Eigen::LLT<Eigen::MatrixXd> root(square_of(k, n));
  constexpr double kWorst = 1e12;
  if (root.info() != Eigen::Success) return kWorst;
  const Eigen::VectorXd z = vector_of(values_);
  const Eigen::MatrixXd lower = root.matrixL();
  double out = 0.5 * z.dot(root.solve(z)) + lower.diagonal().array().log().sum();
  out += penalty(kAmplitude, shape.amplitude) + penalty(kScatter, shape.scatter);
  for (const double l : shape.lengths) out += penalty(kLength, l);
  return std::isfinite(out) ? out : kWorst;
}

GaussianProcess::Shape GaussianProcess::shape_of(const std::vector<double>& logarithms) const {
  Shape out{std::exp(logarithms[0]), {}, std::exp(logarithms[1])};
  for (std::size_t a = 2; a < logarithms.size(); ++a) out.lengths.push_back(std::exp(logarithms[a]));
  return out;
}

void GaussianProcess::fit() {
  const auto of = [this](const std::vector<double>& logarithms) { return cost(shape_of(logarithms)); };
  constexpr double kApart = 0.7;
  double least = 0.0;
  for (const double moved : {0.0, -kApart, kApart}) {
    std::vector<double> at{kAmplitude.mean, kScatter.mean};
    at.resize(2 + points_.front().size(), kLength.mean + moved);
    const double end = minimise(of, at);
    if (!shape_.lengths.empty() && end >= least) continue;
    least = end;
    shape_ = shape_of(at);
  }
}

void GaussianProcess::solve() {
  const std::size_t n = points_.size();
  const std::vector<double> k = matrix(shape_);
  const Eigen::LLT<Eigen::MatrixXd> root(square_of(k, n));
  const bool finite = std::ranges::all_of(k, [](double x) { return std::isfinite(x); });
  if (!finite || root.info() != Eigen::Success)
    throw InputError("Gaussian process: the covariance of its values has no Cholesky decomposition");
  const auto size = static_cast<Eigen::Index>(n);
  const RowMatrix inverse = root.solve(Eigen::MatrixXd::Identity(size, size));
  inverse_.assign(inverse.data(), inverse.data() + inverse.size());
  const Eigen::VectorXd pull = root.solve(vector_of(values_));
  pull_.assign(pull.data(), pull.data() + pull.size());
}

ProcessValue GaussianProcess::at(const std::vector<double>& u) const {
  const std::size_t n = points_.size();
  Eigen::VectorXd k(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) k[static_cast<Eigen::Index>(i)] = covariance(shape_, u, points_[i]);
  const double left = covariance(shape_, u, u) - k.dot(square_of(inverse_, n) * k);
  return {mean_ + unit_ * k.dot(vector_of(pull_)),
          unit_ * std::sqrt(std::max(left, 0.0) + shape_.scatter * shape_.scatter)};
}

void GaussianProcess::expect(const std::vector<double>& u, double error) {
  if (u.size() != points_.front().size() || !std::ranges::all_of(u, [](double x) { return std::isfinite(x); }) ||
      !std::isfinite(error) || error < 0.0)
    throw InputError("Gaussian process: a point has other coordinates than the others, or an error is below 0");
  values_.push_back((at(u).mean - mean_) / unit_);
  points_.push_back(u);
  errors_.push_back(error / unit_);
  solve();
}

double GaussianProcess::scatter() const { return unit_ * shape_.scatter; }
const std::vector<double>& GaussianProcess::lengths() const { return shape_.lengths; }

std::vector<ProcessValue> leave_one_out(const std::vector<std::vector<double>>& points,
                                        const std::vector<double>& values, const std::vector<double>& errors) {
  require_values(points, values, errors);
  std::vector<ProcessValue> out(values.size());
  parallel_tasks(static_cast<std::int64_t>(values.size()), [&](std::int64_t k) {
    const auto but_one = [k](auto all) {
      all.erase(all.begin() + k);
      return all;
    };
    const auto i = static_cast<std::size_t>(k);
    out[i] = GaussianProcess(but_one(points), but_one(values), but_one(errors)).at(points[i]);
  });
  return out;
}

double distance_from_hull(const std::vector<std::vector<double>>& points, const std::vector<double>& u) {
  constexpr double kSum = 1e3;  // weight of sum w = 1
  const auto variables = static_cast<Eigen::Index>(u.size());
  Eigen::MatrixXd a(variables + 1, static_cast<Eigen::Index>(points.size()));
  Eigen::VectorXd b(variables + 1);
  for (std::size_t k = 0; k < points.size(); ++k) {
    a.col(static_cast<Eigen::Index>(k)).head(variables) = vector_of(points[k]);
    a(variables, static_cast<Eigen::Index>(k)) = kSum;
  }
  b.head(variables) = vector_of(u);
  b[variables] = kSum;
  const Eigen::VectorXd w = NonNegative(a, b).solve();
  return (a.topRows(variables) * w - b.head(variables)).norm();
}

}  // namespace softgrain

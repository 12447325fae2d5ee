#include "calibrate/numeric_jacobian.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace softgrain {

namespace {

constexpr std::size_t kLevels = 8;
constexpr double kShrink = 2.0;

/// Central difference of all residuals over parameter j with step h.
bool central(const ResidualFunction& evaluate, std::vector<double> p, std::size_t j, double h,
             std::vector<double>& out) {
  std::vector<double> below(out.size());
  const double x = p[j];
  p[j] = x + h;
  if (!evaluate(p, out)) return false;
  const double up = p[j];
  p[j] = x - h;
  if (!evaluate(p, below)) return false;
  const double width = up - p[j];
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (out[i] - below[i]) / width;
  return true;
}

/// Neville's tableau over the steps; the entry that moved least from its neighbours wins.
double extrapolate(const std::vector<std::vector<double>>& differences, std::size_t i) {
  std::array<double, kLevels> row{};
  double best = differences[0][i];
  double error = std::numeric_limits<double>::infinity();
  for (std::size_t level = 0; level < differences.size(); ++level) {
    double previous_diagonal = row[0];
    row[0] = differences[level][i];
    double factor = 1.0;
    for (std::size_t k = 1; k <= level; ++k) {
      factor *= kShrink * kShrink;
      const double finer = (row[k - 1] * factor - previous_diagonal) / (factor - 1.0);
      const double change = std::max(std::abs(finer - row[k - 1]), std::abs(finer - previous_diagonal));
      previous_diagonal = row[k];
      row[k] = finer;
      if (change <= error) {
        error = change;
        best = finer;
      }
    }
  }
  return best;
}

}  // namespace

bool ridders_jacobian(const ResidualFunction& evaluate, std::size_t residuals, std::span<const double> parameters,
                      std::span<double> jacobian) {
  const std::vector<double> p(parameters.begin(), parameters.end());
  for (std::size_t j = 0; j < p.size(); ++j) {
    double h = 0.01 * (p[j] == 0.0 ? 1.0 : std::abs(p[j]));
    std::vector<std::vector<double>> differences;
    for (std::size_t level = 0; level < kLevels; ++level, h /= kShrink) {
      std::vector<double> d(residuals);
      if (central(evaluate, p, j, h, d))
        differences.push_back(std::move(d));
      else
        differences.clear();
    }
    if (differences.empty()) return false;
    for (std::size_t i = 0; i < residuals; ++i) jacobian[i * p.size() + j] = extrapolate(differences, i);
  }
  return true;
}

}  // namespace softgrain

// Turns "observations y at points x, model f(x; p)" into a least-squares problem with an exact Jacobian.
#pragma once

#include <ceres/jet.h>

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "calibrate/least_squares.h"

namespace softgrain {

/// Observations: `predictors` numbers of x per y, row after row.
struct Observations {
  std::vector<double> y;
  std::vector<double> x;
  std::size_t predictors = 1;
};

/// Residuals f(x_i; p) - y_i. `model(p, x)` is generic in the type of p (double or ceres::Jet<double, N>): `[](const
/// auto* p, const double* x)`.
template <int N, class Model>
LeastSquaresProblem curve_problem(Observations data, Model model) {
  const auto shared = std::make_shared<const Observations>(std::move(data));
  LeastSquaresProblem problem;
  problem.residuals = shared->y.size();
  problem.evaluate = [shared, model](std::span<const double> p, std::span<double> r) {
    bool finite = true;
    for (std::size_t i = 0; i < r.size(); ++i) {
      r[i] = model(p.data(), shared->x.data() + i * shared->predictors) - shared->y[i];
      finite = finite && std::isfinite(r[i]);
    }
    return finite;
  };
  problem.jacobian = [shared, model](std::span<const double> p, std::span<double> jacobian) {
    using Jet = ceres::Jet<double, N>;
    std::array<Jet, N> q;
    for (int j = 0; j < N; ++j) q[j] = Jet(p[j], j);
    bool finite = true;
    for (std::size_t i = 0; i < shared->y.size(); ++i) {
      const Jet f = model(q.data(), shared->x.data() + i * shared->predictors);
      for (int j = 0; j < N; ++j) {
        jacobian[i * N + j] = f.v[j];
        finite = finite && std::isfinite(f.v[j]);
      }
    }
    return finite;
  };
  return problem;
}

}  // namespace softgrain

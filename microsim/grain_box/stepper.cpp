#include "microsim/grain_box/stepper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/core/error.h"
#include "microsim/grain_box/box_measure.h"

namespace softgrain {

namespace {

constexpr int kServoTries = 15;
/// A servo that wants an axis to move more than this many times the increment has lost its way.
constexpr double kServoReach = 50.0;

using ServoMatrix = std::array<std::array<double, 3>, 3>;

/// Solution of a 3 x 3 system by Cramer's rule; not finite when it is singular.
Vec3 solve(const ServoMatrix& m, const Vec3& b) {
  const Vec3 c0{{m[0][0], m[1][0], m[2][0]}};
  const Vec3 c1{{m[0][1], m[1][1], m[2][1]}};
  const Vec3 c2{{m[0][2], m[1][2], m[2][2]}};
  const double det = dot(c0, cross(c1, c2));
  return {{dot(b, cross(c1, c2)) / det, dot(c0, cross(b, c2)) / det, dot(c0, cross(c1, b)) / det}};
}

bool finite(const Vec3& a) { return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]); }

/// Rows: of strained axes the unit vector, of servo axes the stress per strain.
ServoMatrix servo_matrix(const BoxMove& move, const ElasticResponse& elastic) {
  ServoMatrix m{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      m[a][b] = move.control[a] == AxisControl::stress ? elastic.stiffness[a][b] : (a == b ? 1.0 : 0.0);
  return m;
}

/// Broyden: J += (df - J dx) dx^T / |dx|^2, in the rows of servo axes.
void update(ServoMatrix& m, const BoxMove& move, const Vec3& dx, const Vec3& df) {
  const double length2 = norm2(dx);
  if (!(length2 > 0.0)) return;
  for (int a = 0; a < 3; ++a) {
    auto& row = m[static_cast<std::size_t>(a)];
    if (move.control[static_cast<std::size_t>(a)] == AxisControl::strain) continue;
    const double lack = df[a] - (row[0] * dx[0] + row[1] * dx[1] + row[2] * dx[2]);
    for (int b = 0; b < 3; ++b) row[static_cast<std::size_t>(b)] += lack * dx[b] / length2;
  }
}

}  // namespace

bool BoxMove::has_servo() const {
  return std::any_of(control.begin(), control.end(), [](AxisControl c) { return c == AxisControl::stress; });
}

void BoxStepper::fail(const Vec3& strain, double residual, const std::string& reason) {
  ++effort_.retries;
  last_reason_ = reason;
  failures_.push_back({strain, residual, reason});
}

bool BoxStepper::attempt(GrainPack& pack, const Vec3& strain) {
  LeastWorkResult r;
  try {
    r = advance(pack, wall_moves(strain, reference_), options_);
  } catch (const UnusableResult& e) {
    fail(strain, std::numeric_limits<double>::quiet_NaN(), e.what());
    return false;
  }
  effort_.iterations += r.iterations;
  effort_.loop_passes += r.loop_passes;
  effort_.contact_evaluations += r.contact_evaluations;
  effort_.factorisations += r.factorisations;
  effort_.linear_iterations += r.linear_iterations;
  if (!r.converged) {
    fail(strain, r.worst_residual,
         fmt::format("no equilibrium ({} after {} iterations, residual {:.3g})", to_string(r.stopped_by), r.iterations,
                     r.worst_residual));
    return false;
  }
  ++effort_.solutions;
  effort_.residual = r.worst_residual;
  return true;
}

bool BoxStepper::servo(GrainPack& pack, const BoxMove& move, Vec3& taken) {
  const ElasticResponse elastic = elastic_probe(pack, options_);
  effort_.factorisations += elastic.factorisations;
  ServoMatrix m = servo_matrix(move, elastic);
  const GrainPack reference = pack;
  const double reach = kServoReach * std::max(largest(move.strain), 1e-6);
  // Residual of axis a: the strain or the stress that is still wanted.
  Vec3 wanted = move.strain;
  const BoxStress start = box_stress(pack);
  for (int a = 0; a < 3; ++a)
    if (move.control[static_cast<std::size_t>(a)] == AxisControl::stress) wanted[a] = move.stress[a] - start.normal[a];
  Vec3 x{};
  Vec3 before = start.normal;
  for (int n = 0; n < kServoTries; ++n) {
    const Vec3 dx = solve(m, wanted);
    x += dx;
    if (!finite(x) || largest(x) > reach) {
      fail(x, std::numeric_limits<double>::quiet_NaN(),
           "a given stress cannot be reached: the walls would have to move without end");
      return false;
    }
    GrainPack trial = reference;
    if (!attempt(trial, x)) return false;
    const BoxStress now = box_stress(trial);
    const Vec3 change = now.normal - before;
    before = now.normal;
    double worst = 0.0;
    for (int a = 0; a < 3; ++a) {
      const bool by_stress = move.control[static_cast<std::size_t>(a)] == AxisControl::stress;
      wanted[a] = by_stress ? move.stress[a] - now.normal[a] : 0.0;
      if (by_stress)
        worst = std::max(worst, std::abs(wanted[a]) / std::max(std::abs(move.stress[a]), 1e-3 * now.mean()));
    }
    if (worst <= stress_tolerance_) {
      pack = std::move(trial);
      taken = x;
      return true;
    }
    update(m, move, dx, change);
  }
  fail(x, std::numeric_limits<double>::quiet_NaN(), "a given stress was not met by the servo");
  return false;
}

Vec3 BoxStepper::halves(GrainPack& pack, const BoxMove& move, int depth) {
  Vec3 taken = move.strain;
  if (move.has_servo() ? servo(pack, move, taken) : attempt(pack, move.strain)) return taken;
  if (depth >= max_halvings_ || largest(move.strain) == 0.0)
    throw UnusableResult(fmt::format("increment ({:.3g}, {:.3g}, {:.3g}) failed after {} halvings: {}", move.strain[0],
                                     move.strain[1], move.strain[2], depth, last_reason_));
  BoxMove half = move;
  half.strain *= 0.5;
  const Vec3 start = box_stress(pack).normal;
  for (int a = 0; a < 3; ++a) half.stress[a] = 0.5 * (start[a] + move.stress[a]);
  const Vec3 first = halves(pack, half, depth + 1);
  half.stress = move.stress;
  return first + halves(pack, half, depth + 1);
}

Vec3 BoxStepper::apply(GrainPack& pack, const BoxMove& move) { return halves(pack, move, 0); }

StepEffort BoxStepper::take_effort() { return std::exchange(effort_, {}); }
std::vector<FailedTry> BoxStepper::take_failures() { return std::exchange(failures_, {}); }

}  // namespace softgrain

// Increments of the box: by strain, or by stress through a servo; what does not converge is halved and tried again.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/statics/least_work.h"
#include "microsim/grain_box/spec.h"

namespace softgrain {

inline double largest(const Vec3& a) { return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])}); }

/// One increment of the box as it is asked for.
struct BoxMove {
  std::array<AxisControl, 3> control{};
  Vec3 strain{};  ///< strain wanted on axes held by strain; first guess for the others
  Vec3 stress{};  ///< stress wanted on axes held by stress [Pa]

  [[nodiscard]] bool has_servo() const;
};

/// An increment that did not reach equilibrium and was taken back.
struct FailedTry {
  Vec3 strain{};          ///< strain that was tried
  double residual = 0.0;  ///< residual at which it ended
  std::string reason;
};

/// What an increment took, tries that failed included.
struct StepEffort {
  double residual = 0.0;  ///< residual of the accepted state: net force over largest contact force, worst grain
  std::int64_t iterations = 0;
  std::int64_t loop_passes = 0;
  std::int64_t contact_evaluations = 0;
  std::int64_t factorisations = 0;
  std::int64_t linear_iterations = 0;
  std::int64_t solutions = 0;  ///< equilibria found on the way (the servo needs several)
  std::int64_t retries = 0;    ///< tries that failed
};

class BoxStepper {
 public:
  /// Strains are relative to `reference` [m].
  BoxStepper(const LeastWorkOptions& options, const Vec3& reference, int max_halvings, double stress_tolerance)
      : options_(options), reference_(reference), max_halvings_(max_halvings), stress_tolerance_(stress_tolerance) {}

  /// Applies the move and returns the strain it took. Throws UnusableResult with the reason when it fails even after
  /// all halvings; the pack is then at the last equilibrium that was reached.
  Vec3 apply(GrainPack& pack, const BoxMove& move);

  /// Moves by strain alone; zero: equilibrium where the walls are.
  Vec3 strain(GrainPack& pack, const Vec3& strain) { return apply(pack, {{}, strain, {}}); }

  /// Effort and failed tries since the last call.
  StepEffort take_effort();
  std::vector<FailedTry> take_failures();

 private:
  bool attempt(GrainPack& pack, const Vec3& strain);
  bool servo(GrainPack& pack, const BoxMove& move, Vec3& taken);
  Vec3 halves(GrainPack& pack, const BoxMove& move, int depth);
  void fail(const Vec3& strain, double residual, const std::string& reason);

  LeastWorkOptions options_;
  Vec3 reference_;
  int max_halvings_;
  double stress_tolerance_;
  StepEffort effort_;
  std::vector<FailedTry> failures_;
  std::string last_reason_;
};

}  // namespace softgrain

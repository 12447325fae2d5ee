// Scene of kind "example": impacts of an elastic grain on a rigid plane.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/run/findings.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// All that a scene says. SI units.
struct ExampleSetup {
  std::string title;
  std::uint64_t seed = 0;        ///< for the provenance: nothing is drawn here
  double radius = 0.0;           ///< of the grain
  double density = 0.0;          ///< of the grain
  double youngs_modulus = 0.0;   ///< of the grain; the plane is rigid
  double poisson_ratio = 0.0;    ///< of the grain
  std::vector<double> speeds{};  ///< of the impacts
  std::int64_t steps = 0;        ///< time steps of a contact, about
};

/// Throws InputError.
ExampleSetup read_example(const Scene& scene);

/// Duration of a contact at this speed by the closed form of Hertz, 2.868 (m^2/(R E*^2 v))^(1/5) with
/// E* = E/(1 - nu^2) (Johnson, Contact Mechanics, 1985, eq. 11.24) [s].
double hertz_duration(const ExampleSetup& setup, double speed);

/// What follows from the scene without running it.
void check_example(const ExampleSetup& setup, Findings& out);

/// Writes impacts.csv.
SceneKind example_kind();

}  // namespace softgrain

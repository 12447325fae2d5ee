// Runs scenes of kind "particles" as the program does, and gives access to what was recorded.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "microsim/particles/particles_run.h"

namespace softgrain::verification {

using Overrides = std::vector<std::string>;  ///< "key.sub=value", as after --set

/// What came out of a scene.
struct OutsideRun {
  double step = 0.0;  ///< [s]
  ParticlesResult result;

  [[nodiscard]] std::size_t frames() const { return result.trajectory.time.size(); }
  [[nodiscard]] double time(std::size_t frame) const { return result.trajectory.time[frame]; }
  [[nodiscard]] Vec3 position(std::size_t frame, std::size_t particle) const;
  [[nodiscard]] Vec3 velocity(std::size_t frame, std::size_t particle) const;
  [[nodiscard]] Vec3 spin(std::size_t frame, std::size_t particle) const;
  [[nodiscard]] Vec3 final_velocity(std::size_t particle) const { return result.system.particles.velocity[particle]; }
  [[nodiscard]] Vec3 final_spin(std::size_t particle) const { return result.system.particles.spin[particle]; }
  [[nodiscard]] double mass(std::size_t particle) const { return 1.0 / result.system.particles.inverse_mass[particle]; }

 private:
  [[nodiscard]] Vec3 block(const std::vector<double>& values, std::size_t frame, std::size_t particle) const;
};

/// The only pair that touched, with its largest force and overlap; throws std::runtime_error when there was none or
/// more than one, or more than one contact of it.
const ContactHistory& only_contact(const OutsideRun& run);

/// A scene from its text, through the program's own reader; throws InputError, and std::runtime_error when the run was
/// not usable.
OutsideRun run_text(const std::string& text, const Overrides& overrides = {});

/// tests/reference/scenes/NAME.toml.
std::string scene_file(const std::string& name);
OutsideRun run_file(const std::string& name, const Overrides& overrides = {});

/// Rows of numbers of a file below tests/reference; other lines are left out. Throws std::runtime_error.
std::vector<std::vector<double>> reference_table(const std::string& file);

}  // namespace softgrain::verification

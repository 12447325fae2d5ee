// Pieces of scenes of kind "particles" as text: what a person would write by hand, with all digits.
#pragma once

#include <cstdint>
#include <string>

#include "common/core/vec.h"

namespace softgrain::verification {

/// Elastic constants and density of a [material.NAME] [SI].
struct SceneMaterial {
  std::string name = "grain";
  double density = 2500.0;
  double youngs_modulus = 7e10;
  double poisson_ratio = 0.25;
};

/// A [[particle]] [SI].
struct Ball {
  Vec3 position{};
  double radius = 0.01;
  Vec3 velocity{};
  Vec3 spin{};
};

/// A [[contact]] with law = "hertz-tsuji".
struct HertzContact {
  double restitution = 1.0;
  double mu = 0.0;
  std::string tangential = "mindlin";  ///< or "rescaled"
  std::string partner = "grain";       ///< the other material of the pair
};

/// A [[contact]] with law = "linear-spring"; stiffnesses [N/m].
struct LinearContact {
  double restitution = 1.0;
  double mu = 0.0;
  double normal = 1e4;
  double tangential = 1e4;
  std::string partner = "grain";
};

/// Shortest text that reads back as the same double.
std::string digits(double value);
std::string digits(const Vec3& value);  ///< "[x, y, z]"

/// Each returns lines that can be put one after the other; `heading` comes first.
std::string heading(const std::string& title, const Vec3& gravity = {});
std::string text_of(const SceneMaterial& material);
/// The same for contacts with stiffnesses of their own: no elastic constants.
SceneMaterial inelastic(SceneMaterial material);
std::string text_of(const HertzContact& contact);
std::string text_of(const LinearContact& contact);
std::string text_of(const Ball& ball);
std::string plane(const Vec3& point, const Vec3& normal, const std::string& material = "rigid");
std::string cell(const Vec3& size, bool x, bool y, bool z, double shear_rate = 0.0);
/// `steps` of `step` seconds, every `every`-th recorded (0: the first and the last state alone).
std::string timing(double step, std::int64_t steps, std::int64_t every = 0);

}  // namespace softgrain::verification

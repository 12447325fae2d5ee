#include "tests/example_kind/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace softgrain {

ExampleSetup read_example(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    ExampleSetup out;
    (void)root.choice(kKindKey, {"example"});
    out.title = root.title();
    constexpr std::int64_t kLargestSeed = 1'000'000'000'000;
    out.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, kLargestSeed, 0));
    const SceneTable grain = root.table({"grain", "the grain that falls"});
    out.radius = grain.number({"radius", "its radius"}, Unit::length, Range::positive());
    out.density = grain.number({"density", "its density"}, Unit::density, Range::positive(), 2500.0);
    out.youngs_modulus = grain.number({"E", "its Young's modulus"}, Unit::pressure, Range::positive());
    out.poisson_ratio = grain.number({"nu", "its Poisson's ratio"}, Unit::none, kPoissonRange, 0.2);
    const SceneTable impacts = root.table({"impacts", "speeds, and how exactly each impact is integrated"});
    out.speeds = impacts.numbers({"speeds", "speed of each impact"}, Unit::velocity, Range::positive());
    if (out.speeds.empty()) impacts.add_error("speeds", "at least one is needed");
    out.steps = impacts.count({"steps", "time steps of a contact"}, 20, 1000000, 1000);
    return out;
  });
}

double hertz_duration(const ExampleSetup& setup, double speed) {
  const double mass = 4.0 / 3.0 * std::numbers::pi * std::pow(setup.radius, 3) * setup.density;
  const double modulus = setup.youngs_modulus / (1.0 - setup.poisson_ratio * setup.poisson_ratio);
  return 2.868 * std::pow(mass * mass / (setup.radius * modulus * modulus * speed), 0.2);
}

void check_example(const ExampleSetup& setup, Findings& out) {
  out.warn_of_metres("radius", setup.radius);
  out.add("impacts", setup.speeds.size(),
          fmt::format("{} impacts of about {} time steps each", setup.speeds.size(), setup.steps));
  constexpr double kSecondsPerStep = 1e-8;
  out.spend("impacts", kSecondsPerStep * static_cast<double>(setup.steps) * static_cast<double>(setup.speeds.size()));
}

}  // namespace softgrain

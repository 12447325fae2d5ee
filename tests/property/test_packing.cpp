// What the packing generators make, whatever they are asked for: no overlap, all inside, radii as the law allows, the
// same from the same seed on any number of threads.
#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <optional>

#include "common/core/error.h"
#include "common/packing/void_filling.h"
#include "microsim/shell_packing.h"
#include "tests/property/random_cloud.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRounding = 1e-12;

SoftParticleSpec any_spec() {
  SoftParticleSpec spec;
  spec.exponent = 1.5 + 3.5 * share();
  spec.polydispersity = 1.2 + 5.0 * share();
  spec.rmax_over_shell = 0.25 + 0.5 * share();
  spec.beta = 1.01 + 4.0 * share();
  spec.trials = *rc::gen::inRange(5, 150);
  spec.placement = *rc::gen::arbitrary<bool>() ? Placement::voids : Placement::trials;
  return spec;
}

/// A packing, or none when the largest grains found no place.
std::optional<ShellPacking> made(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index) {
  try {
    return generate_shell_packing(spec, seed, index);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

bool same(const std::optional<ShellPacking>& a, const std::optional<ShellPacking>& b) {
  if (!a || !b) return !a && !b;
  return a->radius == b->radius && a->position == b->position;
}

RC_GTEST_PROP(PackingProperty, GrainsLieInTheirShellWithoutOverlap, ()) {
  const SoftParticleSpec spec = any_spec();
  const auto packing = made(spec, *rc::gen::arbitrary<std::uint32_t>(), 0);
  RC_PRE(packing.has_value());
  const auto& x = packing->position;
  const auto& r = packing->radius;
  RC_ASSERT(x.size() == r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    RC_ASSERT(r[i] >= spec.rmax_over_shell / spec.polydispersity * (1.0 - kRounding));
    RC_ASSERT(norm(x[i]) + r[i] <= 1.0 + kRounding);
    for (std::size_t j = i + 1; j < r.size(); ++j) RC_ASSERT(norm(x[i] - x[j]) >= r[i] + r[j] - kRounding);
  }
  RC_ASSERT(packing->solid_fraction() < 1.0);
}

RC_GTEST_PROP(PackingProperty, SeedAndIndexAloneDecide, ()) {
  const SoftParticleSpec spec = any_spec();
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint32_t>();
  std::array<std::optional<ShellPacking>, 3> serial;
  std::array<std::optional<ShellPacking>, 3> parallel;
  for (std::size_t k = 0; k < 3; ++k) serial[k] = made(spec, seed, k);
#pragma omp parallel for num_threads(3) schedule(static, 1)
  for (int k = 0; k < 3; ++k) parallel[static_cast<std::size_t>(k)] = made(spec, seed, static_cast<std::uint64_t>(k));
  for (std::size_t k = 0; k < 3; ++k) RC_ASSERT(same(serial[k], parallel[k]));
  if (serial[0] && serial[1]) RC_ASSERT(!same(serial[0], serial[1]));
}

RC_GTEST_PROP(PackingProperty, VoidsAreFilledLargestFirstWithoutOverlap, ()) {
  SoftParticleSpec spec = any_spec();
  spec.beta = 1.01 + 0.5 * share();
  const auto packing = made(spec, *rc::gen::arbitrary<std::uint32_t>(), 0);
  RC_PRE(packing.has_value());
  std::vector<PackedSphere> all;
  for (std::size_t k = 0; k < packing->radius.size(); ++k) all.push_back({packing->position[k], packing->radius[k]});
  VoidFillingOptions options;
  options.r_min = 0.1 + 0.1 * share();
  options.r_max = options.r_min * (1.0 + share());
  options.count = *rc::gen::inRange(1, 40);
  const VoidFilling filling = fill_voids(all, VoidDomain::unit_sphere(), options);
  RC_ASSERT(static_cast<std::int64_t>(filling.added.size()) <= options.count);
  for (const PackedSphere& s : filling.added) {
    RC_ASSERT(s.r >= options.r_min * (1.0 - kRounding));
    RC_ASSERT(s.r <= options.r_max * (1.0 + kRounding));
    RC_ASSERT(norm(s.x) + s.r <= 1.0 + kRounding);
    for (const PackedSphere& other : all) RC_ASSERT(norm(s.x - other.x) >= s.r + other.r - kRounding);
    all.push_back(s);
  }
}

}  // namespace

#include "macrosim/constructed_packing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/text.h"
#include "common/packing/void_filling.h"
#include "macrosim/cell_specimen.h"
#include "macrosim/preparation.h"

namespace softgrain {

namespace {

/// Share of the box that both kinds fill at first when solid_fill is left open: loose enough for holes of about the
/// size of the grains. What is filled is compacted afterwards.
constexpr double kFilledTogether = 0.44;
constexpr double kShareTolerance = 0.02;

/// Volume of soft particles that is `share` of them and the solid grains together.
double soft_volume(double share, double solid_volume) { return solid_volume * share / (1.0 - share); }

VoidFilling fill(const MacroSpec& spec, const MacroPacking& packing) {
  std::vector<PackedSphere> placed;
  for (const MacroBody& b : packing.bodies) placed.push_back({b.x, b.r});
  VoidFillingOptions options;
  options.r_max = spec.soft_radius_max;
  options.r_min = spec.soft_radius_max / spec.soft_polydispersity;
  options.volume = soft_volume(spec.soft_share, packing.body_volume());
  const bool periodic = spec.boundary == Boundary::periodic;
  return fill_voids(placed,
                    periodic ? VoidDomain::cell(packing.low, packing.high) : VoidDomain::box(packing.low, packing.high),
                    options);
}

[[noreturn]] void refuse(const MacroSpec& spec, double fraction, double reached) {
  throw UnfitScene(
      "macro: soft_share = " + rounded_text(spec.soft_share) + " cannot be reached: between solid grains " +
      "that fill " + rounded_text(fraction) + " of the box, soft particles of radii from " +
      rounded_text(spec.soft_radius_max / spec.soft_polydispersity) + " to " + rounded_text(spec.soft_radius_max) +
      " m hold at most " + rounded_text(reached) + "; lower solid_fill or raise soft_polydispersity");
}

/// The last sphere goes when the share is nearer without it.
void trim(VoidFilling& filling, double wanted) {
  if (filling.added.empty()) return;
  const double r = filling.added.back().r;
  const double last = kSphereVolume * r * r * r;
  if (wanted - (filling.volume - last) >= filling.volume - wanted) return;
  filling.volume -= last;
  filling.added.pop_back();
}

void add_soft(const MacroSpec& spec, MacroPacking& packing) {
  const double solid_volume = packing.body_volume();
  const double fraction = packing.solid_fraction();
  const double wanted = soft_volume(spec.soft_share, solid_volume);
  VoidFilling filling = fill(spec, packing);
  const double reached = filling.volume / (filling.volume + solid_volume);
  if (reached < spec.soft_share - kShareTolerance) refuse(spec, fraction, reached);
  trim(filling, wanted);
  for (const PackedSphere& s : filling.added) packing.bodies.push_back({s.x, s.r, true});
}

}  // namespace

MacroPacking make_constructed_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                                      const PreparationWatch& watch) {
  if (!(spec.soft_share < 1.0))
    throw UnfitScene("macro: construction \"voids\" needs solid grains: soft_share below 1");
  const double fraction = spec.solid_fill > 0.0 ? spec.solid_fill : kFilledTogether * (1.0 - spec.soft_share);
  MacroPacking packing =
      place_loosely(drawn_bodies(spec, seed, sample), seed, sample, std::min(0.30, fraction), spec.boundary);
  compact_to_fraction(spec, packing, fraction);
  if (spec.soft_share > 0.0) add_soft(spec, packing);
  bring_into_touch(spec, packing, watch);
  return packing;
}

MacroPacking make_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                          const PreparationWatch& watch) {
  if (spec.cells) return make_cell_packing(spec, seed, sample, watch);
  return spec.construction == Construction::voids ? make_constructed_packing(spec, seed, sample, watch)
                                                  : make_macro_packing(spec, seed, sample, watch);
}

SceneFacts describe(const MacroPacking& packing, const std::vector<ShellPacking>& contents) {
  SceneFacts facts;
  std::vector<double> radii;
  double solid_volume = 0.0;
  for (const MacroBody& b : packing.bodies) {
    const double volume = kSphereVolume * b.r * b.r * b.r;
    if (!b.soft) {
      ++facts.solid;
      solid_volume += volume;
      radii.push_back(b.r);
      continue;
    }
    const auto k = static_cast<std::size_t>(facts.soft++);
    facts.soft_radius_low = k == 0 ? b.r : std::min(facts.soft_radius_low, b.r);
    facts.soft_radius_high = std::max(facts.soft_radius_high, b.r);
    facts.soft_radius_mean += b.r;
    if (contents.empty()) {
      solid_volume += volume;
      continue;
    }
    const ShellPacking& content = contents[k % contents.size()];
    solid_volume += volume * content.solid_fraction();
    facts.inner_grains += static_cast<std::int64_t>(content.radius.size());
    for (const double r : content.radius) radii.push_back(r * b.r);
  }
  const Vec3 size = packing.size();
  facts.soft_share = packing.soft_volume_share();
  facts.body_fraction = packing.solid_fraction();
  facts.solid_fraction = solid_volume / (size[0] * size[1] * size[2]);
  if (facts.soft > 0) facts.soft_radius_mean /= static_cast<double>(facts.soft);
  const auto [low, high] = std::minmax_element(radii.begin(), radii.end());
  if (radii.size() < 3 || !(*low < *high)) return facts;
  facts.exponent = fit_exponent(radii);
  facts.largest_over_smallest = *high / *low;
  return facts;
}

}  // namespace softgrain

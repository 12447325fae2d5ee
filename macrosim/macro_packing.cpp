#include "macrosim/macro_packing.h"

#include <algorithm>
#include <string>

#include "common/core/error.h"
#include "common/core/solid_sphere.h"
#include "macrosim/preparation.h"

namespace softgrain {

namespace {

/// Draws bodies one by one, always of the kind that is behind its share of the volume.
std::vector<MacroBody> draw_bodies(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  RandomStream random(seed, kMacroRadii, sample);
  std::vector<MacroBody> bodies;
  double soft = 0.0;
  double all = 0.0;
  for (std::int64_t k = 0; k < spec.bodies; ++k) {
    MacroBody body;
    body.soft = spec.soft_share > 0.0 && soft <= spec.soft_share * all;
    body.r = body.soft
                 ? power_law_radius(spec.exponent, spec.soft_radius_max, spec.soft_polydispersity, random.uniform())
                 : power_law_radius(spec.exponent, spec.solid_radius_max, spec.solid_polydispersity, random.uniform());
    all += cube(body.r);
    if (body.soft) soft += cube(body.r);
    bodies.push_back(body);
  }
  std::stable_sort(bodies.begin(), bodies.end(), [](const MacroBody& a, const MacroBody& b) { return a.r > b.r; });
  return bodies;
}

}  // namespace

double MacroPacking::body_volume() const {
  double sum = 0.0;
  for (const MacroBody& b : bodies) sum += kSphereVolume * cube(b.r);
  return sum;
}

double MacroPacking::solid_fraction() const {
  const Vec3 edge = size();
  return body_volume() / (edge[0] * edge[1] * edge[2]);
}

double MacroPacking::soft_volume_share() const {
  double soft = 0.0;
  double all = 0.0;
  for (const MacroBody& b : bodies) {
    all += cube(b.r);
    if (b.soft) soft += cube(b.r);
  }
  return all > 0.0 ? soft / all : 0.0;
}

std::int64_t MacroPacking::soft_count() const {
  return std::count_if(bodies.begin(), bodies.end(), [](const MacroBody& b) { return b.soft; });
}

MacroPacking make_macro_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  MacroPacking packing = place_loosely(draw_bodies(spec, seed, sample), seed, sample);
  if (spec.preparation == MacroEngine::softgrain) bring_into_touch(spec, packing);
  return packing;
}

void write_macro_packing(const h5::Group& group, const MacroPacking& packing) {
  std::vector<double> rows;
  std::vector<std::int64_t> soft;
  for (const MacroBody& b : packing.bodies) {
    rows.insert(rows.end(), {b.x[0], b.x[1], b.x[2], b.r});
    soft.push_back(b.soft ? 1 : 0);
  }
  const std::vector<double> corners{packing.low[0],  packing.low[1],  packing.low[2],
                                    packing.high[0], packing.high[1], packing.high[2]};
  group.write("box", corners);
  group.write("bodies", rows, {packing.bodies.size(), 4});
  group.write("soft", soft);
}

MacroPacking read_macro_packing(const h5::Group& group) {
  const auto corners = group.doubles("box");
  const auto rows = group.doubles("bodies");
  const auto soft = group.integers("soft");
  if (corners.size() != 6 || rows.size() != 4 * soft.size()) throw FileTrouble("macro packing: arrays of wrong length");
  MacroPacking packing{{{corners[0], corners[1], corners[2]}}, {{corners[3], corners[4], corners[5]}}, {}};
  for (std::size_t k = 0; k < soft.size(); ++k)
    packing.bodies.push_back({{{rows[4 * k], rows[4 * k + 1], rows[4 * k + 2]}}, rows[4 * k + 3], soft[k] != 0});
  return packing;
}

}  // namespace softgrain

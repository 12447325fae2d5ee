// [[constituent]] of a recipe: what is mixed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/packing/grading.h"
#include "common/packing/grading_scene.h"
#include "pipelines/kinds/recipe/scene_parts.h"

namespace softgrain {

namespace {

/// One E, nu and mu: packings of one material are measured, and the equation of state is over its E.
void refuse_own_material(const SceneTable& t) {
  for (const char* key : {"E", "nu", "mu", "mu_r", "kr_ratio"})
    if (t.has(key))
      t.add_error(key,
                  "goes into [material]: contacts between constituents of different stiffness or friction are not "
                  "measured, all grains have one E, nu and mu (their mean, by volume)");
}

/// The share, or a mass, of which read_constituents() makes the share.
double read_mass(const SceneTable& t) {
  if (!t.has("mass"))
    return t.number({"mass_share", "share in the mass of all constituents; the shares add up to 1"}, Unit::none,
                    Range{0.0, 1.0, true, false});
  t.refuse({"mass_share"}, "goes without mass, of which the shares are made");
  return t.number({"mass",
                   "mass in the mix, in one unit for all (kg in a cubic metre, parts), instead of `mass_share`: other "
                   "masses keep their ratios when one is changed"},
                  Unit::none, Range::positive());
}

Constituent read_constituent(const SceneTable& t, double density) {
  Constituent c;
  t.section([&] {
    c.name = t.text({"name", "name of the constituent"});
    c.mass_share = read_mass(t);
    c.density = t.number({"density", "density of its grains", "that of `[material]`"}, Unit::density, Range::positive(),
                         density);
    refuse_own_material(t);
    c.sizes = read_sizes(t, {"sizes", "its size distribution, such as a sieve curve"}, {});
    if (!t.has("sizes")) t.add_error("sizes", "is missing: a sieve curve, or another law of sizes");
  });
  return c;
}

}  // namespace

void refuse_idle_density(const SceneTable& root) {
  const std::vector<SceneTable> all = root.tables("constituent");
  if (all.empty() || !root.has("material")) return;
  if (std::all_of(all.begin(), all.end(), [](const SceneTable& t) { return t.has("density"); }))
    root.table("material").refuse({"density"}, "every [[constituent]] gives its own");
}

std::vector<Constituent> read_constituents(const SceneTable& root, double density) {
  std::vector<Constituent> out;
  double sum = 0.0;
  std::size_t by_mass = 0;
  for (const SceneTable& t :
       root.tables({"constituent", "one of the constituents, instead of one size distribution in `[grains]`"})) {
    out.push_back(read_constituent(t, density));
    sum += out.back().mass_share;
    by_mass += t.has("mass") ? 1 : 0;
    if (std::count_if(out.begin(), out.end(), [&](const Constituent& c) { return c.name == out.back().name; }) > 1)
      t.add_error("name", "is used twice");
  }
  if (out.empty() || root.has_errors()) return out;
  if (by_mass > 0 && by_mass < out.size()) {
    root.add_error("constituent", "either all of them give mass, or all give mass_share");
    return out;
  }
  if (by_mass == out.size())
    for (Constituent& c : out) c.mass_share /= sum;
  else if (std::abs(sum - 1.0) > 1e-6)
    root.add_error("constituent", fmt::format("the mass shares add up to {:g}; they must add up to 1", sum));
  double volume = 0.0;
  for (const Constituent& c : out) volume += c.mass_share / c.density;
  for (Constituent& c : out) c.volume_share = c.mass_share / c.density / volume;
  return out;
}

Grading mixed_sizes(const std::vector<Constituent>& constituents) {
  std::vector<SizePiece> pieces;
  for (const Constituent& c : constituents)
    for (SizePiece p : c.sizes->pieces()) {
      p.volume *= c.volume_share;
      pieces.push_back(p);
    }
  return Grading::classes(std::move(pieces));
}

}  // namespace softgrain

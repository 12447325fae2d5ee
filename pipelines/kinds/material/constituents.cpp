#include "pipelines/kinds/material/constituents.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "common/packing/grading_scene.h"
#include "macrosim/grain_materials.h"

namespace softgrain {

namespace {

const char* const kOfMaterial = "that of `[material]`";

void read_own_material(const SceneTable& t, const MacroSpec& common, Constituent& c) {
  c.density =
      t.number({"density", "density of its grains", kOfMaterial}, Unit::density, Range::positive(), common.density);
  c.youngs_modulus = t.number({"E", "Young's modulus of its grains", kOfMaterial}, Unit::pressure, Range::positive(),
                              common.youngs_modulus);
  c.poisson_ratio =
      t.number({"nu", "Poisson's ratio of its grains", kOfMaterial}, Unit::none, kPoissonRange, common.poisson_ratio);
  c.friction = t.number(
      {"mu", "friction coefficient of its grains; contacts of two constituents have the smaller one", kOfMaterial},
      Unit::none, Range::friction(), common.friction);
  for (const char* key : {"mu_r", "kr_ratio"})
    if (t.has(key)) t.add_error(key, "goes into [material]: all grains have one resistance to rolling");
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

Constituent read_constituent(const SceneTable& t, const MacroSpec& common) {
  Constituent c;
  t.section([&] {
    c.name = t.line_text({"name", "name of the constituent"});
    c.mass_share = read_mass(t);
    read_own_material(t, common, c);
    c.sizes = read_sizes(t, {"sizes", "its size distribution, such as a sieve curve"}, {});
    if (!t.has("sizes")) t.add_error("sizes", "is missing: a sieve curve, or another law of sizes");
  });
  return c;
}

/// A density in g/cm^3 beside others in kg/m^3.
void refuse_other_units(const std::vector<SceneTable>& tables, const std::vector<Constituent>& constituents) {
  constexpr double kLightest = 10.0;  // [kg/m^3] no solid grain is lighter, and most have a smaller number of g/cm^3
  constexpr double kFarApart = 100.0;
  const double densest = std::ranges::max(constituents, {}, &Constituent::density).density;
  for (std::size_t k = 0; k < tables.size(); ++k)
    if (const double density = constituents[k].density; density < kLightest && densest > kFarApart * density)
      tables[k].add_error("density", fmt::format("another constituent has {:g} kg/m^3: is a unit missing, such as "
                                                 "density = \"{:g} g/cm^3\"?",
                                                 densest, density));
}

}  // namespace

void refuse_idle_material(const SceneTable& root) {
  const std::vector<SceneTable> all = root.tables("constituent");
  if (all.empty() || !root.has("material")) return;
  for (const char* key : {"density", "E", "nu", "mu"})
    if (std::all_of(all.begin(), all.end(), [&](const SceneTable& t) { return t.has(key); }))
      root.table("material").refuse({key}, "every [[constituent]] gives its own");
}

std::vector<Constituent> read_constituents(const SceneTable& root, const MacroSpec& common) {
  std::vector<Constituent> out;
  double sum = 0.0;
  std::size_t by_mass = 0;
  const std::vector<SceneTable> tables =
      root.tables({"constituent", "one of the constituents, instead of one size distribution in `[grains]`"});
  for (const SceneTable& t : tables) {
    out.push_back(read_constituent(t, common));
    sum += out.back().mass_share;
    by_mass += t.has("mass") ? 1 : 0;
    if (std::count_if(out.begin(), out.end(), [&](const Constituent& c) { return c.name == out.back().name; }) > 1)
      t.add_error("name", "is used twice");
  }
  if (out.empty() || root.has_errors()) return out;
  refuse_other_units(tables, out);
  if (root.has_errors()) return out;
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

void take_materials(const SceneTable& root, std::vector<Constituent>& constituents, MacroSpec& spec) {
  if (constituents.empty()) return;
  const Constituent& first = constituents.front();
  const bool alike = std::ranges::all_of(constituents, [&](const Constituent& c) {
    return c.youngs_modulus == first.youngs_modulus && c.poisson_ratio == first.poisson_ratio &&
           c.friction == first.friction;
  });
  spec.youngs_modulus = first.youngs_modulus;
  spec.poisson_ratio = first.poisson_ratio;
  spec.friction = first.friction;
  if (alike) return;
  std::vector<GrainMaterial>& each = spec.grain_materials.each;
  spec.poisson_ratio = 0.0;
  for (Constituent& c : constituents) {
    const GrainMaterial own{c.name, c.youngs_modulus, c.poisson_ratio, c.friction, c.density};
    const auto at = std::ranges::find_if(each, [&](const GrainMaterial& m) {
      return m.youngs_modulus == own.youngs_modulus && m.poisson_ratio == own.poisson_ratio &&
             m.friction == own.friction && m.density == own.density;
    });
    c.material = static_cast<std::int32_t>(at - each.begin());
    if (at == each.end())
      each.push_back(own);
    else
      at->name += ", " + c.name;
    spec.poisson_ratio += c.volume_share * c.poisson_ratio;
    spec.friction = std::max(spec.friction, c.friction);
  }
  if (each.size() > GrainMaterials::kMost)
    root.add_error("constituent", fmt::format("{} materials (E, nu, mu, density); allowed: up to {}, since each pair "
                                              "has a contact law of its own",
                                              each.size(), GrainMaterials::kMost));
  take_reference(spec, mixed_sizes(constituents));
}

std::string materials_text(const GrainMaterials& materials, double whole) {
  if (materials.empty()) return "";
  return fmt::format(
      "grains of several materials ({}): E of a packing, which stresses \"over E\" are over, is the harmonic mean of "
      "its grains over the solid volume, {} for all; a contact has the effective modulus of its two grains, and the "
      "smaller mu",
      join_text(materials.each, "; ",
                [](const GrainMaterial& m) {
                  return fmt::format("{}: E = {}, nu = {:g}, mu = {:g}", m.name, pressure_text(m.youngs_modulus),
                                     m.poisson_ratio, m.friction);
                }),
      pressure_text(whole));
}

double mean_density(const std::vector<Constituent>& constituents) {
  double sum = 0.0;
  for (const Constituent& c : constituents) sum += c.volume_share * c.density;
  return sum;
}

Grading mixed_sizes(const std::vector<Constituent>& constituents) {
  std::vector<SizePiece> pieces;
  for (const Constituent& c : constituents)
    for (SizePiece p : c.sizes->pieces()) {
      p.volume *= c.volume_share;
      p.material = c.material;
      pieces.push_back(p);
    }
  return Grading::classes(std::move(pieces));
}

}  // namespace softgrain

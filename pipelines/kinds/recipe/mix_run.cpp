#include "pipelines/kinds/recipe/mix_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/core/text.h"
#include "common/io/scene.h"
#include "macrosim/body_contacts.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/material/equation.h"

namespace softgrain {

namespace {

/// The check may have failed without the rest: it is the last packing.
void drop_missing_check(MixRun& run, const std::set<std::string>& measured) {
  if (!run.scene.checked || measured.contains(run.variant(*run.scene.checked).name)) return;
  run.scene.material.variants.pop_back();
  run.scene.checked.reset();
  run.scene.checked_levels = 0;
}

/// Whether a key says what is mixed, and not how it is packed, tested and fitted.
bool is_of_the_mix(const std::string& key) {
  static const std::vector<std::string> mix{"constituent.",     "constituent[",        "grains.sizes",
                                            "grains.exponent",  "grains.ratio",        "grains.radius_max",
                                            "material.density", "levels.cut_diameters"};
  return std::ranges::any_of(mix, [&](const std::string& start) { return key.starts_with(start); });
}

bool same_curve(const MacroCurve& a, const MacroCurve& b) {
  const auto phi = [](const MacroCurve& c) {
    const auto at = c.more.find(kSolidFraction);
    return at == c.more.end() ? std::vector<double>() : at->second;
  };
  return !a.stress_axial.empty() && a.stress_axial == b.stress_axial && a.stress_lateral == b.stress_lateral &&
         phi(a) == phi(b);
}

bool same_curves(const VariantResult& a, const VariantResult& b) {
  return !a.curves.empty() && std::ranges::equal(a.curves, b.curves, same_curve);
}

/// Adds the squares of the slopes between neighbouring mixtures.
void add_squares(const RecipeScene& scene, const std::vector<double>& of, double& sum, double& steps) {
  for (std::size_t k = 0; k + 1 < scene.levels.size(); ++k) {
    std::vector<std::pair<double, double>> points{{0.0, of[scene.slice[k]]}};
    for (std::size_t m = 0; m < scene.mixtures.size(); ++m)
      points.emplace_back(scene.mixtures[m], of[scene.mixed[k][m]]);
    points.emplace_back(1.0, of[scene.slice[k + 1]]);
    for (std::size_t p = 1; p < points.size(); ++p) {
      const double slope = (points[p].second - points[p - 1].second) / (points[p].first - points[p - 1].first);
      if (!std::isfinite(slope)) continue;
      sum += slope * slope;
      steps += 1.0;
    }
  }
}

}  // namespace

MixRun load_mix(const report::RunData& data) {
  const auto any = data.summary_as<AnySummary>();
  if (!any.provenance || any.provenance->scene.empty()) throw NotPaired(data.directory + " does not hold its scene");
  MixRun out{read_recipe_scene(Scene::parse(any.provenance->scene, data.directory + "/summary.json")),
             data.summary_as<RecipeSummary>(),
             {}};
  if (!out.summary.recipe.onset) throw NotPaired(data.directory + " has no law");
  std::set<std::string> measured;
  for (const MaterialVariantSummary& v : out.summary.material.variants) measured.insert(v.name);
  drop_missing_check(out, measured);
  for (const MaterialVariant& v : out.scene.material.variants) {
    const auto& all = out.summary.material.variants;
    const auto at = std::ranges::find(all, v.name, &MaterialVariantSummary::name);
    if (at == all.end()) throw NotPaired(data.directory + " lacks the packing " + v.name);
    out.results.push_back({&v, at->file, load_macro(data.directory + "/" + at->file), nullptr});
  }
  return out;
}

void require_one_protocol(const std::vector<std::string>& keys) {
  std::string others;
  for (const std::string& key : keys)
    if (!is_of_the_mix(key)) append_part(others, key, ", ");
  if (!others.empty()) throw NotPaired("the runs differ in more than their mix (" + others + ")");
}

void require_alike(const MixRun& a, const MixRun& b) {
  if (a.scene.levels.size() != b.scene.levels.size())
    throw NotPaired(fmt::format("A has {} levels, B {}; the same [levels] cut_diameters for both make them alike",
                                a.scene.levels.size(), b.scene.levels.size()));
  if (a.scene.youngs_modulus != b.scene.youngs_modulus)
    throw NotPaired(
        fmt::format("stresses of A are over {}, those of B over {}: the mixes of their materials have other means of E",
                    pressure_text(a.scene.youngs_modulus), pressure_text(b.scene.youngs_modulus)));
}

std::map<std::string, std::string> shared_packings(const MixRun& a, const MixRun& b) {
  std::map<std::string, std::string> out;
  for (const VariantResult& of_b : b.results)
    for (const VariantResult& of_a : a.results)
      if (same_curves(of_a, of_b)) out.emplace(of_b.variant->name, of_a.variant->name);
  return out;
}

StateFitOptions state_options(const MixRun& run) {
  const EquationSettings& equation = run.scene.material.equation;
  return {.form = equation.form, .replicates = static_cast<int>(equation.replicates), .seed = run.scene.material.seed};
}

FittedCurves fit_again(const MixRun& run) {
  FittedCurves out;
  for (const VariantResult* r : first_compressed(run.results))
    for (const MacroCurve& c : r->curves)
      if (takes_part(c))
        out.curves.push_back(state_curve(c, r->variant->name, r->variant->setup.spec.solid_polydispersity));
  out.fit = fit_equation_of_state(out.curves, state_options(run));
  if (!out.fit.usable) throw NotPaired("no equation of state fits the packings: " + out.fit.message);
  return out;
}

double moved_share(const Grading& a, const Grading& b) {
  constexpr int kBins = 4000;
  const double low = 0.999 * std::min(a.smallest(), b.smallest());
  const double high = 1.001 * std::max(a.largest(), b.largest());
  double sum = 0.0;
  double before = 0.0;
  for (int k = 1; k <= kBins; ++k) {
    const double r = low * std::pow(high / low, static_cast<double>(k) / kBins);
    const double ahead = a.passing(r) - b.passing(r);
    sum += std::abs(ahead - before);
    before = ahead;
  }
  return 0.5 * sum;
}

NeighbourSlope neighbour_slope(const RecipeScene& a, const std::vector<double>& of_a, const RecipeScene& b,
                               const std::vector<double>& of_b) {
  double sum = 0.0;
  NeighbourSlope out;
  add_squares(a, of_a, sum, out.steps);
  add_squares(b, of_b, sum, out.steps);
  out.value = out.steps > 0.0 ? std::sqrt(sum / out.steps) : 0.0;
  out.steps *= 0.5;
  return out;
}

}  // namespace softgrain

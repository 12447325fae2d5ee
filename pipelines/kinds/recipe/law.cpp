#include "pipelines/kinds/recipe/law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibrate/state_curves.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/card_text.h"
#include "common/data/law_words.h"
#include "common/io/text_file.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {

MaterialLaw fit_coarsest(const RecipeScene& scene, const std::vector<VariantResult>& results,
                         const std::optional<StateFit>& states, std::uint64_t seed) {
  MaterialLawScene law{
      scene.material,
      pair_of(scene.levels[0], scene.levels[1], fines_over_coarse(scene, 0) / (1.0 + fines_over_coarse(scene, 0))),
      cut_of_pair(scene.levels[0], scene.levels[1]),
      scene.mixtures,
      scene.cells,
      false,
      false,
      {}};
  std::vector<VariantResult> some{results[scene.slice[1]], results[kSheared], results[scene.slice[0]]};
  for (const std::size_t v : scene.mixed[0]) some.push_back(results[v]);
  for (VariantResult& r : some)  // cells have no unloading: they answer the first stage
    if (r.variant != results[kSheared].variant)
      for (MacroCurve& c : r.curves) c = first_stage_of(std::move(c));
  return fit_material_law(law, some, states, seed);
}

double grain_density(const RecipeScene& scene) {
  return scene.constituents.empty() ? scene.material.variants.front().setup.spec.density
                                    : mean_density(scene.constituents);
}

std::string no_cell_law_text(const std::vector<std::string>& problems, bool staged, bool shells) {
  return fmt::format(
      "no cell law of the coarsest level among its fines: {}; missing: cell_law.toml, the curve{} ({}); more grains "
      "([grains] count) or more samples may do",
      join_text(problems, "; "), shells ? "s \"cell law\" and \"shell law\"" : " \"cell law\"",
      staged ? "the stages do not need them" : "the result is the equation of state alone");
}

CellCard among_all_fines(const RecipeScene& scene, const CellCard& coarsest, const OnsetByForms& fines) {
  const auto ratio_of = [](double onset) { return 1.0 / onset - 1.0; };
  CellCard card = coarsest;
  const double value = ratio_of(fines.onset.value);
  const double factor = value / coarsest.void_ratio.value;
  card.void_ratio = {value, kInfinity, -kInfinity, kInfinity};
  if (interval_known(fines.onset.low, fines.onset.high))
    card.void_ratio = {value, fines.onset.standard_error / (fines.onset.value * fines.onset.value),
                       ratio_of(fines.onset.high), ratio_of(std::max(fines.onset.low, 1e-9))};
  Estimate& many = card.excess_many;
  many = {many.value * factor, many.standard_error * factor, many.low * factor, many.high * factor};
  card.density = grain_density(scene);
  card.youngs_modulus = scene.youngs_modulus;
  card.fines_ratio = scene.levels[1].high / scene.sizes.smallest();
  card.fines_sizes = fmt::format("{} levels of a recipe, put together", scene.levels.size() - 1);
  return card;
}

namespace {

/// One packing, mean over its usable samples; empty where one has none.
struct OneShape {
  std::vector<double> factor;
  std::vector<double> ratio;
};

OneShape shape_of_packing(const VariantResult& r, StateForm form, const StateFit& states) {
  const StateGroup* group = states.find(r.variant->name);
  const MacroSpec& spec = r.variant->setup.spec;
  if (group == nullptr) return {};
  const double k = states.modulus.value;
  const double n = states.exponent.value;
  const double start = state_phi(form, k, n, group->onset.value, spec.start_pressure);
  OneShape out;
  for (std::size_t point = 0; point < r.curves.front().strain.size(); ++point) {
    Tally factor;
    Tally ratio;
    for (const MacroCurve& c : r.curves) {
      if (!c.usable || point >= c.strain.size() || !(c.stress_axial[point] > 0.0)) continue;
      const double p = (c.stress_axial[point] + 2.0 * c.stress_lateral[point]) / 3.0 / c.start.youngs_modulus;
      factor.add(p / state_pressure(form, k, n, group->onset.value, std::min(1.0, start / (1.0 - c.strain[point]))));
      ratio.add(c.stress_lateral[point] / c.stress_axial[point]);
    }
    if (!std::isfinite(factor.mean())) return {};
    out.factor.push_back(factor.mean());
    out.ratio.push_back(ratio.mean());
  }
  return out;
}

Estimate ratio_estimate(double value, double deviation) {
  if (!std::isfinite(deviation)) return {value, kInfinity, -kInfinity, kInfinity};
  const double half = kNormal95 * deviation;
  return {value, deviation, std::max(0.0, value - half), value + half};
}

}  // namespace

std::size_t lateral_packing(const RecipeScene& scene, std::size_t count) {
  double all = 0.0;
  for (std::size_t k = 0; k < count; ++k) all += scene.levels[k].share;
  const double share = 1.0 - scene.levels[0].share / all;
  std::size_t best = 0;
  for (std::size_t m = 1; m < scene.mixtures.size(); ++m)
    if (std::abs(scene.mixtures[m] - share) < std::abs(scene.mixtures[best] - share)) best = m;
  return scene.mixed[0][best];
}

std::vector<double> end_ratios(const VariantResult& packing) {
  std::vector<double> out;
  for (const MacroCurve& c : packing.curves) {
    if (!c.usable || c.stress_axial.empty()) continue;
    const auto highest = std::ranges::max_element(c.stress_axial) - c.stress_axial.begin();
    const std::size_t k = c.test == MacroTest::stages ? static_cast<std::size_t>(highest) : c.stress_axial.size() - 1;
    if (c.stress_axial[k] > 0.0) out.push_back(c.stress_lateral[k] / c.stress_axial[k]);
  }
  return out;
}

Estimate predicted_lateral_ratio(const RecipeScene& scene, const std::vector<VariantResult>& results,
                                 std::size_t count) {
  Tally packings;
  for (std::size_t v = 0; v < results.size(); ++v)
    if (const auto ratios = end_ratios(results[v]);
        !results[v].variant->same_packings && scene.checked != v && !ratios.empty())
      packings.add(mean_error(ratios).mean);
  return ratio_estimate(mean_error(end_ratios(results[lateral_packing(scene, count)])).mean,
                        packings.statistics().deviation);
}

ResponseShape shape_of(const RecipeScene& scene, const std::vector<VariantResult>& results, const StateFit& states) {
  std::vector<OneShape> all;
  const std::size_t chosen = lateral_packing(scene, scene.levels.size());
  ResponseShape out;
  for (std::size_t v = 0; v < results.size(); ++v) {
    if (scene.checked == v || results[v].variant->setup.spec.test != MacroTest::oedometric) continue;
    OneShape one = shape_of_packing(results[v], scene.material.equation.form, states);
    if (one.factor.empty()) continue;
    if (v == chosen) out.ratio = one.ratio;
    if (out.strain.empty()) out.strain = results[v].curves.front().strain;
    if (one.factor.size() == out.strain.size()) all.push_back(std::move(one));
  }
  for (std::size_t k = 0; k < out.strain.size(); ++k) {
    Tally factor;
    Tally ratio;
    for (const OneShape& one : all) {
      factor.add(one.factor[k]);
      ratio.add(one.ratio[k]);
    }
    out.factor.push_back(factor.mean());
    out.factor_deviation.push_back(factor.statistics().deviation_or_zero());
    out.ratio_deviation.push_back(ratio.statistics().deviation_or_zero());
    if (out.ratio.size() == k) out.ratio.push_back(ratio.mean());
  }
  return out;
}

Estimate lateral_ratio(const ResponseShape& shape) {
  if (shape.ratio.empty()) return {};
  return ratio_estimate(shape.ratio.back(), shape.ratio_deviation.back());
}

Estimate solid_fraction_of(const WholeLaw& law) {
  const auto at = [&](double onset) {
    return state_phi(law.form, law.modulus.value, law.exponent.value, onset, law.start_pressure);
  };
  if (!interval_known(law.onset.low, law.onset.high)) return {at(law.onset.value), kInfinity, -kInfinity, kInfinity};
  const double low = at(law.onset.low);
  const double high = at(law.onset.high);
  return {at(law.onset.value), 0.5 * (high - low) / kNormal95, low, high};
}

RecipeCurve curve_of(const WholeLaw& law, double strain, std::int64_t steps) {
  RecipeCurve out{"material law", {}, {}, {}, {}, {}, ""};
  const Estimate start = solid_fraction_of(law);
  const auto pressure = [&](double onset, double from, double e) {
    return state_pressure(law.form, law.modulus.value, law.exponent.value, onset, std::min(from / (1.0 - e), 1.0));
  };
  const auto axial = [](double p, double ratio) { return 3.0 * p / (1.0 + 2.0 * ratio); };
  const ResponseShape& shape = law.shape;
  const bool known = interval_known(law.onset.low, law.onset.high);
  for (std::int64_t k = 0; k <= steps; ++k) {
    const double e = strain * static_cast<double>(k) / static_cast<double>(steps);
    const double factor = straight(shape.strain, shape.factor, e);
    const double ratio = straight(shape.strain, shape.ratio, e);
    const double of_factor = kNormal95 * straight(shape.strain, shape.factor_deviation, e);
    const double of_ratio = kNormal95 * straight(shape.strain, shape.ratio_deviation, e);
    const double value = axial(factor * pressure(law.onset.value, start.value, e), ratio);
    // Sides bear as much as the axis at most, or what they bore here: packings at rest can lie a little above.
    const double low = axial(std::max(0.0, factor - of_factor) * pressure(law.onset.low, start.low, e),
                             std::max(ratio, std::min(1.0, ratio + of_ratio)));
    const double high =
        axial((factor + of_factor) * pressure(law.onset.high, start.high, e), std::max(0.0, ratio - of_ratio));
    out.strain.push_back(e);
    out.axial.push_back(value);
    out.lateral.push_back(ratio * value);
    if (!known) continue;
    const double p = (value + 2.0 * out.lateral.back()) / 3.0;
    if (law.pressure_high > 0.0 && p > kHardlyBeyond * law.pressure_high) {  // nothing says how far off it is there
      out.low.push_back(kNaN);
      out.high.push_back(kNaN);
      continue;
    }
    out.low.push_back(std::min(low, value));
    out.high.push_back(std::max(high, value));  // an onset of 1 leaves no pores to press
  }
  return out;
}

std::array<double, 2> set_moduli(std::vector<RecipeCurve>& curves, std::array<double, 2> interval) {
  if (curves.empty() || curves.front().axial.size() < 2) return interval;
  if (!(interval[1] > 0.0)) {  // so far as the lower end of its band comes
    const RecipeCurve& first = curves.front();
    const auto known = std::find_if(first.low.rbegin(), first.low.rend(), [](double x) { return std::isfinite(x); });
    const double low = known == first.low.rend() ? first.axial.back() : *known;
    interval[1] = low > first.axial.front() ? low : first.axial.back();
    interval[0] = std::max(first.axial.front(), 0.5 * interval[1]);
  }
  for (RecipeCurve& c : curves) {
    std::vector<double> strain;
    for (const double e : c.strain) strain.push_back(-std::log1p(-e));
    const auto of = [&](const std::vector<double>& axial) {
      return secant_modulus(strain, axial, interval[0], interval[1]);
    };
    SecantModulus m{interval[0], interval[1], of(c.axial)};
    if (!std::isfinite(m.value)) continue;
    const double a = of(c.low);
    const double b = of(c.high);
    if (std::isfinite(a) && std::isfinite(b)) {
      m.low = std::min({a, b, m.value});
      m.high = std::max({a, b, m.value});
    }
    c.modulus = m;
  }
  return interval;
}

void write_material_card(const RecipeScene& scene, const WholeLaw& law, const std::string& path,
                         const Provenance& provenance) {
  const MacroSpec& spec = scene.material.variants.front().setup.spec;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "# The law of a material without shells, put together from its levels (softgrain, kind \"recipe\").\n"
      "# p/E = K x^n. \"porosity\": x = (phi - phi_J)/(1 - phi_J), \"pores\": x = 1 - Vp/Vp_J. phi counts the\n"
      "# full volume of all grains. K0: lateral over axial stress in oedometric compression.\n"
      "# Ends of intervals: 95 %; that of phi_J holds two ways of putting levels together.\n"
      "schema = {}\n\n[provenance]\nversion = {}\ncommit = {}\ncommand = {}\nseed = {}\n",
      kSchemaVersion, quoted(provenance.version), quoted(provenance.commit), quoted(provenance.command),
      quoted(fmt::format("{}", provenance.seed)));
  const Estimate ratio = lateral_ratio(law.shape);
  fmt::format_to(out, "\n[material]\nform = {}\nK = {}\nn = {}\nphi_J = {}\nK0 = {}\n", quoted(to_string(law.form)),
                 estimate_text(law.modulus), estimate_text(law.exponent), estimate_text(law.onset),
                 estimate_text(ratio));
  fmt::format_to(out, "\n[range]\npressure = [{}, {}]  # p/E of the fit\n", real(law.pressure_low),
                 real(law.pressure_high));
  fmt::format_to(
      out,
      "\n[measured]\nE = {}  # [Pa]\ndensity = {}  # [kg/m^3], mean over the solid volume\n"
      "nu = {}\nmu = {}\n{}preparation = {}\nstart_pressure = {}\nsamples = {}\n",
      real(scene.youngs_modulus), real(grain_density(scene)), real(spec.poisson_ratio), real(spec.friction),
      spec.rolling.friction > 0.0
          ? fmt::format("mu_r = {}\nkr_ratio = {}\n", real(spec.rolling.friction), real(spec.rolling.stiffness))
          : "",
      quoted(to_string(spec.preparation)), real(spec.start_pressure), scene.material.variants.front().setup.samples);
  for (const GrainMaterial& m : spec.grain_materials.each)
    fmt::format_to(out, "\n[[grain_material]]\nname = {}\nE = {}  # [Pa]\nnu = {}\nmu = {}\n", quoted(m.name),
                   real(m.youngs_modulus), real(m.poisson_ratio), real(m.friction));
  for (const RecipeLevel& level : scene.levels)
    fmt::format_to(out, "\n[[level]]\nradius_min = {}  # m\nradius_max = {}\nvolume_share = {}\n", real(level.low),
                   real(level.high), real(level.share));
  write_text_atomic(path, text);
}

}  // namespace softgrain

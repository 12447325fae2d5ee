#include "pipelines/kinds/recipe/law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibrate/state_curves.h"
#include "common/core/statistics.h"
#include "common/data/card_text.h"
#include "common/io/text_file.h"

namespace softgrain {

MaterialLaw fit_coarsest(const RecipeScene& scene, const std::vector<VariantResult>& results,
                         const std::optional<StateFit>& states, std::uint64_t seed) {
  MaterialLawScene law{scene.material,
                       pair_of(scene.levels[0], scene.levels[1], fines_over_coarse(scene, 0) /
                                                                     (1.0 + fines_over_coarse(scene, 0))),
                       cut_of_pair(scene.levels[0], scene.levels[1]), scene.mixtures, scene.cells};
  std::vector<VariantResult> some{results[scene.slice[1]], results[scene.sheared], results[scene.slice[0]]};
  for (const std::size_t v : scene.mixed[0]) some.push_back(results[v]);
  return fit_material_law(law, some, states, seed);
}

CellCard among_all_fines(const RecipeScene& scene, const CellCard& coarsest, const OnsetByForms& fines) {
  const auto ratio_of = [](double onset) { return 1.0 / onset - 1.0; };
  CellCard card = coarsest;
  const double value = ratio_of(fines.onset.value);
  const double factor = value / coarsest.void_ratio.value;
  card.void_ratio = {value, fines.onset.standard_error / (fines.onset.value * fines.onset.value),
                     ratio_of(fines.onset.high), ratio_of(std::max(fines.onset.low, 1e-9))};
  Estimate& many = card.excess_many;
  many = {many.value * factor, many.standard_error * factor, many.low * factor, many.high * factor};
  card.fines_ratio = scene.levels[1].high / scene.sizes.smallest();
  card.fines_sizes = fmt::format("{} levels of a recipe, put together", scene.levels.size() - 1);
  return card;
}

LateralRatio lateral_ratio(const RecipeScene& scene, const std::vector<VariantResult>& results) {
  const auto mean_of = [](const VariantResult& r) {
    Tally at_end;
    for (const MacroCurve& c : r.curves)
      if (c.usable && !c.stress_axial.empty() && c.stress_axial.back() > 0.0)
        at_end.add(c.stress_lateral.back() / c.stress_axial.back());
    return at_end.mean();
  };
  LateralRatio out;
  std::vector<double> all;
  for (const VariantResult& r : results) {
    if (r.variant->setup.spec.test != MacroTest::oedometric) continue;
    const double one = mean_of(r);
    if (std::isfinite(one)) all.push_back(one);
  }
  if (all.empty()) return out;
  const double share = 1.0 - scene.levels[0].share;
  std::size_t nearest = scene.mixed[0].front();
  for (std::size_t m = 0; m < scene.mixtures.size(); ++m)
    if (std::abs(scene.mixtures[m] - share) <
        std::abs(scene.mixtures[static_cast<std::size_t>(
                     std::find(scene.mixed[0].begin(), scene.mixed[0].end(), nearest) - scene.mixed[0].begin())] -
                 share))
      nearest = scene.mixed[0][m];
  out.value = mean_of(results[scene.checked ? *scene.checked : nearest]);
  if (!std::isfinite(out.value)) out.value = mean_error(all).mean;
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  out.low = *low;
  out.high = *high;
  return out;
}

Estimate solid_fraction_of(const WholeLaw& law) {
  const auto at = [&](double onset) {
    return state_phi(law.form, law.modulus.value, law.exponent.value, onset, law.start_pressure);
  };
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
  const double scatter = kNormal95 * law.modulus_scatter;
  for (std::int64_t k = 0; k <= steps; ++k) {
    const double e = strain * static_cast<double>(k) / static_cast<double>(steps);
    const double p = pressure(law.onset.value, start.value, e);
    out.strain.push_back(e);
    out.axial.push_back(axial(p, law.lateral.value));
    out.lateral.push_back(law.lateral.value * out.axial.back());
    const bool moved = k > 0;  // the start pressure is given
    out.low.push_back(axial(moved ? pressure(law.onset.low, start.low, e) * std::max(0.0, 1.0 - scatter) : p,
                            law.lateral.high));
    out.high.push_back(axial(moved ? pressure(law.onset.high, start.high, e) * (1.0 + scatter) : p, law.lateral.low));
  }
  return out;
}

void write_material_card(const RecipeScene& scene, const WholeLaw& law, const std::string& path,
                         const Provenance& provenance) {
  const MacroSpec& spec = scene.material.variants.front().setup.spec;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "# The law of a material without shells, put together from its levels (softgrain, kind \"recipe\").\n"
                 "# p/E = K x^n. \"porosity\": x = (phi - phi_J)/(1 - phi_J), \"pores\": x = 1 - Vp/Vp_J. phi counts the\n"
                 "# full volume of all grains. K0: lateral over axial stress in oedometric compression.\n"
                 "# Ends of intervals: 95 %; that of phi_J holds two ways of putting levels together.\n"
                 "schema = {}\n\n[provenance]\nversion = {}\ncommit = {}\ncommand = {}\nseed = {}\n",
                 kSchemaVersion, quoted(provenance.version), quoted(provenance.commit), quoted(provenance.command),
                 quoted(fmt::format("{}", provenance.seed)));
  const Estimate ratio{law.lateral.value, (law.lateral.high - law.lateral.low) / 4.0, law.lateral.low,
                       law.lateral.high};
  fmt::format_to(out, "\n[material]\nform = {}\nK = {}\nn = {}\nphi_J = {}\nK0 = {}\n", quoted(to_string(law.form)),
                 estimate_text(law.modulus), estimate_text(law.exponent), estimate_text(law.onset),
                 estimate_text(ratio));
  fmt::format_to(out, "\n[range]\npressure = [{}, {}]  # p/E of the fit\n", real(law.pressure_low),
                 real(law.pressure_high));
  fmt::format_to(out, "\n[measured]\nnu = {}\nmu = {}\npreparation = {}\nstart_pressure = {}\nsamples = {}\n",
                 real(spec.poisson_ratio), real(spec.friction), quoted(to_string(spec.preparation)),
                 real(spec.start_pressure), scene.material.variants.front().setup.samples);
  for (const RecipeLevel& level : scene.levels)
    fmt::format_to(out, "\n[[level]]\nradius_min = {}  # m\nradius_max = {}\nvolume_share = {}\n", real(level.low),
                   real(level.high), real(level.share));
  write_text_atomic(path, text);
}

}  // namespace softgrain

#include "pipelines/kinds/recipe/stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "calibrate/state_curves.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/data/law_words.h"
#include "macrosim/body_contacts.h"
#include "macrosim/test_protocol.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

MacroCurve first_stage_of(MacroCurve c) {
  const auto beyond = std::ranges::find_if(c.stage, [](double stage) { return stage > 0.0; });
  if (beyond == c.stage.end()) return c;
  const auto points = static_cast<std::size_t>(beyond - c.stage.begin());
  const auto cut = [&](auto& values) {
    if (values.size() > points) values.resize(points);
  };
  for (auto* column : {&c.strain,
                       &c.stress_axial,
                       &c.stress_lateral,
                       &c.stress_axial_contacts,
                       &c.coordination,
                       &c.residual,
                       &c.residual_largest,
                       &c.stress_x,
                       &c.stress_y,
                       &c.stress_deviator,
                       &c.fabric,
                       &c.fabric_bodies,
                       &c.coordination_bodies,
                       &c.law_evaluations,
                       &c.law_beyond,
                       &c.law_largest,
                       &c.stage,
                       &c.strain_x,
                       &c.strain_y,
                       &c.strain_z})
    cut(*column);
  for (auto& [name, values] : c.more) cut(values);
  for (auto& draw : c.drawn_axial) cut(draw);
  cut(c.places);
  if (c.stages.size() > 1) c.stages.resize(1);
  return c;
}

namespace {

bool came_to_the_end(const MacroCurve& c, std::size_t points) {
  return c.usable && c.strain.size() == points && c.more.contains(kSolidFraction);
}

std::vector<double> mean_over(const std::vector<const MacroCurve*>& curves,
                              const std::function<const std::vector<double>&(const MacroCurve&)>& column) {
  std::vector<double> out;
  for (std::size_t k = 0; k < curves.front()->strain.size(); ++k) {
    Tally tally;
    for (const MacroCurve* c : curves) tally.add(column(*c)[k]);
    out.push_back(tally.mean());
  }
  return out;
}

/// A packing was loaded to stresses over the E of its own grains: those of the whole are this factor higher.
void take_scale(double factor, StatePath& path, std::vector<StageRecord>& stages) {
  for (auto* stresses : {&path.axial, &path.lateral})
    for (double& stress : *stresses) stress *= factor;
  for (StageRecord& stage : stages)
    for (double& stress : stage.modulus_stress) stress *= factor;
}

}  // namespace

StatePaths paths_of(const RecipeScene& scene, const std::vector<VariantResult>& results, const StateFit& states) {
  StatePaths out;
  out.form = scene.material.equation.form;
  const std::size_t chosen = lateral_packing(scene, scene.levels.size());
  for (std::size_t v = 0; v < results.size(); ++v) {
    const MaterialVariant& variant = *results[v].variant;
    const StateGroup* group = states.find(variant.name);
    if (variant.same_packings || scene.checked == v || group == nullptr) continue;
    const auto points = static_cast<std::size_t>(recorded_points(variant.setup.spec));
    std::vector<const MacroCurve*> curves;
    for (const MacroCurve& c : results[v].curves)
      if (came_to_the_end(c, points)) curves.push_back(&c);
    if (curves.empty()) continue;
    if (v == chosen) out.lateral_of = out.packings.size();
    out.stages = curves.front()->stages;
    out.stage = curves.front()->stage;
    StatePath path{variant.name, {}, {}, {}};
    for (const double phi : mean_over(
             curves, [](const MacroCurve& c) -> auto& { return c.more.at(kSolidFraction); }))
      path.state.push_back(state_of_phi(out.form, group->onset.value, phi));
    path.axial = mean_over(
        curves, [](const MacroCurve& c) -> auto& { return c.stress_axial; });
    path.lateral = mean_over(
        curves, [](const MacroCurve& c) -> auto& { return c.stress_lateral; });
    if (const double own = variant.setup.spec.youngs_modulus; own != scene.youngs_modulus)
      take_scale(scene.youngs_modulus / own, path, out.stages);
    out.packings.push_back(std::move(path));
  }
  return out;
}

MacroCurve carried_over(const StatePaths& paths, const StatePath& packing, double onset) {
  MacroCurve c;
  c.test = MacroTest::stages;
  c.stages = paths.stages;
  c.stage = paths.stage;
  c.stress_axial = packing.axial;
  c.stress_lateral = c.stress_x = c.stress_y = packing.lateral;
  std::vector<double>& phi = c.more[kSolidFraction];
  for (const double x : packing.state) phi.push_back(phi_of_state(paths.form, onset, x));
  for (const double now : phi) c.strain_z.push_back(1.0 - phi.front() / now);
  c.strain = c.strain_z;
  c.strain_x.assign(phi.size(), 0.0);
  c.strain_y = c.strain_x;
  return c;
}

namespace {

/// What is said of a point, and of a stage.
struct PointNumbers {
  double strain, axial, lateral_ratio, void_ratio;
};
struct StageNumbers {
  double from, to, secant, begin, end, index, lateral_ratio, void_ratio;
};

std::vector<double> void_ratios(const MacroCurve& c) {
  std::vector<double> out;
  for (const double phi : c.more.at(kSolidFraction)) out.push_back(1.0 / phi - 1.0);
  return out;
}

std::vector<PointNumbers> points_of_curve(const MacroCurve& c) {
  std::vector<PointNumbers> out;
  const std::vector<double> e = void_ratios(c);
  for (std::size_t k = 0; k < c.strain.size(); ++k)
    out.push_back({c.strain_z[k], c.stress_axial[k], c.stress_lateral[k] / c.stress_axial[k], e[k]});
  return out;
}

/// Points of stage `stage`, the one that it begins at included.
std::vector<double> part_of(const std::vector<double>& values, const std::vector<double>& stage, double number) {
  std::vector<double> out;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (stage[k] == number || (k + 1 < stage.size() && stage[k + 1] == number)) out.push_back(values[k]);
  return out;
}

std::vector<StageNumbers> stages_of_curve(const MacroCurve& c) {
  std::vector<StageNumbers> out;
  const std::vector<double> e = void_ratios(c);
  double number = 0.0;
  for (const StageResult& r : stage_results(c)) {
    const std::vector<double> pores = part_of(e, c.stage, number);
    const double index =
        compression_index(pores, part_of(c.stress_axial, c.stage, number), r.modulus_from, r.modulus_to);
    out.push_back({r.modulus_from, r.modulus_to, r.modulus, r.modulus_begin, r.modulus_end, index,
                   r.lateral_end / r.axial_end, pores.back()});
    number += 1.0;
  }
  return out;
}

/// One number at the value and at both ends of the onset, of all packings.
using ByOnset = std::array<std::vector<double>, 3>;

/// Mean and interval, see whole_under_stages(); `value`: in place of the mean. No interval without one of the onset.
Estimate spread_of(const ByOnset& numbers, bool known, std::optional<double> value = {}) {
  const MeanError at = finite_mean(numbers[0]);
  Estimate out{value.value_or(at.mean), kInfinity, -kInfinity, kInfinity};
  if (!std::isfinite(out.value)) return {kNaN, kNaN, kNaN, kNaN};
  if (!known) return out;
  out.low = out.high = out.value;
  for (const std::vector<double>& packings : numbers) {
    const MeanError mean = finite_mean(packings);
    const double half = kNormal95 * mean.deviation_or_zero();
    const double middle = value.value_or(mean.mean);
    out.low = std::min(out.low, middle - half);
    out.high = std::max(out.high, middle + half);
  }
  out.low = std::max(out.low, std::min(0.0, out.value));  // none of these quantities is below 0
  out.standard_error = 0.5 * (out.high - out.low) / kNormal95;
  return out;
}

/// Curves of all packings at the value of the onset and at its ends.
struct CarriedCurves {
  std::array<std::vector<std::vector<PointNumbers>>, 3> points;
  std::array<std::vector<std::vector<StageNumbers>>, 3> stages;
  bool known = true;
  std::optional<std::size_t> lateral_of;

  CarriedCurves(const StatePaths& paths, const Estimate& onset)
      : known(interval_known(onset.low, onset.high)), lateral_of(paths.lateral_of) {
    const std::array ends{onset.value, known ? onset.low : onset.value, known ? onset.high : onset.value};
    for (std::size_t o = 0; o < ends.size(); ++o)
      for (const StatePath& packing : paths.packings) {
        const MacroCurve c = carried_over(paths, packing, ends[o]);
        points[o].push_back(points_of_curve(c));
        stages[o].push_back(stages_of_curve(c));
      }
  }

  template <class Numbers>
  [[nodiscard]] Estimate estimate(const std::array<std::vector<std::vector<Numbers>>, 3>& of, std::size_t k,
                                  double Numbers::*member) const {
    ByOnset numbers;
    for (std::size_t o = 0; o < of.size(); ++o)
      for (const auto& packing : of[o]) numbers[o].push_back(packing[k].*member);
    const bool chosen = lateral_of && member == &Numbers::lateral_ratio;
    return spread_of(numbers, known, chosen ? std::optional(numbers[0][*lateral_of]) : std::nullopt);
  }
};

std::optional<MeanError> measured_mean(const std::vector<std::vector<StageNumbers>>& samples, std::size_t k,
                                       double StageNumbers::*member) {
  std::vector<double> values;
  for (const auto& sample : samples)
    if (k < sample.size()) values.push_back(sample[k].*member);
  const MeanError mean = finite_mean(values);
  return mean.n > 0 ? std::optional(mean) : std::nullopt;
}

}  // namespace

RecipeStages whole_under_stages(const StatePaths& paths, const Estimate& onset,
                                const std::vector<MacroCurve>& resolved) {
  RecipeStages out;
  if (paths.packings.empty()) return out;
  const CarriedCurves carried(paths, onset);
  for (std::size_t k = 0; k < paths.stage.size(); ++k) {
    const auto at = [&](double PointNumbers::*member) { return carried.estimate(carried.points, k, member); };
    out.points.push_back({paths.stages[static_cast<std::size_t>(paths.stage[k])].name, at(&PointNumbers::axial).value,
                          at(&PointNumbers::strain), at(&PointNumbers::lateral_ratio), at(&PointNumbers::void_ratio)});
  }
  std::vector<std::vector<StageNumbers>> samples;
  for (const MacroCurve& c : resolved)
    if (came_to_the_end(c, paths.stage.size())) samples.push_back(stages_of_curve(c));
  for (std::size_t k = 0; k < carried.stages[0].front().size(); ++k) {
    const auto value = [&](double StageNumbers::*member) {
      return PredictedValue{carried.estimate(carried.stages, k, member), measured_mean(samples, k, member)};
    };
    RecipeStageSummary s;
    s.name = paths.stages[k].name;
    s.kind = paths.stages[k].kind;
    s.stress_from = value(&StageNumbers::from).predicted.value;
    s.stress_to = value(&StageNumbers::to).predicted.value;
    s.secant = value(&StageNumbers::secant);
    s.tangent_begin = value(&StageNumbers::begin);
    s.tangent_end = value(&StageNumbers::end);
    s.index = value(&StageNumbers::index);
    s.lateral_ratio = value(&StageNumbers::lateral_ratio);
    s.void_ratio = value(&StageNumbers::void_ratio);
    for (std::size_t point = 0; point < paths.stage.size(); ++point)
      if (paths.stage[point] == static_cast<double>(k)) s.stress_end = out.points[point].axial;
    out.stages.push_back(std::move(s));
  }
  return out;
}

namespace {

std::size_t highest_point(const RecipeStages& stages) {
  const auto highest = std::ranges::max_element(stages.points, {}, &RecipePoint::axial);
  return static_cast<std::size_t>(highest - stages.points.begin());
}

}  // namespace

ResponseShape shape_of_stages(const RecipeStages& stages) {
  if (stages.points.empty()) return {};
  const RecipePoint& p = stages.points[highest_point(stages)];
  return {{p.strain.value}, {1.0}, {0.0}, {p.lateral_ratio.value}, {p.lateral_ratio.standard_error}};
}

RecipeCurve curve_of_stages(const RecipeStages& stages, double modulus) {
  RecipeCurve out{"material law", {}, {}, {}, {}, {}, ""};
  for (const RecipePoint& p : stages.points) {
    out.strain.push_back(p.strain.value);
    out.axial.push_back(p.axial / modulus);
    out.lateral.push_back(p.lateral_ratio.value * p.axial / modulus);
  }
  return out;
}

std::vector<StageQuantity> quantities_of(const RecipeStageSummary& s) {
  const std::string of = ", " + s.name;
  return {{"constrained modulus" + of, "Pa", s.secant.predicted},
          {"K0 at the end" + of, "", s.lateral_ratio.predicted},
          {"void ratio at the end" + of, "", s.void_ratio.predicted},
          {s.index_name() + of, "", s.index.predicted}};
}

TextTable stages_table(const RecipeStages& stages) {
  TextTable t{{"stage", "axial [Pa]", "lateral [Pa]", "strain", "strain_low", "strain_high", "K0", "K0_low", "K0_high",
               "void_ratio", "void_ratio_low", "void_ratio_high"},
              {}};
  const auto number = [](double value) { return std::isfinite(value) ? fmt::format("{:.8g}", value) : ""; };
  for (const RecipePoint& p : stages.points) {
    std::vector<std::string> row{p.stage, number(p.axial), number(p.lateral_ratio.value * p.axial)};
    for (const Estimate* e : {&p.strain, &p.lateral_ratio, &p.void_ratio})
      for (const double value : {e->value, e->low, e->high}) row.push_back(number(value));
    t.rows.push_back(std::move(row));
  }
  return t;
}

}  // namespace softgrain

#include "pipelines/kinds/material_law/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "calibrate/excess_pores_fit.h"
#include "calibrate/face_friction_fit.h"
#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "macrosim/cell_matter/face_springs.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/material_law/fines_in_cells.h"
#include "pipelines/kinds/material_law/memory_fit.h"

namespace softgrain {

namespace {

class MaterialLawFit {
 public:
  MaterialLawFit(const MaterialLawScene& scene, const std::vector<VariantResult>& results, const StateFit& states,
                 std::uint64_t seed)
      : scene_(scene), results_(results), states_(states), seed_(seed) {}

  MaterialLaw run() {
    out_.summary.form = out_.card.form = scene_.material.equation.form;
    out_.summary.split = out_.card.split = scene_.split;
    describe();
    out_.card.modulus = states_.modulus;
    out_.card.exponent = states_.exponent;
    add("K", out_.card.modulus);
    add("n", out_.card.exponent);
    fit_excess();
    compare_preparations();
    lateral_ratio();
    if (scene_.memory)
      fit_memory();
    else
      fit_friction();
    if (out_.problems.empty()) out_.card.correlation = correlation_of_card(out_.card, states_, pores_, faces_);
    out_.summary.usable = out_.problems.empty();
    return std::move(out_);
  }

 private:
  void add(const char* name, const Estimate& e) { out_.summary.numbers.push_back({name, e}); }

  [[nodiscard]] const VariantResult& result(std::size_t place) const { return results_[place]; }

  /// What it was measured on.
  void describe() {
    const MacroSpec& spec = result(scene_.at.fines).variant->setup.spec;
    CellCard& card = out_.card;
    card.youngs_modulus = spec.youngs_modulus;
    card.density = spec.density;
    card.poisson_ratio = spec.poisson_ratio;
    card.grain_friction = spec.friction;
    card.grain_rolling = spec.rolling;
    card.preparation = to_string(spec.preparation);
    card.start_pressure = spec.start_pressure;
    card.fines_ratio = spec.solid_sizes->largest() / spec.solid_sizes->smallest();
    const Grading& whole = scene_.sizes;
    card.fines_sizes = whole.form() == GradingForm::power_law
                           ? fmt::format("power law r^-{:g}", whole.pieces().front().exponent)
                           : fmt::format("{}, cut at the split", to_string(whole.form()));
    card.samples = result(scene_.at.fines).variant->setup.samples;
    std::tie(card.pressure_low, card.pressure_high) = std::tuple_cat(pressure_range(results_));
  }

  /// Grains of all samples of a mixture together.
  [[nodiscard]] GrainShares grains_of(const MaterialVariant& v) const {
    GrainShares all;
    for (std::int64_t s = 0; s < v.setup.samples; ++s) {
      const GrainShares one = shares_of(scene_, v, seed_, static_cast<std::uint64_t>(s));
      all.coarse += one.coarse;
      all.fines += one.fines;
      all.coarse_volume += one.coarse_volume;
      all.fines_volume += one.fines_volume;
    }
    return all;
  }

  void fit_excess() {
    MixtureGroups groups{result(scene_.at.fines).variant->name, result(scene_.at.coarse).variant->name, {}};
    std::vector<GrainShares> shares;
    for (std::size_t k = scene_.at.first_mixture; k < results_.size(); ++k) {
      shares.push_back(grains_of(*results_[k].variant));
      const double ratio = shares.back().fines_volume / shares.back().coarse_volume;
      groups.mixtures.push_back({results_[k].variant->name, ratio});
      out_.card.mixture_high = std::max(out_.card.mixture_high, ratio);
    }
    const ExcessPoresFit fit = fit_excess_pores(states_, groups);
    for (std::size_t k = 0; k < fit.mixtures.size(); ++k) {
      const MixturePores& m = fit.mixtures[k];
      out_.summary.mixtures.push_back({m.name, m.ratio, shares[k].coarse, shares[k].fines, m.pores, m.fitted});
    }
    pores_ = fit.replicates;
    out_.card.void_ratio = fit.void_ratio;
    out_.card.excess_alone = fit.alone;
    add("e_J", fit.void_ratio);
    add("e_c", fit.alone);
    if (!fit.usable) {
      out_.problems.push_back("excess pores: " + fit.message);
      return;
    }
    out_.card.excess_many = fit.many;
    out_.card.excess_decay = fit.decay;
    add("w_inf", fit.many);
    add("xi", fit.decay);
    BandSummary band;
    for (const ExcessPoresBand& b : fit.band) {
      band.ratio.push_back(b.ratio);
      band.value.push_back(b.value);
      band.low.push_back(b.low);
      band.high.push_back(b.high);
    }
    out_.summary.band = std::move(band);
    out_.summary.excess_deviation = fit.deviation;
    out_.summary.excess_widening = fit.widening;
  }

  void compare_preparations() {
    const std::vector<MacroCurve>& own = result(scene_.at.fines).curves;
    for (const std::size_t place : scene_.at.preparations) {
      const std::string name = to_string(result(place).variant->setup.spec.preparation);
      const std::optional<Estimate> factor = preparation_factor(out_.card.form, out_.card.modulus.value,
                                                                out_.card.exponent.value, own, result(place).curves);
      if (!factor) {
        out_.problems.push_back("no sample of fines came to rest both as the card's and prepared '" + name + "'");
        continue;
      }
      out_.card.preparations.push_back({name, *factor});
      out_.summary.void_ratio_factors.push_back({name, *factor});
    }
  }

  /// Adds K0, the lateral over the axial stress of the fines, mean over the recorded points of the compression.
  void lateral_ratio() {
    std::vector<double> samples;
    for (const MacroCurve& c : result(scene_.memory ? scene_.at.oedometer : scene_.at.fines).curves) {
      std::vector<double> ratios;
      for (std::size_t k = 1; k < c.strain.size() && c.stage[k] == 0; ++k)
        if (c.stress_axial[k] > 0.0) ratios.push_back(c.stress_lateral[k] / c.stress_axial[k]);
      if (!ratios.empty()) samples.push_back(mean_error(ratios).mean);
    }
    if (samples.empty()) return;
    out_.card.lateral_ratio = mean_estimate(mean_error(samples), 0.0);
    add("K0", out_.card.lateral_ratio);
  }

  void fit_memory() {
    std::vector<ShearPath> paths;
    for (const std::size_t test : scene_.at.shear_tests)
      for (const MacroCurve& c : result(test).curves) {
        if (!c.usable) {
          out_.problems.push_back("shear memory: a test of the fines did not come to its end: " +
                                  result(test).variant->name);
          return;
        }
        paths.push_back(ShearPath::of(c));
      }
    const FinesBase fines{out_.card.modulus.value, out_.card.exponent.value, out_.card.void_ratio.value,
                          out_.card.start_pressure};
    const ShearMemoryFit fit = fit_shear_memory(fines, paths, scene_.dense);
    if (!fit.usable) {
      out_.problems.push_back("shear memory: " + fit.message);
      return;
    }
    out_.card.friction = fit.friction;
    out_.card.stiffness = fit.stiffness;
    out_.card.memory = fit.memory;
    faces_ = fit.correlation;
    out_.summary.friction_deviation = fit.deviation;
    out_.summary.undetermined = fit.undetermined;
    const std::vector<CellCardNumber> all = numbers_of(out_.card);
    for (auto n = std::ranges::find(all, "mu_f", &CellCardNumber::key); n != all.end(); ++n)
      if (n->key != "K0") out_.summary.numbers.push_back({n->key, n->estimate});
    add_memory_curves(fines, fit);
  }

  /// Mean pressure and stress ratio of every test, and the law from the start of its first sample.
  void add_memory_curves(const FinesBase& fines, const ShearMemoryFit& fit) {
    const ShearNumbers numbers{fit.friction.value, fit.stiffness.value, fit.memory};
    for (const std::size_t test : scene_.at.shear_tests) {
      std::vector<ShearPath> paths;
      std::vector<ShearPrediction> laws;
      for (const MacroCurve& c : result(test).curves) {
        paths.push_back(ShearPath::of(c));
        laws.push_back(predict(fines, numbers, paths.back()));
      }
      const auto add_measure = [&](const char* measure, const std::function<double(const Vec3&)>& of) {
        FrictionCurve curve{result(test).variant->name, measure, {}, {}, {}, {}};
        for (std::size_t k = 1; k < paths.front().strain.size(); ++k) {
          std::vector<double> values;
          std::vector<double> model;
          for (std::size_t s = 0; s < paths.size(); ++s) {
            if (paths[s].stress.size() > k) values.push_back(of(paths[s].stress[k]));
            if (laws[s].stress.size() > k) model.push_back(of(laws[s].stress[k]));
          }
          const MeanError mean = mean_error(values);
          curve.strain.push_back(-std::expm1(-paths.front().strain[k][2]));
          curve.measured.push_back(mean.mean);
          curve.error.push_back(mean.error);
          curve.fitted.push_back(model.empty() ? kNaN : mean_error(model).mean);
        }
        out_.summary.curves.push_back(std::move(curve));
      };
      add_measure("p/E", [](const Vec3& s) { return (s[0] + s[1] + s[2]) / 3.0; });
      add_measure("(sigma_z - sigma_x)/p",
                  [](const Vec3& s) { return 3.0 * (s[2] - 0.5 * (s[0] + s[1])) / (s[0] + s[1] + s[2]); });
    }
  }

  void fit_friction() {
    const std::array<const VariantResult*, 2> tests{&result(scene_.at.fines), &result(scene_.at.sheared_fines)};
    for (const VariantResult* test : tests)
      for (const MacroCurve& c : test->curves)
        if (!c.usable || c.strain.size() != test->curves.front().strain.size()) {
          out_.problems.push_back("face friction: a test of the fines did not come to its end");
          return;
        }
    const std::vector<FinesPath> paths{path_of(tests[0]->curves.front(), FinesMeasure::lateral_ratio),
                                       path_of(tests[1]->curves.front(), FinesMeasure::stress_ratio)};
    FaceFrictionData data;
    for (const FinesPath& path : paths)
      data.weight.insert(data.weight.end(), path.compared, 1.0 / static_cast<double>(path.compared));
    for (std::size_t s = 0; s < tests[0]->curves.size(); ++s) {
      data.samples.emplace_back();
      for (std::size_t t = 0; t < paths.size(); ++t)
        for (const double value : measured_on(tests[t]->curves[s], paths[t])) data.samples.back().push_back(value);
    }
    const FinesState state{out_.card.form, out_.card.modulus.value, out_.card.exponent.value,
                           out_.card.void_ratio.value, out_.card.start_pressure};
    const MacroPacking sites = pack_sites(scene_.cells, seed_);
    const FaceFrictionFit fit = fit_face_friction(
        [&](const std::vector<FaceFrictionTrial>& trials) { return strain_fines(sites, state, trials, paths); }, data);
    add_curves(fit, data, paths);
    if (!fit.usable) {
      out_.problems.push_back("face friction: " + fit.message);
      return;
    }
    out_.card.friction = fit.friction;
    out_.card.stiffness = fit.stiffness;
    faces_ = {{"mu_f", "chi"}, {1.0, 0.0, 0.0, 1.0}};
    out_.summary.friction_deviation = fit.deviation;
    add("mu_f", fit.friction);
    add("chi", fit.stiffness);
  }

  void add_curves(const FaceFrictionFit& fit, const FaceFrictionData& data, const std::vector<FinesPath>& paths) {
    std::size_t at = 0;
    for (std::size_t t = 0; t < paths.size(); ++t) {
      const std::size_t of = t == 0 ? scene_.at.fines : scene_.at.sheared_fines;
      const MacroCurve& c = result(of).curves.front();
      FrictionCurve curve{result(of).variant->name, t == 0 ? "lateral/axial" : "q/p", {}, {}, {}, {}};
      const std::size_t before = paths[t].points.size() - paths[t].compared;
      for (std::size_t k = before; k < paths[t].points.size(); ++k, ++at) {
        std::vector<double> values;
        for (const auto& row : data.samples)
          if (std::isfinite(row[at])) values.push_back(row[at]);
        const MeanError mean = mean_error(values);
        curve.strain.push_back(1.0 - (1.0 - c.strain_z[paths[t].points[k]]) /
                                         (1.0 - c.strain_z[paths[t].points[before - 1]]));
        curve.measured.push_back(mean.mean);
        curve.error.push_back(mean.error);
        curve.fitted.push_back(fit.model.empty() ? kNaN : fit.model[at]);
      }
      out_.summary.curves.push_back(std::move(curve));
    }
  }

  const MaterialLawScene& scene_;
  const std::vector<VariantResult>& results_;
  const StateFit& states_;
  std::uint64_t seed_;
  MaterialLaw out_;
  std::vector<std::array<double, 4>> pores_;  ///< as ExcessPoresFit::replicates
  CellCorrelation faces_;                     ///< of mu_f, chi and what shear leaves behind
};

/// The variant that tells an onset of the law and that the fit does not know; empty where there is none.
std::string missing_group(const MaterialLawScene& scene, const std::vector<VariantResult>& results,
                          const StateFit& states) {
  const std::vector<std::size_t>& prepared = scene.at.preparations;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const MaterialVariant& v = *results[k].variant;
    if (v.same_packings || std::ranges::find(prepared, k) != prepared.end()) continue;
    if (states.find(v.name) == nullptr) return v.name;
  }
  return "";
}

}  // namespace

MaterialLaw fit_material_law(const MaterialLawScene& scene, const std::vector<VariantResult>& results,
                             const std::optional<StateFit>& states, std::uint64_t seed) {
  MaterialLaw none;
  none.summary.form = scene.material.equation.form;
  none.summary.split = scene.split;
  if (!states || !states->usable) {
    none.problems.push_back("the equation of state is not usable" +
                            (states ? ": " + states->message : std::string(": too few points with pressure")));
    return none;
  }
  if (const std::string name = missing_group(scene, results, *states); !name.empty()) {
    none.problems.push_back(name + " bears at too few points to tell its onset");
    return none;
  }
  if (!(states->exponent.value > 1.0)) {
    none.problems.push_back(fmt::format(
        "n = {:.3g} of the equation of state: must be above 1, or the stiffness of cells jumps at the onset",
        states->exponent.value));
    return none;
  }
  return MaterialLawFit(scene, results, *states, seed).run();
}

}  // namespace softgrain

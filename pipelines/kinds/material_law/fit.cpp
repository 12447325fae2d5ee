// Fines alone in cells, strained as measured samples were; then the fit of the cell law.
#include "pipelines/kinds/material_law/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "calibrate/draws.h"
#include "calibrate/excess_pores_fit.h"
#include "calibrate/face_friction_fit.h"
#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"
#include "common/io/interrupt.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/face_springs.h"
#include "macrosim/preparation.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/material_law/memory_fit.h"

namespace softgrain {

namespace {

/// Bodies of one size would order.
constexpr double kSiteRatio = 1.5;
/// Compared points of a stage: steps of one percent give what those of a quarter do.
constexpr std::size_t kComparedPoints = 8;
/// Tolerance of a relaxation; at a tenth of it stress ratios differ by 1e-4.
constexpr double kTolerance = 1e-2;

std::size_t last_stage_begins(const MacroCurve& curve) {
  std::size_t first = curve.stage.size();
  while (first > 1 && curve.stage[first - 1] == curve.stage.back()) --first;
  return first;
}

EquationOfState equation_of_fines(const FinesState& s) {
  if (s.form == StateForm::porosity) return PorosityForm{s.modulus, s.exponent};
  return PoreForm{s.modulus, s.exponent};
}

/// Image of a point in the periodic cell whose low corner is the origin.
Vec3 home(const Vec3& x, const Vec3& size) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) {
    out[k] = x[k] - size[k] * std::floor(x[k] / size[k]);
    if (!(out[k] < size[k])) out[k] = 0.0;
  }
  return out;
}

double measure_of(const Matrix<3>& stress, FinesMeasure measure) {
  const double x = stress[0][0];
  const double y = stress[1][1];
  const double z = stress[2][2];
  if (measure == FinesMeasure::lateral_ratio) return 0.5 * (x + y) / z;
  const double q = std::sqrt(0.5 * ((x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x)));
  return 3.0 * q / (x + y + z);
}

}  // namespace

FinesPath path_of(const MacroCurve& curve, FinesMeasure measure) {
  FinesPath path;
  path.measure = measure;
  const std::size_t first = last_stage_begins(curve);
  const std::size_t all = curve.strain_z.size();
  const std::size_t every = std::max<std::size_t>(1, (all - first) / kComparedPoints);
  for (std::size_t k = 0; k < all; ++k)
    if (k < first || (all - 1 - k) % every == 0) {
      path.points.push_back(k);
      path.length.push_back({{1.0 - curve.strain_x[k], 1.0 - curve.strain_y[k], 1.0 - curve.strain_z[k]}});
      path.compared += k < first ? 0 : 1;
    }
  return path;
}

std::vector<double> measured_on(const MacroCurve& curve, const FinesPath& path) {
  std::vector<double> out;
  const std::vector<double> ratio = stress_ratios(curve);
  for (std::size_t at = path.points.size() - path.compared; at < path.points.size(); ++at) {
    const std::size_t k = path.points[at];
    out.push_back(path.measure == FinesMeasure::stress_ratio ? ratio[k]
                                                             : curve.stress_lateral[k] / curve.stress_axial[k]);
  }
  return out;
}

MacroPacking pack_sites(std::int64_t count, std::uint64_t seed) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.soft_share = 0.0;
  spec.bodies = count;
  spec.solid_polydispersity = kSiteRatio;
  spec.start_pressure = 1e-4;
  spec.protocol = protocol_of(spec.preparation, 0.0);
  return make_macro_packing(spec, seed, 0);
}

std::vector<double> strain_fines(const MacroPacking& sites, const FinesState& state, const FaceFriction& friction,
                                 const FinesPath& path) {
  const Vec3 size = sites.size();
  const Cell<3> cell = box_cell<3>(size, {true, true, true});
  std::vector<Sphere<3>> spheres;
  for (const MacroBody& b : sites.bodies) spheres.push_back({home(b.x - sites.low, size), b.r});
  const double onset = 1.0 / (1.0 + state.void_ratio);
  const double phi = state_phi(state.form, state.modulus, state.exponent, onset, state.start_pressure);
  std::vector<CellContent> content;
  for (const double v : radical_cells(spheres, cell).volume) content.push_back({phi * v, state.void_ratio * phi * v});
  CellPacking packing({equation_of_fines(state), {}, friction}, spheres, std::move(content), cell);
  std::vector<double> out;
  try {
    for (std::size_t k = 1; k < path.length.size(); ++k) {
      Vec3 stretch;
      for (int a = 0; a < 3; ++a) stretch[a] = path.length[k][a] / path.length[k - 1][a];
      const CellPoint point = packing.strain(stretch, {.tolerance = kTolerance});
      if (point.relaxation.end != RelaxationEnd::converged) return {};
      if (k + path.compared >= path.length.size()) out.push_back(measure_of(point.stress, path.measure));
    }
  } catch (const UnusableResult&) {
    return {};
  }
  return out;
}

std::vector<std::vector<double>> strain_fines(const MacroPacking& sites, const FinesState& state,
                                              const std::vector<FaceFrictionTrial>& trials,
                                              const std::vector<FinesPath>& paths) {
  std::vector<std::vector<double>> parts(trials.size() * paths.size());
  parallel_tasks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t task) {
    const auto k = static_cast<std::size_t>(task);
    const FaceFrictionTrial& t = trials[k / paths.size()];
    parts[k] = strain_fines(sites, state, FaceFriction{t.friction, t.stiffness}, paths[k % paths.size()]);
  });
  stop_if_interrupted("straining cells of fines");
  std::vector<std::vector<double>> rows(trials.size());
  for (std::size_t k = 0; k < parts.size(); ++k)
    rows[k / paths.size()].insert(rows[k / paths.size()].end(), parts[k].begin(), parts[k].end());
  return rows;
}

double friction_seconds(std::int64_t cells) {
  constexpr double kSecondsPerCell = 0.14;  // two rounds of 3 x 3 trials and the last one, two paths each
  return kSecondsPerCell * static_cast<double>(cells);
}

namespace {

/// Correlations of both, which know nothing of each other.
CellCorrelation side_by_side(const CellCorrelation& a, const CellCorrelation& b) {
  CellCorrelation out = a;
  out.numbers.insert(out.numbers.end(), b.numbers.begin(), b.numbers.end());
  const std::size_t first = a.numbers.size();
  const std::size_t n = out.numbers.size();
  out.matrix.assign(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if ((i < first) == (j < first))
        out.matrix[i * n + j] = i < first ? a.matrix[i * first + j] : b.matrix[(i - first) * (n - first) + j - first];
  return out;
}

/// Those numbers alone whose errors are known.
CellCorrelation of_known(const CellCorrelation& all, const std::vector<CellCardNumber>& numbers) {
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < all.numbers.size(); ++k) {
    const double error = std::ranges::find(numbers, all.numbers[k], &CellCardNumber::key)->estimate.standard_error;
    if (error > 0.0 && std::isfinite(error)) kept.push_back(k);
  }
  CellCorrelation out;
  for (const std::size_t i : kept) {
    out.numbers.push_back(all.numbers[i]);
    for (const std::size_t j : kept) out.matrix.push_back(all.matrix[i * all.numbers.size() + j]);
  }
  return out;
}

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
    lateral_ratio();
    if (scene_.memory)
      fit_memory();
    else
      fit_friction();
    if (out_.problems.empty()) correlate();
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
    excess_replicates_ = fit.replicates;
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

  /// Correlations of the numbers whose errors are known. Those of the equation of state and of the pores are of refits
  /// to the same drawn samples, made smaller where an error holds more than the scatter of its refits; those of faces
  /// are of their own fit, with the others as they are.
  void correlate() {
    const StateGroup* fines = states_.find(result(scene_.at.fines).variant->name);
    const StateGroup* coarse = states_.find(result(scene_.at.coarse).variant->name);
    const auto onset = [&](const StateGroup* g) { return 2 + static_cast<std::size_t>(g - states_.groups.data()); };
    const auto log_pores = [](double phi) { return std::log((1.0 - phi) / phi); };
    CellCorrelation state{{"K", "n", "e_J", "e_c", "w_inf", "xi"}, {}};
    const std::size_t size = state.numbers.size();
    std::vector<std::vector<double>> refits;
    for (std::size_t r = 0; r < states_.replicates.size(); ++r) {
      const std::vector<double>& p = states_.replicates[r];
      const auto& [many, log_decay] = excess_replicates_[r];
      if (is_known(many))
        refits.push_back({p[0], p[1], log_pores(p[onset(fines)]), log_pores(p[onset(coarse)]), many, log_decay});
    }
    state.matrix = correlations(refits, size);
    const std::vector<CellCardNumber> numbers = numbers_of(out_.card);
    std::vector<double> share;
    for (std::size_t k = 0; k < size; ++k) {
      const CellCardNumber& n = *std::ranges::find(numbers, state.numbers[k], &CellCardNumber::key);
      const double error = n.estimate.standard_error / (n.logarithm ? n.estimate.value : 1.0);
      std::vector<double> values;
      for (const std::vector<double>& one : refits) values.push_back(one[k]);
      share.push_back(error > 0.0 ? std::min(1.0, mean_error(values).deviation_or_zero() / error) : 0.0);
    }
    for (std::size_t k = 0; k < size * size; ++k)
      state.matrix[k] = k / size == k % size ? 1.0 : state.matrix[k] * (share[k / size] * share[k % size]);
    out_.card.correlation = of_known(side_by_side(state, faces_), numbers);
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
  std::vector<std::array<double, 2>> excess_replicates_;  ///< as ExcessPoresFit::replicates
  CellCorrelation faces_;                                 ///< of mu_f, chi and what shear leaves behind
};

/// Whether the fit knows every variant that tells an onset.
std::string missing_group(const std::vector<VariantResult>& results, const StateFit& states) {
  for (const VariantResult& r : results)
    if (!r.variant->same_packings && states.find(r.variant->name) == nullptr) return r.variant->name;
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
  if (const std::string name = missing_group(results, *states); !name.empty()) {
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

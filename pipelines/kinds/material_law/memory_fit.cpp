#include "pipelines/kinds/material_law/memory_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "calibrate/draws.h"
#include "calibrate/least_squares.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"
#include "common/io/interrupt.h"
#include "macrosim/body_contacts.h"
#include "macrosim/cell_matter/material_point.h"
#include "macrosim/cell_matter/shear_memory.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

namespace {

/// Units of residuals.
constexpr double kPressureUnit = 0.08;
constexpr double kRatioUnit = 0.05;
constexpr double kFractionUnit = 0.008;
/// Added to pressures over E: below, samples differ by more than anything that a law could say.
constexpr double kFloor = 3e-6;
/// c where dense fines were not measured, and the start of the fit.
constexpr double kUsualRange = 2.0 / 3.0;
/// Numbers with a larger correlation cannot be told apart.
constexpr double kLeaning = 0.9;

struct FittedNumber {
  const char* name;
  bool needed;  ///< whether there is no law with it at a bound
  bool logarithmic;
  double low;
  double high;
  double start;
};

constexpr std::array<FittedNumber, 7> kFitted{{{"mu_f", true, true, 0.02, 3.0, 0.5},
                                               {"chi", true, true, 0.05, 30.0, 3.0},
                                               {"r_c", true, false, 0.5, 1.6, 0.95},
                                               {"m", false, true, 0.5, 200.0, 20.0},
                                               // Loose fines alone do not tell these from r_c and m.
                                               {"A", true, false, 0.05, 2.0, 1.0},
                                               {"c", false, false, 0.1, 0.98, kUsualRange},
                                               {"lambda", false, false, -1.0, 1.0, 0.0}}};
constexpr std::size_t kOfLooseFines = 4;

std::size_t count_of(bool dense) { return dense ? kFitted.size() : kOfLooseFines; }

double inward(const FittedNumber& n, double x) { return n.logarithmic ? std::log(x) : x; }
double outward(const FittedNumber& n, double x) { return n.logarithmic ? std::exp(x) : x; }

ShearNumbers numbers_at(std::span<const double> parameters, double least_state) {
  std::array<double, kFitted.size()> x{};
  for (std::size_t k = 0; k < kFitted.size(); ++k)
    x[k] = k < parameters.size() ? outward(kFitted[k], parameters[k]) : kFitted[k].start;
  ShearNumbers out{x[0], x[1], {}};
  out.memory.critical_pores.value = x[2];
  out.memory.strength_slope.value = x[3];
  out.memory.dilatancy.value = x[4];
  out.memory.strength_range.value = x[5];
  out.memory.density_slope.value = x[6];
  out.memory.least_state.value = least_state;
  return out;
}

double mean_of(const Vec3& s) { return (s[0] + s[1] + s[2]) / 3.0; }
double deviator_of(const Vec3& s) { return s[2] - 0.5 * (s[0] + s[1]); }

/// Residuals of one path, in their units over the root of their number; two for each point but the first.
void write_residuals(const ShearPath& path, const ShearPrediction& law, std::span<double> out) {
  const std::size_t points = path.strain.size() - 1;
  const double weight = 1.0 / std::sqrt(static_cast<double>(points));
  constexpr double kMost = 20.0;
  for (std::size_t k = 1; k <= points; ++k) {
    const double p = mean_of(path.stress[k]) + kFloor;
    const double first = path.sides_by_stress[k]
                             ? (law.fraction[k] - path.fraction[k]) / kFractionUnit
                             : std::log((std::max(mean_of(law.stress[k]), 0.0) + kFloor) / p) / kPressureUnit;
    const double second = (deviator_of(law.stress[k]) - deviator_of(path.stress[k])) / p / kRatioUnit;
    out[2 * k - 2] = weight * std::clamp(first, -kMost, kMost);
    out[2 * k - 1] = weight * std::clamp(second, -kMost, kMost);
  }
}

class PathFit {
 public:
  PathFit(const FinesBase& fines, std::vector<const ShearPath*> paths, double least_state, bool dense)
      : fines_(fines), paths_(std::move(paths)), least_state_(least_state) {
    for (const ShearPath* path : paths_) {
      begin_.push_back(problem_.residuals);
      problem_.residuals += 2 * (path->strain.size() - 1);
    }
    for (std::size_t k = 0; k < count_of(dense); ++k)
      problem_.bounds.push_back({inward(kFitted[k], kFitted[k].low), inward(kFitted[k], kFitted[k].high)});
    problem_.evaluate = [this](std::span<const double> p, std::span<double> r) { return evaluate(p, r); };
  }

  LeastSquaresFit run(const std::vector<double>& start) {
    LeastSquaresOptions options;
    options.thorough = false;
    options.max_iterations = 300;
    return fit_least_squares(problem_, {start}, options);
  }

 private:
  bool evaluate(std::span<const double> parameters, std::span<double> residuals) const {
    stop_if_interrupted("fitting shear memory");
    const ShearNumbers numbers = numbers_at(parameters, least_state_);
    std::vector<char> made(paths_.size(), 0);
    parallel_tasks(static_cast<std::int64_t>(paths_.size()), [&](std::int64_t task) {
      const auto k = static_cast<std::size_t>(task);
      const ShearPrediction law = predict(fines_, numbers, *paths_[k]);
      if (law.stress.empty()) return;
      write_residuals(*paths_[k], law, residuals.subspan(begin_[k], 2 * (paths_[k]->strain.size() - 1)));
      made[k] = 1;
    });
    return std::ranges::all_of(made, [](char one) { return one != 0; });
  }

  const FinesBase& fines_;
  std::vector<const ShearPath*> paths_;
  std::vector<std::size_t> begin_;
  double least_state_;
  LeastSquaresProblem problem_;
};

Estimate not_fitted(double value) { return {value, kInfinity, -kInfinity, kInfinity}; }

/// The estimate of a number: fits to single samples scatter about the fit to all.
Estimate estimate_of(const FittedNumber& number, double all, const std::vector<double>& single) {
  const double value = outward(number, all);
  if (single.size() < 2) return not_fitted(value);
  const MeanError mean = mean_error(single);
  const double slope = number.logarithmic ? value : 1.0;
  const Estimate e = student_estimate(all, mean.error, static_cast<double>(single.size() - 1),
                                      inward(number, number.low), inward(number, number.high));
  return {value, slope * mean.error, outward(number, e.low), outward(number, e.high)};
}

CellCorrelation correlation_of(const LeastSquaresFit& fit) {
  CellCorrelation out{{}, correlations_of(fit.covariance, fit.parameters.size())};
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) out.numbers.emplace_back(kFitted[k].name);
  return out;
}

std::vector<std::string> leaning(const CellCorrelation& c) {
  std::vector<std::string> out;
  const std::size_t n = c.numbers.size();
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      if (const double r = c.matrix[a * n + b]; std::abs(r) > kLeaning)
        out.push_back(fmt::format("{} and {} (correlation {:.2f})", c.numbers[a], c.numbers[b], r));
  return out;
}

}  // namespace

ShearPath ShearPath::of(const MacroCurve& curve) {
  ShearPath path;
  path.sample = static_cast<std::size_t>(curve.sample);
  const auto fraction = curve.more.find(kSolidFraction);
  if (fraction == curve.more.end()) return path;
  const double modulus = curve.start.youngs_modulus;
  path.fraction = fraction->second;
  for (std::size_t k = 0; k < curve.strain_z.size(); ++k) {
    path.strain.push_back(
        {{-std::log1p(-curve.strain_x[k]), -std::log1p(-curve.strain_y[k]), -std::log1p(-curve.strain_z[k])}});
    path.stress.push_back(
        {{curve.stress_x[k] / modulus, curve.stress_y[k] / modulus, curve.stress_axial[k] / modulus}});
    const StageRecord& stage = curve.stages[static_cast<std::size_t>(curve.stage[k])];
    path.sides_by_stress.push_back(k > 0 && stage.way == StageKind::triaxial);
  }
  return path;
}

ShearPrediction predict(const FinesBase& fines, const ShearNumbers& numbers, const ShearPath& path) {
  ShearPrediction out;
  CellLaw law;
  law.equation = PorosityForm{fines.modulus, fines.exponent};
  const CellMemory& m = numbers.memory;
  law.friction = {numbers.friction, numbers.stiffness};
  law.memory = ShearMemory{m.dilatancy.value,      m.critical_pores.value, m.strength_slope.value,
                           m.strength_range.value, m.density_slope.value,  m.least_state.value};
  const double pressure = mean_of(path.stress.front());
  const double phi = path.fraction.front();
  if (!(pressure > 0.0)) return out;
  const double state = state_at(law.equation, pressure);
  const double onset = (phi - state) / (1.0 - state);
  const double critical = 1.0 / (1.0 + m.critical_pores.value * fines.void_ratio);
  if (!(state < 1.0) || !(onset > 0.0)) return out;
  try {
    MaterialPoint point(law, phi, onset, critical);
    out.stress.push_back(point.stress());
    out.fraction.push_back(phi);
    for (std::size_t k = 1; k < path.strain.size(); ++k) {
      const Vec3 step = path.strain[k] - path.strain[k - 1];
      if (path.sides_by_stress[k])
        (void)point.strain_at(step[2], 0.5 * (path.stress[k][0] + path.stress[k][1]));
      else
        point.strain(step);
      out.stress.push_back(point.stress());
      out.fraction.push_back(point.solid_fraction());
    }
  } catch (const InputError&) {  // numbers that are no law
    return {};
  }
  return out;
}

ShearMemoryFit fit_shear_memory(const FinesBase& fines, const std::vector<ShearPath>& paths, bool dense) {
  ShearMemoryFit out;
  const double least_state = std::pow(kUnloadedPressure * fines.start_pressure / fines.modulus, 1.0 / fines.exponent);
  out.memory.least_state = not_fitted(least_state);
  std::vector<const ShearPath*> all;
  std::size_t samples = 0;
  for (const ShearPath& path : paths) {
    if (path.strain.size() < 2) {
      out.message = "a test of the fines has no points";
      return out;
    }
    all.push_back(&path);
    samples = std::max(samples, path.sample + 1);
  }
  std::vector<double> start;
  for (std::size_t k = 0; k < count_of(dense); ++k) start.push_back(inward(kFitted[k], kFitted[k].start));
  const LeastSquaresFit fit = PathFit(fines, all, least_state, dense).run(start);
  if (fit.parameters.empty() || fit.end == FitEnd::failed || fit.end == FitEnd::capped || fit.rank_deficient) {
    out.message = fit.rank_deficient ? "the tests do not determine all numbers: " + fit.message : fit.message;
    return out;
  }
  constexpr double kNegligible = 0.1;  // standard deviations
  if (fit.end == FitEnd::stalled && fit.step_left > kNegligible)
    out.undetermined.push_back("the fit, which " + fit.message);
  std::vector<std::vector<double>> single(count_of(dense));
  for (std::size_t s = 0; s < samples; ++s) {
    std::vector<const ShearPath*> own;
    for (const ShearPath& path : paths)
      if (path.sample == s) own.push_back(&path);
    if (own.empty()) continue;
    const LeastSquaresFit one = PathFit(fines, own, least_state, dense).run(fit.parameters);
    if (one.parameters.empty()) continue;
    for (std::size_t k = 0; k < single.size(); ++k) single[k].push_back(one.parameters[k]);
  }
  const auto estimate = [&](std::size_t k) { return estimate_of(kFitted[k], fit.parameters[k], single[k]); };
  out.friction = estimate(0);
  out.stiffness = estimate(1);
  out.memory.critical_pores = estimate(2);
  out.memory.strength_slope = estimate(3);
  out.memory.dilatancy = dense ? estimate(4) : not_fitted(kFitted[4].start);
  out.memory.strength_range = dense ? estimate(5) : not_fitted(kFitted[5].start);
  out.memory.density_slope = dense ? estimate(6) : not_fitted(kFitted[6].start);
  out.correlation = correlation_of(fit);
  for (std::string& one : leaning(out.correlation)) out.undetermined.push_back(std::move(one));
  double sum = 0.0;
  std::size_t count = 0;
  const ShearNumbers numbers = numbers_at(fit.parameters, least_state);
  for (const ShearPath& path : paths) {
    const ShearPrediction law = predict(fines, numbers, path);
    for (std::size_t k = 1; k < law.stress.size(); ++k, ++count) {
      const double p = mean_of(path.stress[k]) + kFloor;
      const double off = (deviator_of(law.stress[k]) - deviator_of(path.stress[k])) / p;
      sum += off * off;
    }
  }
  out.deviation = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
  for (std::size_t k = 0; k < fit.at_bound.size(); ++k) {
    if (!fit.at_bound[k]) continue;
    const std::string what = fmt::format("{} = {:.3g}, at the end of what is tried", kFitted[k].name,
                                         outward(kFitted[k], fit.parameters[k]));
    if (!kFitted[k].needed) {
      out.undetermined.push_back(what);
      continue;
    }
    out.message = what;
    return out;
  }
  out.usable = true;
  out.message = "fitted";
  return out;
}

double memory_fit_seconds(const MaterialLawScene& scene) {
  constexpr double kSecondsPerPart = 4e-6;
  constexpr double kPartsOfSearch = 7.0;  // for the lateral strain of a part under constant lateral stress
  // Evaluations of a fit over the square of the number of its parameters: 2,600 to 3,000 with seven, 780 to 1,280 with
  // four, in 20 to 70 iterations.
  constexpr double kEvaluations = 57.0;
  const MacroSetup& setup = scene.material.variants[scene.at.shear_tests.front()].setup;
  double parts = 0.0;
  for (const std::size_t v : scene.at.shear_tests)
    for (const MacroStage& stage : stages_of(scene.material.variants[v].setup.spec)) {
      const auto steps = static_cast<double>(stage.steps);
      const double each = std::abs(stage.axis[2].value) / steps;
      parts += steps * memory_parts(each) * (stage.record.way == StageKind::triaxial ? kPartsOfSearch : 1.0);
    }
  const auto numbers = static_cast<double>(count_of(scene.dense));
  constexpr double kFits = 2.0;  // to all samples, and to each of them
  return kFits * kEvaluations * numbers * numbers * kSecondsPerPart * parts * static_cast<double>(setup.samples);
}

}  // namespace softgrain

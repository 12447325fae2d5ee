#include "calibrate/excess_pores_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

/// Share of replicates that must determine xi.
constexpr double kDeterminedShare = 0.9;
/// xi from a twentieth of the smallest to twenty times the largest ratio: beyond, mixtures tell nothing of it.
constexpr double kBeyond = 20.0;

/// Void ratios and excess pores that one set of onsets says.
struct Pores {
  double fines = 0.0;            ///< e_J
  double coarse = 0.0;           ///< e_c
  std::vector<double> mixtures;  ///< W/V_c
};

double void_ratio_at(double onset) { return (1.0 - onset) / onset; }

class ExcessProblem {
 public:
  ExcessProblem(const StateFit& states, const MixtureGroups& groups)
      : groups_(groups), fines_(place(states, groups.fines)), coarse_(place(states, groups.coarse)) {
    constexpr std::size_t kLeast = 3;
    if (groups.mixtures.size() < kLeast)
      throw InputError(
          fmt::format("excess pores: {} mixtures; at least three are needed for w_inf and xi", groups.mixtures.size()));
    low_ = high_ = groups.mixtures.front().ratio;
    for (const auto& m : groups.mixtures) {
      if (!(m.ratio > 0.0) || !std::isfinite(m.ratio))
        throw InputError(fmt::format("excess pores: {}: V_f/V_c = {}; must be above 0", m.name, m.ratio));
      places_.push_back(place(states, m.name));
      low_ = std::min(low_, m.ratio);
      high_ = std::max(high_, m.ratio);
    }
  }

  /// `parameters` as those of StateFit.
  [[nodiscard]] Pores pores(const std::vector<double>& parameters) const {
    Pores out{void_ratio_at(parameters[fines_]), void_ratio_at(parameters[coarse_]), {}};
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const double ratio = groups_.mixtures[k].ratio;
      out.mixtures.push_back(void_ratio_at(parameters[places_[k]]) * (ratio + 1.0) - out.fines * ratio);
    }
    return out;
  }

  [[nodiscard]] static double form(double ratio, double alone, double many, double decay) {
    return many + (alone - many) * std::exp(-ratio / decay);
  }

  /// Parameters w_inf, ln xi.
  [[nodiscard]] LeastSquaresFit solve(const Pores& pores, const std::vector<double>& error,
                                      const std::vector<std::vector<double>>& starts, bool thorough) const {
    LeastSquaresProblem problem;
    problem.residuals = places_.size();
    problem.bounds = {{0.0, kInfinity}, {std::log(low_ / kBeyond), std::log(high_ * kBeyond)}};
    problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
      for (std::size_t k = 0; k < places_.size(); ++k)
        r[k] = (form(groups_.mixtures[k].ratio, pores.coarse, p[0], std::exp(p[1])) - pores.mixtures[k]) / error[k];
      return true;
    };
    problem.jacobian = [&](std::span<const double> p, std::span<double> j) {
      for (std::size_t k = 0; k < places_.size(); ++k) {
        const double x = groups_.mixtures[k].ratio * std::exp(-p[1]);
        j[2 * k] = (1.0 - std::exp(-x)) / error[k];
        j[2 * k + 1] = (pores.coarse - p[0]) * std::exp(-x) * x / error[k];
      }
      return true;
    };
    LeastSquaresOptions options;
    options.thorough = thorough;
    return fit_least_squares(problem, starts, options);
  }

  [[nodiscard]] std::vector<std::vector<double>> starts(const Pores& pores) const {
    const double many = std::max(0.0, *std::min_element(pores.mixtures.begin(), pores.mixtures.end()));
    return {{many, std::log(low_)}, {0.5 * many, 0.5 * std::log(low_ * high_)}};
  }

 private:
  static std::size_t place(const StateFit& states, const std::string& name) {
    const StateGroup* at = states.find(name);
    if (at == nullptr) throw InputError("excess pores: nothing was fitted to \"" + name + "\"");
    return 2 + static_cast<std::size_t>(at - states.groups.data());
  }

  const MixtureGroups& groups_;
  std::size_t fines_;
  std::size_t coarse_;
  std::vector<std::size_t> places_;
  double low_ = 0.0;
  double high_ = 0.0;
};

/// Student's interval about `value`, not below `least`; unknown where samples tell no error.
Estimate estimate_by(const std::vector<double>& replicates, double value, int degrees, double widening = 1.0,
                     double least = 0.0) {
  return student_estimate(value, widening * mean_error(replicates).deviation, replicates.size() < 2 ? 0 : degrees,
                          least);
}

/// Estimate of a number from that of its logarithm.
Estimate exponential(const Estimate& log) {
  const double value = std::exp(log.value);
  return {value, value * log.standard_error, std::exp(log.low), std::exp(log.high)};
}

struct Replicates {
  std::vector<double> fines, coarse, many, log_decay;
  std::vector<double> fitted_alone;  ///< e_c of those with many and log_decay
  std::vector<std::vector<double>> mixtures;
};

/// Form of the fit and of its refits, from no fines to a tenth more than the mixtures have.
std::vector<ExcessPoresBand> band_of(const Replicates& drawn, double alone, double many, double decay, double largest,
                                     int degrees, double widening) {
  constexpr int kPoints = 30;
  std::vector<ExcessPoresBand> out;
  for (int k = 0; k <= kPoints; ++k) {
    const double ratio = 1.1 * largest * k / kPoints;
    std::vector<double> values;
    for (std::size_t r = 0; r < drawn.many.size(); ++r)
      values.push_back(ExcessProblem::form(ratio, drawn.fitted_alone[r], drawn.many[r], std::exp(drawn.log_decay[r])));
    const Estimate e = estimate_by(values, ExcessProblem::form(ratio, alone, many, decay), degrees, widening);
    out.push_back({ratio, e.value, e.low, e.high});
  }
  return out;
}

/// Errors of W/V_c; all 1 where none are known.
std::vector<double> errors_of(const Replicates& replicates, int degrees) {
  std::vector<double> out;
  for (const auto& values : replicates.mixtures)
    out.push_back(degrees < 1 || values.size() < 2 ? 1.0 : mean_error(values).deviation);
  return out;
}

}  // namespace

ExcessPoresFit fit_excess_pores(const StateFit& states, const MixtureGroups& groups) {
  const ExcessProblem problem(states, groups);
  const Pores pores = problem.pores(states.fit.parameters);
  Replicates drawn;
  drawn.mixtures.resize(groups.mixtures.size());
  std::vector<Pores> all;
  for (const auto& parameters : states.replicates) {
    all.push_back(problem.pores(parameters));
    drawn.fines.push_back(all.back().fines);
    drawn.coarse.push_back(all.back().coarse);
    for (std::size_t k = 0; k < drawn.mixtures.size(); ++k) drawn.mixtures[k].push_back(all.back().mixtures[k]);
  }
  const std::vector<double> error = errors_of(drawn, states.degrees);
  ExcessPoresFit out;
  out.void_ratio = estimate_by(drawn.fines, pores.fines, states.degrees);
  out.alone = estimate_by(drawn.coarse, pores.coarse, states.degrees);
  for (std::size_t k = 0; k < groups.mixtures.size(); ++k)
    out.mixtures.push_back({groups.mixtures[k].name, groups.mixtures[k].ratio,
                            estimate_by(drawn.mixtures[k], pores.mixtures[k], states.degrees), 0.0});
  for (const MixturePores& m : out.mixtures)
    if (!(m.pores.value > 0.0)) {
      out.message =
          fmt::format("{}: fines leave no excess pores beside coarse grains (W/V_c = {:.3g})", m.name, m.pores.value);
      return out;
    }
  const LeastSquaresFit fit = problem.solve(pores, error, problem.starts(pores), true);
  if (!fit.usable() || fit.at_bound[1]) {
    out.message = "the mixtures do not determine xi" + (fit.usable() ? std::string() : ": " + fit.message);
    return out;
  }
  for (MixturePores& m : out.mixtures)
    m.fitted = ExcessProblem::form(m.ratio, pores.coarse, fit.parameters[0], std::exp(fit.parameters[1]));
  for (const MixturePores& m : out.mixtures) out.deviation += std::pow(m.fitted - m.pores.value, 2);
  out.deviation = std::sqrt(out.deviation / static_cast<double>(out.mixtures.size()));
  const auto freedom = static_cast<double>(fit.degrees_of_freedom);
  if (states.degrees >= 1) out.widening = std::sqrt(std::max(1.0, fit.residual_sum_of_squares / freedom));
  for (const Pores& one : all) {
    const LeastSquaresFit refit = problem.solve(one, error, {fit.parameters}, false);
    out.replicates.push_back({one.fines, one.coarse, kNaN, kNaN});
    if (!refit.usable() || refit.at_bound[1]) continue;
    out.replicates.back() = {one.fines, one.coarse, refit.parameters[0], refit.parameters[1]};
    drawn.fitted_alone.push_back(one.coarse);
    drawn.many.push_back(refit.parameters[0]);
    drawn.log_decay.push_back(refit.parameters[1]);
  }
  out.many = estimate_by(drawn.many, fit.parameters[0], states.degrees, out.widening);
  out.decay = exponential(estimate_by(drawn.log_decay, fit.parameters[1], states.degrees, out.widening, -kInfinity));
  double largest = 0.0;
  for (const MixturePores& m : out.mixtures) largest = std::max(largest, m.ratio);
  out.band = band_of(drawn, pores.coarse, fit.parameters[0], std::exp(fit.parameters[1]), largest, states.degrees,
                     out.widening);
  out.usable = static_cast<double>(drawn.many.size()) >= kDeterminedShare * static_cast<double>(all.size());
  out.message = out.usable ? "fitted"
                           : fmt::format("the mixtures do not determine xi: only {} of {} replicates do",
                                         drawn.many.size(), all.size());
  return out;
}

}  // namespace softgrain

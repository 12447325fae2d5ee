#include "calibrate/response_prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/bootstrap.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

constexpr std::size_t kWays = 2;  ///< stays, goes on

/// The groups that take part, by span, and their samples.
struct Group {
  std::size_t number;  ///< number of the group in the fit
  std::vector<const ResponseCurve*> samples;
};

std::vector<Group> groups_of(const StateFit& fit, const std::vector<ResponseCurve>& curves) {
  std::vector<Group> groups;
  for (std::size_t g = 0; g < fit.groups.size(); ++g) {
    Group group{g, {}};
    for (const ResponseCurve& c : curves)
      if (c.group == fit.groups[g].name) group.samples.push_back(&c);
    if (!group.samples.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

void require_curves(const StateFit& fit, const std::vector<ResponseCurve>& curves) {
  if (curves.empty()) throw InputError("responses: no curves");
  const std::vector<double>& volume = curves.front().volume;
  for (const ResponseCurve& c : curves) {
    if (fit.find(c.group) == nullptr) throw InputError("responses: no group " + c.group);
    bool same = c.volume.size() == volume.size() && c.pressure.size() == volume.size() &&
                c.ratio.size() == volume.size() && c.deviator.size() == volume.size();
    for (std::size_t k = 0; same && k < volume.size(); ++k) same = std::abs(c.volume[k] / volume[k] - 1.0) < 1e-4;
    if (!same) throw InputError("responses: samples of " + c.group + " have other points than " + curves.front().group);
  }
}

/// What is taken from one group to another, at one point.
struct Features {
  double log_factor = 0.0;  ///< ln(p/p of the equation of state)
  double ratio = 0.0;
  double deviator = 0.0;
};

Features sum(const Features& a, const Features& b, double by) {
  return {a.log_factor + by * b.log_factor, a.ratio + by * b.ratio, a.deviator + by * b.deviator};
}

/// One equation of state and the start pressure.
struct State {
  StateForm form;
  double modulus;
  double exponent;
  double start;

  [[nodiscard]] double solid_fraction(double onset) const { return state_phi(form, modulus, exponent, onset, start); }
  [[nodiscard]] double pressure(double onset, double volume) const {
    return state_pressure(form, modulus, exponent, onset, solid_fraction(onset) / volume);
  }
};

/// Mean over samples drawn with replacement, as far from the mean over all as means of n samples are.
Features drawn_mean(const Group& group, const std::vector<Features>& of_samples,
                    const std::vector<std::size_t>& drawn) {
  const auto n = static_cast<double>(group.samples.size());
  Features all;
  Features some;
  for (const Features& f : of_samples) all = sum(all, f, 1.0 / n);
  for (const std::size_t k : drawn) some = sum(some, of_samples[k], 1.0 / n);
  const double widen = n > 1.0 ? std::sqrt(n / (n - 1.0)) : 1.0;
  return sum(sum(all, some, widen), all, -widen);
}

/// Straight line through the groups over their onsets, at `onset`; of one group its own.
Features line_at(const std::vector<double>& onsets, const std::vector<Features>& means, double onset) {
  const auto n = static_cast<double>(means.size());
  Features mean;
  double centre = 0.0;
  for (std::size_t g = 0; g < means.size(); ++g) {
    mean = sum(mean, means[g], 1.0 / n);
    centre += onsets[g] / n;
  }
  double squares = 0.0;
  Features slope;
  for (std::size_t g = 0; g < means.size(); ++g) {
    squares += (onsets[g] - centre) * (onsets[g] - centre);
    slope = sum(slope, means[g], onsets[g] - centre);
  }
  return squares > 0.0 ? sum(mean, slope, (onset - centre) / squares) : mean;
}

/// What is collected over replicates, for one form of onset and one way.
struct Collected {
  std::vector<double> solid_fraction;
  std::vector<std::vector<double>> pressure, axial, lateral, deviator;  ///< values at every point
};

Estimate over(const std::vector<Collected>& all, auto&& column) {
  Estimate e{0.0, 0.0, kInfinity, -kInfinity};
  for (const Collected& c : all) {
    std::vector<double> values = column(c);
    const auto [low, high] = interval95(values);
    e.low = std::min(e.low, low);
    e.high = std::max(e.high, high);
    e.standard_error = std::max(e.standard_error, mean_error(values).deviation_or_zero());
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    e.value += values[values.size() / 2] / static_cast<double>(all.size());
  }
  return e;
}

class Predictor {
 public:
  Predictor(const StateFit& fit, const std::vector<ResponseCurve>& curves, const ResponseOptions& options)
      : fit_(fit), options_(options), groups_(groups_of(fit, curves)), volume_(curves.front().volume) {}

  /// Adds what replicate r says, for onsets by every form.
  void add(std::size_t r, const std::vector<std::vector<double>>& onsets, std::vector<Collected>& out) const {
    const std::vector<double>& p = fit_.replicates[r];
    const State state{options_.form, std::exp(p[0]), p[1], options_.start_pressure};
    RandomStream random(options_.seed, RandomPurpose::bootstrap, 1000000 + r);
    std::vector<std::vector<std::size_t>> drawn;
    std::vector<double> own;
    for (const Group& g : groups_) {
      drawn.emplace_back();
      for (std::size_t k = 0; k < g.samples.size(); ++k) drawn.back().push_back(random.below(g.samples.size()));
      own.push_back(p[2 + g.number]);
    }
    for (std::size_t k = 0; k < volume_.size(); ++k) {
      const std::vector<Features> means = means_at(k, state, own, drawn);
      for (std::size_t f = 0; f < onsets.size(); ++f) {
        const double onset = onsets[f][r];
        if (std::isnan(onset)) continue;
        add_point(k, state, onset, means.back(), out[kWays * f]);
        add_point(k, state, onset, line_at(own, means, onset), out[kWays * f + 1]);
      }
    }
  }

  [[nodiscard]] std::size_t points() const { return volume_.size(); }

 private:
  [[nodiscard]] std::vector<Features> means_at(std::size_t k, const State& state, const std::vector<double>& own,
                                               const std::vector<std::vector<std::size_t>>& drawn) const {
    std::vector<Features> means;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const double model = state.pressure(own[g], volume_[k]);
      std::vector<Features> of_samples;
      for (const ResponseCurve* c : groups_[g].samples)
        of_samples.push_back({std::log(c->pressure[k] / model), c->ratio[k], c->deviator[k]});
      means.push_back(drawn_mean(groups_[g], of_samples, drawn[g]));
    }
    return means;
  }

  void add_point(std::size_t k, const State& state, double onset, const Features& f, Collected& out) const {
    out.pressure.resize(points());
    out.axial.resize(points());
    out.lateral.resize(points());
    out.deviator.resize(points());
    const double pressure = state.pressure(onset, volume_[k]) * std::exp(f.log_factor);
    const double axial = 3.0 * pressure / (1.0 + 2.0 * f.ratio);
    if (k == 0) out.solid_fraction.push_back(state.solid_fraction(onset));
    out.pressure[k].push_back(pressure);
    out.axial[k].push_back(axial);
    out.lateral[k].push_back(f.ratio * axial);
    out.deviator[k].push_back(f.deviator);
  }

  const StateFit& fit_;
  const ResponseOptions& options_;
  std::vector<Group> groups_;
  std::vector<double> volume_;
};

}  // namespace

ResponsePrediction predict_response(const StateFit& fit, const std::vector<ResponseCurve>& curves, double span,
                                    const ResponseOptions& options) {
  require_curves(fit, curves);
  ResponsePrediction out;
  out.onset = extrapolate_onset(fit, span, options.onset);
  out.usable = out.onset.usable;
  out.message = out.onset.message;
  if (!out.usable) return out;
  const Predictor predictor(fit, curves, options);
  std::vector<Collected> all(kWays * out.onset.replicates.size());
  for (std::size_t r = 0; r < fit.replicates.size(); ++r) predictor.add(r, out.onset.replicates, all);
  out.solid_fraction = over(all, [](const Collected& c) { return c.solid_fraction; });
  for (std::size_t k = 0; k < predictor.points(); ++k) {
    out.pressure.push_back(over(all, [&](const Collected& c) { return c.pressure[k]; }));
    out.axial.push_back(over(all, [&](const Collected& c) { return c.axial[k]; }));
    out.lateral.push_back(over(all, [&](const Collected& c) { return c.lateral[k]; }));
    out.deviator.push_back(over(all, [&](const Collected& c) { return c.deviator[k]; }));
  }
  return out;
}

double fitted_onset(StateForm form, double modulus, double exponent, const StateCurve& curve) {
  double up = 0.0;
  double down = 0.0;
  for (std::size_t i = 0; i < curve.phi.size(); ++i) {
    if (!(curve.pressure[i] > 0.0)) continue;
    const double u = std::pow(curve.pressure[i] / modulus, 1.0 / exponent);
    // phi = phi_J + (1 - phi_J) u; or e = e_J (1 - u), e the void ratio
    up += (1.0 - u) * (form == StateForm::porosity ? curve.phi[i] - u : 1.0 / curve.phi[i] - 1.0);
    down += (1.0 - u) * (1.0 - u);
  }
  if (!(down > 0.0)) throw InputError("onset: no point bears");
  return form == StateForm::porosity ? up / down : 1.0 / (1.0 + up / down);
}

}  // namespace softgrain

#include "calibrate/experiment_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "calibrate/bootstrap.h"
#include "calibrate/threshold_fit.h"
#include "calibrate/unloading_fit.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr std::size_t kMostPoints = 120;  ///< points of a single sample; the fit costs their square
constexpr std::size_t kMostCommon = 60;   ///< common overlaps of several samples
constexpr double kSame = 1e-7;            ///< overlaps that differ by less are the same

/// Averages in even bins of Delta.
std::vector<ForcePoint> binned(const std::vector<ForcePoint>& points, std::size_t bins) {
  if (points.size() <= bins) return points;
  const double low = points.front().delta;
  const double width = (points.back().delta - low) / static_cast<double>(bins);
  std::vector<ForcePoint> out(bins);
  std::vector<double> count(bins, 0.0);
  for (ForcePoint& p : out) p.error = 0.0;
  for (const ForcePoint& p : points) {
    const auto b = std::min(static_cast<std::size_t>((p.delta - low) / width), bins - 1);
    out[b].delta += p.delta;
    out[b].force += p.force;
    out[b].error += p.error * p.error;
    count[b] += 1.0;
  }
  std::vector<ForcePoint> filled;
  for (std::size_t b = 0; b < bins; ++b)
    if (count[b] > 0.0)
      filled.push_back({out[b].delta / count[b], out[b].force / count[b], std::sqrt(out[b].error) / count[b]});
  return filled;
}

/// Linear interpolation within the range of a curve; NaN outside.
ForcePoint at(const std::vector<ForcePoint>& curve, double delta) {
  ForcePoint out{delta, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const ForcePoint& a = curve[k - 1];
    const ForcePoint& b = curve[k];
    if (delta < a.delta - kSame || delta > b.delta + kSame) continue;
    const double share = std::clamp((delta - a.delta) / (b.delta - a.delta), 0.0, 1.0);
    out.force = a.force + share * (b.force - a.force);
    out.error = a.error + share * (b.error - a.error);
    return out;
  }
  return out;
}

bool same_overlaps(const std::vector<ForceCurve>& samples) {
  for (const ForceCurve& s : samples) {
    if (s.normal.size() != samples.front().normal.size()) return false;
    for (std::size_t k = 0; k < s.normal.size(); ++k)
      if (std::abs(s.normal[k].delta - samples.front().normal[k].delta) > kSame) return false;
  }
  return true;
}

std::vector<double> common_overlaps(const std::vector<ForceCurve>& samples) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  std::vector<std::size_t> counts;
  for (const ForceCurve& s : samples) {
    if (s.normal.empty()) continue;
    low = std::min(low, s.normal.front().delta);
    high = std::max(high, s.normal.back().delta);
    counts.push_back(s.normal.size());
  }
  std::sort(counts.begin(), counts.end());
  const std::size_t n = std::clamp<std::size_t>(counts[counts.size() / 2], 5, kMostCommon);
  std::vector<double> out;
  for (std::size_t k = 0; k < n; ++k)
    out.push_back(low + (high - low) * static_cast<double>(k) / static_cast<double>(n - 1));
  return out;
}

void to_common(std::vector<ForceCurve>& samples) {
  const std::vector<double> deltas = common_overlaps(samples);
  for (ForceCurve& s : samples) {
    const std::vector<ForcePoint> smooth = binned(s.normal, 2 * deltas.size());
    s.normal.clear();
    for (const double d : deltas)
      if (const ForcePoint p = at(smooth, d); !std::isnan(p.force)) s.normal.push_back(p);
  }
}

/// Standard error of a single value at each Delta: the mean square over samples.
std::vector<GivenError> errors_of(const std::vector<ForceCurve>& samples, double unit) {
  std::vector<GivenError> out;
  std::vector<double> count;
  for (const ForceCurve& s : samples)
    for (const ForcePoint& p : s.normal) {
      auto found = std::ranges::find_if(out, [&](const auto& g) { return std::abs(g.delta - p.delta) < kSame; });
      const auto k = static_cast<std::size_t>(found - out.begin());
      if (found == out.end()) {
        out.push_back({p.delta, 0.0});
        count.push_back(0.0);
      }
      out[k].error += p.error * p.error;
      count[k] += 1.0;
    }
  for (std::size_t k = 0; k < out.size(); ++k) out[k].error = std::sqrt(out[k].error / count[k]) / unit;
  return out;
}

std::size_t overlaps_of(const std::vector<TangentialPoint>& points) {
  std::set<double> deltas;
  for (const TangentialPoint& p : points) deltas.insert(p.delta);
  return deltas.size();
}

/// Averages of each angle in even bins of Delta, the same for all samples, where one has more overlaps than the fit can
/// take. Returns whether that was so.
bool bin_rotations(std::vector<ForceCurve>& samples) {
  std::size_t most = 0;
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (const ForceCurve& s : samples) {
    most = std::max(most, overlaps_of(s.tangential));
    for (const TangentialPoint& p : s.tangential) {
      low = std::min(low, p.delta);
      high = std::max(high, p.delta);
    }
  }
  if (most <= kMostPoints) return false;
  const double width = (high - low) / static_cast<double>(kMostPoints);
  const auto bin_of = [&](double delta) {
    return std::min(static_cast<std::size_t>((delta - low) / width), kMostPoints - 1);
  };
  std::array<double, kMostPoints> delta{};
  std::array<double, kMostPoints> count{};
  for (const ForceCurve& s : samples)
    for (const TangentialPoint& p : s.tangential) {
      delta[bin_of(p.delta)] += p.delta;
      count[bin_of(p.delta)] += 1.0;
    }
  for (ForceCurve& s : samples) {
    std::map<std::pair<std::size_t, double>, std::pair<double, double>> forces;  // sum and count of each angle
    for (const TangentialPoint& p : s.tangential) {
      auto& [sum, number] = forces[{bin_of(p.delta), p.angle_deg}];
      sum += p.force_parallel;
      number += 1.0;
    }
    s.tangential.clear();
    for (const auto& [at, force] : forces) {
      TangentialPoint p;
      p.delta = delta[at.first] / count[at.first];
      p.angle_deg = at.second;
      p.force_parallel = force.first / force.second;
      p.converged = true;
      s.tangential.push_back(p);
    }
  }
  return true;
}

PackingRun run_of(const ForceCurve& sample, std::size_t index, PairKind kind) {
  PackingRun run;
  run.packing = static_cast<std::int64_t>(index);
  run.kind = kind;
  run.relaxation = kExperiment;
  for (const ForcePoint& p : sample.normal) run.normal.push_back({p.delta, p.force, 0.0, 0.0, true});
  run.tangential = sample.tangential;
  return run;
}

/// What the overlap and kt of the other kind are over those of the one that was measured.
struct Symmetry {
  double stretch = 2.0;  ///< of Delta and of angles
  double series = 0.5;   ///< of kt: two springs behind one another
};

Symmetry symmetry_of(PairKind measured) {
  return measured == PairKind::soft_solid ? Symmetry{2.0, 0.5} : Symmetry{0.5, 2.0};
}

/// The covariance of `turned` numbers q from that of p, to first order: q = T(p) with T = mirrored_numbers().
std::vector<double> turned_covariance(const std::vector<double>& covariance, const std::array<double, 7>& q,
                                      double stretch, double series) {
  std::array<std::array<double, 7>, 7> slope{};  // dq_i/dp_j
  slope[2][2] = stretch;
  const double log_stretch = std::log(stretch);
  for (const std::size_t a : kRowOfA) {
    const std::size_t b = a + 1;
    // q_a = f p_a stretch^-p_b
    slope[a][a] = (a == kRowOfA[0] ? 1.0 : series) * std::pow(stretch, -q[b]);
    slope[a][b] = -log_stretch * q[a];
    slope[b][b] = 1.0;
  }
  std::vector<double> out(49, 0.0);
  for (std::size_t i = 0; i < 7; ++i)
    for (std::size_t j = 0; j < 7; ++j)
      for (std::size_t k = 0; k < 7; ++k)
        for (std::size_t l = 0; l < 7; ++l) out[i * 7 + j] += slope[i][k] * covariance[k * 7 + l] * slope[j][l];
  return out;
}

PairKind other_kind(PairKind kind) { return kind == PairKind::soft_solid ? PairKind::soft_soft : PairKind::soft_solid; }

/// The law of the kind that was not measured.
FitReport mirrored(const FitReport& measured) {
  const auto [stretch, series] = symmetry_of(measured.law.kind);
  FitReport out = measured;
  for (auto& r : out.replicates) r = mirrored_numbers(r, measured.law.kind);
  PairLaw& law = out.law;
  law.kind = other_kind(measured.law.kind);
  law.status = LawStatus::underdetermined;
  law.reason = fmt::format("Not measured: follows from {} by symmetry, each particle taking half of the overlap.",
                           to_string(measured.law.kind));
  law.delta_min *= stretch;
  law.delta_max *= stretch;
  if (law.unloading) law.unloading->deepest *= stretch;
  law.initial_angle_deg *= stretch;
  law.secant_angle_deg *= stretch;
  law.points = 0;  // its errors are those of the samples that were measured: law.packings stays
  law.chi2_per_dof = law.quality = 0.0;
  law.table = {};
  law.band_delta.clear();
  law.bands.clear();
  const auto value = [](const ThresholdPowerLaw& l) { return std::array{l.a.value, l.b.value}; };
  const auto n = value(measured.law.normal);
  const auto i = value(measured.law.tangential_initial);
  const auto s = value(measured.law.tangential_secant);
  const auto p =
      mirrored_numbers({n[0], n[1], measured.law.normal.delta.value, i[0], i[1], s[0], s[1]}, measured.law.kind);
  const bool known = std::isfinite(measured.law.normal.a.standard_error) && law.covariance.size() == 49;
  if (known) law.covariance = turned_covariance(measured.law.covariance, p, stretch, series);
  law.normal = estimated_law(out, p, 0, known);
  if (law.has_tangential_initial) law.tangential_initial = estimated_law(out, p, 1, known);
  if (law.has_tangential_secant) law.tangential_secant = estimated_law(out, p, 2, known);
  return out;
}

void add(ExperimentFit& out, FitReport report) {
  PairLaw law = report.law;
  add_bands(law, report);
  out.card.pairs.push_back(std::move(law));
  out.reports.push_back(std::move(report));
}

void add_mirror(ExperimentFit& out) {
  if (out.reports.size() != 1) return;
  const FitReport& only = out.reports.front();
  if (only.law.normal.b.value <= 0.0) return;
  FitReport other = mirrored(only);
  if (!(other.law.normal.delta.value < kThresholdsBelow) || other.law.delta_max > kLargestDelta) {
    out.remarks.push_back(fmt::format(
        "no {} law by symmetry: its threshold would lie at Delta = {:.3g} and its range end at {:.3g}; a law of two "
        "bodies has a threshold below {:g} and ends by {:g}",
        to_string(other.law.kind), other.law.normal.delta.value, other.law.delta_max, kThresholdsBelow, kLargestDelta));
    return;
  }
  out.remarks.push_back(to_string(other.law.kind) + ": " + other.law.reason);
  add(out, std::move(other));
}

/// Returns whether a sample has an offset that its readings do not determine.
bool take_off_offsets(ForceCurves& curves, std::vector<double>& zeroed_below) {
  bool open = false;
  for (const ForceOffset& o : subtract_offsets(curves)) {
    open = open || !o.determined;
    if (!o.determined) continue;
    zeroed_below.resize(curves.samples.size(), 0.0);
    zeroed_below[o.sample] = o.below;
  }
  return open;
}

void question(PairLaw& law, const std::string& why) {
  if (!has_numbers(law.status)) return;
  law.status = LawStatus::underdetermined;
  append_part(law.reason, why, " ");
}

/// The unloading branch of a law that has numbers; a remark where there is none, though something was unloaded.
void add_unloading(ForceCurves& curves, PairLaw& law) {
  if (!has_numbers(law.status) || !(law.normal.b.value > 0.0)) return;
  UnloadingFit fit = fit_unloading(curves.samples, law.normal.delta, law.normal.b.value);
  law.unloading = fit.law;
  if (!fit.remark.empty()) curves.remarks.push_back(to_string(curves.kind) + ": " + fit.remark);
}

TurnsVerdict judge_turns(const PreparedCurves& prepared, const FitOptions& options) {
  RunList runs;
  for (const PackingRun& run : prepared.data.runs) runs.push_back(&run);
  const double angle = options.secant_angle_deg.value_or(kSecantAngle);
  const double radius = prepared.data.spec.shell_radius;
  const LostTurns t =
      lost_turns(runs, prepared.data.spec, {options.delta_low, options.delta_high, options.initial_angle_deg, angle});
  if (t.lost == 0) return {};
  std::string why;
  if (t.short_of > 0)
    why = fmt::format("{} do not reach ht = {:.4g} m ({:g} degree of rotation)", t.short_of,
                      tangential_displacement(angle, radius), angle);
  if (t.short_of < t.lost)
    append_part(why,
                fmt::format("{} have no reading before the turn (ht = 0) nor one at either sign", t.lost - t.short_of));
  return {t.lost == t.turns,
          fmt::format("no tangential stiffness from {} of {} rotations (one sample at one overlap each): {}", t.lost,
                      t.turns, why)};
}

}  // namespace

std::array<double, 7> mirrored_numbers(const std::array<double, 7>& numbers, PairKind measured) {
  const auto [stretch, series] = symmetry_of(measured);
  std::array<double, 7> q = numbers;
  q[2] *= stretch;
  q[0] *= std::pow(stretch, -numbers[1]);
  q[3] *= series * std::pow(stretch, -numbers[4]);
  q[5] *= series * std::pow(stretch, -numbers[6]);
  return q;
}

TurnsVerdict judge_turns(const ForceCurves& curves, const FitOptions& options) {
  return judge_turns(prepare_curves(curves), options);
}

PreparedCurves prepare_curves(const ForceCurves& curves) {
  PreparedCurves out;
  std::vector<ForceCurve> samples = curves.samples;
  const std::string kind = to_string(curves.kind);
  if (samples.size() > 1 && !same_overlaps(samples)) {
    to_common(samples);
    out.note =
        fmt::format("{}: samples are interpolated to {} common overlaps", kind, common_overlaps(curves.samples).size());
  }
  for (ForceCurve& s : samples) {
    if (s.normal.size() <= kMostPoints) continue;
    out.note =
        fmt::format("{}: {} points per sample are averaged in {} bins of Delta", kind, s.normal.size(), kMostPoints);
    s.normal = binned(s.normal, kMostPoints);
  }
  if (bin_rotations(samples))
    out.note += (out.note.empty() ? kind + ": " : "; ") +
                fmt::format("stiffness at more than {0} overlaps is averaged in {0} bins of Delta", kMostPoints);
  out.data.spec = curves.spec;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    PackingInfo info;
    info.seed = k;
    out.data.packings.push_back(info);
    out.data.runs.push_back(run_of(samples[k], k, curves.kind));
  }
  if (curves.has_errors)
    out.errors = errors_of(samples, curves.spec.youngs_modulus * curves.spec.shell_radius * curves.spec.shell_radius);
  return out;
}

CurveMeans mean_curve(const ForceCurves& curves) {
  const PreparedCurves prepared = prepare_curves(curves);
  RunList runs;
  for (const PackingRun& run : prepared.data.runs) runs.push_back(&run);
  CurveMeans means = means_of(normal_samples(runs, curves.spec, {}));
  const double unit = curves.spec.youngs_modulus * curves.spec.shell_radius * curves.spec.shell_radius;
  for (std::size_t k = 0; k < means.delta.size(); ++k) {
    double single = means.deviation[k];
    for (const GivenError& g : prepared.errors)
      if (std::abs(g.delta - means.delta[k]) < kSame) single = std::max(single, g.error);
    means.mean[k] *= unit;
    means.deviation[k] = unit * single / std::sqrt(std::max(means.count[k], 1.0));
  }
  return means;
}

ExperimentFit fit_experiment(const std::vector<ForceCurves>& curves, const FitOptions& options, bool mirror) {
  ExperimentFit out;
  out.card.spec = curves.front().spec;
  out.card.relaxation = kExperiment;
  out.card.intervals.clear();
  out.curves = curves;
  for (ForceCurves& one : out.curves) {
    FitOptions o = options;
    const bool open = options.subtract_offset && take_off_offsets(one, o.zeroed_below);
    const PreparedCurves prepared = prepare_curves(one);
    o.experiment = true;
    o.given_errors = prepared.errors;
    FitReport report = fit_pair_law(prepared.data, one.kind, o);
    if (open)
      question(report.law, "The forces do not vanish with the overlap: an offset that the readings do not determine.");
    add_unloading(one, report.law);
    const TurnsVerdict turns = judge_turns(prepared, o);
    if (turns.none)
      question(report.law, std::string(kNoStiffness) + " (" + turns.why + ").");
    else if (!turns.why.empty())
      one.remarks.push_back(to_string(one.kind) + ": " + turns.why);
    out.remarks.insert(out.remarks.end(), one.remarks.begin(), one.remarks.end());
    if (!prepared.note.empty()) out.remarks.push_back(prepared.note);
    if (report.from_residuals)
      out.remarks.push_back(
          one.samples.size() == 1
              ? fmt::format("{}: 1 sample ({} needed for an interval over samples): intervals are from the residuals "
                            "about the law and do not cover other samples",
                            to_string(one.kind), options.min_packings)
              : fmt::format("{}: {} samples ({} needed to draw samples): intervals are from the differences between "
                            "samples (Student's t, {} degree{} of freedom) and the residuals about the law",
                            to_string(one.kind), one.samples.size(), options.min_packings, one.samples.size() - 1,
                            one.samples.size() == 2 ? "" : "s"));
    const std::string origin = report.from_residuals ? kFromResiduals : kFromSamples;
    report.law.band_origin = origin;
    if (out.card.intervals.find(origin) == std::string::npos) append_part(out.card.intervals, origin);
    add(out, std::move(report));
  }
  if (mirror) add_mirror(out);
  return out;
}

}  // namespace softgrain

#include "calibrate/experiment_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/core/few_samples.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

constexpr std::size_t kLeastReadings = 3;  ///< fewest readings without force that tell their scatter
constexpr std::size_t kLeastPoints = 6;    ///< a, b, delta, the offset, and something to judge them by
constexpr std::size_t kMostLookedAt = 100;

/// F = offset + scale (Delta^b - delta^b), offset alone below delta.
struct OffsetLaw {
  double offset = 0.0;
  double scale = 0.0;
  double delta = 0.0;
  double exponent = 1.0;
  double misfit = std::numeric_limits<double>::infinity();  ///< weighted sum of squares
};

/// Points of about even spacing and their weights: errors of a reading about 0.5 % of the range and 5 % of the force.
struct WeightedCurve {
  std::vector<ForcePoint> points;
  std::vector<double> weight;

  explicit WeightedCurve(const std::vector<ForcePoint>& all) {
    const std::size_t n = std::min(all.size(), kMostLookedAt);
    for (std::size_t k = 0; k < n; ++k) points.push_back(all[n < 2 ? k : k * (all.size() - 1) / (n - 1)]);
    const auto [low, high] = std::minmax_element(
        points.begin(), points.end(), [](const ForcePoint& a, const ForcePoint& b) { return a.force < b.force; });
    const double range = high->force - low->force;
    for (const ForcePoint& p : points)
      weight.push_back(1.0 / (0.005 * range + 0.05 * std::abs(p.force - points.front().force)));
  }
};

/// The best offset and scale at this threshold and exponent; without an offset where it must be 0.
OffsetLaw best_at(const WeightedCurve& curve, double delta, double exponent, bool with_offset) {
  double w = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < curve.points.size(); ++k) {
    const ForcePoint& p = curve.points[k];
    const double g = p.delta > delta ? std::pow(p.delta, exponent) - std::pow(delta, exponent) : 0.0;
    const double ww = curve.weight[k] * curve.weight[k];
    w += ww;
    x += ww * g;
    y += ww * p.force;
    xx += ww * g * g;
    xy += ww * g * p.force;
  }
  OffsetLaw law;
  const double determinant = with_offset ? w * xx - x * x : xx;
  if (!(determinant > 0.0)) return law;
  law.delta = delta;
  law.exponent = exponent;
  law.scale = with_offset ? (w * xy - x * y) / determinant : xy / xx;
  if (!(law.scale > 0.0)) return law;
  law.offset = with_offset ? (y - law.scale * x) / w : 0.0;
  double misfit = 0.0;  // from the residuals themselves: differences of the sums above lose what a good fit leaves
  for (std::size_t k = 0; k < curve.points.size(); ++k) {
    const ForcePoint& p = curve.points[k];
    const double g = p.delta > delta ? std::pow(p.delta, exponent) - std::pow(delta, exponent) : 0.0;
    const double r = curve.weight[k] * (p.force - law.offset - law.scale * g);
    misfit += r * r;
  }
  law.misfit = misfit;
  return law;
}

/// The best exponent at a threshold, to a thousandth.
OffsetLaw best_at(const WeightedCurve& curve, double delta, bool with_offset) {
  constexpr double kCoarse = 0.25;
  OffsetLaw best;
  const auto look = [&](double exponent) {
    if (const OffsetLaw law = best_at(curve, delta, exponent, with_offset); law.misfit < best.misfit) best = law;
  };
  for (double exponent = 0.5; exponent < 6.1; exponent += kCoarse) look(exponent);
  for (double step = 0.5 * kCoarse; step > 1e-3 && std::isfinite(best.misfit); step *= 0.5)
    for (const double exponent : {best.exponent - step, best.exponent + step}) look(exponent);
  return best;
}

/// The best law at each of many thresholds: rough, but no start can miss one.
std::vector<OffsetLaw> profile(const WeightedCurve& curve, bool with_offset) {
  constexpr int kParts = 4;
  std::vector<OffsetLaw> out{best_at(curve, 0.0, with_offset)};
  double before = 0.0;
  for (const ForcePoint& p : curve.points) {
    for (int k = 1; k <= kParts; ++k)
      out.push_back(best_at(curve, before + (p.delta - before) * k / kParts, with_offset));
    before = p.delta;
  }
  return out;
}

OffsetLaw best_of(const std::vector<OffsetLaw>& laws) {
  return *std::min_element(laws.begin(), laws.end(),
                           [](const OffsetLaw& a, const OffsetLaw& b) { return a.misfit < b.misfit; });
}

/// Half of the range of offsets of all thresholds that fit about as well as the best: where the curve begins above the
/// threshold, offset and threshold stand for each other.
double open_range(const std::vector<OffsetLaw>& laws, std::size_t points) {
  constexpr double kSmall = 0.02;  // residuals of so many weights are none
  const OffsetLaw best = best_of(laws);
  const auto n = static_cast<double>(points);
  const double near = best.misfit * (1.0 + 4.0 / std::max(n - 4.0, 1.0)) + n * kSmall * kSmall;
  double low = best.offset;
  double high = best.offset;
  for (const OffsetLaw& law : laws) {
    if (!(law.misfit <= near)) continue;
    low = std::min(low, law.offset);
    high = std::max(high, law.offset);
  }
  return 0.5 * (high - low);
}

/// Whether later readings are larger or smaller than earlier ones: the onset of the force, or a drift.
bool has_trend(const std::vector<double>& y) {
  const std::size_t n = y.size();
  if (n < 4) return false;
  const double middle = 0.5 * static_cast<double>(n - 1);
  const double mean = mean_error(y).mean;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double x = static_cast<double>(k) - middle;
    xx += x * x;
    xy += x * (y[k] - mean);
    yy += (y[k] - mean) * (y[k] - mean);
  }
  const double left = std::max(yy - xy * xy / xx, 0.0) / static_cast<double>(n - 2);
  const double slope_error = std::sqrt(left / xx);
  return std::abs(xy / xx) > student_quantile(0.995, static_cast<double>(n - 2)) * slope_error && slope_error > 0.0;
}

/// Readings without force: before touch, and below the threshold up to where they begin to rise.
std::vector<double> idle_readings(const ForceCurve& sample, double delta) {
  std::vector<double> out = sample.before_touch;
  for (const ForcePoint& p : sample.normal)
    if (p.delta < delta) out.push_back(p.force);
  while (out.size() > kLeastReadings && has_trend(out)) out.pop_back();
  return out;
}

double given_error(const ForceCurve& sample, double delta) {
  double sum = 0.0;
  double count = 0.0;
  for (const ForcePoint& p : sample.normal)
    if (p.delta < delta && std::isfinite(p.error)) {
      sum += p.error * p.error;
      count += 1.0;
    }
  return count > 0.0 ? std::sqrt(sum) / count : 0.0;
}

double largest_force(const ForceCurve& sample) {
  double most = 0.0;
  for (const ForcePoint& p : sample.normal) most = std::max(most, std::abs(p.force));
  return most;
}

/// An offset of one sample; none where nothing speaks for one.
std::optional<ForceOffset> offset_of(const ForceCurve& sample) {
  constexpr double kLeastShare = 1e-4;  // of the largest force: less does not matter
  constexpr double kProbability = 0.9995;
  if (sample.normal.size() < kLeastPoints || !(largest_force(sample) > 0.0)) return std::nullopt;
  const WeightedCurve curve(sample.normal);
  if (!std::ranges::all_of(curve.weight, [](double w) { return std::isfinite(w); }))
    return std::nullopt;  // all forces are the same
  const std::vector<OffsetLaw> laws = profile(curve, true);
  const OffsetLaw law = best_of(laws);
  const std::vector<double> idle = idle_readings(sample, law.delta);
  ForceOffset out;
  out.below = law.delta;
  out.readings = idle.size();
  if (idle.size() >= kLeastReadings) {
    const MeanError mean = mean_error(idle);
    out.force = mean.mean;
    out.error = std::max(mean.error, given_error(sample, law.delta));
    const double certain = student_quantile(kProbability, static_cast<double>(idle.size() - 1)) * out.error;
    if (std::abs(out.force) > std::max(certain, kLeastShare * largest_force(sample))) return out;
    return std::nullopt;
  }
  constexpr double kClearShare = 0.02;  // of the largest force
  constexpr double kSureShare = 0.01;
  constexpr double kFarBetter = 0.1;
  out.force = law.offset;
  // Not below what the residuals are at the lowest force, nor below what thresholds so far apart can tell.
  constexpr double kGrid = 0.2;
  const double freedom = std::max(static_cast<double>(curve.points.size()) - 4.0, 1.0);
  out.error = std::max(open_range(laws, curve.points.size()),
                       std::max(std::sqrt(law.misfit / freedom), kGrid) / curve.weight.front());
  out.determined = out.error < kSureShare * largest_force(sample);
  const bool matters = std::abs(law.offset) > kClearShare * largest_force(sample);
  if (matters && law.misfit < kFarBetter * best_of(profile(curve, false)).misfit) return out;
  return std::nullopt;
}

/// Median distance of neighbouring overlaps.
double usual_step(const std::vector<ForcePoint>& points) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < points.size(); ++k) steps.push_back(points[k].delta - points[k - 1].delta);
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return steps[steps.size() / 2];
}

/// Delta where the force begins to rise, of a curve that was recorded before touch though none of its overlaps is about
/// zero: overlaps would begin within a few steps of zero, so these are readings of a machine that has its own zero.
std::optional<double> onset_without_touch(const ForceCurve& sample) {
  constexpr double kStepsFromZero = 5.0;
  constexpr std::size_t kLeastIdle = 5;
  if (!sample.before_touch.empty() || sample.normal.size() < kLeastPoints) return std::nullopt;
  if (sample.normal.front().delta <= kStepsFromZero * usual_step(sample.normal)) return std::nullopt;
  const WeightedCurve curve(sample.normal);
  if (!std::ranges::all_of(curve.weight, [](double w) { return std::isfinite(w); })) return std::nullopt;
  const OffsetLaw law = best_of(profile(curve, true));
  if (idle_readings(sample, law.delta).size() < kLeastIdle) return std::nullopt;
  return law.delta;
}

/// "sample "A"", or of several how many they are, and which one has the largest offset.
std::string samples_text(const ForceCurves& curves, const std::vector<ForceOffset>& of) {
  if (of.size() == 1) return fmt::format("sample \"{}\"", curves.samples[of.front().sample].name);
  const auto largest = std::ranges::max_element(of, {}, [](const ForceOffset& o) { return std::abs(o.force); });
  return fmt::format("{} of {} samples (most in \"{}\")", of.size(), curves.samples.size(),
                     curves.samples[largest->sample].name);
}

/// "0.5 +- 0.01 N", or of several "-0.2 to 0.5 N, +- 0.01 N at most".
std::string forces_text(const std::vector<ForceOffset>& of) {
  if (of.size() == 1) return fmt::format("{:.4g} +- {:.2g} N", of.front().force, of.front().error);
  const auto [low, high] = std::ranges::minmax(of, {}, &ForceOffset::force);
  return fmt::format("{:.3g} to {:.3g} N, +- {:.2g} N at most", low.force, high.force,
                     std::ranges::max(of, {}, &ForceOffset::error).error);
}

/// "10 readings", or of several "10 to 12 readings each".
std::string readings_text(const std::vector<ForceOffset>& of) {
  const auto [fewest, most] = std::ranges::minmax(of, {}, &ForceOffset::readings);
  const std::string counts = fewest.readings == 0   ? "no"
                             : fewest.readings == 1 ? "one"
                                                    : std::to_string(fewest.readings);
  if (fewest.readings != most.readings) return fmt::format("{} to {} readings each", counts, most.readings);
  return counts + (fewest.readings > 1 ? " readings" : " reading") + (of.size() > 1 ? " each" : "");
}

/// What was subtracted, once for all samples: repeats on one machine tend to have an offset all.
std::string subtracted_text(const ForceCurves& curves, const std::vector<ForceOffset>& of) {
  const bool by_shape = std::ranges::any_of(of, [](const ForceOffset& o) { return o.readings < kLeastReadings; });
  return fmt::format(
      "{}: a constant force offset of {}, by {} without contact (before touch, or below Delta = {:.3g}){}, was "
      "subtracted from all forces of {} (softgrain calibrate --set offset=keep leaves it)",
      samples_text(curves, of), forces_text(of), readings_text(of), std::ranges::max(of, {}, &ForceOffset::below).below,
      by_shape ? " and the shape of the curve" : "", of.size() == 1 ? "the sample" : "each sample");
}

std::string open_text(const ForceCurves& curves, const std::vector<ForceOffset>& of) {
  return fmt::format(
      "{}: forces do not vanish with the overlap; a constant offset of about {} would explain it, but {} without "
      "contact do not tell how large it is: record some before touch, or subtract the zero",
      samples_text(curves, of), forces_text(of), readings_text(of));
}

}  // namespace

std::string touch_doubt(const ForceCurves& curves) {
  std::size_t doubtful = 0;
  double onset = std::numeric_limits<double>::infinity();
  double first = std::numeric_limits<double>::infinity();
  for (const ForceCurve& sample : curves.samples)
    if (const auto delta = onset_without_touch(sample)) {
      ++doubtful;
      onset = std::min(onset, *delta);
      first = std::min(first, sample.normal.front().delta);
    }
  if (doubtful == 0) return "";
  const double mm = 1e3 * curves.spec.shell_radius;
  return fmt::format(
      "overlap counts from first touch, but those of {} of {} samples begin at {:.3g} mm, with readings without "
      "contact; "
      "where the displacement has another zero, give its value at touch (\"# touch = {:.3g} mm\" or less: there the "
      "force begins to rise), else threshold and exponent of the law are wrong",
      doubtful, curves.samples.size(), mm * first, mm * onset);
}

std::vector<ForceOffset> force_offsets(const ForceCurves& curves) {
  std::vector<ForceOffset> out;
  for (std::size_t k = 0; k < curves.samples.size(); ++k)
    if (auto one = offset_of(curves.samples[k])) {
      one->sample = k;
      out.push_back(*one);
    }
  return out;
}

std::vector<ForceOffset> subtract_offsets(ForceCurves& curves) {
  std::vector<ForceOffset> found = force_offsets(curves);
  std::vector<ForceOffset> subtracted;
  std::vector<ForceOffset> open;
  for (const ForceOffset& o : found) {
    (o.determined ? subtracted : open).push_back(o);
    if (!o.determined) continue;
    ForceCurve& sample = curves.samples[o.sample];
    for (ForcePoint& p : sample.normal) p.force -= o.force;
    for (double& force : sample.before_touch) force -= o.force;
    for (UnloadedCurve& u : sample.unloaded) {
      u.force -= o.force;
      for (ForcePoint& p : u.points) p.force -= o.force;
    }
  }
  const std::string kind = to_string(curves.kind) + ": ";
  if (!subtracted.empty()) curves.remarks.push_back(kind + subtracted_text(curves, subtracted));
  if (!open.empty()) curves.remarks.push_back(kind + open_text(curves, open));
  return found;
}

}  // namespace softgrain

#include "calibrate/unloading_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calibrate/curve_samples.h"
#include "calibrate/least_squares.h"
#include "common/core/few_samples.h"
#include "common/core/law_range.h"
#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr std::size_t kMostReadings = 120;  ///< readings of one unloading; longer series are averaged
constexpr double kMostExcess = 20.0;        ///< of the exponent above the least one
constexpr std::size_t kShape = 2;           ///< residual and excess of the exponent; the rest are forces

/// Averages of so many neighbouring readings that few enough are left.
std::vector<ForcePoint> thinned(const std::vector<ForcePoint>& points) {
  const std::size_t group = (points.size() + kMostReadings - 1) / kMostReadings;
  if (group < 2) return points;
  std::vector<ForcePoint> out;
  for (std::size_t k = 0; k < points.size(); k += group) {
    const std::size_t end = std::min(k + group, points.size());
    ForcePoint mean;
    for (std::size_t i = k; i < end; ++i) {
      mean.delta += points[i].delta / static_cast<double>(end - k);
      mean.force += points[i].force / static_cast<double>(end - k);
    }
    out.push_back(mean);
  }
  return out;
}

/// Residual and exponent of one fit.
struct BranchFit {
  double residual = 0.0;
  double exponent = 0.0;
  std::array<double, 3> covariance{};  ///< variance of the residual, covariance, variance of the exponent
  bool at_least = false;               ///< the exponent is as small as it may be
  bool at_most = false;                ///< the residual is as large as it may be
};

/// A fit, or why there is none.
struct BranchOutcome {
  std::optional<BranchFit> fit{};
  std::string why{};
};

/// Whether an unloading says anything of the branch. Where it begins is what its own force A is fitted to.
bool is_informative(const UnloadedCurve& u, double threshold) {
  return u.deepest > threshold && u.force > 0.0 && !u.points.empty();
}

/// All unloadings of some samples under one branch, of which each sample has one that counts.
class BranchProblem {
 public:
  BranchProblem(const std::vector<const ForceCurve*>& samples, double threshold, double loading_exponent)
      : threshold_(threshold), b_(loading_exponent) {
    for (const ForceCurve* s : samples)
      for (UnloadedCurve u : s->unloaded) {
        if (!is_informative(u, threshold)) continue;
        u.points = thinned(u.points);
        readings_ += u.points.size() + 1;  // and the one where it begins
        curves_.push_back(std::move(u));
      }
  }

  [[nodiscard]] std::size_t readings() const { return readings_; }
  [[nodiscard]] std::size_t unloadings() const { return curves_.size(); }
  /// Mean Delta where unloadings begin.
  [[nodiscard]] double deepest() const {
    double sum = 0.0;
    for (const UnloadedCurve& u : curves_) sum += u.deepest;
    return sum / static_cast<double>(curves_.size());
  }

  [[nodiscard]] BranchOutcome fit() const {
    constexpr std::size_t kLeast = kShape + 2;
    if (const std::size_t below = readings_ - curves_.size(); below < kLeast)
      return {std::nullopt, fmt::format("{} of unloading from above the threshold of the law, at least {} are needed",
                                        counted(below, "reading"), kLeast)};
    LeastSquaresProblem problem;
    problem.residuals = readings_;
    problem.evaluate = [this](std::span<const double> x, std::span<double> r) { return residuals(x, r); };
    problem.bounds = {{0.0, kLargestResidual}, {0.0, kMostExcess}};
    problem.bounds.resize(kShape + curves_.size());
    std::vector<std::vector<double>> starts;
    for (const double residual : {0.1, 0.3, 0.6}) {
      starts.push_back({residual, 0.2});
      for (const UnloadedCurve& u : curves_) starts.back().push_back(u.force);
    }
    const LeastSquaresFit found = fit_least_squares(problem, starts);
    if (found.rank_deficient)
      return {std::nullopt,
              fmt::format("{} readings do not determine residual and exponent", readings_ - curves_.size())};
    if (!found.usable()) return {std::nullopt, "the fit found no minimum: " + found.message};
    return {branch_of(found), ""};
  }

 private:
  [[nodiscard]] double exponent(double residual, double excess) const {
    return least_unloading_exponent(residual, b_) + excess;
  }

  bool residuals(std::span<const double> x, std::span<double> r) const {
    const double m = exponent(x[0], x[1]);
    std::size_t k = 0;
    for (std::size_t j = 0; j < curves_.size(); ++j) {
      const UnloadedCurve& u = curves_[j];
      const double length = (1.0 - x[0]) * (u.deepest - threshold_);
      const double force = x[kShape + j];
      r[k++] = force - u.force;
      for (const ForcePoint& p : u.points) {
        const double share = 1.0 - (u.deepest - p.delta) / length;
        r[k++] = (share > 0.0 ? force * std::pow(share, m) : 0.0) - p.force;
      }
    }
    return true;
  }

  /// Readings that stand for one, as neighbours are correlated.
  [[nodiscard]] double correlated(const std::vector<double>& x) const {
    std::vector<double> r(readings_);
    (void)residuals(x, r);
    return static_cast<double>(correlation_length(r, 1));
  }

  [[nodiscard]] BranchFit branch_of(const LeastSquaresFit& found) const {
    const std::vector<double>& x = found.parameters;
    BranchFit out{x[0], exponent(x[0], x[1]), {}, found.at_bound[1], found.at_bound[0] && x[0] > 0.0};
    const std::size_t n = x.size();
    const double block = correlated(x);
    const double rr = block * found.covariance[0];
    const double re = block * found.covariance[1];
    const double ee = block * found.covariance[n + 1];
    const double bend = 1.0 + std::max(1.0, b_);
    const double slope = (1.0 - x[0]) * bend > 2.0 ? -bend : 0.0;  // of the least exponent over the residual
    out.covariance = {rr, slope * rr + re, slope * slope * rr + 2.0 * slope * re + ee};
    return out;
  }

  double threshold_;
  double b_;
  std::vector<UnloadedCurve> curves_;
  std::size_t readings_ = 0;
};

/// Covariance from fits without one sample each, or why there is none.
struct BetweenSamples {
  std::optional<std::array<double, 3>> covariance{};
  std::string why{};
};

BetweenSamples jackknife(const std::vector<const ForceCurve*>& samples, double threshold, double loading_exponent) {
  std::vector<BranchFit> left;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    std::vector<const ForceCurve*> others = samples;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const BranchOutcome one = BranchProblem(others, threshold, loading_exponent).fit();
    if (!one.fit)
      return {std::nullopt, fmt::format("its error is not known, as there is none without sample \"{}\" ({})",
                                        samples[k]->name, one.why)};
    left.push_back(*one.fit);
  }
  const auto n = static_cast<double>(left.size());
  double residual = 0.0;
  double exponent = 0.0;
  for (const BranchFit& f : left) {
    residual += f.residual / n;
    exponent += f.exponent / n;
  }
  std::array<double, 3> out{};
  for (const BranchFit& f : left) {
    const double dr = f.residual - residual;
    const double dm = f.exponent - exponent;
    out[0] += (n - 1.0) / n * dr * dr;
    out[1] += (n - 1.0) / n * dr * dm;
    out[2] += (n - 1.0) / n * dm * dm;
  }
  return {out, ""};
}

/// The residual is the share of a depth below the threshold, whose error takes it along: its interval that of the
/// threshold, Student's where that is.
void add_threshold_error(const Estimate& delta, double deepest, Estimate& residual) {
  if (!std::isfinite(delta.standard_error)) return;
  const double slope = residual_slope(residual.value, deepest, delta.value);
  residual.standard_error = std::hypot(residual.standard_error, slope * delta.standard_error);
  double below = std::abs(slope) * (delta.value - delta.low);
  double above = std::abs(slope) * (delta.high - delta.value);
  if (slope < 0.0) std::swap(below, above);
  residual.low = std::max(0.0, residual.value - std::hypot(residual.value - residual.low, below));
  residual.high = std::min(kLargestResidual, residual.value + std::hypot(residual.high - residual.value, above));
}

}  // namespace

UnloadingFit fit_unloading(const std::vector<ForceCurve>& samples, const Estimate& delta, double loading_exponent) {
  const double threshold = delta.value;
  std::vector<const ForceCurve*> used;
  std::size_t unloaded = 0;
  for (const ForceCurve& s : samples) {
    unloaded += s.unloaded.empty() ? 0 : 1;
    if (std::ranges::any_of(s.unloaded, [&](const UnloadedCurve& u) { return is_informative(u, threshold); }))
      used.push_back(&s);
  }
  if (unloaded == 0) return {};
  const std::string idle = fmt::format(
      "of {} of {} samples that were unloaded nothing counts: no unloading with readings begins above the threshold of "
      "the law (Delta = {:.4g}) under a force",
      unloaded - used.size(), unloaded, threshold);
  const auto none = [](const std::string& why) { return UnloadingFit{std::nullopt, "no unloading branch: " + why}; };
  if (used.empty()) return none(idle);
  const BranchProblem problem(used, threshold, loading_exponent);
  const BranchOutcome found = problem.fit();
  if (!found.fit) return none(found.why);
  UnloadingLaw law;
  law.samples = static_cast<int>(used.size());
  law.points = static_cast<int>(problem.readings());
  law.deepest = problem.deepest();
  std::array<double, 3> covariance = found.fit->covariance;
  double freedom = static_cast<double>(problem.readings() - kShape - problem.unloadings());
  if (used.size() > 1) {
    const BetweenSamples between = jackknife(used, threshold, loading_exponent);
    if (!between.covariance) return none(between.why);
    covariance = *between.covariance;
    freedom = static_cast<double>(used.size() - 1);
  }
  law.residual = student_estimate(found.fit->residual, std::sqrt(covariance[0]), freedom, 0.0, kLargestResidual);
  law.exponent = student_estimate(found.fit->exponent, std::sqrt(covariance[2]), freedom, 1.0);
  add_threshold_error(delta, law.deepest, law.residual);
  const double scale = law.residual.standard_error * law.exponent.standard_error;
  law.correlation = scale > 0.0 ? std::clamp(covariance[1] / scale, -1.0, 1.0) : 0.0;
  UnloadingFit out{law, ""};
  if (found.fit->at_least)
    out.remark =
        fmt::format("the exponent of unloading is {:.4g}, the least with which no cycle gives back more than it took",
                    found.fit->exponent);
  if (found.fit->at_most)
    append_part(out.remark, fmt::format("the residual is {:g}, the largest that a law may have", kLargestResidual));
  if (used.size() < unloaded) append_part(out.remark, idle);
  return out;
}

}  // namespace softgrain

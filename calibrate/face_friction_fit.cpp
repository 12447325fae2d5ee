#include "calibrate/face_friction_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/least_squares.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

using Pair = std::array<double, 2>;  ///< ln mu_f, ln chi

/// Half width of the first 3 x 3, and of the last, in logarithms.
constexpr double kFirstWidth = 0.69;
constexpr double kLastWidth = 0.15;
constexpr double kClosing = 0.22;  ///< width of the next round over that of this one
constexpr int kMostRounds = 8;
/// Samples may lie so many widths of the last surface away from its middle.
constexpr double kReach = 5.0;

const Pair kLow{std::log(0.02), std::log(0.02)};
const Pair kHigh{std::log(5.0), std::log(50.0)};

/// Curves at 3 x 3 nodes and parabolas between.
class FrictionSurface {
 public:
  FrictionSurface(const Pair& middle, double width) : middle_(middle), width_(width) {}

  [[nodiscard]] std::vector<FaceFrictionTrial> nodes() const {
    std::vector<FaceFrictionTrial> out;
    for (const double a : {-1.0, 0.0, 1.0})
      for (const double b : {-1.0, 0.0, 1.0})
        out.push_back({std::exp(middle_[0] + a * width_), std::exp(middle_[1] + b * width_)});
    return out;
  }

  void set(std::vector<std::vector<double>> curves) { curves_ = std::move(curves); }

  [[nodiscard]] std::vector<double> at(double log_friction, double log_stiffness) const {
    return combined(lagrange(place(log_friction, 0)), lagrange(place(log_stiffness, 1)));
  }

  /// Where the surface is nearest to `row`, within `reach` widths of its middle.
  [[nodiscard]] LeastSquaresFit nearest(const std::vector<double>& row, const std::vector<double>& weight,
                                        double reach) const {
    LeastSquaresProblem problem;
    std::vector<std::size_t> known;
    for (std::size_t k = 0; k < row.size(); ++k)
      if (std::isfinite(row[k]) && weight[k] > 0.0) known.push_back(k);
    problem.residuals = known.size();
    for (std::size_t p = 0; p < 2; ++p)
      problem.bounds.push_back({middle_[p] - reach * width_, middle_[p] + reach * width_});
    problem.evaluate = [&, known](std::span<const double> p, std::span<double> r) {
      const std::vector<double> values = at(p[0], p[1]);
      for (std::size_t k = 0; k < known.size(); ++k)
        r[k] = std::sqrt(weight[known[k]]) * (values[known[k]] - row[known[k]]);
      return true;
    };
    problem.jacobian = [&, known](std::span<const double> p, std::span<double> j) {
      const double a = place(p[0], 0);
      const double b = place(p[1], 1);
      const std::array slopes{combined(lagrange_slope(a), lagrange(b)), combined(lagrange(a), lagrange_slope(b))};
      for (std::size_t k = 0; k < known.size(); ++k)
        for (std::size_t which = 0; which < 2; ++which)
          j[2 * k + which] = std::sqrt(weight[known[k]]) * slopes[which][known[k]] / width_;
      return true;
    };
    return fit_least_squares(problem, {{middle_[0], middle_[1]}});
  }

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] const Pair& middle() const { return middle_; }

 private:
  [[nodiscard]] double place(double logarithm, std::size_t axis) const { return (logarithm - middle_[axis]) / width_; }

  /// Weights of the nodes -1, 0, 1, and how they change.
  static std::array<double, 3> lagrange(double t) { return {0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)}; }
  static std::array<double, 3> lagrange_slope(double t) { return {t - 0.5, -2.0 * t, t + 0.5}; }

  [[nodiscard]] std::vector<double> combined(const std::array<double, 3>& a, const std::array<double, 3>& b) const {
    std::vector<double> out(curves_.front().size(), 0.0);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < out.size(); ++k) out[k] += a[i] * b[j] * curves_[3 * i + j][k];
    return out;
  }

  Pair middle_;
  double width_;
  std::vector<std::vector<double>> curves_;
};

void require_rows(const FaceFrictionData& data) {
  if (data.samples.empty()) throw InputError("face friction: no sample was measured");
  for (const auto& row : data.samples)
    if (row.size() != data.weight.size() || row.size() < 2)
      throw InputError(fmt::format("face friction: {} values and {} weights; at least two of both are needed",
                                   row.size(), data.weight.size()));
}

std::vector<double> mean_row(const FaceFrictionData& data) {
  std::vector<double> out;
  for (std::size_t k = 0; k < data.weight.size(); ++k)
    out.push_back(finite_mean(data.samples, [k](const auto& row) { return row[k]; }).mean);
  return out;
}

double deviation_of(const FaceFrictionFit& fit, const std::vector<double>& weight) {
  double squares = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < weight.size(); ++k) {
    if (!std::isfinite(fit.mean[k])) continue;
    squares += weight[k] * std::pow(fit.model[k] - fit.mean[k], 2);
    all += weight[k];
  }
  return std::sqrt(squares / all);
}

/// Estimate from the logarithms of the samples' own fits, about that of their mean curve.
Estimate of_samples(double log_value, const std::vector<double>& logs) {
  const double value = std::exp(log_value);
  if (logs.size() < 2) return {value, kInfinity, 0.0, kInfinity};
  const double error = mean_error(logs).error;
  const auto [low, high] = student_interval(log_value, error, static_cast<double>(logs.size()) - 1.0);
  return {value, value * error, std::exp(low), std::exp(high)};
}

class FaceFrictionSearch {
 public:
  FaceFrictionSearch(const FaceFrictionModel& model, const FaceFrictionData& data) : model_(model), data_(data) {
    out_.mean = mean_row(data);
  }

  FaceFrictionFit run(const FaceFrictionTrial& start) {
    FrictionSurface surface({std::log(start.friction), std::log(start.stiffness)}, kFirstWidth);
    Pair found{};
    for (int round = 0;; ++round) {
      if (round == kMostRounds) return not_usable("the search does not settle");
      if (!evaluate(surface)) return out_;
      const LeastSquaresFit fit = surface.nearest(out_.mean, data_.weight, 1.0);
      const bool at_edge = fit.at_bound[0] || fit.at_bound[1];
      if (fit.end == FitEnd::failed || (fit.rank_deficient && !at_edge))
        return not_usable("the curves do not determine mu_f and chi");
      for (std::size_t p = 0; p < 2; ++p) {
        found[p] = fit.parameters[p];
        if (found[p] < kLow[p] || found[p] > kHigh[p])
          return not_usable(p == 0 ? "mu_f is not determined: the best lies beyond 0.02 to 5"
                                   : "chi is not determined: the best lies beyond 0.02 to 50");
      }
      const bool among = fit.usable() && !at_edge;
      if (among && surface.width() <= kLastWidth) break;
      surface = FrictionSurface(found, among ? std::max(kLastWidth, kClosing * surface.width()) : surface.width());
    }
    return finish(surface, found);
  }

 private:
  bool evaluate(FrictionSurface& surface) {
    std::vector<std::vector<double>> curves = curves_at(surface.nodes());
    if (curves.empty()) return false;
    surface.set(std::move(curves));
    return true;
  }

  /// None where the law gives no curve for one of the trials.
  std::vector<std::vector<double>> curves_at(const std::vector<FaceFrictionTrial>& trials) {
    std::vector<std::vector<double>> curves = model_(trials);
    out_.evaluations += static_cast<int>(trials.size());
    for (std::size_t k = 0; k < trials.size(); ++k) {
      const bool finite = std::ranges::all_of(curves[k], [](double value) { return std::isfinite(value); });
      if (curves[k].size() == data_.weight.size() && finite) continue;
      (void)not_usable(fmt::format("the cell law gives no curve of the fines with mu_f = {:.3g}, chi = {:.3g}",
                                   trials[k].friction, trials[k].stiffness));
      return {};
    }
    return curves;
  }

  FaceFrictionFit finish(const FrictionSurface& surface, const Pair& found) {
    std::vector<double> friction;
    std::vector<double> stiffness;
    for (const auto& row : data_.samples) {
      const LeastSquaresFit fit = surface.nearest(row, data_.weight, kReach);
      if (!fit.usable() || fit.at_bound[0] || fit.at_bound[1])
        return not_usable("mu_f and chi are not determined: samples disagree by more than half");
      friction.push_back(fit.parameters[0]);
      stiffness.push_back(fit.parameters[1]);
    }
    const std::vector<std::vector<double>> last = curves_at({{std::exp(found[0]), std::exp(found[1])}});
    if (last.empty()) return out_;
    out_.model = last.front();
    out_.friction = of_samples(found[0], friction);
    out_.stiffness = of_samples(found[1], stiffness);
    out_.deviation = deviation_of(out_, data_.weight);
    out_.usable = true;
    out_.message = data_.samples.size() > 1 ? "fitted" : "fitted; one sample: errors are not known";
    return out_;
  }

  FaceFrictionFit not_usable(const std::string& message) {
    out_.message = message;
    return out_;
  }

  const FaceFrictionModel& model_;
  const FaceFrictionData& data_;
  FaceFrictionFit out_;
};

}  // namespace

FaceFrictionFit fit_face_friction(const FaceFrictionModel& model, const FaceFrictionData& data,
                                  const FaceFrictionTrial& start) {
  require_rows(data);
  return FaceFrictionSearch(model, data).run(start);
}

}  // namespace softgrain

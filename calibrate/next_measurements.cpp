#include "calibrate/next_measurements.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/core/error.h"

namespace softgrain {

/// Covariance of all predicted numbers, then of all measurables.
struct NextMeasurements::Joint {
  Eigen::MatrixXd covariance;
  Eigen::Index predicted = 0;
  std::vector<double> scatter;
  double before = 0.0;  ///< variance of the prediction

  [[nodiscard]] double variance() const { return covariance.diagonal().head(predicted).sum(); }
  [[nodiscard]] Eigen::Index index(std::size_t measurable) const {
    return predicted + static_cast<Eigen::Index>(measurable);
  }
  /// Variance of the mean of so many measurements, with what the law leaves open.
  [[nodiscard]] double variance_of_mean(std::size_t measurable, std::int64_t measurements) const {
    const Eigen::Index k = index(measurable);
    return covariance(k, k) + std::pow(scatter[measurable], 2) / static_cast<double>(measurements);
  }
  /// How much of the variance of the prediction goes.
  [[nodiscard]] double gain(std::size_t measurable, std::int64_t measurements) const {
    return covariance.col(index(measurable)).head(predicted).squaredNorm() / variance_of_mean(measurable, measurements);
  }
};

namespace {

void require_rows(const std::vector<std::vector<double>>& predicted, const std::vector<Measurable>& measurables) {
  if (predicted.size() < 3) throw InputError("a plan needs three draws or more");
  for (const std::vector<double>& row : predicted)
    if (row.size() != predicted.front().size()) throw InputError("predictions of the draws have unequal lengths");
  for (const Measurable& m : measurables) {
    if (m.drawn.size() != predicted.size()) throw InputError("a measurable has not one value per draw");
    if (!(m.scatter > 0.0) || !(m.cost > 0.0)) throw InputError("scatter and cost of a measurable must be above 0");
  }
}

}  // namespace

NextMeasurements::NextMeasurements(const std::vector<std::vector<double>>& predicted,
                                   const std::vector<Measurable>& measurables) {
  require_rows(predicted, measurables);
  const auto draws = static_cast<Eigen::Index>(predicted.size());
  const auto numbers = static_cast<Eigen::Index>(predicted.front().size());
  Eigen::MatrixXd all(draws, numbers + static_cast<Eigen::Index>(measurables.size()));
  for (Eigen::Index r = 0; r < draws; ++r) {
    for (Eigen::Index k = 0; k < numbers; ++k)
      all(r, k) = predicted[static_cast<std::size_t>(r)][static_cast<std::size_t>(k)];
    for (std::size_t c = 0; c < measurables.size(); ++c)
      all(r, numbers + static_cast<Eigen::Index>(c)) = measurables[c].drawn[static_cast<std::size_t>(r)];
  }
  const Eigen::MatrixXd centred = all.rowwise() - all.colwise().mean();
  joint_ = std::make_unique<Joint>();
  Joint& joint = *joint_;
  joint.covariance = centred.transpose() * centred / static_cast<double>(draws - 1);
  joint.predicted = numbers;
  for (const Measurable& m : measurables) joint.scatter.push_back(m.scatter);
  joint.before = joint.variance();
  if (!(joint.before > 0.0)) throw InputError("the prediction is the same with every draw: there is nothing to plan");
}

NextMeasurements::~NextMeasurements() = default;
NextMeasurements::NextMeasurements(NextMeasurements&&) noexcept = default;

double NextMeasurements::share_after(std::size_t measurable, std::int64_t measurements) const {
  const Joint& j = *joint_;
  return std::sqrt(std::max(j.variance() - j.gain(measurable, measurements), 0.0) / j.before);
}

void NextMeasurements::measure(std::size_t measurable, std::int64_t measurements) {
  Joint& j = *joint_;
  const Eigen::VectorXd column = j.covariance.col(j.index(measurable));
  j.covariance -= column * column.transpose() / j.variance_of_mean(measurable, measurements);
}

double NextMeasurements::share() const {
  const Joint& j = *joint_;
  return std::sqrt(std::max(j.variance(), 0.0) / j.before);
}

std::vector<PlannedBlock> plan_greedily(NextMeasurements plan, const std::vector<Measurable>& measurables,
                                        std::int64_t block, double wanted, std::size_t most) {
  constexpr double kHelps = 1e-4;  // of the standard deviation that is left
  std::vector<PlannedBlock> out;
  while (out.size() < most && plan.share() > wanted) {
    const double now = plan.share();
    std::size_t best = measurables.size();
    double best_rate = 0.0;
    for (std::size_t c = 0; c < measurables.size(); ++c) {
      const double after = plan.share_after(c, block);
      const double rate = (now * now - after * after) / measurables[c].cost;
      if (now - after > kHelps * now && rate > best_rate) best = c, best_rate = rate;
    }
    if (best == measurables.size()) break;
    plan.measure(best, block);
    out.push_back({best, block, static_cast<double>(block) * measurables[best].cost, plan.share()});
  }
  return out;
}

}  // namespace softgrain

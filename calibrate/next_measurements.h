// Which further measurement would narrow a prediction most for its cost: linear-Gaussian design of experiments, from
// draws of a law alone.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace softgrain {

/// Something that could be measured once more.
struct Measurable {
  std::vector<double> drawn;  ///< what it comes to with each draw of the law; logarithms of forces
  double scatter = 0.0;       ///< standard deviation between single measurements, in the same units
  double cost = 0.0;          ///< cost of one measurement, above 0
};

/// One step of a plan.
struct PlannedBlock {
  std::size_t measurable = 0;
  std::int64_t measurements = 0;
  double cost = 0.0;   ///< cost of this block
  double share = 1.0;  ///< standard deviation of the prediction after it over that before the plan
};

/// Effect of further measurements on the variance of a prediction. For a prediction with several numbers a plan lessens
/// the sum of their variances.
class NextMeasurements {
 public:
  /// `predicted`: one row per draw. Draws of the law are taken as a sample of a normal distribution. Throws InputError
  /// for fewer than three draws, rows of unequal lengths, a scatter or cost that is not above 0, and where predictions
  /// do not differ from draw to draw.
  NextMeasurements(const std::vector<std::vector<double>>& predicted, const std::vector<Measurable>& measurables);
  ~NextMeasurements();
  NextMeasurements(NextMeasurements&&) noexcept;

  /// Standard deviation of the prediction over that before, were this measured `measurements` times.
  [[nodiscard]] double share_after(std::size_t measurable, std::int64_t measurements) const;

  /// It is: what comes after builds on it.
  void measure(std::size_t measurable, std::int64_t measurements);

  /// Standard deviation of the prediction over that at the outset.
  [[nodiscard]] double share() const;

 private:
  struct Joint;
  std::unique_ptr<Joint> joint_;  // Eigen stays out of this header
};

/// Blocks of `block` measurements, each of them what lessens the variance most per cost, until the standard deviation
/// is `wanted` of what it was, `most` blocks are planned or nothing helps.
std::vector<PlannedBlock> plan_greedily(NextMeasurements plan, const std::vector<Measurable>& measurables,
                                        std::int64_t block, double wanted, std::size_t most);

}  // namespace softgrain

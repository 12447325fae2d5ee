// How a library predicts one number: by a Gaussian process, or by the mean of its materials where that does as well.
#pragma once

#include <string>
#include <vector>

#include "calibrate/gaussian_process.h"
#include "pipelines/law/law_library.h"

namespace softgrain {

/// What is known of one number: a row for each material that has it.
struct KnownNumber {
  std::vector<std::vector<double>> points;  ///< variables, from 0 to 1 over their measured ranges
  std::vector<double> values;
  std::vector<double> errors;
};

/// Points of several coordinates, each of which goes from 0 to 1 over its range; 0.5 where it never varies.
class UnitBox {
 public:
  explicit UnitBox(const std::vector<std::vector<double>>& rows);
  [[nodiscard]] std::vector<double> operator()(const std::vector<double>& row) const;
  [[nodiscard]] std::vector<double> row(const std::vector<double>& u) const;                ///< of a point of the box
  [[nodiscard]] const std::vector<std::vector<double>>& points() const { return points_; }  ///< the rows, scaled
  [[nodiscard]] double low(std::size_t a) const { return low_[a]; }
  [[nodiscard]] double high(std::size_t a) const { return high_[a]; }

 private:
  std::vector<double> low_;
  std::vector<double> high_;
  std::vector<std::vector<double>> points_;
};

/// The materials that have number k of LawLibrary::names().
KnownNumber known_number(const LawLibrary& library, const UnitBox& box, std::size_t k);

/// What is wrong with the value of a variable, at u of its measured range; empty: nothing. One that never varied serves
/// its own value, but for rounding.
std::string outside_text(const LibraryVariable& v, double low, double high, double value, double u);

/// Materials that a number must have: one more than its process needs, so that each can be left out.
std::size_t least_materials();

/// Each material left out in turn, see LibraryCheck.
LibraryCheck checked_number(const std::string& name, const KnownNumber& known);

/// The number of other materials, as its check decides, with the widened deviation. The deviation of a mean is the
/// scatter of the materials, or the mean error of their measurements where that is larger, times sqrt(1 + 1/n) and
/// widened by Student's t.
std::vector<ProcessValue> predicted_number(const LibraryCheck& check, const KnownNumber& known,
                                           const std::vector<std::vector<double>>& points);

/// The same at the first point; the others are draws of it, and what they change is part of the deviation.
ProcessValue predicted_value(const LibraryCheck& check, const KnownNumber& known,
                             const std::vector<std::vector<double>>& points);

/// The check of every number of a library over the points of its materials. Throws InputError for too few materials.
std::vector<LibraryCheck> check_numbers(const LawLibrary& library, const UnitBox& box);

/// All numbers at a point of the box, as `checks` decide, and the nearest material; `at` is left for the caller.
/// `scatter`: draws of the point, where it is not known for certain; what they change is part of the deviations. Throws
/// InputError where too few materials have a number of the law.
LibraryAnswer answer_at(const LawLibrary& library, const std::vector<LibraryCheck>& checks, const UnitBox& box,
                        const std::vector<double>& u, const std::vector<std::vector<double>>& scatter = {});

}  // namespace softgrain

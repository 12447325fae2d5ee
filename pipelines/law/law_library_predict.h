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

/// Materials that a number must have: one more than its process needs, so that each can be left out.
std::size_t least_materials();

/// Each material left out in turn, see LibraryCheck.
LibraryCheck checked_number(const std::string& name, const KnownNumber& known);

/// The number of another material, as its check decides, with the widened deviation. The deviation of a mean is the
/// scatter of the materials, or the mean error of their measurements where that is larger, times sqrt(1 + 1/n) and
/// widened by Student's t.
ProcessValue predicted_number(const LibraryCheck& check, const KnownNumber& known, const std::vector<double>& u);

}  // namespace softgrain

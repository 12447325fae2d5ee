// The compressible packing model of de Larrard beside the onset of a recipe.
#pragma once

#include <string>

#include "common/packing/grading.h"
#include "pipelines/kinds/recipe/summary.h"

namespace softgrain {

/// The model for the sizes of the whole, with one beta for all: that with which grains of one size pack as rods of this
/// gap do, beta = phi_1 (1 + 1/K). So it differs from our value by what it makes of sizes alone.
CompressibleModelSummary compressible_model(const Grading& sizes, double gap);

/// "0.701 (K = 4.1) and 0.722 (K = 9), with beta from grains of one size (0.585)".
std::string compressible_model_text(const CompressibleModelSummary& model);

}  // namespace softgrain

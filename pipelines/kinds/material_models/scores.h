// Curves of models beside the truth.
#pragma once

#include "common/core/text.h"
#include "pipelines/kinds/material_models/models.h"
#include "pipelines/kinds/material_models/summary.h"

namespace softgrain {

/// Samples that truth and model came through to the end are compared, pair by pair, by their mean curves, point by
/// point; those that a model did not are named. Strain and stress of z are axial.
ModelScore score(const ModelRun& run, bool blind);

/// Square root of sum (model - truth)^2 over sum truth^2 of the points from `first` on. NaN where there is none.
double relative_difference(const std::vector<double>& model, const std::vector<double>& truth, std::size_t first);

TextTable table_of(const std::vector<ModelScore>& scores);
std::string console_summary(const std::vector<ModelScore>& scores);

}  // namespace softgrain

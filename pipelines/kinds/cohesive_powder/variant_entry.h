// What one variant of a powder came to, in short.
#pragma once

#include <vector>

#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/kinds/cohesive_powder/variants.h"

namespace softgrain {

/// What the summary in the directory of a variant says.
struct VariantRun {
  AnySummary run;
  PowderSummary powder;
};

/// Names of the quantities of an entry, in the order of the table.
const std::vector<const char*>& powder_quantities();

/// Names of the quantities that may be published: all but the cost of a run.
std::vector<const char*> powder_comparable();

/// "values" has mean, deviation, standard error and number of samples of every quantity over the samples at rest;
/// "difference" to the published values, also in combined standard errors where both are known. `ended`: null when the
/// variant was not run.
VariantEntry powder_variant_entry(const PowderVariant& variant, const VariantRun* ended);

}  // namespace softgrain

// softgrain calibrate DATA.csv...: the law of a contact from force-displacement measurements of an experiment.
#pragma once

#include "pipelines/run/run_context.h"

namespace softgrain {

/// Whether the inputs are tables in text (.csv, .tsv, .txt, .dat). Throws InputError when only some are, or when an
/// option for such tables stands beside other files.
bool are_curve_files(const CommonOptions& options);

/// Fits, writes law.toml, law.h5, summary.json and the report.
ExitStatus calibrate_curves(const CommonOptions& options);

}  // namespace softgrain

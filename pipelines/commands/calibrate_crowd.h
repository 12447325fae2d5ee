// softgrain calibrate with crowd measurements: several neighbours at once.
#pragma once

#include <string>
#include <vector>

#include "pipelines/run/run_context.h"

namespace softgrain {

/// Whether all of these files hold crowd measurements; false when none does. Throws BadInput for a mixture,
/// FileTrouble.
bool are_crowd_files(const std::vector<std::string>& files);

/// Fits one entry per file and writes law_table.toml, law_table.h5, crowd.h5 (that of the first file, for the report),
/// summary.json and the report. Settings through --set: `discrepancy`, `replicates`, `min_packings`, `target`. Status
/// not_usable when a recorded point did not converge or a best law is not good. Throws BadInput (settings, two files of
/// one solid fraction), NotUsable (no force anywhere), FileTrouble.
ExitStatus calibrate_crowd(const CommonOptions& options);

}  // namespace softgrain

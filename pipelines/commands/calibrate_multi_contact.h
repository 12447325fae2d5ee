// softgrain calibrate with multi-contact measurements: several neighbours at once.
#pragma once

#include <string>
#include <vector>

#include "pipelines/run/run_context.h"

namespace softgrain {

/// Whether all of these files hold multi-contact measurements; false when none does. Throws InputError for a mixture,
/// IoError.
bool are_multi_contact_files(const std::vector<std::string>& files);

/// Fits one entry per file and writes law_table.toml, law_table.h5, multi_contact.h5 (that of the first file, for the
/// report), summary.json and the report. Settings through --set: `discrepancy`, `replicates`, `min_packings`, `target`.
/// Status not_usable when a recorded point did not converge or a best law is not good. Throws InputError (settings, two
/// files of one solid fraction), UnusableResult (no force anywhere), IoError.
ExitStatus calibrate_multi_contact(const CommonOptions& options);

}  // namespace softgrain

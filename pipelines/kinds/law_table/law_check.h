// softgrain check of law cards and law tables.
#pragma once

#include <string>

#include "pipelines/run/findings.h"

namespace softgrain {

/// What a card or a table holds, and what to mind when it is used. Throws InputError, IoError.
void check_laws(const std::string& path, Findings& out);

}  // namespace softgrain

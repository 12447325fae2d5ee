// Which form of law a table is taken with, and whether its errors chose it.
#pragma once

#include <string>

#include "common/data/crowd_law.h"

namespace softgrain {

/// "bag (best)" where the errors of all forms chose it (the least one leaving one loading out, of those that the data
/// determine), "bag (set by the scene)" where a key did against them, "bag" of a form that is not taken.
std::string form_label(const LawTableEntry& entry, const CrowdLaw& law);

}  // namespace softgrain

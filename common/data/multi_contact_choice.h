// Which form of law a table is taken with, and whether its errors chose it.
#pragma once

#include <string>

#include "common/data/multi_contact_law.h"

namespace softgrain {

/// "isotropic (best)" where the errors of all forms chose it (the least one leaving one loading out, of those that the
/// data determine), "isotropic (chosen)" where a key did against them, "isotropic" of a form that is not
/// taken.
std::string form_label(const LawTableEntry& entry, const MultiContactLaw& law);

}  // namespace softgrain

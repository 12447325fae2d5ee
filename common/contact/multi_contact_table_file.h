// A law table as files: a card for people (TOML) and, for programs, the forces it stands for on a grid (HDF5).
#pragma once

#include <string>

#include "common/data/multi_contact_law.h"

namespace softgrain {

/// Writes `table.toml` and, beside it with extension .h5, parameters and forces on a grid of overlaps. Atomic. Throws
/// IoError.
void save_law_table(const LawTable& table, const std::string& toml_path,
                    const Provenance& provenance = build_provenance());

}  // namespace softgrain

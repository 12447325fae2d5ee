// The entries of all variants of a powder as tables.
#pragma once

#include <string>
#include <vector>

#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/run/text_table.h"

namespace softgrain {

/// Every quantity with deviation and standard error, and what is published, in full precision; empty where unknown.
TextTable powder_data_table(const std::vector<VariantEntry>& entries);

/// Table of all variants for people, with fewer columns and digits than powder_data_table().
TextTable powder_console_table(const std::vector<VariantEntry>& entries);

/// "rr-mu015: Phi 0.7105 +- 0.0011 (published 0.71 +- 0.002), z ...; 4 of 4 samples at rest", and why not.
std::string powder_variant_line(const VariantEntry& entry);

}  // namespace softgrain

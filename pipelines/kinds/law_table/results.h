// What multi-contact measurements leave behind, and the tables fitted to them.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults law_table_results();

namespace report {
std::string law_table_section(const RunData& run);  ///< several neighbours at once: measured and fitted
}

}  // namespace softgrain

// Numbers with their 95 % intervals as people read them: an interval that is not known is said to be so.
#pragma once

#include <string>

#include "common/data/law_card.h"

namespace softgrain {

/// Whether both ends are numbers that differ. Ends that agree to all their digits say that nothing scattered, which is
/// not that nothing could.
bool interval_known(double low, double high);

/// "0.0447 (0.0441 to 0.0453)", with as many digits as ends need to differ; "0.0447 (interval not determined)".
std::string interval_text(double value, double low, double high);
inline std::string interval_text(const Estimate& e) { return interval_text(e.value, e.low, e.high); }

/// "103 [98.2, 107]" in multiples of `unit`; "103 [not determined]".
std::string bracket_text(const Estimate& e, double unit = 1.0);

}  // namespace softgrain

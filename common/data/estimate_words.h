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

/// As many significant digits, `least` to `most`, as two numbers need to be different texts: 7 for 132.9 and 132.9001.
int digits_to_differ(double low, double high, int least, int most);

/// Writes a number with so many significant digits.
using WriteNumber = std::string (*)(double value, int digits);

/// How the ends of an interval are written.
struct EndsForm {
  WriteNumber number;
  int digits = 4;
  const char* between = " .. ";
  const char* unknown = "not determined";  ///< the text for an interval that is not known
  bool may_be_equal = false;               ///< whether finite ends are known even if they do not differ
};

/// "0.0441 .. 0.0453".
std::string ends_text(double low, double high, const EndsForm& form);

/// How an estimate with its standard error is written.
struct EstimateForm {
  WriteNumber number;
  const char* between = " +- ";
  const char* unknown = " (?)";  ///< the text after a number whose error is not known
};

/// "0.733 +- 0.19": three digits, and two of the error. "0.733" if the error is 0, as of a number that is fixed.
std::string estimate_with_error(const Estimate& e, const EstimateForm& form);

}  // namespace softgrain

// Numbers as people read them: few digits, powers of ten as superscripts, errors with two digits, times with units.
#pragma once

#include <cstdint>
#include <string>

namespace softgrain::report {

/// `digits` significant digits, trailing zeros dropped; very large or small values as "1.2×10⁻⁵"; "–" for NaN. UTF-8.
std::string format_number(double value, int digits = 4);

/// Fixed decimals, no trailing zeros dropped (axis labels keep equal length). UTF-8 minus sign.
std::string format_fixed(double value, int decimals);

/// "12 345 678" with narrow no-break spaces.
std::string format_count(std::int64_t count);

/// "0.5760 ± 0.0120": the error has two significant digits and rules those of the value; no error when it is not finite
/// or zero.
std::string format_with_error(double value, double error);

/// "0.85 s", "4 min 05 s", "2 h 13 min".
std::string format_seconds(double seconds);

/// Digits of an exponent as UTF-8 superscripts.
std::string superscript(int exponent);

/// Decimal prefix that brings a largest magnitude between 1 and 1000: value = shown * factor, unit = symbol + unit.
struct SiPrefix {
  double factor = 1.0;
  std::string symbol;
};

/// Prefix for data whose largest magnitude is `largest` (n to G; none for 0 and for values that are not finite).
SiPrefix si_prefix(double largest);

}  // namespace softgrain::report

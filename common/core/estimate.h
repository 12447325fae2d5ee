// A number with its error.
#pragma once

namespace softgrain {

/// A number with its standard error and 95 % interval, in the unit of the number. An error that is not known is
/// infinite, and so are the ends.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;
  double low = 0.0;
  double high = 0.0;
};

}  // namespace softgrain

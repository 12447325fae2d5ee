#include "common/core/lanes.h"

#include <cmath>

// glibc says that pow has vectors only to programs that ask for fast mathematics as a whole; the vectors themselves
// need nothing of it.
#if defined __x86_64__ && defined __GLIBC__ && !defined __clang__
extern "C" [[gnu::simd("notinbranch")]] double pow(double, double) noexcept;
#endif

namespace softgrain {

void powers_of(const double* x, const double* y, double* out, std::size_t many) {
#pragma omp simd
  for (std::size_t k = 0; k < many; ++k) out[k] = ::pow(x[k], y[k]);
}

}  // namespace softgrain

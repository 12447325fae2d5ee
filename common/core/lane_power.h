// Powers of several numbers at once.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstddef>

namespace softgrain {

/// out[k] = x[k]^y[k], by the vector functions of the C library where there are some (glibc on x86 with gcc: it
/// promises 4 units in the last place, 1 was measured), else one after the other.
void powers_of(const double* x, const double* y, double* out, std::size_t many);

}  // namespace softgrain

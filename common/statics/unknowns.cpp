#include "common/statics/unknowns.h"

#include <algorithm>

namespace softgrain::statics {

double dot(const Unknowns& a, const Unknowns& b) {
  constexpr std::size_t kBlock = 4096;
  double total = 0.0;
  for (std::size_t begin = 0; begin < a.size(); begin += kBlock) {
    // Four sums: the compiler may not reorder one.
    double s[4] = {};
    const std::size_t end = std::min(begin + kBlock, a.size());
    std::size_t k = begin;
    for (; k + 4 <= end; k += 4)
      for (std::size_t l = 0; l < 4; ++l) s[l] += a[k + l] * b[k + l];
    for (; k < end; ++k) s[0] += a[k] * b[k];
    total += (s[0] + s[1]) + (s[2] + s[3]);
  }
  return total;
}

void add_scaled(Unknowns& y, double s, const Unknowns& x) {
  for (std::size_t k = 0; k < y.size(); ++k) y[k] += s * x[k];
}

}  // namespace softgrain::statics

// The number type with which the laws of common/contact are asked at whole arrays: as many overlaps side by side as the
// processor takes. The laws are templates of the number type, and those of the contact loop are the same.
#pragma once

#include <algorithm>
#include <experimental/simd>
#include <span>
#include <thread>
#include <vector>

#include "common/core/lanes.h"

namespace softgrain {

namespace python {

using Wide = std::experimental::native_simd<double>;
inline constexpr std::size_t kWide = Wide::size();

/// f(begin, end) over 0 .. n - 1 in stretches of whole Wides on the cores there are. Threads of its own: those of
/// OpenMP do not survive a fork, which Python's multiprocessing is fond of. f must not throw.
template <class F>
void in_stretches(std::size_t n, const F& f) {
  constexpr std::size_t kWorthAThread = 1 << 15;
  const std::size_t most = std::max<std::size_t>(1, std::thread::hardware_concurrency());
  const std::size_t threads = std::clamp<std::size_t>(n / kWorthAThread, 1, most);
  const std::size_t length = (n / threads / kWide + 1) * kWide;
  std::vector<std::jthread> others;
  for (std::size_t begin = length; begin < n; begin += length)
    others.emplace_back([&f, begin, end = std::min(begin + length, n)] { f(begin, end); });
  f(0, std::min(length, n));
}

/// Wide of x[at] and what follows; what is missing at the end is 0.
inline Wide load(std::span<const double> x, std::size_t at) {
  if (at + kWide <= x.size()) return {x.data() + at, std::experimental::element_aligned};
  return Wide([&](auto k) { return at + k < x.size() ? x[at + k] : 0.0; });
}

/// Puts the lanes that are there to out[at] and what follows.
inline void store(const Wide& y, std::span<double> out, std::size_t at) {
  if (at + kWide <= out.size()) {
    y.copy_to(out.data() + at, std::experimental::element_aligned);
    return;
  }
  for (std::size_t k = 0; at + k < out.size(); ++k) out[at + k] = y[k];
}

}  // namespace python

}  // namespace softgrain

// The number type with which the laws of common/contact are asked at whole arrays: as many overlaps side by side as the
// processor takes. The laws are templates of the number type, and those of the contact loop are the same; only x^y has
// a way of its own here.
#pragma once

#include <algorithm>
#include <experimental/simd>
#include <span>
#include <thread>
#include <vector>

#include "common/core/lanes.h"

#if defined(__x86_64__) && defined(__GLIBC__)
#include <immintrin.h>

// Names of the vector ABI of x86-64 (libmvec of glibc): two, four and eight numbers per call.
extern "C" {
__m128d _ZGVbN2vv_pow(__m128d, __m128d);
__m256d _ZGVdN4vv_pow(__m256d, __m256d);
__m512d _ZGVeN8vv_pow(__m512d, __m512d);
}
#endif

namespace softgrain {

namespace python {

using Wide = std::experimental::native_simd<double>;
inline constexpr std::size_t kWide = Wide::size();

/// x^y by the vector mathematics library of glibc, which differs from std::pow by at most one unit in the last place
/// (measured; it promises four); by std::pow where there is none.
inline Wide vector_power(const Wide& x, const Wide& y) {
#if defined(__x86_64__) && defined(__GLIBC__)
#if defined(__AVX512F__)
  return Wide(_ZGVeN8vv_pow(static_cast<__m512d>(x), static_cast<__m512d>(y)));
#elif defined(__AVX2__)
  return Wide(_ZGVdN4vv_pow(static_cast<__m256d>(x), static_cast<__m256d>(y)));
#elif !defined(__AVX__)
  return Wide(_ZGVbN2vv_pow(static_cast<__m128d>(x), static_cast<__m128d>(y)));
#endif
#endif
  return Wide([&](auto k) { return std::pow(static_cast<double>(x[k]), static_cast<double>(y[k])); });
}

}  // namespace python

template <>
inline python::Wide power<python::Wide>(const python::Wide& x, const python::Wide& y) {
  return all_of(y == 1.0) ? x : python::vector_power(x, y);  // 1: of a law without this part
}

namespace python {

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

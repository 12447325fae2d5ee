// Arithmetic that is one text for a number and for several side by side (the lanes of a vectorised loop): comparisons
// give a mask, bool for one number, and both sides of a choice are worked out.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace softgrain {

/// out[k] = x[k]^y[k], by the vector functions of the C library where there are some (glibc on x86 with gcc: it
/// promises 4 units in the last place, 1 was measured), else one after the other.
void powers_of(const double* x, const double* y, double* out, std::size_t many);

/// What comparing two T gives.
template <class T>
using Mask = decltype(std::declval<const T&>() < std::declval<const T&>());

/// `yes` where the mask holds, else `no`.
template <class T>
[[gnu::always_inline]] inline T choose(const Mask<T>& mask, const std::type_identity_t<T>& yes, T no) {
  if constexpr (std::is_same_v<Mask<T>, bool>) {
    return mask ? yes : no;
  } else {
#if defined __clang__ && defined __AVX512F__
    // where() of libstdc++ takes one side for all lanes here: its _S_blend_avx512 (bits/simd_x86.h) has no blend for
    // clang but a boolean choice, marked FIXME.
    return T([&](auto lane) { return mask[lane] ? yes[lane] : no[lane]; });
#else
    where(mask, no) = yes;
    return no;
#endif
  }
}

/// Whether the mask holds in some lane.
template <class M>
[[gnu::always_inline]] inline bool any(const M& mask) {
  if constexpr (std::is_same_v<M, bool>)
    return mask;
  else
    return any_of(mask);
}

/// Maximum and minimum with the choice of std::max and std::min.
template <class T>
[[gnu::always_inline]] inline T largest(const T& a, const std::type_identity_t<T>& b) {
  return choose<T>(a < b, b, a);
}
template <class T>
[[gnu::always_inline]] inline T least(const T& a, const std::type_identity_t<T>& b) {
  return choose<T>(b < a, b, a);
}

template <class T>
[[gnu::always_inline]] inline T root(const T& x) {
  using std::sqrt;
  return sqrt(x);
}
template <class T>
[[gnu::always_inline]] inline T with_sign(const T& size, const T& sign) {
  using std::copysign;
  return copysign(size, sign);
}

/// x^y.
template <class T>
T power(const T& x, const std::type_identity_t<T>& y) {
  if constexpr (std::is_same_v<Mask<T>, bool>)
    return std::pow(x, y);
  else {
    using Numbers = std::array<double, T::size()>;
    auto base = std::bit_cast<Numbers>(x);
    const auto exponent = std::bit_cast<Numbers>(y);
    powers_of(base.data(), exponent.data(), base.data(), T::size());
    return std::bit_cast<T>(base);
  }
}

}  // namespace softgrain

// Four doubles at once and their transposition: how the contact loop turns records of bodies into lanes.
#pragma once

#include "common/core/vec.h"

namespace softgrain {

using Quad = double __attribute__((vector_size(32)));

namespace detail {
// By typedef, as clang takes no notice of may_alias and aligned in an alias: it would load unaligned numbers by an
// instruction that asks for aligned ones.
typedef double QuadInMemory __attribute__((vector_size(32), may_alias));               // NOLINT(modernize-use-using)
typedef double UnalignedQuad __attribute__((vector_size(32), may_alias, aligned(8)));  // NOLINT(modernize-use-using)
}  // namespace detail

/// 32 bytes at an address that is a multiple of 32.
inline Quad load_quad(const void* from) { return *static_cast<const detail::QuadInMemory*>(from); }
inline void store_quad(void* to, Quad q) { *static_cast<detail::QuadInMemory*>(to) = q; }
inline Quad load_unaligned(const double* from) { return *reinterpret_cast<const detail::UnalignedQuad*>(from); }
inline void store_unaligned(double* to, Quad q) { *reinterpret_cast<detail::UnalignedQuad*>(to) = q; }

/// Missing components are zero; the fourth is whatever the padding holds.
inline Quad quad_of(const Stored<3>& a) { return load_quad(&a); }
inline Quad quad_of(const Stored<2>& a) { return Quad{a[0], a[1], 0.0, 0.0}; }
inline Quad quad_of(const Stored<1>& a) { return Quad{a[0], 0.0, 0.0, 0.0}; }
inline void store(Stored<3>& to, Quad q) { store_quad(&to, q); }
inline void store(Stored<2>& to, Quad q) { to = Vec<2>{{q[0], q[1]}}; }
inline void store(Stored<1>& to, Quad q) { to = Vec<1>{{q[0]}}; }

/// The first numbers alone.
template <int D>
Vec<D> vec_of(Quad q) {
  Vec<D> out;
  for (int k = 0; k < D; ++k) out[k] = q[k];
  return out;
}

/// `a` with its fourth number replaced by that of `b`.
inline Quad with_fourth(Quad a, Quad b) { return __builtin_shufflevector(a, b, 0, 1, 2, 7); }

using QuadMask = decltype(Quad{} < Quad{});

/// One bit per lane of a comparison.
inline int sign_bits(QuadMask mask) {
#ifdef __AVX__
  return __builtin_ia32_movmskpd256(reinterpret_cast<Quad>(mask));
#else
  int bits = 0;
  for (int l = 0; l < 4; ++l) bits |= static_cast<int>(mask[l] & 1) << l;
  return bits;
#endif
}

/// Rows become columns.
inline void transpose(Quad& a, Quad& b, Quad& c, Quad& d) {
  const Quad ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Quad ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Quad cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

}  // namespace softgrain

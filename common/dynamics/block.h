// What the vectorised contact loop works on: the touching pairs of a block, number by number, in lanes of the
// processor. For block_loop.cpp and its laws alone: the header of the vector types is a heavy one.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <experimental/simd>

#include "common/core/cell.h"
#include "common/core/particles.h"
#include "common/core/quad.h"

namespace softgrain::block {

using Lanes = std::experimental::native_simd<double>;
constexpr int kLanes = static_cast<int>(Lanes::size());
constexpr auto kAligned = std::experimental::vector_aligned;

/// Pairs looked at in one go. All that a block needs stays in the first-level cache.
constexpr int kBlock = 128;

/// One number of every contact of a block.
struct alignas(64) Row {
  double v[kBlock + 8];

  [[nodiscard]] Lanes at(int k) const { return Lanes(v + k, kAligned); }
  void put(int k, const Lanes& x) { x.copy_to(v + k, kAligned); }
};

template <int D>
using Rows = std::array<Row, static_cast<std::size_t>(D)>;

template <int D>
Vec<D, Lanes> at(const Rows<D>& rows, int k) {
  Vec<D, Lanes> out;
  for (int c = 0; c < D; ++c) out[c] = rows[static_cast<std::size_t>(c)].at(k);
  return out;
}
template <int D>
void put(Rows<D>& rows, int k, const Vec<D, Lanes>& x) {
  for (int c = 0; c < D; ++c) rows[static_cast<std::size_t>(c)].put(k, x[c]);
}

/// Sums of bodies, see MultiContactSum.
template <int D>
struct SumRows {
  Row volume;
  Rows<D> first;
  Rows<D*(D + 1) / 2> second;
  Row gain, gain_slope;
};

/// Numbers of a roll history: none in the plane.
template <int D>
inline constexpr int kRollsOf = D == 3 ? 3 : 0;

/// The touching pairs of a block, number by number.
template <int D>
struct Block {
  int touching = 0;
  std::array<std::int32_t, kBlock + 8> pair;  ///< place in the list, or number among foreign pairs
  std::array<Quad, kBlock + 8> record;        ///< x_i - x_j and one number more, see `fourth`
  Rows<D> branch;
  std::array<Quad, kBlock + 8> upright_record;  ///< normals of planes
  Row fourth;                                   ///< r_i + r_j of spheres, r_j - r_i of a shell, r_i above a plane
  Rows<D> upright;                              ///< normals of planes
  Row radius_i, radius_j;
  Rows<D> velocity;  ///< velocity of i relative to j
  Rows<kRot<D>> spin_i, spin_j;
  Rows<D> spring;
  Row a, b, memory;
  Rows<kRollsOf<D>> roll;  ///< roll history, in space
  SumRows<D> sum_i, sum_j;
  // Results.
  Rows<D> force;         ///< force on i
  Rows<kRot<D>> moment;  ///< moment for a unit arm
  Row arm_i, arm_j;
  Row rolling;                    ///< moment of rolling resistance, in two dimensions
  Rows<kRollsOf<D>> roll_moment;  ///< moment of rolling resistance, in space
  Row rolling_stiffness;
  Row normal_force, stiffness, tangential_stiffness;
  Rows<D> normal;      ///< contact normals of the particle pass
  Row lost_i, lost_j;  ///< results of the particle pass, then what laws are told of them
};

/// Position with the radius in the fourth place.
inline Quad place(const Sphere<3>& s) { return load_quad(&s); }
inline Quad place(const Sphere<2>& s) { return __builtin_shufflevector(load_quad(&s), Quad{}, 0, 1, 4, 2); }

/// Bit l of the index in byte l.
constexpr std::array<std::uint32_t, 16> kFlags = [] {
  std::array<std::uint32_t, 16> flags{};
  for (std::uint32_t bits = 0; bits < 16; ++bits)
    for (std::uint32_t l = 0; l < 4; ++l) flags[bits] |= (bits >> l & 1U) << (8 * l);
  return flags;
}();
static_assert(std::endian::native == std::endian::little);

/// Shift of every periodic image and the velocity that goes with it; nothing in an open cell.
template <int D, bool kPeriodic>
struct Images {
  explicit Images(const Cell<D>&) {}
};
template <int D>
struct Images<D, true> {
  std::array<Quad, static_cast<std::size_t>(image_count<D>())> shift{};
  std::array<Quad, static_cast<std::size_t>(image_count<D>())> velocity{};

  explicit Images(const Cell<D>& cell) {
    for (int image = 0; image < image_count<D>(); ++image) {
      const Vec<D> x = cell.image_shift(image);
      const Vec<D> v = cell.velocity_gradient * x;
      for (int k = 0; k < D; ++k) {
        shift[static_cast<std::size_t>(image)][k] = x[k];
        velocity[static_cast<std::size_t>(image)][k] = v[k];
      }
    }
  }
};

template <int N>
void store_rows(Rows<N>& rows, int k, const std::array<Quad, 4>& columns) {
  for (std::size_t c = 0; c < static_cast<std::size_t>(N); ++c) store_quad(rows[c].v + k, columns[c]);
}

}  // namespace softgrain::block

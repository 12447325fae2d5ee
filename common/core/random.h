// Counter-based random numbers (Random123, Philox 4x64): a number depends on seed, purpose and index alone, never on
// threads.
#pragma once

#include <Random123/philox.h>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace softgrain {

/// What a stream is for; streams of different purpose never share numbers. Who needs one more declares
/// `constexpr RandomPurpose kName{number}` of a number of its own: the test of this header looks that no two are the
/// same.
enum class RandomPurpose : std::uint64_t {
  radii = 1,
  positions = 2,
  bootstrap = 3,
  test = 6,
  rotation = 7,
  directions = 8
};

/// A sequence of independent numbers keyed by (seed, purpose, index).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, RandomPurpose purpose, std::uint64_t index)
      : key_{{seed, static_cast<std::uint64_t>(purpose)}}, counter_{{0, index, 0, 0}} {}

  /// Uniform in the open interval (0, 1), 53 bits.
  double uniform() { return open_unit(next()); }

  /// (k + 1/2) / 2^53 with k the upper 53 bits, as a number; the last one of all, which would be rounded to 1, stays
  /// below.
  static double open_unit(std::uint64_t bits) {
    const double u = (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
    return u < 1.0 ? u : 1.0 - 0x1p-53;
  }

  /// Normal, mean 0, deviation 1 (Box and Muller; the second of the pair is not used).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

  /// Uniform integer in [0, n), n > 0, by rejection (unbiased).
  std::uint64_t below(std::uint64_t n) {
    const std::uint64_t limit = UINT64_MAX - UINT64_MAX % n;
    std::uint64_t x = next();
    while (x >= limit) x = next();
    return x % n;
  }

 private:
  std::uint64_t next() {
    if (used_ == 4) {
      block_ = generator_(counter_, key_);
      ++counter_[0];
      used_ = 0;
    }
    return block_[used_++];
  }

  r123::Philox4x64 generator_;
  r123::Philox4x64::key_type key_;
  r123::Philox4x64::ctr_type counter_;
  r123::Philox4x64::ctr_type block_{};
  unsigned used_ = 4;
};

}  // namespace softgrain

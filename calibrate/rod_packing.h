// How densely spheres of any sizes pack, from rods on a line (Farr and Groot 2009, J. Chem. Phys. 131, 244104).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "common/packing/grading.h"

namespace softgrain {

/// Pieces that a straight line through randomly placed spheres is cut into by them: `count` chord lengths in units of
/// the largest diameter, one from the middle of each of `count` equal shares, descending. A sphere is hit in proportion
/// to r^2, and of its chords (L/2r)^2 are shorter than L.
std::vector<double> chords_of(const Grading& sizes, std::size_t count);

/// Share of the line that rods fill when each is set, longest first, into the widest gap, and no two are closer than
/// `gap` times the shorter of them. 0.7654 makes equal spheres as dense as without friction (0.6435); a looser
/// preparation has a larger one.
double rod_packing(const std::vector<double>& chords, double gap);

/// What rods of these sizes fill, over their gap: a spline of the logarithm of the void ratio between gaps of 0.25 and
/// 3.27, held beyond. phi_J of a packing is that of its preparation's gap.
class RodCurve {
 public:
  static constexpr double kLeastGap = 0.25;
  static constexpr double kLargestGap = 3.27;

  explicit RodCurve(const Grading& sizes, std::size_t rods = 5000);
  ~RodCurve();
  RodCurve(RodCurve&&) noexcept;
  RodCurve& operator=(RodCurve&&) noexcept;

  [[nodiscard]] double at(double gap) const;

 private:
  struct Spline;
  std::unique_ptr<Spline> spline_;
};

}  // namespace softgrain

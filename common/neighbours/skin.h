// Margins of the neighbour list: how wide they are, how much of them is used up, how wide they should be.
//
// A pair is listed when its distance is below r_i + r_j + 2 q + s_i + s_j, 2 q the largest gap at which pairs interact
// (0 but for laws that act at a distance). In a deforming periodic cell bodies are followed relative to the affine
// motion F of the cell since the list was made: with u = x - F x0 and e = |F - 1| (Frobenius) no pair can have come
// within reach unseen as long as |u| + e (r + q + s) <= s for every body, because a pair that was not listed is at
// least |F d0| - |u_i| - |u_j| >= (1 - e) |d0| - |u_i| - |u_j| apart. So a steadily sheared packing, where
// |x - x0| grows with the size of the cell, keeps its list as long as one at rest with the same fluctuations.
// Any F and shift will do, frozen since the last look too. Between walls that face each other bodies are followed
// relative to the box where that leaves less, else from where they were.
#pragma once

#include <limits>
#include <vector>

#include "common/system.h"

namespace softgrain {

/// Half the largest gap at which a pair of grains interacts; 0 for laws of contact alone [m].
double half_reach(const LawSet& laws);

/// Margin per body [m] before anything is known about its motion: an eighth of the radius, at most half of the smallest
/// one; planes and shells take the largest.
template <int D>
std::vector<double> default_skin(const Particles<D>& particles);

/// Largest share of its margin that a body has used up since the list was made; above 1 the list must be made anew.
/// Infinite when there is no list or a position is not finite.
template <int D>
double skin_used(const System<D>& system);

/// A body with half the largest gap and its margin takes at most this share of the shortest period: a little less than
/// the quarter from which on a pair could meet in two images.
inline constexpr double kShareOfPeriod = 0.249;

/// Narrows margins so that no pair can meet in two images of a periodic cell, where radii leave room for that.
template <int D>
void fit_skin_to_cell(System<D>& system);

/// Numbers that follow from margins and radii; needed after either was set.
template <int D>
void note_skin(System<D>& system);

/// Margins for the next list, from what the last one saw: every size class gets what it uses up in N passes, N such
/// that looking at pairs that do not touch and making lists cost the same. Counts alone decide, never a clock, so
/// that a run can be repeated bit for bit. Call before a list is made, with the old one in place.
template <int D>
void adapt_skin(System<D>& system);

/// Bounds the share of the margins used up per time while bodies move.
template <int D>
class SkinUse {
 public:
  explicit SkinUse(const System<D>& system);

  /// Square of the share per second that body `u` uses up when it moves with this velocity from where it is; infinite
  /// when that is not a number, which no maximum loses.
  [[nodiscard]] double rate2(const System<D>& s, std::size_t u, const Vec<D>& velocity) const {
    Vec<D> w = velocity;
    if (flows_) w -= s.cell.velocity_gradient * s.particles.sphere[u].x;
    const double rate2 = norm2(w) * s.neighbours.inverse_skin2[u];
    return rate2 < kInfinite ? rate2 : kInfinite;
  }

  /// What the deformation of the cell adds for any body [1/s].
  [[nodiscard]] double strain_rate() const { return strain_rate_; }

 private:
  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  bool flows_ = false;
  double strain_rate_ = 0.0;
};

}  // namespace softgrain

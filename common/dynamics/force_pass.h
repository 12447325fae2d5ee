// Forces and torques on all bodies from all contacts.
#pragma once

#include <vector>

#include "common/dynamics/block_loop.h"
#include "common/system.h"

namespace softgrain {

/// One loop pass: updates the neighbour list when needed, evaluates every contact over a time `dt` since the last
/// commit and sums forces and torques per body (gravity not included). By default history is left uncommitted in
/// contacts.*_next.
/// Sums run in list order for every body, whatever the number of threads: the result is bitwise the same.
template <int D>
void force_pass(System<D>& system, double dt, History history = History::next);

/// The sums alone: the list is known to be valid and the forces of all bodies are zero.
template <int D>
void add_contact_forces(System<D>& system, double dt, History history);

/// Sums the forces and the contact stiffness per body; the list is known to be valid and the forces of all bodies are
/// zero.
template <int D>
void add_contact_forces(System<D>& system, double dt, BodyStiffness& stiffness, History history);

/// Sums the forces; `virials` gets force times branch of every listed pair, per axis [N m].
template <int D>
void add_contact_forces(System<D>& system, double dt, std::vector<Vec<D>>& virials, History history);

/// A pass that also returns the stiffness sums.
template <int D>
void force_pass(System<D>& system, double dt, BodyStiffness& stiffness, History history = History::next);

/// One contact as it is, for measurement and output.
template <int D>
struct ContactRecord {
  Slot i = 0;
  Slot j = 0;
  double overlap = 0.0;
  Vec<D> normal{};  ///< unit normal, points to body i
  Vec<D> branch{};  ///< x_i - x_j (from a point of the plane for planes) [m]
  Vec<D> point{};   ///< contact point, image near i [m]
  double normal_force = 0.0;
  Vec<D> tangential_force{};
  bool sliding = false;
  Rot<D> rolling_moment{};  ///< rolling moment on i, for laws with rolling resistance [N m]
};

/// All force-carrying contacts of the committed state. Never changes the trajectory; not counted as a loop pass.
template <int D>
std::vector<ContactRecord<D>> contact_records(const System<D>& system);

// Prescribed displacements, without time.

/// Moves every body by its entry of `moves` [m] in one stroke and lets the tangential springs follow (history is
/// committed). Velocities are zero afterwards. Contact laws must be without damping.
template <int D>
void displace(System<D>& system, const std::vector<Vec<D>>& moves);

/// Moves every body as displace() above does, while space in a periodic cell, sheared or not, is stretched by the
/// factors 1 + growth per axis. A contact across a face sees the image move with it.
template <int D>
void displace(System<D>& system, const std::vector<Vec<D>>& moves, const Vec<D>& growth);

}  // namespace softgrain

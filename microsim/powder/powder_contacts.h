// Who touches whom in a powder, with what forces, and how these are distributed [CP 3.5].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/histogram.h"
#include "common/system.h"
#include "microsim/powder/powder_interactions.h"

namespace softgrain {

/// Counts and mean forces of one state, in the units of the sample (F0, or P a without cohesion).
struct PowderContacts {
  std::int64_t contacts = 0;   ///< N_c, h < 0 in the notation of the publication
  std::int64_t distant = 0;    ///< N_d, attracting across a gap
  double coordination = 0.0;   ///< z = 2 (N_c + N_d)/N
  std::vector<double> shares;  ///< x_k, share of disks with k interactions
  std::int64_t rattlers = 0;   ///< disks without force-carrying backbone, removed one after another; 0 with cohesion
  double coordination_backbone = 0.0;  ///< z* = z/(1 - x0), rattlers counting as x0 without cohesion
  std::int64_t repulsive = 0;
  std::int64_t tensile = 0;
  std::int64_t unstressed = 0;  ///< |N| below `zero`
  double mean_normal = 0.0;     ///< mean N over all interactions
  double mean_repulsive = 0.0;
  double mean_tensile = 0.0;        ///< negative
  double square_mean_normal = 0.0;  ///< root of the mean of N^2
  double rumpf_pressure = 0.0;      ///< z Phi mean(N) mean(d)/(pi mean(d^2))
  double branch_pressure =
      0.0;  ///< sum of N |branch|/(2 A): what Rumpf's means leave out is that large disks touch more
};

/// `zero`: forces below it count as none. `cohesive`: whether disks are held by tension, so that none is a rattler.
PowderContacts powder_contacts(const System<2>& system, double zero, bool cohesive);

/// Whether each disk, by slot, has fewer than two contacts once such disks are taken away one after another.
std::vector<bool> powder_rattlers(const System<2>& system);

/// Distributions of the forces in the units of the sample (F0, or P a without cohesion). Bins are the same for every
/// sample, so that counts add up.
struct PowderForces {
  Histogram normal{-1.1, 6.1, 144};            ///< N of all pairs, distant ones too
  Histogram normal_over_mean{-2.0, 8.0, 100};  ///< N over its mean, of the same; empty unless that is above the limit
  Histogram ratio{0.0, 5.0, 100};   ///< |T/N| of stressed contacts; |T/N| = sqrt 3 where a disk leans on two that touch
  Histogram angle{0.0, 180.0, 36};  ///< between n and F of stressed contacts [degrees]: 0 pressed, 180 pulled
  std::optional<double> zero_share;  ///< share of contacts (distant pairs left out) with |F| below `zero`
};

/// `zero`: as in powder_interactions.
PowderForces powder_forces(const std::vector<PowderInteraction>& pairs, double zero);

}  // namespace softgrain

// SPDX-License-Identifier: BSD-3-Clause
// The simulation box of fix softgrain/relax, where stress holds it.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "macrosim/lammps/fix_softgrain_relax.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
#include "macrosim/lammps/pair_softgrain.h"
#include "macrosim/lammps/words.h"
#include "neighbor.h"
#include "update.h"

namespace LAMMPS_NS {

using softgrain::PseudoMasses;
namespace bridge = softgrain::lammps;

void FixSoftgrainRelax::set_stress(char** words) {
  for (int k = 0; k < 3; ++k) {
    const std::string word = words[k];
    by_stress_[static_cast<std::size_t>(k)] = word != "no";
    asked_[k] = word == "no" ? 0.0 : bridge::number(word, "stress", error);
    if (!std::isfinite(asked_[k])) error->all(FLERR, "fix softgrain/relax: stress " + word + ": a number, or no");
  }
}

FixSoftgrainWall* FixSoftgrainRelax::box_walls() const {
  for (FixSoftgrainWall* wall : pair_->walls)
    if (wall->in_box()) return wall;
  return nullptr;
}

void FixSoftgrainRelax::make_alike(softgrain::Vec<3>& a) const {
  if (!isotropic_) return;
  const double mean = (a[0] + a[1] + a[2]) / 3.0;
  a = {{mean, mean, mean}};
}

/// What the bodies and walls resist a strain with, and the stress on the box, both from the forces of the last pass.
void FixSoftgrainRelax::take_box_sums() {
  FixSoftgrainWall* const walls = box_walls();
  if (walls == nullptr && domain->nonperiodic != 0) return;
  softgrain::Vec<3> own = pair_->gathered.virial;
  if (walls != nullptr) {
    own = {};
    for (int i = 0; i < atom->nlocal; ++i)
      for (int k = 0; k < 3; ++k)
        own[k] += atom->f[i][k] * (atom->x[i][k] - 0.5 * (domain->boxlo[k] + domain->boxhi[k]));
  }
  std::array<double, 3> mine{own[0], own[1], own[2]};
  std::array<double, 3> all{};
  MPI_Allreduce(mine.data(), all.data(), 3, MPI_DOUBLE, MPI_SUM, world);
  double volume = 1.0;
  for (int k = 0; k < 3; ++k) volume *= domain->boxhi[k] - domain->boxlo[k];
  for (int k = 0; k < 3; ++k) {
    resisted_[k] = all[static_cast<std::size_t>(k)];
    stress_[k] = resisted_[k] / volume;
    if (walls == nullptr) continue;
    const double length = domain->boxhi[k] - domain->boxlo[k];
    const double push = 0.5 * (walls->compute_vector(2 * k) + walls->compute_vector(2 * k + 1)) * length;
    resisted_[k] += push;
    stress_[k] = push / volume;
  }
}

void FixSoftgrainRelax::scale_box(const PseudoMasses& masses) {
  double own = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double r = atom->radius[i];
    own += std::max(pair_->gathered.translation[static_cast<std::size_t>(i)], masses.floor(r)) * r * r;
  }
  double all = 0.0;
  MPI_Allreduce(&own, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  box_inverse_mass_ = 1.0 / (4.0 / 3.0 * all);
}

/// Adds what the box has to the sums of power, speed and pull; the same on every rank.
void FixSoftgrainRelax::steer_box(double* sums) {
  double volume = 1.0;
  for (int k = 0; k < 3; ++k) volume *= domain->boxhi[k] - domain->boxlo[k];
  box_force_ = asked_ * volume - resisted_;
  make_alike(box_force_);
  for (int k = 0; k < 3; ++k) {
    if (!by_stress_[static_cast<std::size_t>(k)]) box_force_[k] = 0.0;
    // A free side that nothing pushes stays where it is: no stress would bring it back.
    if (asked_[k] == 0.0 && box_force_[k] >= 0.0) box_force_[k] = box_velocity_[k] = 0.0;
    sums[0] += box_force_[k] * box_velocity_[k];
    sums[1] += box_velocity_[k] * box_velocity_[k] / box_inverse_mass_;
    sums[2] += box_force_[k] * box_force_[k] * box_inverse_mass_;
  }
}

/// The box one step on, and all in it; contacts see the motion (PairSoftgrain::flow).
void FixSoftgrainRelax::carry() {
  constexpr double kLargestStrain = 2e-3;  // per pass
  const double most = kLargestStrain / fire_.step;
  box_velocity_ += box_force_ * (fire_.step * box_inverse_mass_);
  for (int k = 0; k < 3; ++k) {
    box_velocity_[k] = std::clamp(box_velocity_[k], -most, most);
    const double centre = 0.5 * (domain->boxlo[k] + domain->boxhi[k]);
    const double shrink = box_velocity_[k] * fire_.step;
    for (int i = 0; i < atom->nlocal; ++i) atom->x[i][k] += (centre - atom->x[i][k]) * shrink;
    domain->boxlo[k] += (centre - domain->boxlo[k]) * shrink;
    domain->boxhi[k] += (centre - domain->boxhi[k]) * shrink;
    pair_->flow[k] = -box_velocity_[k] / (1.0 - shrink);
    box_strain_[k] += shrink;
    shrunk_[k] *= 1.0 - shrink;
  }
  domain->set_global_box();
  domain->set_local_box();
  pair_->flows = true;
  note_box();
}

/// A list is about to be made.
void FixSoftgrainRelax::pre_neighbor() {
  if (!log_lists_) return;
  listed_.resize(static_cast<std::size_t>(atom->nlocal));
  for (std::size_t i = 0; i < listed_.size(); ++i) listed_[i] = {{atom->x[i][0], atom->x[i][1], atom->x[i][2]}};
  shrunk_ = {{1.0, 1.0, 1.0}};
}

/// Asks for a list where two bodies can have come nearer by the skin: each by itself, and both with the box, by its
/// strain times how far apart they are at most.
void FixSoftgrainRelax::watch_lists() {
  double own = 0.0;
  for (std::size_t i = 0; i < listed_.size(); ++i) {
    double away2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double centre = 0.5 * (domain->boxlo[k] + domain->boxhi[k]);
      const double away = atom->x[i][k] - (centre + (listed_[i][k] - centre) * shrunk_[k]);
      away2 += away * away;
    }
    own = std::max(own, away2);
  }
  double all = 0.0;
  MPI_Allreduce(&own, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  double strain = 0.0;
  for (int k = 0; k < 3; ++k) strain = std::max(strain, std::abs(1.0 - shrunk_[k]));
  // Not a number asks for one too: it is then found where bodies are counted.
  if (!(2.0 * std::sqrt(all) + strain * neighbor->cutneighmax < neighbor->skin)) next_reneighbor = update->ntimestep;
}

double FixSoftgrainRelax::box_residual() const {
  softgrain::Vec<3> off = stress_ - asked_;
  make_alike(off);
  double worst = 0.0;
  double largest = least_stress_;
  for (int k = 0; k < 3; ++k) {
    if (!by_stress_[static_cast<std::size_t>(k)]) continue;
    worst = std::max(worst, std::abs(off[k]));
    largest = std::max(largest, std::abs(asked_[k]));
  }
  return worst / (stress_tolerance_ * largest);
}

}  // namespace LAMMPS_NS

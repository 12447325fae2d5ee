// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/compute_softgrain_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "atom.h"
#include "comm.h"
#include "common/core/limits.h"
#include "error.h"
#include "force.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
#include "macrosim/lammps/forward_values.h"
#include "macrosim/lammps/pair_softgrain.h"
#include "macrosim/lammps/words.h"
#include "update.h"

namespace LAMMPS_NS {

using softgrain::ContactGeometry;
using softgrain::ContactResponse;
using softgrain::ContactState;
using softgrain::MultiContactSum;
using softgrain::Vec;
namespace bridge = softgrain::lammps;

namespace {

enum Value {
  kContacts,
  kWithWalls,
  kForces,
  kFabric,
  kVirial,
  kOverlap = 10,
  kEvaluations,
  kBeyond,
  kLargest,
  kRejected,
  kClamped,
  kBehind
};

/// A contact across ranks, or of images, is on two lists: the one of the smaller tag counts, of equal tags the lower.
bool is_mine(const bridge::Bodies& b, int i, int j) {
  if (j < b.own || b.tag[i] < b.tag[j]) return true;
  if (b.tag[i] > b.tag[j]) return false;
  for (int k = 2; k >= 0; --k)
    if (b.x[i][k] != b.x[j][k]) return b.x[i][k] < b.x[j][k];
  return false;
}

}  // namespace

ComputeSoftgrainContacts::ComputeSoftgrainContacts(LAMMPS* engine, int count, char** words)
    : Compute(engine, count, words) {
  if (count == 4 || (count > 4 && std::string(words[3]) != "grains"))
    error->all(FLERR, std::string("compute softgrain/contacts: all it takes is grains LEAST RADIUS ..."));
  if (count > 4) least_ = static_cast<int>(bridge::number(words[4], "least contacts", error));
  for (int k = 5; k < count; ++k) coarse_.push_back(bridge::number(words[k], "radius", error));
  grain_values_.assign(least_ > 0 ? 1 + 3 * coarse_.size() : 0, 0.0);
  comm_forward = 1;
  vector_flag = local_flag = 1;
  size_vector = kValues + static_cast<int>(grain_values_.size());
  size_local_cols = kColumns;
  extvector = 0;
  vector = new double[static_cast<std::size_t>(size_vector)]();
}

ComputeSoftgrainContacts::~ComputeSoftgrainContacts() { delete[] vector; }

void ComputeSoftgrainContacts::init() {
  pair_ = dynamic_cast<PairSoftgrain*>(force->pair);
  if (pair_ == nullptr) error->all(FLERR, std::string("compute softgrain/contacts needs pair style softgrain"));
  looked_ = -1;
}

/// Counts the uses of fitted laws as the program's own watch does: pair laws per contact, multi-contact laws per body.
template <class Law>
void ComputeSoftgrainContacts::note_use(const Law& law, const ContactState<3>& state, int i, int j, bool mine) {
  if constexpr (Law::traits.is_fitted && !Law::traits.is_multi_contact) {
    if (mine) use_.add(state.overlap / (state.constants.a * law.range.end), law.range.beyond);
  } else if constexpr (Law::traits.is_multi_contact) {
    if constexpr (Law::traits.needs_particle_pass) {
      if (law.i_is_soft) form_[static_cast<std::size_t>(i)] = &law.form;
      if (law.j_is_soft && j < atom->nlocal) form_[static_cast<std::size_t>(j)] = &law.form;
    } else if (mine) {
      for (const bool of_i : {true, false}) {
        MultiContactSum<3> own;
        law.share(state, of_i, own);
        const auto& range = law.form.pressure.range;
        if (own.square > 0.0) use_.add(own.volume / range.end, range.beyond);
      }
    }
  }
}

void ComputeSoftgrainContacts::note_sums() {
  for (std::size_t i = 0; i < form_.size(); ++i) {
    if (form_[i] == nullptr || !(pair_->sums[i].square > 0.0)) continue;
    const auto& range = form_[i]->pressure.range;
    use_.add(form_[i]->equivalent_volume(pair_->sums[i]) / range.end, range.beyond);
  }
}

template <class Surface>
void ComputeSoftgrainContacts::look_at(const bridge::ContactStore& store, const std::vector<softgrain::AnyLaw>& laws,
                                       const Surface& surface, int planes_before) {
  constexpr bool kPlanes = std::is_same_v<Surface, bridge::PlaneSurface>;
  const bridge::Bodies& b = surface.b;
  const bridge::Pass still{false, 0.0, pair_->sums.data()};
  const bridge::StorePairs source{store, surface, still};
  bridge::over_sections(store, laws, [&]<class Law>(const Law& law, const softgrain::PairRange& range) {
    softgrain::visit_pairs(
        source, softgrain::reach_of(law), range,
        [&](std::size_t c, const auto& pair, const ContactGeometry<3>& g) {
          const auto [i, j] = pair;
          const bool mine = kPlanes || is_mine(b, i, j);
          note_use(law, source.template state<Law::traits>(pair, c, g), i, kPlanes ? atom->nlocal : j, mine);
          const bool grains = least_ > 0;
          if (!mine && !grains) return;
          const ContactResponse<3> r = response_of(source, law, c, pair, g);
          const bool bears = r.elastic_force != 0.0 || r.normal_force != 0.0;
          const Vec<3> push = g.normal * r.normal_force + r.tangential_force;
          const Vec<3> branch = kPlanes ? g.normal * dot(g.branch, g.normal) : g.branch;
          if (grains && bears) note_grains(i, kPlanes ? -1 : j, dot(push, branch), mine);
          if (!mine) return;
          const double smaller = kPlanes ? b.r(i) : std::min(b.r(i), surface.radius_j(j));
          values_[kOverlap] = softgrain::larger_or_nan(values_[kOverlap], g.overlap / smaller);
          if (kPlanes && g.overlap > b.r(i)) values_[kBehind] += 1.0;
          if (!bears) return;
          values_[kContacts] += 1.0;
          values_[kForces] += std::abs(r.normal_force);
          if (kPlanes) {
            values_[kWithWalls] += 1.0;
          } else {
            pairs_ += 1.0;
            values_[kFabric] += g.normal[2] * g.normal[2] - g.normal[0] * g.normal[0];
          }
          constexpr int kRow[6] = {0, 1, 2, 0, 0, 1};
          constexpr int kColumn[6] = {0, 1, 2, 1, 2, 2};
          for (std::size_t k = 0; k < 6; ++k) values_[kVirial + k] += push[kRow[k]] * branch[kColumn[k]];
          const double partner = kPlanes ? -(planes_before + j + 1) : b.tag[j];
          rows_.push_back({static_cast<double>(b.tag[i]), partner, r.normal_force, push[0], push[1], push[2], branch[0],
                           branch[1], branch[2]});
        },
        [](std::size_t) {});
  });
}

void ComputeSoftgrainContacts::note_grains(int i, int j, double virial, bool mine) {
  holds_.push_back({i, j});
  if (j < 0 || !mine) return;
  for (std::size_t k = 0; k < coarse_.size(); ++k) {
    const std::size_t fine = (atom->radius[i] < coarse_[k] ? 1U : 0U) + (atom->radius[j] < coarse_[k] ? 1U : 0U);
    grain_values_[1 + 3 * k + fine] += virial;
  }
}

/// Bodies that too few hold go, until all that are left hold each other. In any order the same are left.
void ComputeSoftgrainContacts::count_rattlers() {
  const int own = atom->nlocal;
  loose_.assign(static_cast<std::size_t>(own + atom->nghost), 0.0);
  grain_values_[0] = 0.0;
  std::vector<int> held;
  const auto is_loose = [&](int i) { return i >= 0 && loose_[static_cast<std::size_t>(i)] > 0.0; };
  for (int more = 1; more > 0;) {
    held.assign(static_cast<std::size_t>(own), 0);
    for (const Hold& h : holds_) {
      if (!is_loose(h.j)) ++held[static_cast<std::size_t>(h.i)];
      if (h.j >= 0 && h.j < own && !is_loose(h.i)) ++held[static_cast<std::size_t>(h.j)];
    }
    int found = 0;
    for (int i = 0; i < own; ++i)
      if (!is_loose(i) && held[static_cast<std::size_t>(i)] < least_) {
        loose_[static_cast<std::size_t>(i)] = 1.0;
        ++found;
      }
    grain_values_[0] += found;
    MPI_Allreduce(&found, &more, 1, MPI_INT, MPI_MAX, world);
    if (more > 0) bridge::forward_values(*comm, this);
  }
}

int ComputeSoftgrainContacts::pack_forward_comm(int n, int* list, double* buf, int, int*) {
  for (int k = 0; k < n; ++k) buf[k] = loose_[static_cast<std::size_t>(list[k])];
  return n;
}

void ComputeSoftgrainContacts::unpack_forward_comm(int n, int first, double* buf) {
  for (int k = 0; k < n; ++k) loose_[static_cast<std::size_t>(first + k)] = buf[k];
}

void ComputeSoftgrainContacts::look() {
  if (looked_ == update->ntimestep) return;
  looked_ = update->ntimestep;
  values_ = {};
  pairs_ = 0.0;
  use_ = {};
  rows_.clear();
  holds_.clear();
  std::fill(grain_values_.begin(), grain_values_.end(), 0.0);
  form_.assign(static_cast<std::size_t>(atom->nlocal), nullptr);
  const bridge::Bodies b = pair_->bodies();
  look_at(pair_->store, pair_->laws, bridge::AtomSurface{b}, 0);
  int before = 0;
  for (const FixSoftgrainWall* wall : pair_->walls) {
    look_at(wall->store, wall->laws, bridge::PlaneSurface{b, wall->planes}, before);
    before += static_cast<int>(wall->planes.size());
  }
  note_sums();
  values_[kEvaluations] = static_cast<double>(use_.evaluations);
  values_[kBeyond] = static_cast<double>(use_.beyond);
  values_[kLargest] = use_.max_range_ratio;
  values_[kRejected] = static_cast<double>(use_.rejected);
  values_[kClamped] = static_cast<double>(use_.clamped);
}

void ComputeSoftgrainContacts::compute_vector() {
  invoked_vector = update->ntimestep;
  look();
  MPI_Allreduce(values_.data(), vector, kValues, MPI_DOUBLE, MPI_SUM, world);
  for (const int k : {kOverlap, kLargest}) {
    // MPI promises nothing for the maximum of what is not a number.
    double& own = values_[static_cast<std::size_t>(k)];
    if (std::isnan(own)) own = std::numeric_limits<double>::infinity();
    MPI_Allreduce(&own, vector + k, 1, MPI_DOUBLE, MPI_MAX, world);
  }
  double pairs = 0.0;
  MPI_Allreduce(&pairs_, &pairs, 1, MPI_DOUBLE, MPI_SUM, world);
  vector[kFabric] = pairs > 0.0 ? vector[kFabric] / pairs : 0.0;
  if (least_ == 0) return;
  count_rattlers();
  MPI_Allreduce(grain_values_.data(), vector + kValues, static_cast<int>(grain_values_.size()), MPI_DOUBLE, MPI_SUM,
                world);
}

void ComputeSoftgrainContacts::compute_local() {
  invoked_local = update->ntimestep;
  look();
  size_local_rows = static_cast<int>(rows_.size());
  row_pointers_.clear();
  for (auto& row : rows_) row_pointers_.push_back(row.data());
  array_local = row_pointers_.data();
}

double ComputeSoftgrainContacts::memory_usage() {
  return static_cast<double>(rows_.capacity() * sizeof(rows_[0]) + row_pointers_.capacity() * sizeof(double*));
}

}  // namespace LAMMPS_NS

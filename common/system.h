// One mechanical system: bodies, cell, contacts with history, laws, clock. Everything a run needs to go on is in here.
#pragma once

#include <cstdint>
#include <vector>

#include "common/contact/contact_list.h"
#include "common/contact/law_set.h"
#include "common/core/cell.h"
#include "common/core/cost.h"
#include "common/core/material.h"
#include "common/core/particles.h"

namespace softgrain {

/// Neighbour list bookkeeping: where bodies were when the list was made and how far each may move before the next.
template <int D>
struct NeighbourState {
  std::vector<Vec<D>> reference;  ///< positions at the last rebuild; empty: list must be built
  std::vector<double> skin;       ///< per body [m]: a pair's margin is the sum of both, each may move its own share
  Matrix<D> reference_edges{};    ///< edges of the cell at the last rebuild
  std::int64_t rebuilds = 0;
  std::int64_t short_lived =
      0;  ///< rebuilds one pass after the one before: some body crosses its whole margin in a step
  std::int64_t passes_at_build = 0;  ///< loop passes when the list was made
  // Follow from the margins (note_skin), not part of a saved state.
  std::vector<double> inverse_skin2;  ///< [1/m^2]
  double slimmest = 0.0;              ///< largest ratio of radius and half the reach to margin
};

template <int D>
struct System {
  std::vector<Material> materials;
  LawSet laws;
  Particles<D> particles;
  Cell<D> cell = open_cell<D>();
  Vec<D> gravity{};
  ContactList<D> contacts;
  NeighbourState<D> neighbours;
  double time = 0.0;  ///< [s]
  std::int64_t step = 0;
  Cost cost;
};

using System3 = System<3>;

}  // namespace softgrain

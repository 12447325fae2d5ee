// Anderson mixing: speeds up a fixed-point iteration x -> x + d(x) that converges linearly in a few directions.
#pragma once

#include <vector>

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

class AndersonMixing {
 public:
  explicit AndersonMixing(std::size_t memory) : memory_(memory) {}
  void forget() {
    states_.clear();
    steps_.clear();
  }

  /// The step to take from x instead of d: the combination of the remembered steps with the least |weight d|.
  Unknowns mixed(const Unknowns& x, const Unknowns& d, const Unknowns& weight);

 private:
  std::size_t memory_;
  std::vector<Unknowns> states_, steps_;  ///< oldest first
};

}  // namespace softgrain::statics

#include "common/statics/anderson.h"

#include <cmath>

namespace softgrain::statics {

namespace {

Unknowns difference(const Unknowns& a, const Unknowns& b) {
  Unknowns out = a;
  add_scaled(out, -1.0, b);
  return out;
}

}  // namespace

Unknowns AndersonMixing::mixed(const Unknowns& x, const Unknowns& d, const Unknowns& weight) {
  const auto weighted = [&](const Unknowns& a) {
    Unknowns out = a;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] *= weight[k];
    return out;
  };
  // Modified Gram-Schmidt on the changes of d, newest first; a change that adds nothing new is left out.
  Unknowns step = d;
  Unknowns rest = weighted(d);
  std::vector<Unknowns> basis, moves;
  for (std::size_t k = states_.size(); k-- > 0;) {
    const bool newest = k + 1 == states_.size();
    const Unknowns plain = difference(newest ? d : steps_[k + 1], steps_[k]);
    Unknowns move = difference(newest ? x : states_[k + 1], states_[k]);
    add_scaled(move, 1.0, plain);
    Unknowns change = weighted(plain);
    const double before = dot(change, change);
    for (std::size_t b = 0; b < basis.size(); ++b) {
      const double share = dot(basis[b], change);
      add_scaled(change, -share, basis[b]);
      add_scaled(move, -share, moves[b]);
    }
    const double left = dot(change, change);
    if (!(left > 1e-12 * before)) continue;
    const double scale = 1.0 / std::sqrt(left);
    for (double& v : change) v *= scale;
    for (double& v : move) v *= scale;
    const double share = dot(change, rest);
    add_scaled(rest, -share, change);
    add_scaled(step, -share, move);
    basis.push_back(std::move(change));
    moves.push_back(std::move(move));
  }
  states_.push_back(x);
  steps_.push_back(d);
  if (states_.size() > memory_) {
    states_.erase(states_.begin());
    steps_.erase(steps_.begin());
  }
  return step;
}

}  // namespace softgrain::statics

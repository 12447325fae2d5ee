// Anderson's mixing of the steps of an iteration [Walker and Ni 2011, SIAM J. Numer. Anal. 49, 1715].
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

/// An iteration x -> x + f(x) whose f goes to zero. mix() makes of f and what the last steps did to it the step that
/// would bring f nearest to zero, were it linear: least squares over the last `depth` differences.
class StepMixer {
 public:
  explicit StepMixer(std::size_t depth) : depth_(depth) {}

  /// f at the present place; the step from here. What is done with it is said to took().
  std::vector<Vec3> mix(const std::vector<Vec3>& f);
  void took(const std::vector<Vec3>& step) { step_ = step; }
  void forget();

 private:
  std::size_t depth_;
  std::vector<Vec3> f_;
  std::vector<Vec3> step_;
  std::deque<std::vector<Vec3>> changes_;  ///< changes of f in the last steps
  std::deque<std::vector<Vec3>> steps_;    ///< steps that caused these changes
};

}  // namespace softgrain

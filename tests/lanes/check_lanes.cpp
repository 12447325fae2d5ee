// Every way of choosing between two vectors lane by lane, against the plain choice. A program of its own, so that it
// can be built with compilers that the rest is not built with.
#include <cstdio>

#include "common/core/lanes.h"
#include "common/dynamics/block.h"

namespace {

using namespace softgrain;
using namespace softgrain::block;

/// No constants that a compiler could work the answer out from.
volatile double kOne = 1.0;

Lanes numbers(double first) {
  return Lanes([first](auto lane) { return first + static_cast<double>(static_cast<int>(lane)) * kOne; });
}

/// Whether the lanes named by the bits of `wanted`, and no others, come from the first vector.
bool chooses(unsigned wanted) {
  const Lanes yes = numbers(100.0);
  const Lanes no = numbers(-100.0);
  const Lanes sign([wanted](auto lane) { return (wanted >> static_cast<int>(lane) & 1U) != 0 ? kOne : -kOne; });
  const Lanes chosen = choose<Lanes>(sign > 0.0, yes, no);
  bool right = true;
  for (int k = 0; k < kLanes; ++k) {
    const auto lane = static_cast<std::size_t>(k);
    right = right && chosen[lane] == ((wanted >> k & 1U) != 0 ? yes[lane] : no[lane]);
  }
  return right;
}

}  // namespace

int main() {
  int wrong = 0;
  for (unsigned wanted = 0; wanted < 1U << kLanes; ++wanted) wrong += chooses(wanted) ? 0 : 1;
  std::printf("%d lanes: %d of %u masks wrong\n", kLanes, wrong, 1U << kLanes);
  return wrong == 0 ? 0 : 1;
}

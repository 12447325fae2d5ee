// What a computation cost: counts that do not depend on the machine, and wall time.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <chrono>
#include <cstdint>

namespace softgrain {

/// A loop pass is one evaluation of all contacts of a system;
/// a contact evaluation is one touching or candidate pair in such a pass.
struct Cost {
  std::int64_t loop_passes = 0;
  std::int64_t contact_evaluations = 0;
  double seconds = 0.0;  ///< wall time of the thread that did the work

  Cost& operator+=(const Cost& o) {
    loop_passes += o.loop_passes;
    contact_evaluations += o.contact_evaluations;
    seconds += o.seconds;
    return *this;
  }
};

class Stopwatch {
 public:
  /// Since it was made [s].
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace softgrain

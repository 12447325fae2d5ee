// Wall time since the beginning of something.
#pragma once

#include <chrono>

namespace softgrain {

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

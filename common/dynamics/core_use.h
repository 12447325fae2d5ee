// Whether threads get the cores that they want, as the kernel tells it (Linux): how long they waited for one, and how
// much of all cores nobody uses.
#pragma once

#include <optional>
#include <vector>

namespace softgrain {

/// How long threads of this program were ready to run while other programs had their cores, all threads together.
/// Threads that spin or sleep because they have nothing to do do not wait in this sense.
class CoreWaits {
 public:
  /// Since the last call, or since it was made [s]; none where the kernel does not tell (no schedstat).
  std::optional<double> since_last();
  CoreWaits() { (void)since_last(); }

 private:
  struct OfThread {
    int id = 0;
    double waited = 0.0;  ///< since it began [s]
  };
  std::vector<OfThread> threads_;
};

/// Idle time of the cores that this program may use, all together.
class IdleCores {
 public:
  /// Since the last call, or since it was made [s], in steps of 0.01 s per core; none where the kernel does not tell.
  std::optional<double> since_last();
  IdleCores() { (void)since_last(); }

 private:
  std::optional<double> before_;
};

}  // namespace softgrain

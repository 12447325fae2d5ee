// How a run that takes long is kept from being lost, and what it tells meanwhile.
#pragma once

#include <functional>
#include <string>

#include "common/io/interrupt.h"
#include "common/state/checkpoint.h"

namespace softgrain {

/// What a caller asks of a run; all functions may be empty, and may throw to end it. State: all that the run needs to
/// go on, in the same bits.
template <class State>
struct RunControl {
  std::function<void(const State&)> save{};                    ///< keeps the state
  std::function<void(const State&, double share)> progress{};  ///< share of the run that is done, 0 to 1
  std::function<void(const std::string&)> say{};               ///< a line for people
  double seconds = kCheckpointSeconds;  ///< wall time between two calls of `save` between recorded points
};

/// Asks at the right moments.
template <class State>
class RunKeeper {
 public:
  explicit RunKeeper(const RunControl<State>& control) : control_(control), due_(control.seconds) {}

  /// A point was recorded: it is saved, and the run ends when a signal came. Throws Interrupted, which says what the
  /// run was `doing`.
  void at_point(const State& state, double share, const char* doing) const {
    if (control_.save) control_.save(state);
    if (control_.progress) control_.progress(state, share);
    stop_if_interrupted(doing);
  }

  /// A part of what a point takes was done: the same when it is time for it, or a signal came.
  void between_points(const State& state, double share, const char* doing) {
    if (interrupt_requested() || due_.due()) at_point(state, share, doing);
  }

 private:
  const RunControl<State>& control_;
  CheckpointClock due_;
};

}  // namespace softgrain

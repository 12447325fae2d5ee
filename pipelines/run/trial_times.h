// Short trials by which softgrain check tells how long a run will take.
#pragma once

#include <cstdint>
#include <functional>

namespace softgrain {

/// Wall time of one call [s].
double seconds_of(const std::function<void()>& work);

/// Mean wall time of a call [s]: called at least once and at most `most` times, until `budget` seconds have passed.
double seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most);

/// An observer throws it to end a trial that has taken long enough.
struct TrialOver {};

/// Processor time of this thread so far [s].
double thread_seconds();

/// Processor time of one call with one thread [s]: what other programs do meanwhile does not count.
double core_seconds_of(const std::function<void()>& work);

/// Mean processor time of a call with one thread [s]; `budget` and `most` as above.
double core_seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most);

}  // namespace softgrain

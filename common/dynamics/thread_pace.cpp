#include "common/dynamics/thread_pace.h"

#include <algorithm>

namespace softgrain {

namespace {

/// Passes that make a measurement, and the most between two looks.
constexpr int kEnough = 16;
constexpr int kLookAtLeastEvery = 1024;
/// Waiting time, as a share of the longest, from which new shares pay.
constexpr double kUneven = 0.08;
constexpr double kLeastPart = 0.2;

}  // namespace

void ThreadPace::share_out(std::size_t threads) {
  const double equal = 1.0 / static_cast<double>(threads);
  const bool measured = share.size() == threads && passes >= kEnough &&
                        std::all_of(seconds.begin(), seconds.end(), [](double s) { return s > 0.0; });
  if (share.size() != threads) share.assign(threads, equal);
  if (measured) {
    double speeds = 0.0;
    for (std::size_t t = 0; t < threads; ++t) speeds += share[t] / seconds[t];
    double sum = 0.0;
    for (std::size_t t = 0; t < threads; ++t) {
      share[t] = std::max(share[t] / seconds[t] / speeds, kLeastPart * equal);
      sum += share[t];
    }
    for (double& part : share) part /= sum;
  }
  if (passes >= look_after) look_after = std::min(2 * look_after, kLookAtLeastEvery);
  seconds.assign(threads, 0.0);
  passes = 0;
}

bool ThreadPace::uneven() const {
  if (passes < look_after || seconds.empty()) return false;
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  return *most - *least > kUneven * *most;
}

}  // namespace softgrain

// Independent tasks over threads, with the first error carried out.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace softgrain {

/// Runs task(0..count-1), in order of index where threads allow. After an error no further task starts; the error of
/// the smallest index is thrown when all running ones have ended.
void parallel_tasks(std::int64_t count, const std::function<void(std::int64_t)>& task);

/// Runs one task per entry of `costs`, the most expensive first, so that no long one is left over at the end. `costs`
/// may be in any unit. The error that is thrown is that of the task that came first in this order.
void parallel_tasks(const std::vector<double>& costs, const std::function<void(std::size_t)>& task);

}  // namespace softgrain

// Independent tasks over threads, with the first error carried out.
#pragma once

#include <cstdint>
#include <functional>

namespace softgrain {

/// Runs task(0..count-1), in order of index where threads allow. After an error no further task starts; the error of
/// the smallest index is thrown when all running ones have ended.
void parallel_tasks(std::int64_t count, const std::function<void(std::int64_t)>& task);

}  // namespace softgrain

// Work on several threads: loops in pieces of a fixed length, whose sums have the same bits for any number of threads;
// independent tasks with the first error carried out; OpenMP with one thread for a while.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <vector>

namespace softgrain {

inline constexpr std::size_t kPieceLength = 2048;
/// Length below which one thread is faster than two. It counts bodies, or items that cost as little as a body.
inline constexpr std::size_t kParallelLength = 4000;

inline std::size_t pieces_of(std::size_t length) { return (length + kPieceLength - 1) / kPieceLength; }

/// Thread of every piece, for threads that find in their caches what they wrote there before; null: pieces are dealt
/// out evenly.
using PieceThreads = std::vector<std::uint8_t>;

/// work(begin, end) for all pieces of 0 .. length - 1; piece k begins at k kPieceLength. Of errors that of the first
/// piece is thrown, when all have ended.
template <class Work>
void in_pieces(std::size_t length, const Work& work, const PieceThreads* threads = nullptr) {
  const auto pieces = static_cast<std::int64_t>(pieces_of(length));
  std::exception_ptr error;
  std::int64_t failed = pieces;
  const auto work_on = [&](std::int64_t k) {
    const std::size_t begin = static_cast<std::size_t>(k) * kPieceLength;
    try {
      work(begin, std::min(begin + kPieceLength, length));
    } catch (...) {
#pragma omp critical(softgrain_in_pieces)
      if (k < failed) {
        failed = k;
        error = std::current_exception();
      }
    }
  };
  if (threads != nullptr && threads->size() == static_cast<std::size_t>(pieces) && length >= kParallelLength &&
      omp_in_parallel() == 0) {
#pragma omp parallel
    for (std::int64_t k = 0; k < pieces; ++k)
      if ((*threads)[static_cast<std::size_t>(k)] % omp_get_num_threads() == omp_get_thread_num()) work_on(k);
  } else {
#pragma omp parallel for schedule(static) if (length >= kParallelLength && omp_in_parallel() == 0)
    for (std::int64_t k = 0; k < pieces; ++k) work_on(k);
  }
  if (error) std::rethrow_exception(error);
}

/// What work(begin, end) returns for all pieces, joined in their order by join(so far, next).
template <class Result, class Work, class Join>
Result joined_in_pieces(std::size_t length, const Work& work, const Join& join, const PieceThreads* threads = nullptr) {
  std::vector<Result> pieces(pieces_of(length));
  in_pieces(
      length, [&](std::size_t begin, std::size_t end) { pieces[begin / kPieceLength] = work(begin, end); }, threads);
  Result all{};
  for (const Result& piece : pieces) join(all, piece);
  return all;
}

/// Sum of what work(begin, end) returns for all pieces, in their order.
template <class Sum, class Work>
Sum sum_in_pieces(std::size_t length, const Work& work, const PieceThreads* threads = nullptr) {
  return joined_in_pieces<Sum>(
      length, work, [](Sum& all, const Sum& piece) { all += piece; }, threads);
}

/// Runs task(0..count-1), in order of index where threads allow. After an error no further task starts; the error of
/// the smallest index is thrown when all running ones have ended. A single task has all threads to itself.
void parallel_tasks(std::int64_t count, const std::function<void(std::int64_t)>& task);

/// Runs one task per entry of `costs`, the most expensive first, so that no long one is left over at the end. `costs`
/// may be in any unit. The error that is thrown is that of the task that came first in this order.
void parallel_tasks(const std::vector<double>& costs, const std::function<void(std::size_t)>& task);

/// Limits OpenMP to one thread during its lifetime; its destructor restores the number before.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

}  // namespace softgrain

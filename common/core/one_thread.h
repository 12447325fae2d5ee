// OpenMP with one thread for a while.
#pragma once

#include <omp.h>

namespace softgrain {

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

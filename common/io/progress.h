// Progress with an estimate of the time left, on standard error: a bar on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace softgrain {

/// Thread-safe. Prints nothing for work shorter than about two seconds, or when quiet.
class Progress {
 public:
  Progress(std::string what, double total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(double amount = 1.0);  ///< work done, in the unit of `total`
  void set(double done);
  void finish();

 private:
  void print(bool last);

  std::string what_;
  double total_;
  double done_ = 0.0;
  bool quiet_;
  bool terminal_;
  bool printed_ = false;
  bool finished_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_print_;
  std::mutex mutex_;
};

}  // namespace softgrain

// What a run says while it works: lines for its log, and progress with an estimate of the time left.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

namespace softgrain {

/// On standard error: a bar on a terminal, a line now and then elsewhere. Thread-safe. Prints nothing for work shorter
/// than about two seconds, or when quiet. Beginning and end of all work go to the log of the run.
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
  double found_ = 0.0;  ///< done when the work began: what a run that goes on has from before says nothing of its speed
  bool quiet_;
  bool terminal_;
  bool printed_ = false;
  bool finished_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point found_at_;
  std::chrono::steady_clock::time_point last_print_;
  std::mutex mutex_;
};

/// One of the tasks behind a progress bar; it stands for so much of the whole.
class TaskProgress {
 public:
  explicit TaskProgress(Progress& whole, double weight = 1.0) : whole_(whole), weight_(weight) {}
  /// Share of the task that is done, 0 to 1; what lies behind is passed over.
  void reach(double share) {
    if (share <= done_) return;
    whole_.advance((share - done_) * weight_);
    done_ = share;
  }

 private:
  Progress& whole_;
  double weight_;
  double done_ = 0.0;
};

// Lines for the log of the run that is at work, from parts of the program that know of no run: stages, warnings, the
// end.

/// Takes a line without its end.
using LogSink = std::function<void(const std::string& line)>;

/// A log in use, from here to the end of its life. Logs may lie within each other (a run of several): lines go to the
/// newest. What is said before there is a log, a warning about an option say, goes to the first one; what is said after
/// the last one has ended, why the program ends say, still goes to that one.
class LogScope {
 public:
  explicit LogScope(LogSink sink);
  ~LogScope();
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

 private:
  std::size_t number_;
};

/// Each line of a text to the log. Thread-safe.
void log_text(const std::string& text);

}  // namespace softgrain

// Lines for the log of the run that is at work, from parts of the program that know of no run: stages, warnings, the
// end.
#pragma once

#include <functional>
#include <string>

namespace softgrain {

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

// What softgrain check found out: lines for people, the same facts for programs, and warnings that a colleague would
// give.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softgrain {

class Findings {
 public:
  nlohmann::json facts = nlohmann::json::object();
  std::string lines;  ///< each with two spaces before it

  void add(const std::string& key, const nlohmann::json& value, const std::string& line);
  /// Adds a fact and its line like add(), but does not repeat a line that is there already: for what holds for several
  /// scenes.
  void add_once(const std::string& key, const nlohmann::json& value, const std::string& line);
  /// Nothing is wrong, but it may not be what was meant. Said once.
  void warn(const std::string& text);
  /// Where a radius [m] is so large that its unit was probably forgotten; `key`: what it is called.
  void warn_of_metres(const std::string& key, double radius);
  /// The same of E [Pa] and density [kg/m^3] of grains that are too small.
  void warn_of_grains(double modulus, double density);
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// Adds to the time that the run will take [s of one core] what a part of it ("measuring", "twins") takes.
  void spend(const std::string& part, double core_seconds);
  /// Time of all parts so far [s of one core].
  [[nodiscard]] double spent() const;
  /// Says the time of the run and its parts, once all are there; with a warning when it is more than a day.
  void close_times();
  /// Bytes that a run will write to disk, with a warning when less is free in the directory of results here.
  void add_disk(double bytes);

 private:
  std::vector<std::string> warnings_;
  std::vector<std::pair<std::string, double>> times_;  ///< core seconds of the parts of the run
};

/// "0.4 s", "12 s", "3 min", "2.5 h", "4 days".
std::string time_text(double seconds);
/// "the machine is busy now, load 7.5 on 8 cores"; empty where at least half of the cores are idle. `load`: mean number
/// of processes at work.
std::string busy_text(double load, int cores);
/// The same of this machine in the last minute; empty where it is not known.
std::string busy_text();
/// "12 kB", "3.4 MB", "1.2 GB".
std::string bytes_text(double bytes);

// Short trials by which softgrain check tells how long a run will take.

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

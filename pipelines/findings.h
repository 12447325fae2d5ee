// What softgrain check found out: lines for people, the same facts for programs, and warnings that a colleague would
// give.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace softgrain {

class Findings {
 public:
  nlohmann::json facts = nlohmann::json::object();
  std::string lines;  ///< each with two spaces before it

  void add(const std::string& key, const nlohmann::json& value, const std::string& line);
  /// The same, but a line that is there already is not said again: what holds for several scenes.
  void add_once(const std::string& key, const nlohmann::json& value, const std::string& line);
  /// Nothing is wrong, but it may not be what was meant. Said once.
  void warn(const std::string& text);
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// Time that a run will take [s of wall time or of one core], with a warning when that is more than a day.
  void add_time(const std::string& key, double seconds, const std::string& of_what);
  /// Bytes that a run will write to disk, with a warning when less is free in the directory of results here.
  void add_disk(double bytes);

 private:
  std::vector<std::string> warnings_;
};

/// "0.4 s", "12 s", "3 min", "2.5 h", "4 days".
std::string time_text(double seconds);
/// "12 kB", "3.4 MB", "1.2 GB".
std::string bytes_text(double bytes);

/// Wall time of one call [s].
double seconds_of(const std::function<void()>& work);

/// Mean wall time of a call [s]: called at least once and at most `most` times, until `budget` seconds have passed.
double seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most);

}  // namespace softgrain

#include "pipelines/run/findings.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "common/core/cost.h"
#include "common/core/parallel_tasks.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr double kDay = 86400.0;

template <typename Timer>
double mean_of_calls(const Timer& timed, double budget, std::int64_t most) {
  std::int64_t calls = 0;
  double spent = 0.0;
  while (calls == 0 || (calls < most && spent < budget)) {
    spent += timed();
    ++calls;
  }
  return spent / static_cast<double>(calls);
}

}  // namespace

void Findings::add(const std::string& key, const nlohmann::json& value, const std::string& line) {
  facts[key] = value;
  lines += "  " + line + "\n";
}

void Findings::add_once(const std::string& key, const nlohmann::json& value, const std::string& line) {
  const std::string said = "  " + line + "\n";
  const bool new_line = !lines.starts_with(said) && lines.find("\n" + said) == std::string::npos;
  if (new_line)
    add(key, value, line);
  else
    facts[key] = value;
}

void Findings::warn(const std::string& text) {
  if (std::ranges::find(warnings_, text) == warnings_.end()) warnings_.push_back(text);
}

void Findings::warn_of_metres(const std::string& key, double radius) {
  constexpr double kBoulder = 1.0;
  if (radius > kBoulder)
    warn(fmt::format("{} is {:g} m: numbers without a unit are metres; was \"{:g} mm\" meant?", key, radius, radius));
}

void Findings::warn_of_grains(double modulus, double density) {
  constexpr double kSoftest = 1e3;    // [Pa]
  constexpr double kLightest = 15.0;  // [kg/m^3]; beads of foam
  if (modulus < kSoftest)
    warn(fmt::format("E is {:g} Pa: numbers without a unit are pascals; was \"{:g} GPa\" meant?", modulus, modulus));
  if (density < kLightest)
    warn(fmt::format("density is {:g} kg/m^3: numbers without a unit are kg/m^3; was \"{:g} g/cm^3\" meant?", density,
                     density));
}

void Findings::spend(const std::string& part, double core_seconds) {
  const auto known = std::ranges::find_if(times_, [&](const auto& t) { return t.first == part; });
  if (known == times_.end())
    times_.emplace_back(part, core_seconds);
  else
    known->second += core_seconds;
}

double Findings::spent() const {
  double total = 0.0;
  for (const auto& [part, seconds] : times_) total += seconds;
  return total;
}

void Findings::close_times() {
  if (times_.empty()) return;
  constexpr double kTrifle = 0.02;  // of the whole: such parts are in the facts alone
  const double total = spent();
  std::string parts;
  for (const auto& [part, seconds] : times_) {
    facts["core_seconds_parts"][part] = seconds;
    if (seconds >= kTrifle * total) append_part(parts, part + " " + time_text(seconds), ", ");
  }
  const std::string busy = busy_text();
  add("core_seconds", total,
      "time: about " + time_text(total) + " of one idle core (" + parts + ")" +
          (busy.empty() ? "" : "; " + busy + ": by the clock it takes longer"));
  if (total > kDay) warn("the run takes about " + time_text(total) + " of one core: see what can be smaller");
}

void Findings::add_disk(double bytes) {
  add("disk_bytes", bytes, "on disk: about " + bytes_text(bytes));
  std::error_code failed;
  const auto space = std::filesystem::space(".", failed);
  if (!failed && bytes > static_cast<double>(space.available))
    warn(fmt::format("the output of about {} does not fit into the {} that are free here", bytes_text(bytes),
                     bytes_text(static_cast<double>(space.available))));
}

std::string time_text(double seconds) {
  constexpr double kNever = 1e9;  // days
  if (seconds < 10.0) return fmt::format("{:.2g} s", seconds);
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.0f} min", seconds / 60.0);
  if (seconds < 2.0 * kDay) return fmt::format("{:.1f} h", seconds / 3600.0);
  return seconds < kNever * kDay ? fmt::format("{:.0f} days", seconds / kDay) : "millions of years";
}

std::string busy_text(double load, int cores) {
  if (!(load >= 0.5 * cores)) return "";
  return fmt::format("the machine is busy now, load {:.1f} on {}", load, counted(cores, "core"));
}

std::string busy_text() {
  double load = 0.0;
  return ::getloadavg(&load, 1) == 1 ? busy_text(load, omp_get_num_procs()) : "";
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.3g} kB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

double seconds_of(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

double seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most) {
  return mean_of_calls([&] { return seconds_of(work); }, budget, most);
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double core_seconds_of(const std::function<void()>& work) {
  const OneThread one;
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

double core_seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most) {
  return mean_of_calls([&] { return core_seconds_of(work); }, budget, most);
}

}  // namespace softgrain

#include "pipelines/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

namespace softgrain {

namespace {

constexpr double kDay = 86400.0;

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
  if (std::find(warnings_.begin(), warnings_.end(), text) == warnings_.end()) warnings_.push_back(text);
}

void Findings::add_time(const std::string& key, double seconds, const std::string& of_what) {
  add(key, seconds, of_what + ": about " + time_text(seconds));
  if (seconds > kDay) warn(of_what + " takes about " + time_text(seconds) + ": see what can be smaller before it runs");
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
  if (seconds < 10.0) return fmt::format("{:.2g} s", seconds);
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.0f} min", seconds / 60.0);
  if (seconds < 2.0 * kDay) return fmt::format("{:.1f} h", seconds / 3600.0);
  return fmt::format("{:.0f} days", seconds / kDay);
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.3g} kB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most) {
  std::int64_t calls = 0;
  double spent = 0.0;
  while (calls == 0 || (calls < most && spent < budget)) {
    spent += seconds_of(work);
    ++calls;
  }
  return spent / static_cast<double>(calls);
}

}  // namespace softgrain

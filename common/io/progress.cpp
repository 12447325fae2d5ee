#include "common/io/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <sstream>
#include <utility>
#include <vector>

namespace softgrain {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kSilentStart{2.0};     ///< shorter work prints nothing
constexpr Seconds kFirstLook{0.5};       ///< done by then: found, not made
constexpr Seconds kTerminalPeriod{0.2};  ///< between two updates of the bar
constexpr Seconds kLinePeriod{30.0};     ///< between two lines of a log
constexpr std::size_t kBarWidth = 30;

std::string readable_time(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string bar(double share) {
  const auto full = static_cast<std::size_t>(share * static_cast<double>(kBarWidth));
  return fmt::format("[{:#<{}}{:.<{}}]", "", full, "", kBarWidth - full);
}

struct Logs {
  std::mutex mutex;
  std::vector<std::pair<std::size_t, LogSink>> open;
  LogSink ended;                     ///< the last one of all
  std::vector<std::string> waiting;  ///< lines that wait for the first log
  std::size_t number = 0;
};

Logs& logs() {
  static Logs all;
  return all;
}

constexpr std::size_t kMostWaiting = 100;

}  // namespace

Progress::Progress(std::string what, double total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      found_at_(start_),
      last_print_(start_) {
  log_text(what_ + ": begins");
}

Progress::~Progress() { finish(); }

void Progress::advance(double amount) {
  const std::lock_guard lock(mutex_);
  done_ += amount;
  print(false);
}

void Progress::set(double done) {
  const std::lock_guard lock(mutex_);
  done_ = done;
  print(false);
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  finished_ = true;
  if (printed_) print(true);
  const std::string time = readable_time(Seconds(std::chrono::steady_clock::now() - start_).count());
  const double share = total_ > 0.0 ? done_ / total_ : 1.0;
  constexpr double kWhole = 1.0 - 1e-6;  // sums of shares are rounded
  log_text(share >= kWhole ? fmt::format("{}: done, {}", what_, time)
                           : fmt::format("{}: left at {:.0f} % after {}", what_, 100.0 * share, time));
}

void Progress::print(bool last) {
  if (quiet_ || (finished_ && !last)) return;
  const auto now = std::chrono::steady_clock::now();
  const Seconds elapsed = now - start_;
  if (elapsed < kFirstLook) {
    found_ = done_;
    found_at_ = now;
  }
  const Seconds period = terminal_ ? kTerminalPeriod : kLinePeriod;
  if (!last && (elapsed < kSilentStart || (printed_ && now - last_print_ < period))) return;
  const double share = total_ > 0.0 ? std::clamp(done_ / total_, 0.0, 1.0) : 0.0;
  std::string line = terminal_ ? fmt::format("\r\033[K{} {} {:3.0f} %", what_, bar(share), 100.0 * share)
                               : fmt::format("{}: {:.0f} %", what_, 100.0 * share);
  line += ", " + readable_time(elapsed.count()) + " so far";
  const Seconds working = now - found_at_;
  if (!last && done_ > found_)
    line += ", about " + readable_time(working.count() * (total_ * (1.0 - share)) / (done_ - found_)) + " left";
  if (!terminal_ || last) line += "\n";
  std::fputs(line.c_str(), stderr);
  printed_ = true;
  last_print_ = now;
}

LogScope::LogScope(LogSink sink) {
  Logs& all = logs();
  const std::lock_guard lock(all.mutex);
  for (const std::string& line : all.waiting) sink(line);
  all.waiting.clear();
  all.ended = nullptr;
  number_ = ++all.number;
  all.open.emplace_back(number_, std::move(sink));
}

LogScope::~LogScope() {
  Logs& all = logs();
  const std::lock_guard lock(all.mutex);
  const auto own = std::find_if(all.open.begin(), all.open.end(), [&](const auto& o) { return o.first == number_; });
  if (all.open.size() == 1) all.ended = std::move(own->second);
  all.open.erase(own);
}

void log_text(const std::string& text) {
  Logs& all = logs();
  const std::lock_guard lock(all.mutex);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!all.open.empty())
      all.open.back().second(line);
    else if (all.ended)
      all.ended(line);
    else if (all.waiting.size() < kMostWaiting)
      all.waiting.push_back(line);
  }
}

}  // namespace softgrain

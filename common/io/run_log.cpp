#include "common/io/run_log.h"

#include <algorithm>
#include <mutex>
#include <sstream>
#include <utility>
#include <vector>

namespace softgrain {

namespace {

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

#include "pipelines/runs/member_process.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <sstream>
#include <thread>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/child_process.h"
#include "common/io/interrupt.h"
#include "common/io/json_record.h"
#include "common/io/text_file.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

constexpr const char* kMembers = ".members";  ///< folder of what members leave for the set
constexpr double kMemberPatience = 60.0;      ///< from SIGTERM to SIGKILL: a checkpoint may be large [s]

std::string member_file(const std::string& directory, const std::string& name, const std::string& ending) {
  return directory + "/" + kMembers + "/" + name + ending;
}

std::optional<RunEntry> read_member_entry(const std::string& directory, const std::string& name) {
  const std::string path = member_file(directory, name, ".json");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  return record_of<RunEntry>(nlohmann::json::parse(read_text(path), nullptr, false));
}

/// Errors that the program told on standard error, without its name before each line.
std::string told_errors(const std::string& file) {
  const std::string prefix = "softgrain: ";
  std::istringstream lines(read_text(file));
  std::string text;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(prefix) && !line.starts_with(prefix + "warning: "))
      append_part(text, line.substr(prefix.size()), "\n");
  return text;
}

/// What the end of a process means for the run; throws where it ends the set.
RunEntry ended_entry(const RunEntry& planned, const ChildEnd& end, const std::string& directory) {
  const std::string told = told_errors(member_file(directory, planned.name, ".txt"));
  const auto is = [&](ExitStatus status) { return end.signal == 0 && end.status == static_cast<int>(status); };
  if (end.interrupted || is(ExitStatus::interrupted))
    throw Interrupted(told.empty() ? "stopped by a signal while running side by side; go on with --resume" : told);
  if (is(ExitStatus::file_trouble)) throw IoError(told);
  if (is(ExitStatus::bad_input)) throw InputError(told);
  const auto known = read_member_entry(directory, planned.name);
  if (known && (is(ExitStatus::good) || is(ExitStatus::not_usable))) return *known;
  RunEntry entry = planned;
  entry.status = RunStatus::not_usable;
  entry.reason = end.signal != 0 ? fmt::format("its process was ended by signal {}", end.signal) : told;
  if (entry.reason.empty()) entry.reason = fmt::format("its process ended with status {}", end.status);
  return entry;
}

class SideBySide {
 public:
  SideBySide(const CommonOptions& options, const RunContext& context, std::vector<RunEntry>& entries)
      : options_(options), context_(context), entries_(entries), jobs_(jobs_of(options, entries.size())) {
    options_.threads =
        std::max(1, (options.threads > 0 ? options.threads : omp_get_num_procs()) / static_cast<int>(jobs_));
    options_.quiet = true;
  }

  void run() {
    context_.say(fmt::format("{}, {} at once with {} each", counted(entries_.size(), "run"), jobs_,
                             counted(options_.threads, "thread")));
    std::vector<std::thread> workers;
    for (std::size_t k = 0; k < jobs_; ++k) workers.emplace_back([this] { work(); });
    for (std::thread& worker : workers) worker.join();
    if (trouble_) std::rethrow_exception(trouble_);
    stop_if_interrupted("running side by side");
  }

 private:
  static std::size_t jobs_of(const CommonOptions& options, std::size_t runs) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(options.jobs), 1, std::max<std::size_t>(1, runs));
  }

  /// Number of the next run; none where there is no other, or the set is to stop.
  std::optional<std::size_t> next() {
    const std::lock_guard lock(mutex_);
    if (trouble_ || interrupt_requested() || next_ == entries_.size()) return std::nullopt;
    return next_++;
  }

  void work() {
    try {
      while (const auto at = next()) make(*at);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!trouble_) trouble_ = std::current_exception();
      request_interrupt();  // the others save what they have
    }
  }

  void make(std::size_t at) {
    const std::string& name = entries_[at].name;
    const std::string output = member_file(context_.directory(), name, ".txt");
    const ChildEnd end = run_child(
        member_command(options_, context_.directory(), name), ".", output, [] {}, kMemberPatience);
    RunEntry entry = ended_entry(entries_[at], end, context_.directory());
    const std::lock_guard lock(mutex_);
    entries_[at] = std::move(entry);
    ++ended_;
    context_.say(ended_text(entries_[at]));
  }

  /// "sample_003: good; 5 of 20 runs have ended, about 4 min left".
  [[nodiscard]] std::string ended_text(const RunEntry& entry) const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
    const std::size_t left = entries_.size() - ended_;
    const double seconds = passed.count() * static_cast<double>(left) / static_cast<double>(ended_);
    return fmt::format("{}: {}{}; {} of {} runs have ended{}", entry.name, to_string(entry.status),
                       entry.reason.empty() ? "" : " (" + entry.reason + ")", ended_, entries_.size(),
                       left == 0 ? "" : ", " + time_text(seconds) + " left");
  }

  CommonOptions options_;  ///< those of the members
  const RunContext& context_;
  std::vector<RunEntry>& entries_;
  std::size_t jobs_;
  std::mutex mutex_;
  std::size_t next_ = 0;
  std::size_t ended_ = 0;
  std::exception_ptr trouble_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<std::string> member_command(const CommonOptions& options, const std::string& directory,
                                        const std::string& name) {
  std::vector<std::string> words{own_program(), "sweep", options.inputs.front(), "--out", directory};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--only", name);
  const auto number = [](std::int64_t value) { return value > 0 ? std::to_string(value) : std::string(); };
  for (const std::string& one : options.over) add("--over", one);
  add("--sample", options.sample);
  add("--seeds", options.seeds);
  if (options.seed_given) add("--seed", std::to_string(options.seed));
  for (const std::string& one : options.overrides) add("--set", one);
  add("--law", options.law);
  add("--bands", number(options.bands));
  add("--engine", options.engine);
  add("--ranks", number(options.ranks));
  add("--law-cache", options.law_cache);
  add("--packing-cache", options.packing_cache);
  add("--twin-cache", options.twin_cache);
  add("--threads", number(options.threads));
  if (options.checkpoint_seconds != kCheckpointSeconds)
    add("--checkpoint-every", fmt::format("{}", options.checkpoint_seconds));
  if (options.resume) words.emplace_back("--resume");
  if (options.quiet) words.emplace_back("--quiet");
  return words;
}

void write_member_entry(const std::string& directory, const RunEntry& entry) {
  require_writable_directory(directory + "/" + kMembers);
  write_text_atomic(member_file(directory, entry.name, ".json"), json_of(entry).dump(2) + "\n");
}

void forget_member_entries(const std::string& directory) {
  std::error_code ignored;
  std::filesystem::remove_all(std::filesystem::path(directory) / kMembers, ignored);
}

void run_side_by_side(const CommonOptions& options, const RunContext& context, std::vector<RunEntry>& entries) {
  forget_member_entries(context.directory());
  require_writable_directory(context.path(kMembers));
  SideBySide(options, context, entries).run();
}

}  // namespace softgrain

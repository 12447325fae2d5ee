#include "pipelines/run/run_context.h"

#include <fmt/format.h>
#include <omp.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <span>
#include <system_error>

#include "common/core/text.h"
#include "common/dynamics/thread_choice.h"
#include "common/io/json_record.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/law/terminal_plot.h"
#include "pipelines/results/summary.h"

namespace softgrain {

namespace {

using law::kTerminalColumns;
using law::wrapped;

/// Lines with a time into DIR/log.txt (continued by --resume), plain lines to standard error unless quiet.
std::shared_ptr<spdlog::logger> make_logger(const std::string& file, const CommonOptions& options) {
  std::vector<spdlog::sink_ptr> sinks;
  auto to_file = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file, !options.resume);
  to_file->set_pattern("%Y-%m-%d %H:%M:%S %v");
  sinks.push_back(std::move(to_file));
  if (!options.quiet) {
    auto to_terminal = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    // On a terminal a progress bar may stand on the current line: begin by clearing it.
    to_terminal->set_pattern(::isatty(STDERR_FILENO) == 1 ? "\r\033[K%v" : "%v");
    sinks.push_back(std::move(to_terminal));
  }
  auto logger = std::make_shared<spdlog::logger>("softgrain", sinks.begin(), sinks.end());
  logger->flush_on(spdlog::level::info);
  // A full disk is told once, by what finds no room for its results.
  logger->set_error_handler([](const std::string&) {});
  return logger;
}

void log_to(spdlog::sinks::sink& sink, const std::string& line) {
  sink.log({"softgrain", spdlog::level::info, line});
  sink.flush();
}

constexpr const char* kRunFile = ".run";  ///< name of the file that RunContext::begin() writes

nlohmann::json read_object(const std::string& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return nlohmann::json::object();
  nlohmann::json object = nlohmann::json::parse(read_text(file), nullptr, false);
  return object.is_object() ? object : nlohmann::json::object();
}

/// Whether a summary is that of a run that came to its end, usable or not.
bool has_ended(const nlohmann::json& summary) {
  const auto status = parse_enum<RunStatus>(summary.value("status", ""));
  return status == RunStatus::good || status == RunStatus::not_usable;
}

/// What the run in a directory is of; where its own file does not say it, the summary of a run that has ended does.
nlohmann::json earlier_run(const std::string& run_file, const std::string& summary_file) {
  const nlohmann::json run = read_object(run_file);
  if (!run.empty()) return run;
  const nlohmann::json summary = read_object(summary_file);
  return summary.value("provenance", nlohmann::json::object());
}

/// "macro.strain is 0.03 there and 0.04 now": keys in which two scenes differ, the first ones.
std::string changed_keys(const std::string& before, const std::string& now) {
  constexpr std::size_t kMostShown = 4;
  std::map<std::string, std::string> of_before;
  std::map<std::string, std::string> of_now;
  try {
    of_before = flat_scene(before, kRunFile);
    of_now = flat_scene(now, "scene");
  } catch (const InputError&) {  // of an earlier version, say
    return "its text is another";
  }
  std::vector<std::string> changes;
  for (const auto& [key, value] : of_before) {
    const auto found = of_now.find(key);
    if (found == of_now.end())
      changes.push_back(fmt::format("{} is {} there and not given now", key, value));
    else if (found->second != value)
      changes.push_back(fmt::format("{} is {} there and {} now", key, value, found->second));
  }
  for (const auto& [key, value] : of_now)
    if (!of_before.contains(key)) changes.push_back(fmt::format("{} is not given there and {} now", key, value));
  if (changes.empty()) return "its text is another, of the same values";
  std::string text = join_text(std::span(changes).first(std::min(changes.size(), kMostShown)), "; ");
  if (changes.size() > kMostShown) text += fmt::format("; and {} more", changes.size() - kMostShown);
  return text;
}

/// In what a run differs from the earlier one that it would go on with; empty: in nothing.
std::string difference_from(const nlohmann::json& before, const nlohmann::json& now) {
  const auto differs = [&](const char* key) { return before.contains(key) && before[key] != now[key]; };
  if (differs("scene"))
    return before["scene"].is_string()
               ? changed_keys(before["scene"].get<std::string>(), now["scene"].get<std::string>())
               : "its text is another";
  for (const auto& [key, what] : {std::pair{"seed", "its seed"}, {"engine", "its engine"}, {"bands", "--bands"}})
    if (differs(key)) return fmt::format("{} is {} there and {} now", what, before[key].dump(), now[key].dump());
  return differs("beside") ? "its law or data file is another" : "";
}

/// What the log has of the scene, as it is used: the whole text, but of thousands of bodies their number of lines.
std::string settings_text(const Scene& scene, std::uint64_t seed) {
  constexpr std::ptrdiff_t kMostLines = 200;
  const std::string text = scene.text();
  const std::ptrdiff_t lines = std::count(text.begin(), text.end(), '\n');
  const std::string head = fmt::format("scene {}, seed {}", scene.path(), seed);
  if (lines > kMostLines) return fmt::format("{}: {} lines, in the file .run", head, lines);
  return head + ":\n" + text;
}

constexpr std::size_t kMostWarnings = 5;

/// The result; whether it is not usable, and why; the first kMostWarnings warnings; where the rest is. In lines of at
/// most kTerminalColumns.
std::string console_text(std::string result, const nlohmann::json& summary) {
  if (!result.empty() && result.back() != '\n') result += '\n';
  const auto all = record_of<AnySummary>(summary);
  std::vector<std::string> warnings = warnings_of(all);
  const bool bad = parse_enum<RunStatus>(all.status) == RunStatus::not_usable;
  std::string text;
  for (std::size_t at = 0; at < result.size();) {
    const std::size_t end = result.find('\n', at);
    const std::string line = result.substr(at, end - at);
    text += line.size() > kTerminalColumns ? wrapped(line, 4, kTerminalColumns) : line + "\n";
    at = end + 1;
  }
  if (bad && !result.starts_with(all.status))
    text += wrapped(fmt::format("status: {} (exit status {}){}", all.status, static_cast<int>(ExitStatus::not_usable),
                                warnings.empty() ? "" : ": " + warnings.front()),
                    4, kTerminalColumns);
  if (bad && !warnings.empty()) warnings.erase(warnings.begin());  // has been said
  for (std::size_t k = 0; k < std::min(warnings.size(), kMostWarnings); ++k)
    text += wrapped("warning: " + warnings[k], 4, kTerminalColumns);
  const std::size_t further = warnings.size() - std::min(warnings.size(), kMostWarnings);
  if (further > 0) text += counted(further, "more warning") + " at the end of log.txt\n";
  const std::size_t notes = notes_of(all).size();
  if (notes > 0) text += counted(notes, "note") + " at the end of log.txt\n";
  return text;
}

/// What the log has beside the console summary: all warnings and notes.
std::string remarks_text(const nlohmann::json& summary) {
  const auto all = record_of<AnySummary>(summary);
  std::string text;
  for (const std::string& one : warnings_of(all)) text += "warning: " + one + "\n";
  for (const std::string& one : notes_of(all)) text += "note: " + one + "\n";
  return text;
}

}  // namespace

std::string default_directory(const std::string& name) {
  const std::string directory = "results/" + name;
  std::error_code ignored;
  return std::filesystem::exists(directory + "/README.md", ignored) ? directory + "_run" : directory;
}

std::optional<bool> began_with(const std::string& directory, const std::string& beside) {
  const nlohmann::json run = read_object(directory + "/" + kRunFile);
  if (!run.contains("beside")) return std::nullopt;
  return run["beside"] == short_hash(beside);
}

RunContext::RunContext(const CommonOptions& options, const std::string& command, const std::string& default_name,
                       const std::vector<std::string>& read)
    : options_(options),
      command_(command),
      directory_(options.out.empty() ? default_directory(default_name) : options.out),
      threads_(options.threads > 0 ? options.threads : omp_get_max_threads()) {
  require_writable_directory(directory_);
  lock_ = std::make_shared<DirectoryLock>(directory_);
  if (!options_.resume) {
    std::vector<std::string> inputs = options_.inputs;
    inputs.insert(inputs.end(), read.begin(), read.end());
    remove_earlier_run(directory_, command, inputs);
  }
  omp_set_num_threads(threads_);
  if (threads_ > 1) watch_cores();
  const Provenance build = build_provenance();
  shows_ = !options_.member;
  require_no_pipe(path("log.txt"));
  try {
    logger_ = make_logger(path("log.txt"), options_);
    // The first line: was_run_directory() knows the directory of a run by it.
    log_to(*logger_->sinks().front(), fmt::format("softgrain {} ({}), {}: {}", build.version, build.commit,
                                                  counted(threads_, "thread"), options_.command_line));
  } catch (const spdlog::spdlog_ex& e) {
    throw IoError(path("log.txt") + ": " + e.what());
  }
  log_ = std::make_shared<LogScope>([file = logger_->sinks().front()](const std::string& line) {
    try {
      log_to(*file, line);
    } catch (const spdlog::spdlog_ex&) {  // results find a full disk too, and say so; a log must not end a run
    }
  });
}

RunContext RunContext::part(const std::string& name) const {
  CommonOptions options = options_;
  options.out = path(name);
  RunContext out(options, command_, name);
  out.part_ = true;
  out.shows_ = false;
  return out;
}

void RunContext::begin(const Scene& scene, std::uint64_t seed, const std::string& beside) const {
  const nlohmann::json now{{"scene", scene.text()},
                           {"seed", seed},
                           {"beside", short_hash(beside)},
                           {"engine", options_.engine.empty() ? "softgrain" : options_.engine},
                           {"bands", options_.bands}};
  if (!part_ && resume()) {
    const nlohmann::json before = earlier_run(path(kRunFile), path("summary.json"));
    if (const std::string difference = difference_from(before, now); !difference.empty())
      throw FingerprintMismatch(
          fmt::format("{}: belongs to another scene ({}); give what it has to go on with it, run without --resume to "
                      "start anew, or choose another --out",
                      directory_, difference));
    if (options_.member && has_ended(read_object(path("summary.json")))) throw AlreadyFinished();
  }
  write_text_atomic(path(kRunFile), now.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  log_text(settings_text(scene, seed));
}

Provenance RunContext::provenance(const Scene& scene, std::uint64_t used_seed) const {
  Provenance p = build_provenance();
  p.threads = threads_;
  p.seed = used_seed;
  p.command = options_.command_line;
  if (const SceneTable root = scene.root(); root.is_text("kind")) p.kind = root.text("kind");  // fits have none
  p.scene = scene.text();
  return p;
}

void RunContext::say(const std::string& line) const {
  std::string text = line.size() > kTerminalColumns ? wrapped(line, 4, kTerminalColumns) : line;
  if (!text.empty() && text.back() == '\n') text.pop_back();
  logger_->info("{}", text);
}

void RunContext::finish(nlohmann::json summary, const std::string& console) const {
  const Provenance build = build_provenance();
  const auto add = [&](const char* key, const std::string& value) {
    if (!summary.contains(key)) summary[key] = value;
  };
  add("status", "good");
  add("command", command_);
  add("version", build.version);
  add("commit", build.commit);
  const std::string text = summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  write_text_atomic(path("summary.json"), text);
  const std::string end = console_text(console, summary);
  log_text(end + remarks_text(summary));
  if (shows_) write_standard_output(options_.json ? text : end);
}

void RunContext::finish(nlohmann::json summary, const Provenance& provenance, const std::string& console) const {
  if (!provenance.kind.empty()) summary["kind"] = provenance.kind;
  summary["provenance"] = json_of(provenance);
  finish(std::move(summary), console);
}

void RunContext::guard(const Provenance& provenance, const std::function<void()>& work) const {
  try {
    work();
  } catch (const UnusableResult& e) {
    finish({{"status", to_string(RunStatus::not_usable)}, {"remarks", {e.what()}}}, provenance,
           "not usable: " + std::string(e.what()));
    throw;
  }
}

}  // namespace softgrain

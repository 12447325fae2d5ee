#include "pipelines/runs/run_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "common/core/text.h"
#include "common/io/file_safety.h"
#include "common/io/interrupt.h"
#include "common/io/key_record.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/report/report.h"
#include "pipelines/run/run.h"
#include "pipelines/run/run_context.h"
#include "pipelines/runs/member_process.h"
#include "pipelines/runs/search.h"
#include "pipelines/runs/set_text.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRunsFile = ".runs";  ///< names of the directories of a set, one a line

/// Everything about one run of the set but where it goes.
struct ReadyRun {
  const PlannedRun* planned = nullptr;
  Scene scene;
  CommonOptions options;
};

CommonOptions options_of(const CommonOptions& all, const RunPlan& plan, const PlannedRun& run) {
  CommonOptions options = all;
  const auto more = plan.overrides(run);
  options.overrides.insert(options.overrides.end(), more.begin(), more.end());
  if (run.seed) {
    options.seed = *run.seed;
    options.seed_given = true;
  }
  options.over.clear();
  options.sample.clear();
  options.maximise.clear();
  options.minimise.clear();
  options.points = 0;
  options.jobs = 1;
  options.only.clear();
  options.slurm = false;
  options.seeds.clear();
  options.json = false;
  options.member = true;
  return options;
}

/// Mistakes of many scenes: each once, with the runs that have it where others do not. The first kMostShown of them.
class AllErrors {
 public:
  void add(const std::string& message, const std::string& run) {
    std::istringstream lines(message);
    for (std::string one; std::getline(lines, one);) {
      if (!runs_.contains(one)) order_.push_back(one);
      runs_[one].insert(run);
    }
  }
  void throw_if_any(std::size_t all) const {
    if (order_.empty()) return;
    constexpr std::size_t kMostShown = 20;
    std::string text;
    for (const std::string& one : std::span(order_).first(std::min(order_.size(), kMostShown))) {
      const std::set<std::string>& runs = runs_.at(one);
      append_part(text, one, "\n");
      if (runs.size() == all) continue;
      text += fmt::format(" (in the run {}{})", *runs.begin(),
                          runs.size() > 1 ? fmt::format(" and {} more", runs.size() - 1) : "");
    }
    if (order_.size() > kMostShown) append_part(text, counted(order_.size() - kMostShown, "more error"), "\n");
    throw InputError(text);
  }

 private:
  std::vector<std::string> order_;
  std::map<std::string, std::set<std::string>> runs_;
};

void validate_options(const SceneKind& kind, const CommonOptions& options) {
  refuse_idle_options(kind, options);
  if (options.write_only) throw InputError("--write-only: goes with one run; leave it out, or --over and --seeds");
}

/// What the kind refuses before it begins.
void refuse_scene(const ReadyRun& run) {
  const SceneKind& kind = kind_of(run.scene);
  validate_options(kind, run.options);
  if (kind.refuse != nullptr)
    kind.refuse(run.scene, run.options);
  else
    kind.read(run.scene);
}

/// All scenes, sound; nothing is made before that.
std::vector<ReadyRun> ready_runs(const CommonOptions& options, const RunPlan& plan) {
  AllErrors errors;
  std::vector<ReadyRun> ready;
  for (const PlannedRun& planned : plan.runs) {
    CommonOptions own = options_of(options, plan, planned);
    try {
      ready.push_back({&planned, Scene::load(options.inputs.front(), own.overrides), own});
      refuse_scene(ready.back());
    } catch (const InputError& e) {
      errors.add(e.what(), planned.name);
    }
  }
  errors.throw_if_any(plan.runs.size());
  return ready;
}

std::vector<std::string> lines_of(const std::string& path) {
  std::vector<std::string> out;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return out;
  std::istringstream lines(read_text(path));
  for (std::string one; std::getline(lines, one);)
    if (!one.empty()) out.push_back(one);
  return out;
}

/// What a run leaves beside results.
bool is_housekeeping(const fs::path& file) {
  static const std::set<std::string> names{"log.txt", ".lock", report::kFigureFolder, report::kCurveFolder};
  return names.contains(file.filename().string()) || file.extension() == ".xdmf";  // of states that are gone
}

/// Runs of an earlier set that the new one does not have: their results go, and the directory if nothing else is there.
/// Throws IoError, and removes nothing, while one of them is at work: tasks of a cluster do not hold the set.
void remove_earlier_members(const std::string& directory, const std::vector<std::string>& before) {
  std::vector<std::unique_ptr<DirectoryLock>> held;
  for (const std::string& name : before) {
    const fs::path member = fs::path(directory) / name;
    std::error_code error;
    if (name.find('/') == std::string::npos && fs::is_directory(member, error))
      held.push_back(std::make_unique<DirectoryLock>(member.string()));
  }
  for (const std::string& name : before) {
    const fs::path member = fs::path(directory) / name;
    std::error_code error;
    if (name.find('/') != std::string::npos || !fs::is_directory(member, error)) continue;
    remove_earlier_run(member.string(), "sweep", {});
    const bool empty = std::all_of(fs::directory_iterator(member, error), fs::directory_iterator(),
                                   [](const fs::directory_entry& entry) { return is_housekeeping(entry.path()); });
    if (empty) fs::remove_all(member, error);
  }
}

/// Says which directories belong to the set; those of an earlier one go unless it is resumed.
/// `all`: also those of the same names, which would not be repeated.
void keep_names(const RunContext& context, const RunPlan& plan, bool all) {
  const std::string path = context.path(kRunsFile);
  std::vector<std::string> before = lines_of(path);
  std::vector<std::string> names;
  for (const PlannedRun& run : plan.runs) names.push_back(run.name);
  if (!all || context.resume())
    std::erase_if(before, [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); });
  if (context.resume())
    names.insert(names.end(), before.begin(), before.end());
  else
    remove_earlier_members(context.directory(), before);
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  write_text_atomic(path, text);
}

/// What an earlier part of a set that goes on said of all its runs: no longer true while runs are added.
void forget_summary(const RunContext& context) {
  std::error_code ignored;
  for (const char* file : {"summary.json", "report.html", "table.csv", "search.csv"})
    fs::remove(context.path(file), ignored);
}

RunEntry entry_of(const RunPlan& plan, const PlannedRun& planned) {
  RunEntry entry{.name = planned.name, .directory = planned.name};
  for (std::size_t k = 0; k < plan.over.size(); ++k) entry.values[plan.over[k].key] = planned.values[k];
  if (planned.seed) entry.seed = static_cast<std::int64_t>(*planned.seed);
  return entry;
}

/// Runs it, or finds that it has ended before (true). What it refuses or finds unusable only now is said in its entry,
/// and the others go on.
bool make_run(ReadyRun run, const std::string& directory, RunEntry& entry) {
  run.options.out = directory + "/" + run.planned->name;
  bool before = false;
  try {
    (void)kind_of(run.scene).run(run.scene, run.options);
  } catch (const AlreadyFinished&) {
    before = true;
    complete_ended_run(run.options.out);
  } catch (const UnusableResult& e) {
    entry.reason = e.what();
  } catch (const FingerprintMismatch&) {
    throw;
  } catch (const InputError& e) {
    entry.reason = e.what();
  }
  if (entry.reason.empty())
    read_numbers(run.options.out, entry);
  else
    entry.status = RunStatus::not_usable;
  return before;
}

std::vector<RunEntry> make_runs(const std::vector<ReadyRun>& ready, const RunPlan& plan, const RunContext& context) {
  std::vector<RunEntry> entries;
  for (const ReadyRun& run : ready) {
    stop_if_interrupted("going from run to run; --resume goes on");
    entries.push_back(entry_of(plan, *run.planned));
    context.say(fmt::format("run {} of {}: {}", entries.size(), ready.size(), run.planned->name));
    if (make_run(run, context.directory(), entries.back())) context.say(run.planned->name + ": has ended before");
  }
  return entries;
}

/// Adds the rounds that the set asks for after its first runs, which `all` and `entries` then hold too.
void make_rounds(const CommonOptions& options, const RunRounds& rounds, const RunContext& context, RunPlan& all,
                 std::vector<RunEntry>& entries) {
  while (rounds.next) {
    const RunPlan more = rounds.next(all, entries);
    if (more.runs.empty()) return;
    all.runs.insert(all.runs.end(), more.runs.begin(), more.runs.end());
    for (std::size_t k = 0; k < all.over.size(); ++k)
      for (const std::string& value : more.over[k].values)
        if (std::ranges::find(all.over[k].values, value) == all.over[k].values.end())
          all.over[k].values.push_back(value);
    keep_names(context, all, false);
    const std::vector<RunEntry> added = make_runs(ready_runs(options, more), more, context);
    entries.insert(entries.end(), added.begin(), added.end());
  }
}

/// The same with several at once.
std::vector<RunEntry> make_side_by_side(const CommonOptions& options, const RunPlan& plan, const RunContext& context) {
  std::vector<RunEntry> entries;
  for (const PlannedRun& planned : plan.runs) entries.push_back(entry_of(plan, planned));
  run_side_by_side(options, context, entries);
  return entries;
}

/// One run of the set by its name. Throws InputError.
const PlannedRun& run_named(const RunPlan& plan, const std::string& name) {
  const auto at = std::ranges::find(plan.runs, name, &PlannedRun::name);
  if (at != plan.runs.end()) return *at;
  std::vector<std::string> names;
  for (const PlannedRun& run : plan.runs) names.push_back(run.name);
  const std::string all = fmt::format("its runs are {} to {}", names.front(), names.back());
  throw InputError(fmt::format("--only {}: the set has no such run; {}", name, nearest_text(name, names, all)));
}

/// --only: one run of the set, whose entry the set finds when it is collected.
ExitStatus run_alone(const CommonOptions& options, const RunPlan& plan, const std::string& directory) {
  RunPlan one = plan;
  one.runs = {run_named(plan, options.only)};
  const std::vector<ReadyRun> ready = ready_runs(options, one);
  RunEntry entry = entry_of(plan, one.runs.front());
  (void)make_run(ready.front(), directory, entry);
  write_member_entry(directory, entry);
  const std::string line =
      fmt::format("{}: {}{}\n", entry.name, to_string(entry.status), entry.reason.empty() ? "" : ": " + entry.reason);
  write_standard_output(options.json ? json_of(entry).dump(2) + "\n" : line);
  return entry.status == RunStatus::good ? ExitStatus::good : ExitStatus::not_usable;
}

/// What a key that is swept does not change although its name may be taken to say so.
void note_swept_keys(const RunPlan& plan, SetSummary& summary) {
  for (const SweptKey& one : plan.over)
    if (one.key == "macro.mu")
      summary.head.warnings.emplace_back(
          "macro.mu changes the friction between the particles of the scene alone: the law of soft particles stays the "
          "one that was measured, with grains of its own friction inside; for grains of another friction measure a law "
          "with them");
}

SetSummary summarise(const Scene& scene, const RunPlan& plan, std::vector<RunEntry> entries) {
  SetSummary summary;
  const std::string title = scene.root().title();
  summary.over = plan.over;
  summary.seeds.assign(plan.seeds.begin(), plan.seeds.end());
  summary.runs = std::move(entries);
  summary.points = points_of(summary.over, summary.runs);
  if (plan.design) summary.design = {plan.design->text(), static_cast<std::int64_t>(plan.design->seed)};
  summary.sensitivity = sensitivity_of(summary);
  summary.head.title = (title.empty() ? fs::path(scene.path()).stem().string() : title) + ": " + varied_text(summary);
  note_swept_keys(plan, summary);
  for (const RunEntry& run : summary.runs)
    if (run.status != RunStatus::good)
      summary.head.mark_unusable(
          fmt::format("run {} is {}{}", run.name, to_string(run.status), run.reason.empty() ? "" : ": " + run.reason));
  return summary;
}

std::uint64_t first_seed(const Scene& scene, const RunPlan& plan, const RunContext& context) {
  return plan.seeds.empty() ? context.seed(scene_seed(scene)) : plan.seeds.front();
}

}  // namespace

std::uint64_t scene_seed(const Scene& scene) {
  constexpr std::int64_t kMost = 1'000'000'000'000;
  return static_cast<std::uint64_t>(scene.root().count("seed", 0, kMost, 1));
}

TakesWholeNumbers takes_whole_numbers(const CommonOptions& options) {
  return [&options](const std::string& key, const std::string& value) {
    std::vector<std::string> overrides = options.overrides;
    overrides.push_back(key + "=" + value);
    KeyRecord record;
    std::string name;
    try {
      const Scene scene = Scene::load(options.inputs.front(), overrides);
      name = scene.path();
      kind_of(scene).read(scene);
    } catch (const Error&) {  // what is wrong with the scene is said where the runs are read
    }
    const auto& keys = record.keys(name);
    const auto at = keys.find(key);
    return at != keys.end() && at->second.form == KeyForm::count;
  };
}

ExitStatus run_set(const CommonOptions& options, const RunPlan& plan, const std::string& command,
                   const std::string& suffix, const RunRounds& rounds) {
  const Scene scene = Scene::load(options.inputs.front(), options.overrides);
  const std::string name = fs::path(scene.path()).stem().string() + "_" + suffix;
  if (!options.only.empty())
    return run_alone(options, plan, options.out.empty() ? default_directory(name) : options.out);
  const std::vector<ReadyRun> ready = ready_runs(options, plan);
  const RunContext context(options, command, name);
  keep_names(context, plan, options.slurm);
  forget_summary(context);
  const Provenance provenance = context.provenance(scene, first_seed(scene, plan, context));
  if (options.slurm) {
    const std::string next = write_job_array(options, plan, context);
    SummaryHead head{.status = RunStatus::written, .title = name + ": a job array", .remarks = {}, .files = {}};
    for (const char* file : {"slurm/job.sh", "slurm/commands.txt"}) head.files[file] = context.path(file);
    context.finish(json_of(head), provenance, next);
    return ExitStatus::good;
  }
  RunPlan all = plan;
  std::vector<RunEntry> entries =
      options.jobs > 1 ? make_side_by_side(options, plan, context) : make_runs(ready, plan, context);
  make_rounds(options, rounds, context, all, entries);
  SetSummary summary = summarise(scene, all, std::move(entries));
  if (rounds.conclude) rounds.conclude(all, summary);
  forget_member_entries(context.directory());
  for (const char* file : {"report.html", "table.csv"}) summary.head.files[file] = context.path(file);
  write_text_atomic(context.path("table.csv"), as_csv(table_of(summary)));
  if (summary.search && !summary.search->curve.x.empty()) {
    write_text_atomic(context.path("search.csv"), as_csv(search_table(*summary.search)));
    summary.head.files["search.csv"] = context.path("search.csv");
  }
  const bool good = summary.head.status == RunStatus::good;
  context.finish(json_of(summary), provenance, set_text(summary) + "report: " + context.path("report.html"));
  write_report(context.directory());
  return good ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain

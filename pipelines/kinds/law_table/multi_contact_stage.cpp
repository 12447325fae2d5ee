#include "pipelines/kinds/law_table/multi_contact_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

#include "common/core/parallel_tasks.h"
#include "common/io/interrupt.h"
#include "common/io/progress.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"

namespace softgrain {

namespace {

constexpr std::int64_t kPilotPackings = 3;
constexpr double kPilotIncrement = 4.0;  ///< increment of a pilot over that of the measurement: it finds the onset only
constexpr std::int64_t kBatch = 4;       ///< packings that a configuration gets at a time beyond the first ones

/// One configuration of one packing in one orientation.
struct MultiContactTask {
  const MultiContactConfiguration* configuration = nullptr;
  const MultiContactPlan* plan = nullptr;
  std::int64_t index = 0;  ///< number of the configuration
  std::int64_t packing = 0;
  std::int64_t orientation = 0;
};

std::int64_t soft_count(const MultiContactConfiguration& c) {
  return std::count_if(c.partners.begin(), c.partners.end(),
                       [](const MultiContactPartner& p) { return p.kind == PartnerKind::soft; });
}

/// Packings of the centre and of its soft neighbours.
std::vector<std::int64_t> packings_of(const MultiContactTask& task, std::int64_t pool) {
  std::vector<std::int64_t> packings{task.packing};
  for (std::int64_t k = 0; k < soft_count(*task.configuration); ++k) packings.push_back((task.packing + 1 + k) % pool);
  return packings;
}

/// What all tasks share, and the memory of what is measured already.
class MultiContactRunner {
 public:
  MultiContactRunner(const MultiContactSetup& setup, const Run& run, const std::vector<SoftContent>& contents,
                     const MultiContactLevel* level)
      : setup_(setup), run_(run), contents_(contents), level_(level) {}

  /// Runs tasks in parallel, long ones first; results are in the order of the tasks.
  /// Those that came to their end, in the order of tasks. What broke off (a grain squeezed out of its shell...) is left
  /// out as a whole, and said.
  std::vector<MultiContactRun> measure(const std::vector<MultiContactTask>& tasks, const MultiContactOptions& options,
                                       const std::string& what) {
    std::vector<double> weights;
    double total = 0.0;
    for (const MultiContactTask& t : tasks) {
      weights.push_back(static_cast<double>(count_increments(*t.configuration, *t.plan, options)) *
                        (1.0 + static_cast<double>(soft_count(*t.configuration))));
      total += weights.back();
    }
    Progress progress(what, total, run_.context.quiet());
    std::vector<MultiContactRun> runs(tasks.size());
    std::vector<std::string> broke_off(tasks.size());
    parallel_tasks(weights, [&](std::size_t t) {
      try {
        runs[t] = known_or_measured(tasks[t], options, weights[t], progress);
      } catch (const UnusableResult& e) {
        broke_off[t] = fmt::format(
            "{}, packing {} is left out: it broke off: {}; smaller overlaps or increments may keep it whole",
            tasks[t].configuration->name, tasks[t].packing, e.what());
      }
    });
    progress.finish();
    return whole_ones(std::move(runs), broke_off);
  }

  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }
  /// Said, and among the remarks.
  void leave_out(const std::string& text) {
    run_.context.say(text);
    left_out_.push_back(text);
  }

 private:
  std::vector<MultiContactRun> whole_ones(std::vector<MultiContactRun> runs,
                                          const std::vector<std::string>& broke_off) {
    std::vector<MultiContactRun> out;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (broke_off[k].empty()) {
        out.push_back(std::move(runs[k]));
        continue;
      }
      leave_out(broke_off[k]);
    }
    return out;
  }

  [[nodiscard]] std::string key_of(const MultiContactTask& task, const MultiContactOptions& options) const {
    std::string text = fmt::format("seed {} packings", run_.seed);
    for (const std::int64_t p : packings_of(task, static_cast<std::int64_t>(contents_.size())))
      text += fmt::format(" {}", p);
    if (task.orientation > 0) text += fmt::format("\norientation {}", task.orientation);
    if (level_ != nullptr) text += "\nlevel " + level_->tag;
    return multi_contact_run_key(setup_.spec, *task.configuration, *task.plan, options, text);
  }

  MultiContactRun known_or_measured(const MultiContactTask& task, const MultiContactOptions& options, double weight,
                                    Progress& progress) const {
    const std::string key = key_of(task, options);
    const std::string name = multi_contact_run_name(key);
    bool now = false;
    MultiContactRun run = run_.get_or_make(kept_multi_contact_run(), name, run_.context.law_cache(), key, [&] {
      now = true;
      return measured(task, name, options, weight, progress);
    });
    if (!now) progress.advance(weight);
    run.configuration = task.index;
    run.packing = task.packing;
    run.orientation = task.orientation;
    return run;
  }

  MultiContactRun measured(const MultiContactTask& task, const std::string& name, const MultiContactOptions& options,
                           double weight, Progress& progress) const {
    const auto packings = packings_of(task, static_cast<std::int64_t>(contents_.size()));
    std::vector<SoftContent> contents;
    for (const std::int64_t p : packings)
      contents.push_back(turned(contents_[static_cast<std::size_t>(p)], run_.seed, p, task.orientation));
    std::vector<const SoftContent*> others;
    for (std::size_t k = 1; k < contents.size(); ++k) others.push_back(&contents[k]);
    MultiContactExperiment e = make_multi_contact(setup_.spec, *task.configuration, contents.front(), others,
                                                  level_ != nullptr ? &level_->laws : nullptr);
    TaskProgress mine(progress, weight);
    return run_kept_multi_contact(run_.store, name, e, *task.plan, options, [&](double share) { mine.reach(share); });
  }

  const MultiContactSetup& setup_;
  const Run& run_;
  const std::vector<SoftContent>& contents_;
  const MultiContactLevel* level_;
  std::vector<std::string> left_out_;
};

/// Throws UnusableResult when fewer than half of the packings of a configuration are left: what is left are the soft
/// ones.
void require_enough(const MultiContactConfiguration& c, std::size_t left, std::size_t tried,
                    const MultiContactRunner& runner) {
  if (2 * left >= tried && left > 0) return;
  throw UnusableResult(fmt::format("{}: {} of {} packings broke off; {}", c.name, tried - left, tried,
                                   runner.left_out().empty() ? "" : runner.left_out().back()));
}

/// Adds the packings that the pool lacks.
void complete_pool(std::vector<ShellPacking>& pool, const MultiContactSetup& setup, const Run& run) {
  const auto there = static_cast<std::int64_t>(pool.size());
  pool.resize(static_cast<std::size_t>(setup.pool()));
  const std::int64_t wanted = std::max(setup.pool() - there, std::int64_t{0});
  Progress progress("packing", static_cast<double>(wanted), run.context.quiet());
  parallel_tasks(wanted, [&](std::int64_t n) {
    if (interrupt_requested()) throw Interrupted("stopped by a signal while packing");
    const std::int64_t k = there + n;
    pool[static_cast<std::size_t>(k)] = generate_shell_packing(setup.spec, run.seed, static_cast<std::uint64_t>(k));
    progress.advance();
  });
  progress.finish();
}

/// A coarse look at every way of loading; configurations that load alike share it.
class Pilot {
 public:
  Pilot(const MultiContactSetup& setup, MultiContactRunner& runner) : setup_(setup) {
    for (const MultiContactConfiguration& c : setup.configurations) add(loading_part(c));
    MultiContactOptions options = setup.options;
    options.relaxation = Relaxation::damped;
    options.increment *= kPilotIncrement;
    std::vector<MultiContactTask> tasks;
    const std::int64_t packings = std::min(kPilotPackings, setup.packings_max);
    for (std::size_t k = 0; k < parts_.size(); ++k)
      for (std::int64_t p = 0; p < packings; ++p)
        tasks.push_back({&parts_[k], &plans_[k], static_cast<std::int64_t>(k), p});
    std::vector<std::vector<MultiContactRun>> runs(parts_.size());
    for (MultiContactRun& run : runner.measure(tasks, options, "looking for onsets"))
      runs[static_cast<std::size_t>(run.configuration)].push_back(std::move(run));
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      require_enough(parts_[k], runs[k].size(), static_cast<std::size_t>(packings), runner);
      onsets_.push_back(onset_shares(parts_[k], runs[k]));
    }
  }

  [[nodiscard]] MultiContactPlan plan(std::size_t configuration) const {
    return recording_plan(setup_.configurations[configuration], onsets_[part_[configuration]], setup_.points,
                          setup_.options.increment);
  }

 private:
  void add(const MultiContactConfiguration& part) {
    const MultiContactPlan plan = coarse_plan(part);
    const std::string key = multi_contact_run_key(setup_.spec, part, plan, setup_.options, "");
    const auto [place, is_new] = known_.emplace(key, parts_.size());
    if (is_new) {
      parts_.push_back(part);
      plans_.push_back(plan);
    }
    part_.push_back(place->second);
  }

  const MultiContactSetup& setup_;
  std::map<std::string, std::size_t> known_;
  std::vector<MultiContactConfiguration> parts_;
  std::vector<MultiContactPlan> plans_;
  std::vector<std::size_t> part_;  ///< place in parts_ of each configuration
  std::vector<std::vector<double>> onsets_;
};

/// Runs that are there, per configuration, and how many packings each configuration is to have.
class Batches {
 public:
  Batches(const MultiContactSetup& setup, const std::vector<MultiContactPlan>& plans)
      : setup_(setup), plans_(plans), runs_(setup.configurations.size()), tried_(setup.configurations.size(), 0) {
    for (const MultiContactConfiguration& c : setup.configurations) wanted_.push_back(setup.least_packings(c));
  }

  [[nodiscard]] std::vector<MultiContactTask> next() const {
    std::vector<MultiContactTask> tasks;
    for (std::size_t c = 0; c < runs_.size(); ++c)
      for (auto p = tried_[c]; p < wanted_[c]; ++p)
        for (std::int64_t o = 0; o < setup_.orientations; ++o)
          tasks.push_back({&setup_.configurations[c], &plans_[c], static_cast<std::int64_t>(c), p, o});
    return tasks;
  }
  void take(std::vector<MultiContactRun> runs) {
    for (MultiContactRun& run : runs) runs_[static_cast<std::size_t>(run.configuration)].push_back(std::move(run));
    tried_ = wanted_;
    for (std::size_t c = 0; c < runs_.size(); ++c)
      if (!met(mean_end_force(setup_.configurations[c], runs_[c]), setup_.target))
        wanted_[c] = std::min(setup_.most_packings(setup_.configurations[c]), tried_[c] + kBatch);
  }
  /// How many packings each configuration has, those that broke off included.
  [[nodiscard]] const std::vector<std::int64_t>& tried() const { return tried_; }
  void add(std::vector<MultiContactRun> runs) {
    for (MultiContactRun& run : runs) runs_[static_cast<std::size_t>(run.configuration)].push_back(std::move(run));
  }
  void require_enough_left(const MultiContactRunner& runner) const {
    for (std::size_t c = 0; c < runs_.size(); ++c)
      require_enough(setup_.configurations[c], runs_[c].size(),
                     static_cast<std::size_t>(tried_[c] * setup_.orientations), runner);
  }
  [[nodiscard]] std::vector<MultiContactRun> all() const {
    std::vector<MultiContactRun> out;
    for (const auto& runs : runs_) out.insert(out.end(), runs.begin(), runs.end());
    return out;
  }

 private:
  const MultiContactSetup& setup_;
  const std::vector<MultiContactPlan>& plans_;
  std::vector<std::vector<MultiContactRun>> runs_;
  std::vector<std::int64_t> tried_;  ///< packings, those that broke off included
  std::vector<std::int64_t> wanted_;
};

/// A configuration and where it is recorded.
struct LoadingPath {
  MultiContactConfiguration configuration;
  MultiContactPlan plan;
};

/// Path up to the last state that is recorded within `depth`. Its recorded states are shares of the shorter path. Empty
/// where no state is recorded within `depth`.
std::optional<LoadingPath> cut_short(const LoadingPath& way, double depth) {
  if (depth >= 1.0) return way;
  constexpr double kRounding = 1e-9;
  std::vector<double> shares;
  for (const double s : way.plan.front())
    if (s <= depth * (1.0 + kRounding)) shares.push_back(s);
  if (shares.empty()) return {};
  const double reach = shares.back();
  for (double& s : shares) s /= reach;
  return LoadingPath{cut_short(way.configuration, reach), {shares}};
}

/// What the plan asks for beyond the packings that there are; of one configuration the deepest first.
class Planned {
 public:
  Planned(const MultiContactSetup& setup, const std::vector<MultiContactPlan>& plans, std::vector<std::int64_t> tried) {
    std::vector<PlannedPackings> wanted = setup.plan;
    std::stable_sort(wanted.begin(), wanted.end(), [](const auto& a, const auto& b) { return a.depth > b.depth; });
    for (const PlannedPackings& p : wanted) add(setup, plans, p, tried);
  }

  [[nodiscard]] const std::vector<MultiContactTask>& tasks() const { return tasks_; }
  /// What the plan asks for and cannot have.
  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }

 private:
  void add(const MultiContactSetup& setup, const std::vector<MultiContactPlan>& plans, const PlannedPackings& p,
           std::vector<std::int64_t>& tried) {
    for (std::size_t c = 0; c < setup.configurations.size(); ++c) {
      if (setup.configurations[c].name != p.configuration) continue;
      const std::optional<LoadingPath> way = cut_short(LoadingPath{setup.configurations[c], plans[c]}, p.depth);
      if (!way) {
        left_out_.push_back(
            fmt::format("{}: nothing is recorded within {} of its way, so that the plan's packings there "
                        "are left out",
                        p.configuration, p.depth));
        continue;
      }
      ways_.push_back(*way);
      for (std::int64_t packing = tried[c]; packing < p.packings; ++packing)
        for (std::int64_t o = 0; o < setup.orientations; ++o)
          tasks_.push_back({&ways_.back().configuration, &ways_.back().plan, static_cast<std::int64_t>(c), packing, o});
      tried[c] = std::max(tried[c], p.packings);
    }
  }

  std::deque<LoadingPath> ways_;  ///< stay where they are
  std::vector<MultiContactTask> tasks_;
  std::vector<std::string> left_out_;
};

std::vector<MultiContactRun> measure_all(const MultiContactSetup& setup, MultiContactRunner& runner, const Run& run) {
  std::vector<MultiContactPlan> plans;
  const Pilot pilot(setup, runner);
  for (std::size_t c = 0; c < setup.configurations.size(); ++c) plans.push_back(pilot.plan(c));
  Batches batches(setup, plans);
  std::string what = "measuring";
  for (auto tasks = batches.next(); !tasks.empty(); tasks = batches.next()) {
    run.context.say(fmt::format("{}: {} runs", what, tasks.size()));
    batches.take(runner.measure(tasks, setup.options, what));
    what = "measuring more packings";
  }
  batches.require_enough_left(runner);
  const Planned planned(setup, plans, batches.tried());
  for (const std::string& text : planned.left_out()) runner.leave_out(text);
  if (!planned.tasks().empty()) {
    run.context.say(fmt::format("as planned: {} runs", planned.tasks().size()));
    batches.add(runner.measure(planned.tasks(), setup.options, "measuring as planned"));
  }
  return batches.all();
}

}  // namespace

MultiContactMeasurements run_multi_contact_stage(const MultiContactSetup& setup, const Run& run,
                                                 std::vector<std::string>& left_out, std::vector<ShellPacking>& known,
                                                 const MultiContactLevel* level) {
  complete_pool(known, setup, run);
  const std::vector<ShellPacking>& pool = known;
  std::vector<SoftContent> filled(pool.size());
  parallel_tasks(static_cast<std::int64_t>(pool.size()), [&](std::int64_t k) {
    const ShellPacking& packing = pool[static_cast<std::size_t>(k)];
    filled[static_cast<std::size_t>(k)] =
        level != nullptr && level->fill ? level->fill(packing, k) : SoftContent{packing, {}, {}};
  });
  MultiContactMeasurements data;
  data.spec = setup.spec;
  data.relaxation = relaxation_text(setup.options);
  data.configurations = setup.configurations;
  for (const SoftContent& c : filled) data.packings.push_back(describe(c.grains, setup.spec));
  MultiContactRunner runner(setup, run, filled, level);
  data.runs = measure_all(setup, runner, run);
  left_out.insert(left_out.end(), runner.left_out().begin(), runner.left_out().end());
  save_multi_contact(data, run.path(level != nullptr ? level->file : kMultiContactFile), run.provenance);
  return data;
}

}  // namespace softgrain

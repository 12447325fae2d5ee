#include "pipelines/kinds/law_table/crowd_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

#include "common/core/parallel_tasks.h"
#include "common/io/interrupt.h"
#include "common/io/progress.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/law_table/crowd_cache.h"
#include "pipelines/kinds/law_table/crowd_plan.h"
#include "pipelines/kinds/law_table/crowd_summary.h"
#include "pipelines/kinds/law_table/kept_crowd.h"

namespace softgrain {

namespace {

constexpr std::int64_t kPilotPackings = 3;
constexpr double kPilotIncrement = 4.0;  ///< of that of the measurement: a pilot looks for the onset only
constexpr std::int64_t kBatch = 4;       ///< packings that a configuration gets at a time beyond the first ones

/// One configuration of one packing in one orientation.
struct CrowdTask {
  const CrowdConfiguration* configuration = nullptr;
  const CrowdPlan* plan = nullptr;
  std::int64_t index = 0;  ///< of the configuration
  std::int64_t packing = 0;
  std::int64_t orientation = 0;
};

std::int64_t soft_count(const CrowdConfiguration& c) {
  return std::count_if(c.partners.begin(), c.partners.end(),
                       [](const CrowdPartner& p) { return p.kind == PartnerKind::soft; });
}

/// Packings of the centre and of its soft neighbours.
std::vector<std::int64_t> packings_of(const CrowdTask& task, std::int64_t pool) {
  std::vector<std::int64_t> packings{task.packing};
  for (std::int64_t k = 0; k < soft_count(*task.configuration); ++k) packings.push_back((task.packing + 1 + k) % pool);
  return packings;
}

/// What all tasks share, and the memory of what is measured already.
class CrowdRunner {
 public:
  CrowdRunner(const CrowdSetup& setup, const Run& run, const std::vector<SoftContent>& contents,
              const CrowdLevel* level)
      : setup_(setup),
        run_(run),
        cache_(run.context.law_cache(), [&run](const std::string& remark) { run.context.say(remark); }),
        contents_(contents),
        level_(level) {}

  /// Runs tasks in parallel, long ones first; results are in the order of the tasks.
  /// Those that came to their end, in the order of tasks. What broke off (a grain squeezed out of its shell...) is left
  /// out as a whole, and said.
  std::vector<CrowdRun> measure(const std::vector<CrowdTask>& tasks, const CrowdOptions& options,
                                const std::string& what) {
    std::vector<double> weights;
    double total = 0.0;
    for (const CrowdTask& t : tasks) {
      weights.push_back(static_cast<double>(count_increments(*t.configuration, *t.plan, options)) *
                        (1.0 + static_cast<double>(soft_count(*t.configuration))));
      total += weights.back();
    }
    Progress progress(what, total, run_.context.quiet());
    std::vector<CrowdRun> runs(tasks.size());
    std::vector<std::string> broke_off(tasks.size());
    parallel_tasks(weights, [&](std::size_t t) {
      try {
        runs[t] = known_or_measured(tasks[t], options, weights[t], progress);
      } catch (const NotUsable& e) {
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
  std::vector<CrowdRun> whole_ones(std::vector<CrowdRun> runs, const std::vector<std::string>& broke_off) {
    std::vector<CrowdRun> out;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (broke_off[k].empty()) {
        out.push_back(std::move(runs[k]));
        continue;
      }
      leave_out(broke_off[k]);
    }
    return out;
  }

  [[nodiscard]] std::string key_of(const CrowdTask& task, const CrowdOptions& options) const {
    std::string text = fmt::format("seed {} packings", run_.seed);
    for (const std::int64_t p : packings_of(task, static_cast<std::int64_t>(contents_.size())))
      text += fmt::format(" {}", p);
    if (task.orientation > 0) text += fmt::format("\norientation {}", task.orientation);
    if (level_ != nullptr) text += "\nlevel " + level_->tag;
    return crowd_run_key(setup_.spec, *task.configuration, *task.plan, options, text);
  }

  CrowdRun known_or_measured(const CrowdTask& task, const CrowdOptions& options, double weight,
                             Progress& progress) const {
    const std::string key = key_of(task, options);
    const std::string name = crowd_run_name(key);
    std::optional<CrowdRun> run = cache_.find(key);
    if (!run) run_.store.load(name, [&](const h5::Group& g) { run = read_crowd_runs(g).at(0); });
    if (run) {
      progress.advance(weight);
    } else {
      run = measured(task, name, options, weight, progress);
      run_.store.save(name, [&](const h5::Group& g) { write_crowd_runs(g, {*run}); });
      cache_.keep(key, *run);
    }
    run->configuration = task.index;
    run->packing = task.packing;
    run->orientation = task.orientation;
    return *run;
  }

  CrowdRun measured(const CrowdTask& task, const std::string& name, const CrowdOptions& options, double weight,
                    Progress& progress) const {
    const auto packings = packings_of(task, static_cast<std::int64_t>(contents_.size()));
    std::vector<SoftContent> contents;
    for (const std::int64_t p : packings)
      contents.push_back(turned(contents_[static_cast<std::size_t>(p)], run_.seed, p, task.orientation));
    std::vector<const SoftContent*> others;
    for (std::size_t k = 1; k < contents.size(); ++k) others.push_back(&contents[k]);
    CrowdExperiment e = make_crowd(setup_.spec, *task.configuration, contents.front(), others,
                                   level_ != nullptr ? &level_->laws : nullptr);
    TaskProgress mine(progress, weight);
    return run_kept_crowd(run_.store, name, e, *task.plan, options, [&](double share) { mine.reach(share); });
  }

  const CrowdSetup& setup_;
  const Run& run_;
  CrowdCache cache_;
  const std::vector<SoftContent>& contents_;
  const CrowdLevel* level_;
  std::vector<std::string> left_out_;
};

/// Throws NotUsable when fewer than half of the packings of a configuration are left: what is left are the soft ones.
void require_enough(const CrowdConfiguration& c, std::size_t left, std::size_t tried, const CrowdRunner& runner) {
  if (2 * left >= tried && left > 0) return;
  throw NotUsable(fmt::format("{}: {} of {} packings broke off; {}", c.name, tried - left, tried,
                              runner.left_out().empty() ? "" : runner.left_out().back()));
}

/// Of the pool, those that are not there.
void complete_pool(std::vector<ShellPacking>& pool, const CrowdSetup& setup, const Run& run) {
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
  Pilot(const CrowdSetup& setup, CrowdRunner& runner) : setup_(setup) {
    for (const CrowdConfiguration& c : setup.configurations) add(loading_part(c));
    CrowdOptions options = setup.options;
    options.relaxation = Relaxation::damped;
    options.increment *= kPilotIncrement;
    std::vector<CrowdTask> tasks;
    const std::int64_t packings = std::min(kPilotPackings, setup.packings_max);
    for (std::size_t k = 0; k < parts_.size(); ++k)
      for (std::int64_t p = 0; p < packings; ++p)
        tasks.push_back({&parts_[k], &plans_[k], static_cast<std::int64_t>(k), p});
    std::vector<std::vector<CrowdRun>> runs(parts_.size());
    for (CrowdRun& run : runner.measure(tasks, options, "looking for onsets"))
      runs[static_cast<std::size_t>(run.configuration)].push_back(std::move(run));
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      require_enough(parts_[k], runs[k].size(), static_cast<std::size_t>(packings), runner);
      onsets_.push_back(onset_shares(parts_[k], runs[k]));
    }
  }

  [[nodiscard]] CrowdPlan plan(std::size_t configuration) const {
    return recording_plan(setup_.configurations[configuration], onsets_[part_[configuration]], setup_.points,
                          setup_.options.increment);
  }

 private:
  void add(const CrowdConfiguration& part) {
    const CrowdPlan plan = coarse_plan(part);
    const std::string key = crowd_run_key(setup_.spec, part, plan, setup_.options, "");
    const auto [place, is_new] = known_.emplace(key, parts_.size());
    if (is_new) {
      parts_.push_back(part);
      plans_.push_back(plan);
    }
    part_.push_back(place->second);
  }

  const CrowdSetup& setup_;
  std::map<std::string, std::size_t> known_;
  std::vector<CrowdConfiguration> parts_;
  std::vector<CrowdPlan> plans_;
  std::vector<std::size_t> part_;  ///< of each configuration
  std::vector<std::vector<double>> onsets_;
};

/// Which runs are there, per configuration, and how many each one is to have.
class Batches {
 public:
  Batches(const CrowdSetup& setup, const std::vector<CrowdPlan>& plans)
      : setup_(setup), plans_(plans), runs_(setup.configurations.size()), tried_(setup.configurations.size(), 0) {
    for (const CrowdConfiguration& c : setup.configurations) wanted_.push_back(setup.least_packings(c));
  }

  [[nodiscard]] std::vector<CrowdTask> next() const {
    std::vector<CrowdTask> tasks;
    for (std::size_t c = 0; c < runs_.size(); ++c)
      for (auto p = tried_[c]; p < wanted_[c]; ++p)
        for (std::int64_t o = 0; o < setup_.orientations; ++o)
          tasks.push_back({&setup_.configurations[c], &plans_[c], static_cast<std::int64_t>(c), p, o});
    return tasks;
  }
  void take(std::vector<CrowdRun> runs) {
    for (CrowdRun& run : runs) runs_[static_cast<std::size_t>(run.configuration)].push_back(std::move(run));
    tried_ = wanted_;
    for (std::size_t c = 0; c < runs_.size(); ++c)
      if (!met(mean_end_force(setup_.configurations[c], runs_[c]), setup_.target))
        wanted_[c] = std::min(setup_.most_packings(setup_.configurations[c]), tried_[c] + kBatch);
  }
  /// How many packings each configuration has, those that broke off included.
  [[nodiscard]] const std::vector<std::int64_t>& tried() const { return tried_; }
  void add(std::vector<CrowdRun> runs) {
    for (CrowdRun& run : runs) runs_[static_cast<std::size_t>(run.configuration)].push_back(std::move(run));
  }
  void require_enough_left(const CrowdRunner& runner) const {
    for (std::size_t c = 0; c < runs_.size(); ++c)
      require_enough(setup_.configurations[c], runs_[c].size(),
                     static_cast<std::size_t>(tried_[c] * setup_.orientations), runner);
  }
  [[nodiscard]] std::vector<CrowdRun> all() const {
    std::vector<CrowdRun> out;
    for (const auto& runs : runs_) out.insert(out.end(), runs.begin(), runs.end());
    return out;
  }

 private:
  const CrowdSetup& setup_;
  const std::vector<CrowdPlan>& plans_;
  std::vector<std::vector<CrowdRun>> runs_;
  std::vector<std::int64_t> tried_;  ///< packings, those that broke off included
  std::vector<std::int64_t> wanted_;
};

/// A configuration and where it is recorded.
struct Way {
  CrowdConfiguration configuration;
  CrowdPlan plan;
};

/// As far as the last state that is recorded within `depth`, and the same states as shares of that; none: no way.
std::optional<Way> cut_short(const Way& way, double depth) {
  if (depth >= 1.0) return way;
  constexpr double kRounding = 1e-9;
  std::vector<double> shares;
  for (const double s : way.plan.front())
    if (s <= depth * (1.0 + kRounding)) shares.push_back(s);
  if (shares.empty()) return {};
  const double reach = shares.back();
  for (double& s : shares) s /= reach;
  return Way{cut_short(way.configuration, reach), {shares}};
}

/// What the plan asks for beyond the packings that there are; of one configuration the deepest first.
class Planned {
 public:
  Planned(const CrowdSetup& setup, const std::vector<CrowdPlan>& plans, std::vector<std::int64_t> tried) {
    std::vector<PlannedPackings> wanted = setup.plan;
    std::stable_sort(wanted.begin(), wanted.end(), [](const auto& a, const auto& b) { return a.depth > b.depth; });
    for (const PlannedPackings& p : wanted) add(setup, plans, p, tried);
  }

  [[nodiscard]] const std::vector<CrowdTask>& tasks() const { return tasks_; }
  /// What the plan asks for and cannot have.
  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }

 private:
  void add(const CrowdSetup& setup, const std::vector<CrowdPlan>& plans, const PlannedPackings& p,
           std::vector<std::int64_t>& tried) {
    for (std::size_t c = 0; c < setup.configurations.size(); ++c) {
      if (setup.configurations[c].name != p.configuration) continue;
      const std::optional<Way> way = cut_short(Way{setup.configurations[c], plans[c]}, p.depth);
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

  std::deque<Way> ways_;  ///< stay where they are
  std::vector<CrowdTask> tasks_;
  std::vector<std::string> left_out_;
};

std::vector<CrowdRun> measure_all(const CrowdSetup& setup, CrowdRunner& runner, const Run& run) {
  std::vector<CrowdPlan> plans;
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

CrowdMeasurements run_crowd_stage(const CrowdSetup& setup, const Run& run, std::vector<std::string>& left_out,
                                  std::vector<ShellPacking>& known, const CrowdLevel* level) {
  complete_pool(known, setup, run);
  const std::vector<ShellPacking>& pool = known;
  std::vector<SoftContent> filled(pool.size());
  parallel_tasks(static_cast<std::int64_t>(pool.size()), [&](std::int64_t k) {
    const ShellPacking& packing = pool[static_cast<std::size_t>(k)];
    filled[static_cast<std::size_t>(k)] =
        level != nullptr && level->fill ? level->fill(packing, k) : SoftContent{packing, {}, {}};
  });
  CrowdMeasurements data;
  data.spec = setup.spec;
  data.relaxation = relaxation_text(setup.options);
  data.configurations = setup.configurations;
  for (const SoftContent& c : filled) data.packings.push_back(describe(c.grains, setup.spec));
  CrowdRunner runner(setup, run, filled, level);
  data.runs = measure_all(setup, runner, run);
  left_out.insert(left_out.end(), runner.left_out().begin(), runner.left_out().end());
  save_crowd(data, run.path(level != nullptr ? level->file : "crowd.h5"), run.provenance);
  return data;
}

}  // namespace softgrain

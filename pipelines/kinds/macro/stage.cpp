#include "pipelines/kinds/macro/stage.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "common/core/parallel_tasks.h"
#include "common/core/text.h"
#include "common/data/attributes.h"
#include "common/io/progress.h"
#include "common/state/system_io.h"
#include "macrosim/cell_specimen.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/macro_system.h"
#include "macrosim/twin_places.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/macro/bands.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/twin_cache.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

namespace {

/// How far a test has come, beside its curve and the state of its bodies.
void place_fields(auto&& visit, auto& state) {
  visit("increments", state.increments);
  visit("over", state.over, kLater);
  visit("worst_increment", state.worst.number, kLater);
  auto end = static_cast<std::int64_t>(state.worst.rest.end);
  visit("worst_end", end, kLater);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(state)>>)
    state.worst.rest.end = static_cast<RelaxationEnd>(std::clamp<std::int64_t>(end, 0, 3));
  visit("worst_residual", state.worst.rest.residual, kLater);
}

template <class State>
void write_place(const h5::Group& group, const State& state) {
  place_fields(AttributeWriter{group}, state);
}

/// States of earlier versions do not have all of it: nothing is known of their increments then.
template <class State>
void read_place(const h5::Group& group, State& state) {
  state.over = false;
  state.worst = {{RelaxationEnd::converged, 0, 0.0}, 0};
  place_fields(AttributeReader{group}, state);
  if (!group.has_attribute("worst_increment")) state.worst.number = state.increments;
}

void write_progress(const h5::Group& group, const CompressionState& state) {
  write_place(group, state);
  write_macro_curve(group.create("curve"), state.curve);
  write_system(group.create("system"), state.macro.system);
}

void read_progress(const h5::Group& group, CompressionState& state) {
  read_place(group, state);
  state.curve = read_macro_curve(group.open("curve"));
  read_system(group.open("system"), state.macro.system);
}

/// Whether samples share the threads, or take them one after another.
bool side_by_side(std::int64_t tasks) { return tasks >= omp_get_max_threads(); }

/// Samples in parallel when there are enough of them for all threads, else one after another with threads inside.
void over_samples(std::int64_t samples, const std::function<void(std::int64_t)>& task) {
  if (side_by_side(samples)) {
    parallel_tasks(samples, task);
  } else {
    for (std::int64_t k = 0; k < samples; ++k) task(k);
  }
}

/// What the tasks share.
struct Stage {
  const MacroRuns& runs;
  const Run& run;
  double inner_solid_fraction;
};

struct Engine {
  std::string name;
  const NamedLaws* laws = nullptr;  ///< null: a twin, or cells with the card of the scene
  Twin twin = Twin::shelled;
  bool cells = false;
};

Snapshot name_state(Snapshot s, const MacroCurve& c, const std::string& runs) {
  const bool twin = c.twin().has_value();
  s.kind = twin ? SnapshotKind::twin : SnapshotKind::macro;
  s.strain = c.strain.back();
  s.series = fmt::format("{}{}-{}", runs == "macro" ? "" : runs + "/", c.engine, c.sample);
  s.label = fmt::format("{}{} {}, sample {}, strain {:.4g}", runs == "macro" ? "" : runs + ": ", c.engine,
                        twin ? "twin" : "run", c.sample, s.strain);
  return s;
}

MacroSystem make_system(const Stage& stage, std::int64_t sample, const Engine& engine) {
  const MacroSpec& spec = stage.runs.setup.spec;
  const MacroPacking& packing = stage.runs.packings[static_cast<std::size_t>(sample)];
  if (engine.laws != nullptr) return make_law_system(spec, packing, engine.laws->laws, stage.inner_solid_fraction);
  const auto make = engine.twin == Twin::free ? make_free_system : make_shelled_system;
  return make(spec, packing, stage.runs.contents, stage.runs.seed, static_cast<std::uint64_t>(sample));
}

/// Test of a system with contacts, for run_task().
struct ContactRun {
  const MacroSpec& spec;
  PointRecord also;
  using State = CompressionState;

  static void write(const h5::Group& g, const State& s) { write_progress(g, s); }
  static void read(const h5::Group& g, State& s) { read_progress(g, s); }
  static Snapshot picture(const State& s, const MacroPacking& packing, const std::string& runs) {
    return named_state(s.macro, packing, s.curve, runs);
  }
  void go(State& s, const RunControl<State>& control) const { compress(s, spec, control, also); }
};

/// Test of cells of fines, for run_task().
struct CellRun {
  const MacroSpec& spec;
  using State = CellTestState;

  static void write(const h5::Group& group, const State& s) {
    write_place(group, s);
    write_macro_curve(group.create("curve"), s.curve);
    write_cell_state(group.create("cells"), s.packing.state());
  }
  void read(const h5::Group& group, State& s) const {
    read_place(group, s);
    s.curve = read_macro_curve(group.open("curve"));
    s.packing = CellPacking(cell_law_of(spec.cells->card, spec), read_cell_state(group.open("cells")),
                            spec.boundary == Boundary::periodic);
  }
  static Snapshot picture(const State& s, const MacroPacking& packing, const std::string& runs) {
    return name_state(cell_snapshot(s.packing, packing), s.curve, runs);
  }
  void go(State& s, const RunControl<State>& control) const { test_cells(s, spec, control); }
};

/// Runs a task from its checkpoint on, to its end or to where it breaks off.
template <class Kind>
RunOutcome run_task(const Stage& stage, const Kind& kind, typename Kind::State& state, const std::string& task,
                    Progress& progress) {
  using State = typename Kind::State;
  const auto points = recorded_points(kind.spec);
  const MacroPacking& packing = stage.runs.packings[static_cast<std::size_t>(state.curve.sample)];
  SnapshotRecorder states(stage.run.store, task, points, state.curve.sample == 0 ? stage.runs.setup.kept_states : 0);
  const LawIdentity law = state.curve.law;
  stage.run.store.load(task, [&](const h5::Group& g) { kind.read(g, state); });
  state.curve.law = law;
  TaskProgress mine(progress);
  mine.reach(static_cast<double>(state.curve.strain.size()) / static_cast<double>(points));
  MacroCurve recorded = state.curve;
  RunControl<State> control{.seconds = stage.run.store.seconds()};
  control.save = [&](const State& s) {
    const auto point = static_cast<std::int64_t>(s.curve.strain.size()) - 1;
    if (s.increments == 0 && states.wants(point)) states.add(kind.picture(s, packing, stage.runs.name), point);
    stage.run.store.save(task, [&](const h5::Group& g) { kind.write(g, s); });
    recorded = s.curve;
  };
  control.progress = [&](const State&, double share) { mine.reach(share); };
  try {
    kind.go(state, control);
  } catch (const UnusableResult& e) {  // this run alone ends here; without a point there is nothing to go on with
    if (recorded.strain.empty()) throw;
    state.curve = std::move(recorded);
    state.curve.usable = false;
    append_part(state.curve.note,
                fmt::format("broke off beyond strain {:.4g}: {}", state.curve.strain.back(), e.what()));
    mine.reach(1.0);
  }
  return {state.curve, states.take()};
}

/// Laws are asked at the places of a shelled twin.
PointRecord places_record(const MacroSpec& spec, const MacroPacking& packing, const Engine& engine) {
  if (any_slides(stages_of(spec))) return {};  // places are those of a rectangular cell
  if (engine.laws != nullptr || engine.twin != Twin::shelled) return {};
  return [&](const MacroSystem& twin, MacroCurve& curve) { record_places(twin, packing, curve); };
}

MacroSpec spec_for(const Stage& stage, const Engine& engine) {
  if (engine.laws == nullptr) return stage.runs.setup.spec;
  MacroSpec spec = law_spec(stage.runs.setup);
  if (engine.cells) spec.cells->card = *engine.laws->cells;
  return spec;
}

std::string task_name(const Stage& stage, std::int64_t sample, const Engine& engine) {
  const std::string law = engine.laws != nullptr && !engine.laws->tag.empty() ? "-" + engine.laws->tag : "";
  return stage.runs.name + "-" + engine.name + law + "-" + std::to_string(sample);
}

/// Runs the test of the first samples of a scene again, slightly_changed(). Differences of
/// the results come from the paths of grains.
void run_again(const Stage& stage, std::int64_t sample, const Engine& engine, MacroCurve& curve, Progress& progress) {
  if (sample >= stage.runs.setup.noise_samples || engine.cells) return;
  const MacroSpec spec = slightly_changed(spec_for(stage, engine));
  const MacroPacking& packing = stage.runs.packings[static_cast<std::size_t>(sample)];
  CompressionState state;
  state.macro = make_system(stage, sample, engine);
  state.curve = begin_curve(spec, packing, state.macro, engine.name, sample);
  const MacroCurve again =
      run_task(stage, ContactRun{spec, {}}, state, task_name(stage, sample, engine) + "-again", progress).curve;
  if (!again.usable || again.strain.size() != curve.strain.size()) return;
  curve.more[kAgainAxial] = again.stress_axial;
  curve.more[kAgainLateral] = again.stress_lateral;
}

RunOutcome run_contacts(const Stage& stage, std::int64_t sample, const Engine& engine, const MacroSpec& spec,
                        CompressionState& state, Progress& progress) {
  const NamedLaws* const laws = engine.laws;
  const MacroPacking& packing = stage.runs.packings[static_cast<std::size_t>(sample)];
  state.curve = begin_curve(spec, packing, state.macro, engine.name, sample);
  if (laws != nullptr) state.curve.law = laws->identity;
  RunOutcome out = run_task(stage, ContactRun{spec, places_record(spec, packing, engine)}, state,
                            task_name(stage, sample, engine), progress);
  if (laws != nullptr && out.curve.usable) add_law_texts(*laws, state.macro.system, out.curve);
  run_again(stage, sample, engine, out.curve, progress);
  return out;
}

RunOutcome cannot_begin(const Engine& engine, std::int64_t sample, const InputError& why) {
  RunOutcome out;
  out.curve.engine = engine.name;
  out.curve.sample = sample;
  out.curve.usable = false;
  out.curve.note = why.what();
  return out;
}

RunOutcome run_one(const Stage& stage, std::int64_t sample, const Engine& engine, Progress& progress) {
  const MacroSpec spec = spec_for(stage, engine);
  const MacroPacking& packing = stage.runs.packings[static_cast<std::size_t>(sample)];
  if (engine.cells) {
    std::optional<CellTestState> state;
    try {
      state.emplace(begin_cell_test(spec, packing, engine.name, sample));
    } catch (const InputError& e) {
      if (engine.laws == nullptr) throw;
      return cannot_begin(engine, sample, e);  // numbers that were drawn
    }
    return run_task(stage, CellRun{spec}, *state, task_name(stage, sample, engine), progress);
  }
  CompressionState state;
  state.macro = make_system(stage, sample, engine);
  const auto go = [&] { return run_contacts(stage, sample, engine, spec, state, progress); };
  if (engine.laws != nullptr) return go();
  bool ran = false;
  RunOutcome out = kept_twin(
      twin_key(spec, stage.runs.setup, packing, state.macro, engine.name, sample, stage.runs.name), stage.run, [&] {
        ran = true;
        return go();
      });
  if (!ran) TaskProgress(progress).reach(1.0);
  out.curve.density = packing.density;  // a kept twin may be of another target that the same packing met
  return out;
}

/// Keeps preparations under way among the tasks of a run. Writing takes at most a twentieth of the time.
class KeptPreparation : public PreparationKeeper {
 public:
  KeptPreparation(const TaskStore& store, const std::string& task)
      : store_(store), task_(task + "-under-way"), due_(store.seconds()) {}

  bool due() override { return due_.due(); }
  void save(const std::function<void(const h5::Group&)>& write) override {
    const Stopwatch watch;
    store_.save(task_, write);
    constexpr double kShare = 0.05;
    due_ = CheckpointClock(std::max(store_.seconds(), watch.seconds() / kShare));
  }
  void load(const std::function<void(const h5::Group&)>& read) override { store_.load(task_, read); }
  void remove() { store_.remove(task_); }

 private:
  const TaskStore& store_;
  std::string task_;
  CheckpointClock due_;
};

/// A packing, made now if it is not kept under its key; `task` is what the run keeps it as.
MacroPacking prepared_packing(const MacroSpec& spec, const Run& run, std::uint64_t sample, const std::string& task,
                              const std::function<void(double share)>& watch) {
  return kept_packing(packing_key(spec, run.seed, sample), task, run, [&] {
    KeptPreparation keeper(run.store, task);
    MacroPacking packing = make_packing(spec, run.seed, sample, {watch, &keeper});
    keeper.remove();
    return packing;
  });
}

/// Raised whenever a search would come to another packing.
constexpr int kDensitySchema = 1;

/// The share of a search that is done when this one of its tries has come so far; it is not known how many there are.
double density_progress(std::int64_t tries, double share) {
  return 1.0 - std::exp(-2.0 * (static_cast<double>(tries - 1) + share) / kUsualDensityTries);
}

/// Prepared to the density that the setup asks for. Every try is a packing of that friction, and kept as such: a run
/// that goes on, and a later one with another target, take the tries that they share from there.
MacroPacking packing_of_density(const MacroSetup& setup, const Run& run, std::int64_t sample, const std::string& task,
                                const std::function<void(double share)>& watch) {
  const MacroSpec& spec = setup.spec;
  const DensityTarget& target = *setup.density;
  const auto number = static_cast<std::uint64_t>(sample);
  const KeyText goal("density", kDensitySchema, target.solid_fraction(spec.density), target.tolerance);
  return kept_packing(packing_key(spec, run.seed, number) + goal.text(), task, run, [&] {
    std::int64_t tries = 0;
    return pack_to_density(target, spec.density, spec.protocol.friction, sample, [&](double friction) {
      MacroSpec tried = spec;
      tried.protocol.friction = friction;
      ++tries;
      return prepared_packing(tried, run, number, fmt::format("{}-try-{}", task, tries),
                              [&](double share) { watch(density_progress(tries, share)); });
    });
  });
}

MacroPacking sample_packing(const MacroSetup& setup, const Run& run, std::int64_t sample, const std::string& file_name,
                            const std::function<void(double share)>& watch) {
  if (setup.given) return *setup.given;
  const auto number = static_cast<std::uint64_t>(sample);
  const std::string task = file_name.substr(0, file_name.rfind('.')) + "-" + std::to_string(sample);
  if (setup.density) return packing_of_density(setup, run, sample, task, watch);
  return prepared_packing(setup.spec, run, number, task, watch);
}

/// All samples of all engines, in that order: engines of a kind cost about the same, and share the threads.
void run_kind(const Stage& stage, const std::vector<Engine>& engines, const std::string& title,
              const RunContext& context, std::vector<RunOutcome>& runs) {
  const std::int64_t samples = stage.runs.setup.samples;
  const auto tasks = static_cast<std::int64_t>(engines.size()) * samples;
  const std::int64_t again = std::min(stage.runs.setup.noise_samples, samples);
  if (tasks == 0) return;
  const std::size_t first = runs.size();
  runs.resize(first + static_cast<std::size_t>(tasks));
  Progress progress((stage.runs.progress.empty() ? stage.runs.name : stage.runs.progress) + title,
                    static_cast<double>(tasks + static_cast<std::int64_t>(engines.size()) * again), context.quiet());
  over_samples(tasks, [&](std::int64_t k) {
    const Engine& engine = engines[static_cast<std::size_t>(k / samples)];
    runs[first + static_cast<std::size_t>(k)] = run_one(stage, k % samples, engine, progress);
  });
}

/// What laws say at the places of shelled twins.
void ask_laws(const Stage& stage, const std::vector<NamedLaws>& laws, std::vector<RunOutcome>& outcomes) {
  std::vector<PlacedLaw> placed;
  for (const NamedLaws& l : laws) placed.push_back({l.name, l.laws});
  for (RunOutcome& o : outcomes)
    if (o.curve.twin() == Twin::shelled)
      place_laws(stage.runs.setup.spec, stage.runs.packings[static_cast<std::size_t>(o.curve.sample)],
                 stage.inner_solid_fraction, placed, o.curve);
}

}  // namespace

MacroSpec law_spec(const MacroSetup& setup) {
  MacroSpec spec = setup.spec;
  spec.increments_per_step *= setup.law_increments;
  for (MacroStage& s : spec.stages) s.increments_per_step *= setup.law_increments;
  return spec;
}

Snapshot named_state(const MacroSystem& macro, const MacroPacking& packing, const MacroCurve& c,
                     const std::string& runs) {
  return name_state(macro_snapshot(macro, packing), c, runs);
}

std::vector<DrawnSizes> drawn_sizes(const MacroSetup& setup, std::uint64_t seed, const std::string& of) {
  std::vector<DrawnSizes> out;
  for (const bool soft : {false, true}) {
    const std::optional<Grading>& asked = soft ? setup.spec.soft_sizes : setup.spec.solid_sizes;
    if (!asked) continue;
    DrawnSizes sizes{of + (soft ? "soft particles" : "solid grains"), *asked, {}};
    for (std::int64_t k = 0; k < setup.samples; ++k) {
      std::vector<double> radii;
      for (const MacroBody& b : drawn_bodies(setup.spec, seed, static_cast<std::uint64_t>(k)))
        if (b.soft == soft) radii.push_back(b.r);
      if (!radii.empty()) sizes.samples.push_back(std::move(radii));
    }
    out.push_back(std::move(sizes));
  }
  return out;
}

double mean_solid_fraction(const std::vector<ShellPacking>& contents) {
  double sum = 0.0;
  for (const ShellPacking& p : contents) sum += p.solid_fraction();
  // Without contents the mass of soft particles is that of a solid of the same size; quasi-static results do not depend
  // on it.
  return contents.empty() ? 1.0 : sum / static_cast<double>(contents.size());
}

std::vector<ShellPacking> make_contents(const SoftParticleSpec& spec, std::int64_t count, std::uint64_t seed) {
  std::vector<ShellPacking> contents(static_cast<std::size_t>(count));
  parallel_tasks(count, [&](std::int64_t k) {
    contents[static_cast<std::size_t>(k)] = generate_shell_packing(spec, seed, static_cast<std::uint64_t>(k));
  });
  return contents;
}

MacroPacking kept_packing(const std::string& key, const std::string& task, const Run& run,
                          const std::function<MacroPacking()>& make) {
  static const KeptForm<MacroPacking> form{
      "macro packing", "packing", "prepared again", [](const h5::Group& g) { return read_macro_packing(g); },
      [](const h5::Group& g, const MacroPacking& packing) { write_macro_packing(g, packing); }};
  return run.get_or_make(form, task, run.context.packing_cache(), key, make);
}

std::vector<MacroPacking> prepare_packings(const MacroSetup& setup, const Run& run, const std::string& file_name,
                                           const std::string& title) {
  std::vector<MacroPacking> packings(static_cast<std::size_t>(setup.samples));
  Progress progress(title, static_cast<double>(setup.samples), run.context.quiet());
  over_samples(setup.samples, [&](std::int64_t k) {
    TaskProgress mine(progress);
    packings[static_cast<std::size_t>(k)] =
        sample_packing(setup, run, k, file_name, [&](double share) { mine.reach(share); });
    mine.reach(1.0);
  });
  return packings;
}

void save_packings(const std::vector<MacroPacking>& packings, const Run& run, const std::string& file_name) {
  h5::AtomicFile file(run.path(file_name));
  write_provenance(file.root(), run.provenance);
  for (std::size_t k = 0; k < packings.size(); ++k)
    write_macro_packing(file.root().create("sample_" + std::to_string(k)), packings[k]);
  file.commit();
}

std::vector<MacroPacking> make_macro_packings(const MacroSetup& setup, const Run& run, const std::string& file_name) {
  auto packings = prepare_packings(setup, run, file_name);
  save_packings(packings, run, file_name);
  return packings;
}

std::vector<MacroCurve> run_laws(const MacroRuns& runs, const std::vector<NamedLaws>& laws, const std::string& title,
                                 const Run& run) {
  MacroSetup setup = runs.setup;
  setup.kept_states = 0;
  setup.noise_samples = 0;
  const MacroRuns once{setup, runs.packings, runs.contents, runs.seed, runs.name, runs.progress};
  const Stage stage{once, run, mean_solid_fraction(runs.contents)};
  std::vector<Engine> engines;
  for (const NamedLaws& l : laws) engines.push_back({l.name, &l, {}, l.cells.has_value()});
  std::vector<RunOutcome> outcomes;
  run_kind(stage, engines, title, run.context, outcomes);
  std::vector<MacroCurve> curves;
  for (RunOutcome& o : outcomes) curves.push_back(std::move(o.curve));
  return curves;
}

std::vector<MacroCurve> run_engines(const MacroRuns& runs, const std::vector<NamedLaws>& laws, const Run& run,
                                    const std::string& states_file, std::vector<RunOutcome> before) {
  const Stage stage{runs, run, mean_solid_fraction(runs.contents)};
  std::vector<Engine> with_laws;
  std::vector<Engine> twins;
  if (runs.setup.spec.cells) with_laws.push_back({"law", nullptr, {}, true});
  for (const NamedLaws& l : laws) with_laws.push_back({l.name, &l});
  for (const Twin twin : runs.setup.twins) twins.push_back({to_string(twin), nullptr, twin});
  std::vector<RunOutcome> outcomes = std::move(before);
  run_kind(stage, with_laws, runs.progress.empty() ? " with laws" : "", run.context, outcomes);
  run_kind(stage, twins, ": resolved twins", run.context, outcomes);
  ask_laws(stage, laws, outcomes);
  std::vector<MacroCurve> curves;
  std::vector<Snapshot> states;
  for (RunOutcome& o : outcomes) {
    curves.push_back(std::move(o.curve));
    std::move(o.states.begin(), o.states.end(), std::back_inserter(states));
  }
  save_kept_states(states, run.path(states_file), run.provenance);
  return curves;
}

std::vector<MacroCurve> run_macro_stage(const MacroSetup& setup, const std::vector<NamedLaws>& laws,
                                        const std::vector<ShellPacking>& contents, const Run& run,
                                        const std::vector<LawDraws>& draws, std::vector<BandRecord>& records) {
  const auto packings = make_macro_packings(setup, run, "macro_initial.h5");
  const MacroRuns runs{setup, packings, contents, run.seed, "macro"};
  auto curves = run_engines(runs, laws, run, "states_macro.h5");
  records = add_bands(runs, draws, run, curves);
  save_macro(curves, run.path("macro.h5"), run.provenance);
  return curves;
}

}  // namespace softgrain

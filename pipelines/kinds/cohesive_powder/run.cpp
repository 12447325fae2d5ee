#include "pipelines/kinds/cohesive_powder/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "common/core/cost.h"
#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/core/text.h"
#include "common/io/interrupt.h"
#include "common/io/progress.h"
#include "common/io/text_file.h"
#include "microsim/powder/powder_state_io.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/run/run.h"

namespace softgrain {

namespace {

using nlohmann::json;
struct Sample {
  PowderState state;
  PowderResult result;
  PowderAnalysis analysis;
};

/// Pressure of the last phase that was reached.
double imposed_pressure(const std::vector<PowderPhase>& phases, const PowderState& state) {
  return phases[std::min(static_cast<std::size_t>(state.phase), phases.size() - 1)].pressure;
}

/// The sample of this number of an earlier run, as it ended; whether it was at rest. Throws InputError when that run
/// was of other disks, or ended under another pressure.
bool take_state(const PowderSetup& setup, const std::vector<PowderPhase>& phases, std::int64_t number,
                PowderState& state) {
  const std::lock_guard lock(h5::library_mutex());
  const h5::Group file = h5::open_file(setup.states);
  const std::string sample = fmt::format("sample_{}", number);
  if (!file.has("spec") || !file.has(sample)) throw InputError(fmt::format("{}: has no {}", setup.states, sample));
  if (!(read_powder_spec(file.open("spec")) == setup.spec))
    throw InputError(setup.states + ": holds samples of other [disks], [contact] or [assembly] than the scene");
  read_powder_state(file.open(sample), state);
  const double imposed = state.stages.empty() ? 0.0 : state.stages.back().pressure;
  const bool rests = file.open(sample).integer("usable") != 0;
  if (rests && imposed != phases.back().pressure)
    throw InputError(fmt::format("{}: its states are under P* = {:g}, the scene asks for {:g} ([assembly] pressure)",
                                 setup.states, imposed, phases.back().pressure));
  state.phase = static_cast<std::int64_t>(phases.size());  // nothing is assembled any more
  return rests;
}

Sample run_sample(const PowderSetup& setup, std::uint64_t seed, std::int64_t number, const TaskStore& store,
                  Progress& progress) {
  Sample sample;
  sample.state = start_powder(setup.spec, seed, static_cast<std::uint64_t>(number));
  const std::string task = fmt::format("powder-{}", number);
  const auto phases = setup.phases();
  bool rests = true;
  if (setup.states.empty())
    store.load(task, [&](const h5::Group& g) { read_powder_state(g, sample.state); });
  else
    rests = take_state(setup, phases, number, sample.state);
  TaskProgress mine(progress);
  const Stopwatch watch;
  const double seconds_before = sample.state.system.cost.seconds;
  const auto count_time = [&] { sample.state.system.cost.seconds = seconds_before + watch.seconds(); };
  RunControl<PowderState> control;
  control.save = [&](const PowderState& now) {
    count_time();
    store.save(task, [&](const h5::Group& g) { write_powder_state(g, now); });
  };
  control.progress = [&](const PowderState&, double share) { mine.reach(share); };
  sample.result = run_powder(sample.state, setup.spec, phases, setup.options, control);
  count_time();
  if (!rests) {
    sample.result.usable = false;
    sample.result.reason = "the run that left the state ended before it was";
  }
  stop_if_interrupted("analysing packs");
  sample.analysis =
      analyse_powder(sample.state.system, setup.spec, imposed_pressure(phases, sample.state), setup.rigidity);
  mine.reach(1.0);
  return sample;
}

PackSummary summary_of(const Sample& s) {
  PackSummary out;
  out.usable = s.result.usable;
  out.reason = s.result.reason;
  out.time = s.state.system.time;
  out.steps = s.state.system.step;
  out.loop_passes = s.state.system.cost.loop_passes;
  out.contact_evaluations = s.state.system.cost.contact_evaluations;
  out.fraction = s.result.fraction;
  out.stress = {s.result.stress[0], s.result.stress[1]};
  if (s.state.stages.size() > 1) out.stages = s.state.stages;
  out.contacts = s.analysis.contacts;
  out.analysis = s.analysis;
  return out;
}

/// Means over the samples that came to rest, and their histograms added up.
void add_statistics(const std::vector<Sample>& samples, PowderSummary& summary) {
  std::vector<json> scalars;
  std::vector<const PowderForces*> forces;
  for (const Sample& s : samples) {
    if (!s.result.usable) continue;
    scalars.push_back(json_of(summary_of(s)));
    forces.push_back(&s.analysis.forces);
  }
  summary.statistics = sample_statistics(scalars);
  summary.histograms = histograms_json(forces);
}

/// Whether each sample counts in the mean.
std::vector<bool> usable_samples(const std::vector<Sample>& samples) {
  std::vector<bool> usable;
  for (const Sample& s : samples) usable.push_back(s.result.usable);
  return usable;
}

PowderStructures structures_of(const std::vector<Sample>& samples, const PowderStructureOptions& options) {
  std::vector<const System<2>*> systems;
  for (const Sample& s : samples) systems.push_back(&s.state.system);
  return powder_structures(systems, usable_samples(samples), options);
}

void save_samples(const std::string& path, const std::vector<Sample>& samples, const PowderStructures& structures,
                  const PowderSpec& spec, const Provenance& provenance) {
  h5::AtomicFile file(path);
  write_provenance(file.root(), provenance);
  write_powder_spec(file.root().create("spec"), spec);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const h5::Group group = file.root().create(fmt::format("sample_{}", k));
    group.attribute("usable", std::int64_t{samples[k].result.usable ? 1 : 0});
    group.attribute("reason", samples[k].result.reason);
    write_powder_state(group, samples[k].state);
    write_analysis(group.create("analysis"), samples[k].analysis);
    if (k < structures.samples.size()) write_structure(group, structures.samples[k]);
  }
  write_structures(file.root(), structures);
  file.commit();
}

std::vector<Sample> run_samples(const PowderSetup& setup, const Run& run) {
  std::vector<Sample> samples(static_cast<std::size_t>(setup.samples));
  Progress progress("powders", static_cast<double>(setup.samples), run.context.quiet());
  parallel_tasks(setup.samples, [&](std::int64_t k) {
    samples[static_cast<std::size_t>(k)] = run_sample(setup, run.seed, k, run.store, progress);
  });
  progress.finish();
  return samples;
}

/// What came out of each.
void add_samples(const std::vector<Sample>& samples, const PowderStructures& structures, PowderSummary& summary) {
  for (std::size_t k = 0; k < samples.size(); ++k) {
    summary.samples.push_back(summary_of(samples[k]));
    if (k < structures.samples.size()) add_structure(summary.samples.back(), structures.samples[k]);
    summary.seconds.push_back(samples[k].state.system.cost.seconds);
    if (!samples[k].result.usable)
      summary.head.mark_unusable(fmt::format("sample {} is not at rest: {}", k, samples[k].result.reason));
  }
  for (const std::string& remark : structure_remarks(structures)) summary.head.remarks.push_back(remark);
}

/// Adds the consolidation fit of samples under several pressures; returns the line about it for people.
std::string add_consolidation(const std::vector<Sample>& samples, PowderSummary& summary) {
  std::vector<PowderStages> stages;
  for (const Sample& s : samples) stages.push_back(s.state.stages);
  summary.consolidation = consolidation_of(stages);
  return summary.consolidation ? consolidation_text(*summary.consolidation) + "\n" : "";
}

/// "0.7178 +- 0.0020" of an entry of the statistics; without an error where it has one sample.
std::string mean_with_error(const json& statistics, int digits) {
  if (statistics["mean"].is_null()) return "-";
  std::optional<double> error;
  if (!statistics["deviation"].is_null())
    error = statistics["deviation"].get<double>() / std::sqrt(statistics["samples"].get<double>());
  return with_error(statistics["mean"].get<double>(), error, {.value = {digits, true}, .error = {digits, true}});
}

/// Means over samples that came to rest; returns the line about them for people.
std::string add_means(const PowderSetup& setup, const std::vector<Sample>& samples, const PowderStructures& structures,
                      PowderSummary& summary) {
  add_statistics(samples, summary);
  const json none{{"mean", nullptr}, {"deviation", nullptr}};  // no sample came to rest
  const json fraction = summary.statistics.value("Phi", none);
  const json z = summary.statistics.value("z", none);
  summary.mean = {{"Phi", fraction["mean"]},
                  {"Phi_deviation", fraction["deviation"]},
                  {"z", z["mean"]},
                  {"z_deviation", z["deviation"]}};
  summary.mean.update(structure_means_json(structures, usable_samples(samples)));
  if (structures.mean_curve) summary.scattering = {structures.fit, structures.other_ranges};
  return fmt::format("{} of {} disks: Phi {}, z {} (standard errors of the means)\n", counted(setup.samples, "sample"),
                     setup.spec.disks, mean_with_error(fraction, 4), mean_with_error(z, 3));
}

}  // namespace

ExitStatus run_powder_ensemble(const PowderSetup& setup, const Run& run) {
  std::vector<Sample> samples;
  run.guard([&] { samples = run_samples(setup, run); });
  const PowderStructures structures = structures_of(samples, setup.structure);
  save_samples(run.path("powder.h5"), samples, structures, setup.spec, run.provenance);
  PowderSummary summary;
  summary.head.title = setup.title;
  summary.head.files = {{"powder.h5", run.path("powder.h5")}, {"report", run.path("report.html")}};
  summary.head.sizes = summaries_of(drawn_sizes(setup, run.seed));
  add_samples(samples, structures, summary);
  std::string console = add_means(setup, samples, structures, summary);
  console += add_consolidation(samples, summary);
  return run.finish(json_of(summary), console + "data: " + run.path("powder.h5") + "\n");
}

namespace {

ExitStatus run_powder_scene(const Scene& scene, const CommonOptions& options) {
  if (has_powder_variants(scene)) return run_powder_variants(scene, options);
  const PowderSetup setup = read_powder(scene);
  return run_powder_ensemble(setup, Run(scene, options, "microsim", {setup.seed, {setup.states}, powder_text(setup)}));
}

void read_any_powder(const Scene& scene) {
  if (has_powder_variants(scene))
    (void)read_powder_variants(scene);
  else
    (void)read_powder(scene);
}

/// As SceneKind::starter.
constexpr const char* kCohesivePowderStarter = R"(title = "A small cohesive powder"
seed = 1
samples = 2
[disks]
count = 100
solid_fraction = 0.36
[contact]
kappa = 1e3
mu = 0.5
[assembly]
method = 1
pressure = 0.01
)";

}  // namespace

SceneKind cohesive_powder_kind() {
  return {.name = "cohesive-powder",
          .command = "microsim",
          .run = run_powder_scene,
          .check = [](const Scene& scene, const CommonOptions&, Findings& out) { check_powder(scene, out); },
          .read = read_any_powder,
          .results = powder_results(),
          .summary = members_of<PowderSummary>,
          .starter = kCohesivePowderStarter};
}

}  // namespace softgrain

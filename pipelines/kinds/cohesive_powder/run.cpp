#include "pipelines/kinds/cohesive_powder/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "common/core/error.h"
#include "common/core/stopwatch.h"
#include "common/io/interrupt.h"
#include "common/io/progress.h"
#include "microsim/powder/powder_state_io.h"
#include "pipelines/kinds/cohesive_powder/output.h"
#include "pipelines/kinds/cohesive_powder/structure.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/kinds/cohesive_powder/variants_run.h"
#include "pipelines/run/parallel_tasks.h"
#include "pipelines/run/run_summary.h"
#include "pipelines/run/sample_statistics.h"
#include "pipelines/run/task_store.h"

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

/// The sample of this number of an earlier run. Throws BadInput when that run was of other disks.
void take_state(const PowderSetup& setup, std::int64_t number, PowderState& state) {
  const std::lock_guard lock(h5::library_mutex());
  const h5::Group file = h5::open_file(setup.states);
  const std::string sample = fmt::format("sample_{}", number);
  if (!file.has("spec") || !file.has(sample)) throw BadInput(fmt::format("{}: has no {}", setup.states, sample));
  if (!(read_powder_spec(file.open("spec")) == setup.spec))
    throw BadInput(setup.states + ": holds samples of other [disks], [contact] or [assembly] than the scene");
  read_powder_state(file.open(sample), state);
}

Sample run_sample(const PowderSetup& setup, std::uint64_t seed, std::int64_t number, const TaskStore& store,
                  Progress& progress) {
  Sample sample;
  sample.state = start_powder(setup.spec, seed, static_cast<std::uint64_t>(number));
  const std::string task = fmt::format("powder-{}", number);
  if (setup.states.empty())
    store.load(task, [&](const h5::Group& g) { read_powder_state(g, sample.state); });
  else
    take_state(setup, number, sample.state);
  const auto phases = setup.phases();
  double reported = 0.0;
  const Stopwatch watch;
  const double seconds_before = sample.state.system.cost.seconds;
  sample.result = run_powder(sample.state, setup.spec, phases, setup.options, [&](const PowderState& now) {
    sample.state.system.cost.seconds = seconds_before + watch.seconds();
    store.save(task, [&](const h5::Group& g) { write_powder_state(g, now); });
    // Nobody knows when a phase comes to rest; most take about kUsual.
    constexpr double kUsual = 150.0;
    const double elapsed = now.system.time - now.phase_start;
    const double share =
        (static_cast<double>(now.phase) + elapsed / (elapsed + kUsual)) / static_cast<double>(phases.size());
    progress.advance(std::max(share - reported, 0.0));
    reported = std::max(share, reported);
    if (interrupt_requested()) throw Interrupted("stopped by a signal; go on with --resume");
  });
  sample.state.system.cost.seconds = seconds_before + watch.seconds();
  stop_if_interrupted("analysing packs");
  sample.analysis =
      analyse_powder(sample.state.system, setup.spec, imposed_pressure(phases, sample.state), setup.rigidity);
  progress.advance(1.0 - reported);
  return sample;
}

json sample_json(const Sample& s) {
  const PowderContacts& c = s.analysis.contacts;
  json out{{"usable", s.result.usable},
           {"reason", s.result.reason},
           {"time", s.state.system.time},
           {"steps", s.state.system.step},
           {"loop_passes", s.state.system.cost.loop_passes},
           {"contact_evaluations", s.state.system.cost.contact_evaluations},
           {"Phi", s.result.fraction},
           {"z", c.coordination},
           {"z_star", c.coordination_backbone},
           {"shares", c.shares},
           {"contacts", c.contacts},
           {"distant", c.distant},
           {"rattlers", c.rattlers},
           {"repulsive", c.repulsive},
           {"tensile", c.tensile},
           {"unstressed", c.unstressed},
           {"mean_normal", c.mean_normal},
           {"mean_repulsive", c.mean_repulsive},
           {"mean_tensile", c.mean_tensile},
           {"quadratic_mean_normal", c.square_mean_normal},
           {"rumpf_pressure", c.rumpf_pressure},
           {"branch_pressure", c.branch_pressure},
           {"stress", {s.result.stress[0], s.result.stress[1]}}};
  out.update(analysis_json(s.analysis));
  return out;
}

/// Means over the samples that came to rest, and their histograms added up.
void add_statistics(const std::vector<Sample>& samples, json& summary) {
  std::vector<json> scalars;
  std::vector<const PowderForces*> forces;
  for (const Sample& s : samples) {
    if (!s.result.usable) continue;
    scalars.push_back(sample_json(s));
    forces.push_back(&s.analysis.forces);
  }
  summary["statistics"] = sample_statistics(scalars);
  summary["histograms"] = histograms_json(forces);
}

/// Which samples count in the mean.
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

std::vector<Sample> run_samples(const PowderSetup& setup, std::uint64_t seed, const TaskStore& store,
                                const RunContext& context) {
  std::vector<Sample> samples(static_cast<std::size_t>(setup.samples));
  Progress progress("powders", static_cast<double>(setup.samples), context.quiet());
  parallel_tasks(setup.samples, [&](std::int64_t k) {
    samples[static_cast<std::size_t>(k)] = run_sample(setup, seed, k, store, progress);
  });
  progress.finish();
  return samples;
}

/// {"samples", "seconds", "remarks", "status"}: what came out of each.
void add_samples(const std::vector<Sample>& samples, const PowderStructures& structures, json& summary) {
  bool usable = true;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    summary["samples"].push_back(sample_json(samples[k]));
    if (k < structures.samples.size()) summary["samples"].back().update(structure_json(structures.samples[k]));
    summary["seconds"].push_back(samples[k].state.system.cost.seconds);
    usable = usable && samples[k].result.usable;
    if (!samples[k].result.usable)
      summary["remarks"].push_back(fmt::format("sample {} is not at rest: {}", k, samples[k].result.reason));
  }
  summary["status"] = usable ? "good" : "not usable";
  for (const std::string& remark : structure_remarks(structures)) summary["remarks"].push_back(remark);
}

/// Means over samples that came to rest; returns the line about them for people.
std::string add_means(const PowderSetup& setup, const std::vector<Sample>& samples, const PowderStructures& structures,
                      json& summary) {
  add_statistics(samples, summary);
  const json none{{"mean", nullptr}, {"deviation", nullptr}};  // no sample came to rest
  const json fraction = summary["statistics"].value("Phi", none);
  const json z = summary["statistics"].value("z", none);
  summary["mean"] = {{"Phi", fraction["mean"]},
                     {"Phi_deviation", fraction["deviation"]},
                     {"z", z["mean"]},
                     {"z_deviation", z["deviation"]}};
  summary["mean"].update(structure_means_json(structures, usable_samples(samples)));
  if (structures.mean_curve) summary["scattering"] = ensemble_fit_json(structures);
  const auto text = [](const json& x, int digits) {
    return x.is_null() ? std::string("-") : fmt::format("{:.{}f}", x.get<double>(), digits);
  };
  return fmt::format("{} samples of {} disks: Phi {} (deviation {}), z {} ({})\n", setup.samples, setup.spec.disks,
                     text(fraction["mean"], 4), text(fraction["deviation"], 4), text(z["mean"], 3),
                     text(z["deviation"], 3));
}

}  // namespace

ExitStatus run_powder_ensemble(const PowderSetup& setup, const Scene& scene, const RunContext& context) {
  const std::uint64_t seed = context.seed(setup.seed);
  const TaskStore store(context, scene, seed);
  const Provenance provenance = context.provenance(scene, seed);
  std::vector<Sample> samples;
  context.guard([&] { samples = run_samples(setup, seed, store, context); });
  const PowderStructures structures = structures_of(samples, setup.structure);
  save_samples(context.path("powder.h5"), samples, structures, setup.spec, provenance);
  json summary{{"kind", "cohesive-powder"}, {"title", setup.title}, {"remarks", json::array()}};
  add_samples(samples, structures, summary);
  std::string people = add_means(setup, samples, structures, summary);
  summary["files"] = {{"powder.h5", context.path("powder.h5")}};
  summary["provenance"] = provenance_json(provenance);
  for (const auto& remark : summary["remarks"]) people += "note: " + remark.get<std::string>() + "\n";
  context.finish(summary, people + "data: " + context.path("powder.h5"));
  store.clear();
  return has_status(summary, RunStatus::good) ? ExitStatus::good : ExitStatus::not_usable;
}

namespace {

ExitStatus run_powder_scene(const Scene& scene, const CommonOptions& options) {
  if (has_powder_variants(scene)) return run_powder_variants(scene, options);
  const PowderSetup setup = read_powder(scene);
  const RunContext context(options, "microsim", std::filesystem::path(scene.path()).stem().string(), {setup.states});
  return run_powder_ensemble(setup, scene, context);
}

void read_any_powder(const Scene& scene) {
  if (has_powder_variants(scene))
    (void)read_powder_variants(scene);
  else
    (void)read_powder(scene);
}

}  // namespace

SceneKind cohesive_powder_kind() {
  return {.name = "cohesive-powder",
          .command = "microsim",
          .run = run_powder_scene,
          .check = [](const Scene& scene, const std::string&, Findings& out) { check_powder(scene, out); },
          .read = read_any_powder};
}

}  // namespace softgrain

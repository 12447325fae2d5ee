// softgrain check: is this file sound, and what follows from it. Runs nothing that takes more than a moment.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <iostream>

#include "common/data/crowd_law.h"
#include "common/data/crowd_measurements.h"
#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/time_step.h"
#include "macrosim/constructed_packing.h"
#include "microsim/grain_box/record.h"
#include "microsim/particles/particles_scene.h"
#include "microsim/shell_packing.h"
#include "pipelines/crowd_law_fit.h"
#include "pipelines/grain_box_check.h"
#include "pipelines/hierarchy_command.h"
#include "pipelines/inverse_command.h"
#include "pipelines/law_table_command.h"
#include "pipelines/kept_states.h"
#include "pipelines/macro_comparison.h"
#include "pipelines/named_laws.h"
#include "pipelines/particles_check.h"
#include "pipelines/pipeline_setup.h"
#include "pipelines/powder_command.h"
#include "pipelines/run_context.h"

namespace softgrain {

namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

/// Lines for people and the same facts for programs.
struct Findings {
  json facts;
  std::string lines;

  void add(const std::string& key, const json& value, const std::string& line) {
    facts[key] = value;
    lines += "  " + line + "\n";
  }
};

double seconds_of(const std::function<void()>& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Loop passes per recorded point of each relaxation, as measured on the published parameters.
double typical_passes(const MeasureSetup& setup, const std::string& relaxation, bool rotated) {
  if (relaxation == "published") return 55000.0;
  if (relaxation == "least-work") {
    if (rotated) return 270.0;
    return setup.least_work.increment_passes > 0 ? 2500.0 : 6700.0;
  }
  return rotated ? 450.0 : 2500.0;
}

struct PointCounts {
  std::int64_t normal = 0;
  std::int64_t rotated = 0;
};

PointCounts count_points(const MeasureSeries& series, PairKind kind) {
  const MeasurementPlan& plan = series.plan(kind);
  return {series.packings * static_cast<std::int64_t>(plan.deltas.size()),
          series.packings * static_cast<std::int64_t>(plan.tangential_deltas.size() * plan.angles_deg.size())};
}

/// Time from one packing and a short trial of the loop on this machine, one thread.
void check_measurements(const MeasureSetup& setup, Findings& out) {
  ShellPacking packing;
  const double packing_time = seconds_of([&] { packing = generate_shell_packing(setup.spec, setup.seed, 0); });
  SoftExperiment e = make_soft_solid(setup.spec, packing, true);
  force_pass(e.system, 0.0);
  constexpr int kTrials = 500;
  const double pass_time = seconds_of([&] {
                             for (int k = 0; k < kTrials; ++k) force_pass(e.system, 0.0);
                           }) /
                           kTrials;
  const StepLimit limit = step_limit(e.system);
  out.add("grains", packing.radius.size(),
          fmt::format("grains in the first packing: {}, solid fraction {:.3f}", packing.radius.size(),
                      packing.solid_fraction()));
  out.add("time_step", setup.published.step_fraction * limit.natural_time,
          fmt::format("time step of the published protocol: {:.3g} s, set by grain {} (radius {:.3g} m) at a stiffness "
                      "of {:.3g} N/m",
                      setup.published.step_fraction * limit.natural_time, limit.body,
                      e.system.particles.sphere[static_cast<std::size_t>(limit.body)].r, limit.stiffness));
  double seconds = packing_time * static_cast<double>(setup.packings());
  for (const MeasureSeries& series : setup.series) {
    for (const PairKind kind : series.kinds) {
      const PointCounts points = count_points(series, kind);
      const double weight =
          (kind == PairKind::soft_soft ? 2.2 : 1.0) * 2.0;  // the squeezed state has about twice the pairs of the first
      seconds += weight * pass_time *
                 (static_cast<double>(points.normal) * typical_passes(setup, series.relaxation, false) +
                  static_cast<double>(points.rotated) * typical_passes(setup, series.relaxation, true));
      out.add(series.relaxation + " " + to_string(kind), json{{"normal", points.normal}, {"rotated", points.rotated}},
              fmt::format("{} {}: {} packings, {} normal and {} rotated states", series.relaxation, to_string(kind),
                          series.packings, points.normal, points.rotated));
    }
  }
  out.add("core_seconds_measuring", seconds, fmt::format("measuring: about {:.0f} s of one core", seconds));
}

struct BodyCounts {
  double all = 0.0;
  double soft = 0.0;
};

/// Scenes by construction are made on trial, in a fraction of a second: how many soft particles fit, and whether the
/// share does, is known only then.
BodyCounts count_bodies(const MacroSetup& setup) {
  const auto bodies = static_cast<double>(setup.spec.bodies);
  if (setup.spec.construction != "voids") return {bodies, setup.spec.soft_share * bodies};
  const SceneFacts facts = describe(make_packing(setup.spec, 1, 0), {});
  return {static_cast<double>(facts.solid + facts.soft), static_cast<double>(facts.soft)};
}

void check_macro(const MacroSetup& setup, double grains_per_soft, Findings& out) {
  const BodyCounts count = count_bodies(setup);
  const double resolved = count.all + count.soft * grains_per_soft;
  constexpr double kBytesPerGrain = 300.0;
  constexpr double kBytesPerContact = 160.0;
  const double memory = resolved * (kBytesPerGrain + 3.0 * kBytesPerContact);
  out.add("macro_bodies", count.all,
          fmt::format("macro: {} samples of {:.0f} bodies, about {:.0f} of them soft, {} test to a strain of {}",
                      setup.samples, count.all, count.soft, setup.spec.test, setup.spec.strain_end));
  for (const std::string& twin : setup.twins)
    out.lines += fmt::format("  resolved twin ({}): about {:.0f} grains per sample\n", twin, resolved);
  if (!setup.twins.empty()) {
    out.facts["twin_grains"] = resolved;
    out.add("twin_bytes", memory, fmt::format("memory of a twin: about {:.1f} MB", memory / 1e6));
  }
}

void check_scene(const std::string& path, const CommonOptions& options, Findings& out) {
  const Scene scene = Scene::load(path, options.overrides);
  const SceneTable root = scene.root();
  const std::string kind = root.choice("kind", {"pipeline", "soft-particle", "macro", "macro-comparison", "particles",
                                                "grain-box", "law-table", "cohesive-powder", "hierarchy", "inverse"});
  out.add("kind", kind, "scene of kind " + kind);
  if (kind == "particles") {
    check_particles(read_particles_scene(scene), out.facts, out.lines);
  } else if (kind == "grain-box") {
    check_grain_box(read_grain_box(scene), out.facts, out.lines);
  } else if (kind == "law-table") {
    check_law_table(scene, out.facts, out.lines);
  } else if (kind == "cohesive-powder") {
    check_powder(scene, out.facts, out.lines);
  } else if (kind == "hierarchy") {
    check_hierarchy(scene, out.facts, out.lines);
  } else if (kind == "inverse") {
    check_inverse(scene, out.facts, out.lines);
  } else if (kind == "macro") {
    (void)root.text("title", "");
    (void)root.text("law", "");
    LawSources choices;
    read_law_choices(root, choices);
    (void)root.count("seed", 0, 1000000000000, 1);
    (void)root.count("contents", 1, 100000, 7);
    (void)read_kept_states(root);
    const MacroSetup macro = read_macro_setup(root.table("macro"), SoftParticleSpec{});
    root.finish();
    check_macro(macro, 400.0, out);
  } else if (kind == "macro-comparison") {
    const MacroComparisonSetup setup = read_macro_comparison(scene);
    out.add("scenes", setup.scenes.size(),
            fmt::format("comparison of laws with twins on {} scenes", setup.scenes.size()));
    for (const ComparisonScene& s : setup.scenes) check_macro(s.setup, 400.0, out);
  } else if (kind == "pipeline") {
    const PipelineSetup setup = read_pipeline_setup(root);
    check_measurements(setup.measure, out);
    if (setup.macro) check_macro(*setup.macro, out.facts["grains"].get<double>(), out);
  } else {
    (void)root.text("title", "");
    const MeasureSetup setup = read_measure_setup(root);
    root.finish();
    check_measurements(setup, out);
  }
}

void check_card(const std::string& path, Findings& out) {
  const LawCard card = load_card(path);
  out.add("kind", "law card", "law card, measured with the " + card.relaxation + " relaxation");
  for (const PairLaw& law : card.pairs)
    out.add(to_string(law.kind), {{"status", law.status}, {"delta_min", law.delta_min}, {"delta_max", law.delta_max}},
            fmt::format("{}: {}, fitted for Delta from {:.3f} to {:.3f} on {} packings, largest grain overlap {:.2f} "
                        "of the smaller radius",
                        to_string(law.kind), law.status, law.delta_min, law.delta_max, law.packings, law.max_overlap));
}

/// "0.712 to 0.745", or one number.
std::string fractions_text(const LawTable& table) {
  const double low = table.entries.front().solid_fraction;
  const double high = table.entries.back().solid_fraction;
  return low == high ? fmt::format("{:.3f}", low) : fmt::format("{:.3f} to {:.3f}", low, high);
}

std::string partners_text(const CrowdLaw& law, PartnerKind kind) {
  const std::vector<PartnerRow> rows = law.rows(kind);
  if (rows.empty()) return fmt::format("no {} neighbours", to_string(kind));
  return fmt::format("{} neighbours of ratio {:.3g} to {:.3g}", to_string(kind), rows.front().ratio, rows.back().ratio);
}

std::string slide_text(const SlideLaw& slide, PartnerKind kind) {
  return fmt::format("{:.3g} and {:.3g} ({})", slide.friction.value, slide.kt_ratio.value, to_string(kind));
}

void check_law(const LawTableEntry& entry, const CrowdLaw& law, json& facts, std::string& lines) {
  facts["laws"].push_back({{"form", law.form},
                           {"status", law.status},
                           {"error_fitted", law.error_fitted},
                           {"error_held_out", law.error_held_out},
                           {"error_cross", law.error_cross}});
  lines += fmt::format(
      "    {}{}: {}{}, off by {:.1f} % on what it was fitted to, {}, {:.1f} % leaving "
      "one out; {}, {}\n",
      law.form, law.form == entry.best ? " (best)" : "", law.status, law.reason.empty() ? "" : " (" + law.reason + ")",
      100.0 * law.error_fitted, held_out_text(law), 100.0 * law.error_cross, partners_text(law, PartnerKind::solid),
      partners_text(law, PartnerKind::soft));
}

void check_entry(const LawTableEntry& e, Findings& out) {
  json facts{
      {"solid_fraction", e.solid_fraction}, {"packings", e.packings},       {"best", e.best},
      {"volume_max", e.volume_max},         {"overlap_max", e.overlap_max}, {"grain_overlap_max", e.grain_overlap_max}};
  out.lines += fmt::format(
      "  solid fraction {:.4f} +- {:.4f}: {} packings, {} relaxation, grains of nu = {}, mu = {}\n"
      "    valid up to a lost volume of {:.3f} and an overlap of {:.3f} Rs with a plane, where grains overlap by "
      "{:.2f} of "
      "the smaller radius\n"
      "    unloading {:.3g} times as steep; friction limit and kt/kn: {}, {}, {}\n",
      e.solid_fraction, e.solid_fraction_error, e.packings, e.relaxation, e.spec.poisson_ratio, e.spec.friction,
      e.volume_max, e.overlap_max, e.grain_overlap_max, e.retreat.value, slide_text(e.slide_plane, PartnerKind::plane),
      slide_text(e.slide_solid, PartnerKind::solid), slide_text(e.slide_soft, PartnerKind::soft));
  for (const CrowdLaw& law : e.laws) check_law(e, law, facts, out.lines);
  out.facts["entries"].push_back(facts);
}

void check_table(const std::string& path, Findings& out) {
  const LawTable table = load_law_table(path);
  out.add("kind", "law table",
          fmt::format("law table: {} entries, solid fraction {}", table.entries.size(), fractions_text(table)));
  for (const LawTableEntry& e : table.entries) check_entry(e, out);
}

void check_laws(const std::string& path, Findings& out) {
  if (law_file_kind(path) == LawFileKind::table)
    check_table(path, out);
  else
    check_card(path, out);
}

void check_data(const std::string& path, Findings& out) {
  const h5::Group root = h5::open_file(path);
  if (root.has("configurations")) {
    const CrowdMeasurements data = load_crowd(path);
    out.add("kind", "crowd measurements",
            fmt::format("crowd measurements: {} configurations, {} packings, {} runs", data.configurations.size(),
                        data.packings.size(), data.runs.size()));
    return;
  }
  if (root.has("runs")) {
    const Measurements data = load_measurements(path);
    out.add("kind", "measurements",
            fmt::format("measurements: {} packings, {} runs", data.packings.size(), data.runs.size()));
    return;
  }
  if (root.has("packs")) {
    const auto packs = load_grain_boxes(path);
    out.add("kind", "grain boxes", fmt::format("grain boxes: {} packs", packs.size()));
    return;
  }
  if (root.has("curves")) {
    const auto curves = load_macro(path);
    out.add("kind", "macro curves", fmt::format("macro curves: {}", curves.size()));
    return;
  }
  std::string names;
  for (const std::string& child : root.children()) names += (names.empty() ? "" : ", ") + child;
  out.add("kind", "HDF5", "readable HDF5 file with " + names);
}

/// Laws and scenes are both TOML; cards and tables of laws have a schema at the top.
bool holds_laws(const std::string& path) { return Scene::load(path).root().has("schema"); }

}  // namespace

ExitStatus command_check(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("check: give one file");
  const std::string& path = options.inputs[0];
  Findings out;
  if (std::filesystem::path(path).extension() == ".h5")
    check_data(path, out);
  else if (holds_laws(path))
    check_laws(path, out);
  else
    check_scene(path, options, out);
  out.facts["status"] = "good";
  if (options.json)
    std::cout << out.facts.dump(2) << "\n";
  else
    std::cout << path << ": sound\n" << out.lines;
  return ExitStatus::good;
}

}  // namespace softgrain

#include "pipelines/kinds/macro/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "common/core/few_samples.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "pipelines/kinds/macro/bands.h"
#include "pipelines/kinds/macro/check.h"
#include "pipelines/kinds/macro/lammps_stage.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/law/law_library_press.h"
#include "pipelines/run/run.h"

namespace softgrain {

namespace {

std::string lateral_ratio(const MacroCurve& c) {
  if (c.stress_axial.back() == 0.0) return "undefined (no axial stress)";
  return fmt::format("{:.3f}", c.stress_lateral.back() / c.stress_axial.back());
}

/// A slope whose error is as large as itself is none.
std::string modulus_text(const MeanError& m) {
  if (is_told_from_zero(m.n, m.mean, m.error)) return pressure_text(m);
  return fmt::format("not determined ({}, {})", pressure_text(m), counted(m.n, "sample"));
}

/// Moduli and strength of one stage of one engine.
std::string stage_line(const std::string& engine, const StageMeans& s) {
  std::string line = fmt::format("{}, stage {}:", engine, s.record.name);
  if (const std::string modulus = modulus_text(s); !modulus.empty()) line += " " + modulus + ",";
  if (s.modulus_begin && s.record.kind != StageKind::hold)
    line += fmt::format(" tangent at its beginning {},", modulus_text(*s.modulus_begin));
  if (s.axial_end) line += fmt::format(" axial stress {},", pressure_text(*s.axial_end));
  if (s.lateral_ratio) line += fmt::format(" K0 {},", with_error(*s.lateral_ratio, {.value = {3}}));
  if (s.ratio_peak) line += fmt::format(" q/p {} at most,", with_error(*s.ratio_peak));
  if (s.ratio_end) line += fmt::format(" {} at its end,", with_error(*s.ratio_end));
  if (s.friction_peak) line += fmt::format(" shear over normal stress {} at most,", with_error(*s.friction_peak));
  if (s.friction_end) line += fmt::format(" {} at its end,", with_error(*s.friction_end));
  line.back() = '\n';
  return line;
}

std::string console_summary(const LawIdentity& law, const std::vector<MacroCurve>& curves) {
  std::string text = "law: " + identity_text(law) + "\n";
  if (const auto density = density_of(curves, curves.front().engine)) text += density_text(*density) + "\n";
  for (const MacroCurve& c : curves) {
    const EndStrain strain = strain_at_end(c);
    text += fmt::format("{} sample {}: axial stress {:.5g} Pa at {} {:.3f}, lateral ratio {}, {:.1f} s{}\n", c.engine,
                        c.sample, c.stress_axial.back(), strain.name, strain.value, lateral_ratio(c), c.cost.seconds,
                        c.usable ? "" : " (" + c.note + ")");
  }
  std::vector<std::string> engines;
  for (const MacroCurve& c : curves)
    if (std::ranges::find(engines, c.engine) == engines.end()) engines.push_back(c.engine);
  for (const std::string& engine : engines)
    for (const StageMeans& s : stage_means(curves, engine)) text += stage_line(engine, s);
  return text;
}

NamedLaws law_of(const MacroScene& scene, const std::vector<ShellPacking>& contents) {
  return scene_law(scene.law, scene.setup.spec, contents.empty() ? 0.0 : mean_solid_fraction(contents), "law");
}

/// What the law does beside the shelled twin; nothing to compare is a remark, as all that was computed is kept.
void compare_with_twin(const std::vector<MacroCurve>& curves, MacroRunSummary& summary) {
  try {
    const Comparison c = compare_curves(curves_of(curves, "law"), curves_of(curves, "shelled"));
    summary.runs.comparison = summary_of(c);
    for (const std::string& one : c.undefined) summary.head.mark_unusable("law and twin: " + one);
  } catch (const ZeroReference& e) {
    summary.head.mark_unusable(std::string("law and twin cannot be compared: ") + e.what());
  } catch (const InputError& e) {
    summary.head.remarks.push_back(std::string("law and twin cannot be compared: ") + e.what());
  }
}

MacroRunSummary summarise(const MacroScene& scene, const LawIdentity& law, const std::vector<MacroCurve>& curves,
                          bool usable) {
  MacroRunSummary summary;
  const bool resolved = has_twin(scene.setup, Twin::shelled);
  summary.head = {usable ? RunStatus::good : RunStatus::not_usable, scene.title, macro_remarks(curves), {}};
  summary.head.warnings = macro_warnings(curves);
  if (!scene.setup.given)
    for (const std::string& one : first_point_remarks(scene.setup.spec, curves)) summary.head.remarks.push_back(one);
  summary.law = {law, scene.law_file};
  summary.runs.macro = summary_of(curves, "law");
  if (resolved) summary.runs.resolved = summary_of(curves, "shelled");
  if (has_twin(scene.setup, Twin::free)) summary.runs.free = summary_of(curves, "free");
  if (std::string text = negative_tangents_text(tangents_of(summary.runs.macro->stages)); !text.empty())
    summary.head.warnings.push_back(std::move(text));
  if (const std::string assumed = assumed_text(scene.setup); !assumed.empty()) summary.head.remarks.push_back(assumed);
  for (std::string& one : scene.law.remarks()) summary.head.remarks.push_back(std::move(one));
  if (resolved && usable) compare_with_twin(curves, summary);
  return summary;
}

LammpsRuns lammps_runs(const MacroScene& scene, const NamedLaws& law, const std::vector<ShellPacking>& contents,
                       const Provenance& provenance) {
  MacroSetup setup = scene.setup;
  setup.spec = law_spec(scene.setup);
  return {std::move(setup), law, mean_solid_fraction(contents), scene.title,
          lammps_identity(provenance, scene.law.text())};
}

constexpr const char* kInitialFile = "macro_initial.h5";

/// Bodies that LAMMPS is still to bring into touch are no starting state.
void save_if_prepared(const MacroScene& scene, const std::vector<MacroPacking>& packings, const Run& run) {
  if (scene.setup.spec.preparation != Preparation::lammps) save_packings(packings, run, kInitialFile);
}

/// Where LAMMPS works on each sample.
void add_directories(std::int64_t samples, const RunContext& context, MacroRunSummary& summary) {
  for (std::int64_t k = 0; k < samples; ++k)
    summary.head.files["lammps_" + std::to_string(k)] = lammps_directory(context, k);
}

/// The input of LAMMPS, to be run elsewhere or with --resume; the packings stay in the store for that.
ExitStatus write_only(const MacroScene& scene, const NamedLaws& law, const std::vector<ShellPacking>& contents,
                      const Run& run) {
  run.guard([&] {
    const auto packings = prepare_packings(scene.setup, run, kInitialFile);
    save_if_prepared(scene, packings, run);
    write_lammps_files(lammps_runs(scene, law, contents, run.provenance), packings, run.context);
  });
  MacroRunSummary summary;
  summary.head = {RunStatus::written, scene.title, {"nothing was run"}, {}};
  summary.law = {law.identity, scene.law_file};
  add_directories(scene.setup.samples, run.context, summary);
  run.context.finish(
      json_of(summary), run.provenance,
      written_text(lammps_directory(run.context, 0) +
                   (scene.setup.samples > 1 ? fmt::format(" to lammps-{}", scene.setup.samples - 1) : "")));
  return ExitStatus::good;
}

std::vector<MacroCurve> curves_of_run(const MacroScene& scene, const std::optional<LammpsEngine>& lammps,
                                      const NamedLaws& law, const std::vector<ShellPacking>& contents, const Run& run,
                                      const std::vector<LawDraws>& draws, std::vector<BandRecord>& bands) {
  if (!lammps) return run_macro_stage(scene.setup, {law}, contents, run, draws, bands);
  auto packings = prepare_packings(scene.setup, run, kInitialFile);
  save_if_prepared(scene, packings, run);
  const LammpsRuns runs = lammps_runs(scene, law, contents, run.provenance);
  write_lammps_files(runs, packings, run.context);
  auto outcomes = run_with_lammps(runs, *lammps, packings, run.context);
  if (scene.setup.spec.preparation == Preparation::lammps) save_packings(packings, run, kInitialFile);
  auto curves = run_engines({scene.setup, packings, contents, run.seed, "macro"}, {}, run, "states_macro.h5",
                            std::move(outcomes));
  save_macro(curves, run.path("macro.h5"), run.provenance);
  return curves;
}

/// Cells, which have no laws of contacts: their engine's name alone.
NamedLaws engine_of_cells() {
  NamedLaws out;
  out.name = "law";
  return out;
}

/// Draws of the law for its bands.
std::vector<LawDraws> draws_of(const MacroScene& scene, const NamedLaws& law,
                               const std::vector<ShellPacking>& contents) {
  return draws_for(scene.setup, scene.law, {law}, contents.empty() ? 0.0 : mean_solid_fraction(contents));
}

/// Checks before any work that the law has draws for bands. Throws InputError.
void require_draws(const MacroScene& scene, bool lammps) {
  if (lammps) throw InputError("bands: runs in LAMMPS have none; leave --engine lammps out, or bands");
  const bool cells = scene.law.cells() != nullptr;
  (void)draws_of(scene, cells ? engine_of_cells() : scene_law(scene.law, scene.setup.spec, 0.0, "law"), {});
}

/// Runs in LAMMPS are not run again. Throws InputError.
void require_noise(const Scene& scene, const MacroSetup& setup, bool lammps) {
  if (lammps && setup.noise_samples > 0 && setup.twins.empty())
    scene.root().table("macro").throw_error(
        "noise_samples",
        "LAMMPS runs each sample once: goes with a resolved twin, or without --engine lammps; must be 0");
}

/// The scene with its law, and what runs it; all that can be refused is, before anything is made.
struct ReadyMacro {
  MacroScene macro;
  std::optional<LammpsEngine> lammps;
};

/// With the bands and the law of the command line.
MacroScene read_with_options(const Scene& scene, const CommonOptions& options) {
  MacroScene macro = read_macro_scene(scene, options.law);
  if (options.bands > 0) macro.setup.bands = options.bands;
  if (macro.setup.bands == 0 && scene.root().table("macro").has("band_estimator"))
    scene.root().table("macro").throw_error("band_estimator",
                                            "goes with bands, the number of draws of the law, or --bands");
  // A card without a usable law is refused before soft particles are packed.
  if (macro.law.card() != nullptr) (void)scene_law(macro.law, macro.setup.spec, 0.0, "law");
  return macro;
}

ReadyMacro ready_macro(const Scene& scene, const CommonOptions& options) {
  ReadyMacro ready{read_with_options(scene, options), std::nullopt};
  MacroScene& macro = ready.macro;
  if (macro.law_file.empty())
    scene.root().throw_error(
        "law", "no law: give --law law.toml (a card) or --law law_table.toml (a table), or the key law in the scene");
  const std::optional<LammpsEngine> lammps = ready.lammps = read_engine(options, macro.setup.spec.bodies);
  if (macro.setup.spec.preparation == Preparation::lammps && !lammps)
    throw InputError("key macro.preparation = \"lammps\" needs --engine lammps");
  if (macro.setup.spec.balance != Balance::mean_force && lammps)
    throw InputError(
        "--engine lammps: LAMMPS compares net forces with the mean contact force alone; leave it out, or balance");
  if (macro.law.cells() != nullptr && lammps) throw InputError("--engine lammps: LAMMPS knows no cells; leave it out");
  if (lammps) refuse_sliding(macro.setup.spec);
  if (lammps && macro.law.unloading_ratio > 1.0)
    scene.root().throw_error("unloading_ratio",
                             "--engine lammps: soft particles of LAMMPS remember nothing; leave it out");
  if (macro.setup.bands > 0) require_draws(macro, lammps.has_value());
  require_noise(scene, macro.setup, lammps.has_value());
  return ready;
}

namespace {

/// The law that was fitted to a press test, for other scenes, and what its fit had to say.
void keep_fitted_law(const LawCard& card, const Run& run, MacroRunSummary& summary) {
  save_card(card, run.path("law.toml"), run.provenance);
  summary.head.files["law"] = run.path("law.toml");
  for (const std::string& note : card.notes) summary.head.remarks.push_back("press test: " + note);
  for (const PairLaw& law : card.pairs)
    summary.head.remarks.push_back(fmt::format("press test: {}: {}", to_string(law.kind), unloading_text(law)));
}

}  // namespace

ExitStatus run_macro_scene(const Scene& scene, const CommonOptions& options) {
  const ReadyMacro ready = ready_macro(scene, options);
  const MacroScene& macro = ready.macro;
  const std::optional<LammpsEngine>& lammps = ready.lammps;
  const Run run(scene, options, "macrosim",
                {macro.seed, macro.law.files(), macro.law.text() + sizes_text(macro.setup.spec)});
  const auto contents =
      macro.setup.twins.empty() ? std::vector<ShellPacking>{} : make_contents(macro.spec, macro.contents, run.seed);
  std::optional<NamedLaws> law;  // none with cells
  if (macro.law.cells() == nullptr) law = law_of(macro, contents);
  if (lammps && lammps->write_only) return write_only(macro, *law, contents, run);
  std::vector<MacroCurve> curves;
  std::vector<BandRecord> bands;
  run.guard([&] {
    curves = law ? curves_of_run(macro, lammps, *law, contents, run, draws_of(macro, *law, contents), bands)
                 : run_macro_stage(macro.setup, {}, {}, run, draws_of(macro, engine_of_cells(), {}), bands);
  });
  const LawIdentity identity = law ? law->identity : curves.front().law;
  const bool usable =
      all_carry_stress(curves) && std::ranges::all_of(curves, [](const MacroCurve& c) { return c.usable; });
  MacroRunSummary summary = summarise(macro, identity, curves, usable);
  summary.bands = bands;
  summary.band_ends = banded_ends(curves);
  for (const std::string& one : missing_bands(bands, summary.band_ends)) summary.head.warnings.push_back(one);
  summary.head.files = {
      {"macro", run.path("macro.h5")}, {"initial", run.path("macro_initial.h5")}, {"report", run.path("report.html")}};
  if (macro.law.card() != nullptr && is_curve_file(macro.law_file)) keep_fitted_law(*macro.law.card(), run, summary);
  summary.head.sizes = summaries_of(drawn_sizes(macro.setup, run.seed));
  if (lammps) {
    summary.engine = engine_use(*lammps, lammps_directory(run.context, 0));
    add_directories(macro.setup.samples, run.context, summary);
  }
  return run.finish(json_of(summary), console_summary(identity, curves) + bands_text(bands, summary.band_ends));
}

void check_with_options(const Scene& scene, const CommonOptions& options, Findings& out) {
  const MacroScene macro = read_with_options(scene, options);
  if (macro.setup.bands > 0 && !macro.law_file.empty())
    require_draws(macro, macro.setup.spec.preparation == Preparation::lammps);
  require_noise(scene, macro.setup, macro.setup.spec.preparation == Preparation::lammps);
  check_macro_scene(macro, out);
}

/// As SceneKind::starter.
constexpr const char* kMacroStarter = R"(title = "Compression of solid grains and soft particles"
seed = 1
law = "../results/law_table/law_table.toml"
[macro]
bodies = 60
soft_share = 0.45
test = "oedometric"
strain = 0.15
steps = 10
resolved = false
)";

}  // namespace

SceneKind macro_kind() {
  return {.name = "macro",
          .command = "macrosim",
          .run = run_macro_scene,
          .check = check_with_options,
          .read = [](const Scene& scene) { (void)read_macro_scene_alone(scene); },
          .refuse = [](const Scene& scene, const CommonOptions& options) { (void)ready_macro(scene, options); },
          .results = macro_results(),
          .summary = members_of<MacroRunSummary>,
          .takes_law = true,
          .takes_engine = true,
          .keeps = {.packings = true, .twins = true},
          .explored_from = {"", explored_stages()},
          .starter = kMacroStarter};
}

}  // namespace softgrain

#include "pipelines/kinds/macro_comparison/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/text.h"
#include "common/io/text_file.h"
#include "pipelines/compare/compare.h"
#include "pipelines/kinds/macro/bands.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro_comparison/summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// What a scene left behind.
struct SceneResult {
  std::string name;
  MacroSpec spec;
  std::string file;  ///< name of its curves in the run directory
  std::vector<SceneFacts> facts;
  std::vector<EngineScore> scores;
  std::vector<NamedLaws> laws;
  std::vector<BandRecord> bands;
  std::vector<std::string> warnings;
  std::vector<std::string> remarks;
  bool usable = true;
};

/// The voids between bodies are empty in these scenes: without shells the contents spread into them.
void remark_spread(SceneResult& r) {
  for (const EngineScore& s : r.scores)
    if (s.twin() == Twin::free && s.shelled.axial_end.n > 0 && s.shelled.axial_end.mean < 0.2)
      r.remarks.push_back(
          fmt::format("{}: the free twin carries {:.2g} of the stress of the shelled one: without shells the grains "
                      "spread into the "
                      "voids between bodies, and these must be strained away before they bear",
                      r.name, s.shelled.axial_end.mean));
}

void remark_notes(const std::vector<MacroCurve>& curves, SceneResult& r) {
  for (const MacroCurve& c : curves) r.usable = r.usable && c.usable;
  for (std::string& one : run_warnings(curves, r.name + ", ")) r.warnings.push_back(std::move(one));
  for (std::string& note : run_notes(curves, r.name + ", ")) r.remarks.push_back(std::move(note));
}

/// Solid fraction of soft particles, at which a table is taken; 0: that of its main entry.
double inside_fraction(const ComparisonScene& scene, const std::vector<ShellPacking>& contents) {
  return scene.by_own_law() ? 0.0 : mean_solid_fraction(contents);
}

/// Soft particles hold what the law says, whatever its levels; of radii inside it knows nothing.
SceneFacts facts_by_law(const MacroPacking& packing, const LawSources& sources) {
  SceneFacts facts = describe(packing, {});
  facts.exponent = {kUnknown, kUnknown};
  facts.largest_over_smallest = kUnknown;
  if (sources.table() == nullptr) return facts;
  std::string remark;
  const LawTableEntry entry = law_entry(sources, 0.0, remark);
  facts.inner_grains = std::llround(static_cast<double>(facts.soft) * entry.grains);
  facts.solid_fraction = facts.body_fraction * (1.0 - facts.soft_share * (1.0 - entry.solid_fraction));
  return facts;
}

SceneResult run_scene(const ComparisonScene& scene, const MacroComparisonSetup& setup,
                      const std::vector<ShellPacking>& contents, const Run& run) {
  SceneResult r{scene.name, scene.setup.spec, "macro_" + scene.name + ".h5", {}, {}, {}, {}, {}, {}, true};
  const auto packings = make_macro_packings(scene.setup, run, "macro_initial_" + scene.name + ".h5");
  const LawSources& sources = setup.laws_of(scene);
  const double fraction = inside_fraction(scene, contents);
  for (const MacroPacking& p : packings)
    r.facts.push_back(scene.by_own_law() ? facts_by_law(p, sources) : describe(p, contents));
  r.laws = laws_for(sources, scene.setup.spec, fraction);
  const MacroRuns runs{scene.setup, packings, contents, run.seed, scene.name};
  auto curves = run_engines(runs, r.laws, run, "states_macro_" + scene.name + ".h5");
  r.bands = add_bands(runs, draws_for(scene.setup, sources, r.laws, fraction), run, curves);
  save_macro(curves, run.path(r.file), run.provenance);
  r.scores = score_engines(curves);
  r.usable = r.usable && all_carry_stress(curves);
  remark_notes(curves, r);
  remark_spread(r);
  return r;
}

ComparedScene summary_of(const SceneResult& r) {
  ComparedScene out{r.name, {}, r.spec.test, r.spec.construction, r.spec.soft_share, r.file, r.facts, r.scores};
  for (const NamedLaws& l : r.laws) out.laws.push_back(l.identity);
  out.bands = r.bands;
  return out;
}

/// One row per scene and engine, the scene in the first column.
ScoreTable whole_table(const std::vector<SceneResult>& results) {
  ScoreTable all;
  for (const SceneResult& r : results) {
    ScoreTable part = score_table(r.scores);
    if (all.header.empty()) {
      all.header = std::move(part.header);
      all.header.insert(all.header.begin(), "scene");
    }
    for (auto& row : part.rows) {
      row.insert(row.begin(), r.name);
      all.rows.push_back(std::move(row));
    }
  }
  return all;
}

void write_tables(const ScoreTable& scores, const Run& run) {
  const TextTable table{scores.header, scores.rows};
  write_text_atomic(run.path("table.md"), as_markdown(table));
  write_text_atomic(run.path("table.csv"), as_csv(table));
}

std::string console_summary(const std::vector<SceneResult>& results, const Run& run) {
  std::string text;
  for (const SceneResult& r : results)
    for (const EngineScore& s : r.scores) {
      text +=
          fmt::format("{}, {}: axial stress {:.4g} Pa, {:.3g} s per sample", r.name, s.engine, s.axial.mean, s.seconds);
      const ComparedQuantity off = headline_of(s.shelled);
      if (off.value.n > 0 && std::isfinite(s.shelled.speedup_evaluations))
        text += fmt::format("; against shelled: {} error {:.3g} %, {}{:.3g} times fewer contact evaluations", off.what,
                            100.0 * off.value.mean,
                            s.shelled.unloading.n > 0
                                ? fmt::format("unloading modulus {:.3g} times its own, ", s.shelled.unloading.mean)
                                : "",
                            s.shelled.speedup_evaluations);
      text += "\n";
    }
  return text + "table: " + run.path("table.md") + "\n";
}

/// The packings of a comparison should be those that the laws were measured on; of a table the entry that is taken for
/// contents of this solid fraction.
std::vector<std::string> law_remarks(const SoftParticleSpec& mine, const LawSources& laws, double contents_fraction) {
  std::vector<std::string> out;
  const auto compare = [&](const SoftParticleSpec& law, const char* what) {
    const bool same = same_sizes(law, mine) && law.beta == mine.beta && law.friction == mine.friction &&
                      law.poisson_ratio == mine.poisson_ratio;
    if (!packing_known(law))
      out.push_back(fmt::format(
          "the {} does not say what is inside the soft particle that was measured; the twins are filled as this scene "
          "says",
          what));
    else if (!same)
      out.push_back(fmt::format(
          "the {} was measured on soft particles of another packing or material than those of the twins", what));
  };
  std::string said_with_its_law;
  if (laws.table() != nullptr) compare(law_entry(laws, contents_fraction, said_with_its_law).spec, "law table");
  if (laws.card() != nullptr) compare(laws.card()->spec, "law card");
  return out;
}

MacroComparisonSummary summarise(const MacroComparisonSetup& setup, const std::vector<ShellPacking>& contents,
                                 const std::vector<SceneResult>& results, const Run& run) {
  MacroComparisonSummary s;
  s.head.title = setup.title;
  const auto say_once = [&](const std::vector<std::string>& remarks) {
    for (const std::string& one : remarks)
      if (std::ranges::find(s.head.remarks, one) == s.head.remarks.end()) s.head.remarks.push_back(one);
  };
  for (const ComparisonScene& scene : setup.scenes) {
    const LawSources& laws = setup.laws_of(scene);
    say_once(laws.remarks());
    if (!scene.by_own_law()) say_once(law_remarks(setup.spec, laws, inside_fraction(scene, contents)));
  }
  for (const SceneResult& r : results) {
    if (!r.usable) s.head.status = RunStatus::not_usable;
    s.compared.scenes.push_back(summary_of(r));
    s.head.warnings.insert(s.head.warnings.end(), r.warnings.begin(), r.warnings.end());
    s.head.remarks.insert(s.head.remarks.end(), r.remarks.begin(), r.remarks.end());
    s.head.files["macro_" + r.name] = run.path(r.file);
  }
  for (const ComparisonScene& scene : setup.scenes)
    for (const SizesSummary& sizes : summaries_of(drawn_sizes(scene.setup, run.seed, scene.name + ": ")))
      s.head.sizes.push_back(sizes);
  for (const char* file : {"comparison.json", "table.md", "table.csv", "report.html"})
    s.head.files[file] = run.path(file);
  return s;
}

RunInputs inputs_of(const MacroComparisonSetup& setup) {
  std::string sizes = sizes_text(setup.spec);
  std::vector<std::string> files = setup.laws.files();
  std::string text = setup.laws.text();
  for (const ComparisonScene& s : setup.scenes) {
    sizes += sizes_text(s.setup.spec);
    if (!s.laws) continue;
    for (const std::string& file : s.laws->files()) files.push_back(file);
    text += s.laws->text();
  }
  return {setup.seed, std::move(files), text + sizes};
}

Outcome run_macro_comparison(const MacroComparisonSetup& setup, const Run& run) {
  const auto contents = make_contents(setup.spec, setup.contents, run.seed);
  for (const ComparisonScene& s : setup.scenes) {  // before any run
    const double fraction = inside_fraction(s, contents);
    (void)draws_for(s.setup, setup.laws_of(s), laws_for(setup.laws_of(s), s.setup.spec, fraction), fraction);
  }
  std::vector<SceneResult> results;
  run.guard([&] {
    for (const ComparisonScene& s : setup.scenes) results.push_back(run_scene(s, setup, contents, run));
  });
  const MacroComparisonSummary summary = summarise(setup, contents, results, run);
  write_text_atomic(run.path("comparison.json"),
                    json_of(summary.compared).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  write_tables(whole_table(results), run);
  return {json_of(summary), console_summary(results, run)};
}

/// As SceneKind::starter.
constexpr const char* kMacroComparisonStarter = R"(title = "A law against its resolved twin"
seed = 1
[packing]
polydispersity = 3.0
trials = 200
count = 2
[law]
card = "../results/published/law.toml"
[macro]
construction = "voids"
bodies = 20
soft_share = 0.35
soft_radius_max = "12 mm"
soft_polydispersity = 2.0
steps = 5
strain = 0.15
[[scene]]
samples = 2
[[scene]]
test = "shear"
preload = 0.05
preload_steps = 2
strain = 0.05
)";

}  // namespace

SceneKind macro_comparison_kind() {
  return scene_kind(TypedKind<MacroComparisonSetup>{.name = "macro-comparison",
                                                    .command = "run",
                                                    .read = read_macro_comparison,
                                                    .inputs = inputs_of,
                                                    .run = run_macro_comparison,
                                                    .check = check_macro_comparison,
                                                    .results = macro_comparison_results(),
                                                    .summary = members_of<MacroComparisonSummary>,
                                                    .keeps = {.packings = true, .twins = true},
                                                    .explored_from = {"", explored_stages(), explored_stages("scene")},
                                                    .starter = kMacroComparisonStarter});
}

}  // namespace softgrain

// softgrain macrosim: one macro scene with a law card or a law table, and its resolved twin when the scene asks for it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "pipelines/compare/compare.h"
#include "pipelines/kept_states.h"
#include "pipelines/macro_stage.h"
#include "pipelines/report/report.h"
#include "pipelines/run_context.h"
#include "pipelines/run_summary.h"
#include "pipelines/scene_kind.h"

namespace softgrain {

namespace {

std::string law_path(const Scene& scene, const SceneTable& root, const CommonOptions& options) {
  const std::string written = root.text("law", "");
  if (!options.law.empty()) return options.law;
  if (written.empty())
    root.reject("law",
                "no law: give --law law.toml (a card) or --law law_table.toml (a table), or the key law in the scene");
  return scene.resolve(written);
}

std::string people_text(const std::vector<MacroCurve>& curves, const RunContext& context) {
  std::string text;
  for (const MacroCurve& c : curves)
    text += fmt::format("{} sample {}: axial stress {:.5g} Pa at strain {:.3f}, lateral ratio {:.3f}, {:.1f} s{}\n",
                        c.engine, c.sample, c.stress_axial.back(), c.strain.back(),
                        c.stress_lateral.back() / c.stress_axial.back(), c.cost.seconds,
                        c.usable ? "" : " (" + c.note + ")");
  return text + "report: " + context.path("report.html");
}

struct MacroScene {
  std::string title;
  std::uint64_t seed = 1;
  std::string law_file;
  LawSources law;
  MacroSetup setup;
  SoftParticleSpec spec;      ///< that the law was measured on, and of the contents of twins
  std::int64_t contents = 7;  ///< number of different ones
};

/// What the laws were measured on; of a table its first entry.
const SoftParticleSpec& measured_spec(const LawSources& law) {
  return law.card ? law.card->spec : law.table->entries.front().spec;
}

MacroScene read_macro_scene(const Scene& scene, const CommonOptions& options) {
  const SceneTable root = scene.root();
  refuse_other_commands(root, "macrosim");
  (void)root.choice("kind", {"macro"});
  MacroScene out;
  out.title = root.text("title", "");
  out.seed = static_cast<std::uint64_t>(root.count("seed", 0, 1000000000000, 1));
  out.law_file = law_path(scene, root, options);
  out.law = read_scene_law(root, out.law_file);
  out.spec = measured_spec(out.law);
  out.setup = read_macro_setup(root.table("macro"), out.spec);
  out.setup.kept_states = read_kept_states(root);
  out.contents = root.count("contents", 1, 100000, out.contents);
  root.finish();
  return out;
}

/// At the solid fraction of the contents, when there are any.
NamedLaws law_of(const MacroScene& scene, const std::vector<ShellPacking>& contents) {
  double fraction = mean_solid_fraction(contents);
  if (contents.empty() && scene.law.table) fraction = scene.law.table->entries.front().solid_fraction;
  return scene_law(scene.law, scene.setup.spec, fraction, "law");
}

/// What the law does beside the shelled twin; nothing to compare is a remark, as all that was computed is kept.
void compare_with_twin(const std::vector<MacroCurve>& curves, nlohmann::json& summary) {
  try {
    const Comparison c = compare_curves(curves_of(curves, "law"), curves_of(curves, "shelled"));
    summary["comparison"] = {{"stress_error", c.axial_difference.mean},
                             {"speedup_seconds", c.speedup_seconds},
                             {"speedup_contact_evaluations", c.speedup_contact_evaluations}};
  } catch (const BadInput& e) {
    summary["remarks"].push_back(std::string("law and twin cannot be compared: ") + e.what());
  }
}

nlohmann::json summarise(const MacroScene& scene, const NamedLaws& law, const std::vector<MacroCurve>& curves,
                         bool usable) {
  nlohmann::json summary;
  const bool resolved = has_twin(scene.setup, "shelled");
  summary["status"] = usable ? "good" : "not usable";
  summary["title"] = scene.title;
  summary["law"] = {{"file", scene.law_file}, {"form", law.form}};
  summary["macro"] = macro_json(curves, "law");
  if (resolved) summary["resolved"] = macro_json(curves, "shelled");
  if (has_twin(scene.setup, "free")) summary["free"] = macro_json(curves, "free");
  summary["remarks"] = macro_remarks(curves);
  if (resolved && usable) compare_with_twin(curves, summary);
  return summary;
}

}  // namespace

ExitStatus command_macrosim(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("macrosim: give one scene file");
  const Scene scene = Scene::load(options.inputs[0], options.overrides);
  const MacroScene macro = read_macro_scene(scene, options);
  const RunContext context(options, "macrosim", std::filesystem::path(scene.path()).stem().string());
  const std::uint64_t seed = context.seed(macro.seed);
  const Provenance provenance = context.provenance(scene, seed);
  const TaskStore store(context, scene, seed, macro.law.text);
  const auto contents =
      macro.setup.twins.empty() ? std::vector<ShellPacking>{} : make_contents(macro.spec, macro.contents, seed);
  const NamedLaws law = law_of(macro, contents);
  std::vector<MacroCurve> curves;
  context.guard([&] { curves = run_macro_stage(macro.setup, law, contents, seed, store, context, provenance); });

  const bool usable = std::all_of(curves.begin(), curves.end(), [](const MacroCurve& c) { return c.usable; });
  nlohmann::json summary = summarise(macro, law, curves, usable);
  summary["files"] = {{"macro", context.path("macro.h5")},
                      {"initial", context.path("macro_initial.h5")},
                      {"report", context.path("report.html")}};
  summary["provenance"] = provenance_json(provenance);
  context.finish(summary, people_text(curves, context));
  write_report(context.directory());
  store.clear();
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain

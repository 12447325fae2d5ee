// softgrain macrosim: one macro scene with a law card, and its resolved twin when the scene asks for it.
#include <fmt/format.h>

#include <filesystem>

#include "pipelines/compare/compare.h"
#include "pipelines/macro_stage.h"
#include "pipelines/report/report.h"
#include "pipelines/run_context.h"
#include "pipelines/run_summary.h"

namespace softgrain {

namespace {

std::string law_path(const Scene& scene, const SceneTable& root, const CommonOptions& options) {
  const std::string written = root.text("law", "");
  if (!options.law.empty()) return options.law;
  if (written.empty()) root.reject("law", "no law card: give --law law.toml, or the key law in the scene");
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

}  // namespace

ExitStatus command_macrosim(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("macrosim: give one scene file");
  const Scene scene = Scene::load(options.inputs[0], options.overrides);
  const SceneTable root = scene.root();
  (void)root.choice("kind", {"macro"});
  const std::string title = root.text("title", "");
  const auto scene_seed = static_cast<std::uint64_t>(root.count("seed", 0, 1000000000000, 1));
  const LawCard card = load_card(law_path(scene, root, options));
  const MacroSetup setup = read_macro_setup(root.table("macro"), card.spec);
  const std::int64_t contents_count = root.count("contents", 1, 100000, 7);
  root.finish();
  const RunContext context(options, "macrosim", std::filesystem::path(scene.path()).stem().string());
  const std::uint64_t seed = context.seed(scene_seed);
  const TaskStore store(context, scene, seed);
  const auto contents =
      !setup.twins.empty() ? make_contents(card.spec, contents_count, seed) : std::vector<ShellPacking>{};
  std::vector<MacroCurve> curves;
  context.guard(
      [&] { curves = run_macro_stage(setup, card, contents, seed, store, context, context.provenance(scene, seed)); });

  nlohmann::json summary;
  const bool resolved = has_twin(setup, "shelled");
  bool usable = true;
  for (const MacroCurve& c : curves) usable = usable && c.usable;
  summary["status"] = usable ? "good" : "not usable";
  summary["title"] = title;
  summary["macro"] = macro_json(curves, "law");
  if (resolved) summary["resolved"] = macro_json(curves, "shelled");
  if (has_twin(setup, "free")) summary["free"] = macro_json(curves, "free");
  if (resolved && usable) {
    const Comparison c = compare_curves(curves_of(curves, "law"), curves_of(curves, "shelled"));
    summary["comparison"] = {{"stress_error", c.axial_difference.mean},
                             {"speedup_seconds", c.speedup_seconds},
                             {"speedup_contact_evaluations", c.speedup_contact_evaluations}};
  }
  summary["remarks"] = macro_remarks(curves);
  summary["files"] = {{"macro", context.path("macro.h5")},
                      {"initial", context.path("macro_initial.h5")},
                      {"report", context.path("report.html")}};
  summary["provenance"] = provenance_json(context.provenance(scene, seed));
  context.finish(summary, people_text(curves, context));
  write_report(context.directory());
  store.clear();
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain

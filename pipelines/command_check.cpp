// softgrain check: is this file sound, and what follows from it. Runs nothing that takes more than a moment.
#include <fmt/format.h>

#include <filesystem>

#include "common/io/text_file.h"
#include "microsim/particles/particles_scene.h"
#include "pipelines/crowd_check.h"
#include "pipelines/grain_box_check.h"
#include "pipelines/inverse_command.h"
#include "pipelines/law_check.h"
#include "pipelines/macro_check.h"
#include "pipelines/measure_check.h"
#include "pipelines/particles_check.h"
#include "pipelines/pipeline_setup.h"
#include "pipelines/powder_command.h"
#include "pipelines/result_check.h"
#include "pipelines/run_context.h"

namespace softgrain {

namespace {

void check_pipeline(const SceneTable& root, Findings& out) {
  const PipelineSetup setup = read_pipeline_setup(root);
  const MeasureTrial trial = check_measurements(setup.measure, out);
  if (setup.macro) check_macro(*setup.macro, content_of(trial), nullptr, out);
}

void check_soft_particle(const SceneTable& root, Findings& out) {
  (void)root.text("title", "");
  const MeasureSetup setup = read_measure_setup(root);
  root.finish();
  (void)check_measurements(setup, out);
}

void check_scene(const std::string& path, const CommonOptions& options, Findings& out) {
  const Scene scene = Scene::load(path, options.overrides);
  const SceneTable root = scene.root();
  const std::string kind = root.choice("kind", {"pipeline", "soft-particle", "macro", "macro-comparison", "particles",
                                                "grain-box", "law-table", "cohesive-powder", "hierarchy", "inverse"});
  out.add("kind", kind, "scene of kind " + kind);
  if (!options.law.empty() && kind != "macro") throw BadInput("check: --law goes with scenes of kind \"macro\"");
  if (kind == "particles" && particles_dimension(scene) == 2)
    check_particles(read_particles_scene<2>(scene), out);
  else if (kind == "particles")
    check_particles(read_particles_scene(scene), out);
  else if (kind == "grain-box")
    check_grain_box(read_grain_box(scene), out);
  else if (kind == "law-table")
    check_law_table(scene, out);
  else if (kind == "cohesive-powder")
    check_powder(scene, out);
  else if (kind == "hierarchy")
    check_hierarchy(scene, out);
  else if (kind == "inverse")
    check_inverse(scene, out);
  else if (kind == "macro")
    check_macro_scene(scene, options.law, out);
  else if (kind == "macro-comparison")
    check_macro_comparison(scene, out);
  else if (kind == "pipeline")
    check_pipeline(root, out);
  else
    check_soft_particle(root, out);
}

/// Laws and scenes are both TOML; cards and tables of laws have a schema at the top.
bool holds_laws(const std::string& path) { return Scene::load(path).root().has("schema"); }

void check_file(const std::string& path, const CommonOptions& options, Findings& out) {
  std::error_code ignored;
  const std::string extension = std::filesystem::path(path).extension();
  if (std::filesystem::is_directory(path, ignored))
    check_directory(path, out);
  else if (extension == ".h5")
    check_data(path, out);
  else if (extension == ".json")
    check_summary(path, out);
  else if (holds_laws(path))
    check_laws(path, out);
  else
    check_scene(path, options, out);
}

}  // namespace

ExitStatus command_check(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("check: give one file");
  const std::string& path = options.inputs[0];
  Findings out;
  check_file(path, options, out);
  out.close_times();
  out.facts["status"] = "good";
  out.facts["warnings"] = out.warnings();
  if (options.json) {
    write_standard_output(out.facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    return ExitStatus::good;
  }
  std::string text = path + ": sound\n" + out.lines;
  for (const std::string& warning : out.warnings()) text += "  mind: " + warning + "\n";
  write_standard_output(text);
  return ExitStatus::good;
}

}  // namespace softgrain

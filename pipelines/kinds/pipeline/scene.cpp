#include "pipelines/kinds/pipeline/scene.h"

#include "pipelines/kinds/macro/memory.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/law/fit_settings.h"

namespace softgrain {

namespace {

LawSources read_crowd_law(const Scene& scene, const SceneTable& law) {
  const std::string path = scene.resolve(law.text("table"));
  LawSources out = read_scene_law(law, path);
  if (!out.table) law.reject("table", path + " is no law table (the pair law is the one that this run measures)");
  if (out.forms.front() == Crowd::pair)
    law.reject("form", "the pair law is the one that this run measures: \"bag\", \"directional\" or \"best\"");
  return out;
}

}  // namespace

PipelineSetup read_pipeline_setup(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    PipelineSetup setup;
    (void)root.choice("kind", {"pipeline"});
    setup.title = root.text("title", "");
    setup.measure = read_measure_setup(root);
    setup.fit = read_fit_settings(root.table_or_empty("calibrate"));
    if (!root.has("macro")) {
      if (root.has("law")) root.reject("law", "goes with [macro]: laws of crowds are for many neighbours at once");
      return setup;
    }
    if (root.has("law")) setup.crowd = read_crowd_law(scene, root.table("law"));
    const SceneTable macro = root.table("macro");
    setup.macro = read_macro_setup(macro, setup.measure.spec);
    read_stages(root, macro, setup.macro->spec);
    setup.macro->kept_states = setup.measure.kept_states;
    require_own_preparation(macro, *setup.macro);
    if (root.sound()) require_macro_memory(macro, *setup.macro, setup.measure.spec);
    return setup;
  });
}

}  // namespace softgrain

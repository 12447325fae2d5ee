#include "pipelines/kinds/pipeline/scene.h"

#include "pipelines/kinds/macro/memory.h"
#include "pipelines/law/fit_settings.h"

namespace softgrain {

PipelineSetup read_pipeline_setup(const SceneTable& root) {
  PipelineSetup setup;
  (void)root.choice("kind", {"pipeline"});
  setup.title = root.text("title", "");
  setup.measure = read_measure_setup(root);
  setup.fit = read_fit_settings(root.table_or_empty("calibrate"));
  if (root.has("macro")) {
    setup.macro = read_macro_setup(root.table("macro"), setup.measure.spec);
    require_own_preparation(root.table("macro"), *setup.macro);
    require_macro_memory(root.table("macro"), *setup.macro, setup.measure.spec);
  }
  if (setup.macro) setup.macro->kept_states = setup.measure.kept_states;
  root.finish();
  return setup;
}

}  // namespace softgrain

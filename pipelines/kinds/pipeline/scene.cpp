#include "pipelines/kinds/pipeline/scene.h"

#include "pipelines/kinds/macro/memory.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/law/fit_settings.h"

namespace softgrain {

PipelineSetup read_pipeline_setup(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    PipelineSetup setup;
    (void)root.choice("kind", {"pipeline"});
    setup.title = root.text("title", "");
    setup.measure = read_measure_setup(root);
    setup.fit = read_fit_settings(root.table_or_empty("calibrate"));
    if (!root.has("macro")) return setup;
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

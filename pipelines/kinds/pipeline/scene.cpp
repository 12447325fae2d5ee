#include "pipelines/kinds/pipeline/scene.h"

#include "pipelines/kinds/macro/memory.h"

namespace softgrain {

FitOptions read_fit_options(const SceneTable& t) {
  FitOptions o;
  o.delta_low = t.number("delta_low", Unit::none, Range::not_negative(), o.delta_low);
  if (t.has("delta_high")) o.delta_high = t.number("delta_high", Unit::none, Range::above(o.delta_low));
  o.initial_angle_deg = t.number("initial_angle_deg", Unit::angle_degree, Range::positive(), o.initial_angle_deg);
  o.secant_angle_deg = t.number("secant_angle_deg", Unit::angle_degree, Range::positive(), o.secant_angle_deg);
  o.noise_floor = t.number("noise_floor", Unit::none, Range::positive(), o.noise_floor);
  o.min_packings = static_cast<int>(t.count("min_packings", 2, 100000, o.min_packings));
  o.replicates = static_cast<int>(t.count("replicates", 0, 1000000, o.replicates));
  return o;
}

PipelineSetup read_pipeline_setup(const SceneTable& root) {
  PipelineSetup setup;
  (void)root.choice("kind", {"pipeline"});
  setup.title = root.text("title", "");
  setup.measure = read_measure_setup(root);
  setup.fit = read_fit_options(root.table_or_empty("calibrate"));
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

#include "pipelines/kinds/pipeline/scene.h"

#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/law/law_fit.h"
#include "pipelines/law/law_library_scene.h"

namespace softgrain {

namespace {

LawSources read_multi_contact_law(const Scene& scene, const SceneTable& law) {
  const std::string path =
      law_path(scene, law.filled_text({"table", "existing law table (path relative to the scene)"}));
  LawSources out = read_scene_law(law, path);
  if (out.table() == nullptr)
    law.throw_error("table", path + " is no law table (the pair law is the one that this run measures)");
  if (out.forms.front() == LawForm::pair)
    law.throw_error("form",
                    "the pair law is the one that this run measures: \"isotropic\", \"directional\" or \"best\"");
  return out;
}

MeasuredTable read_measured_table(const SceneTable& root) {
  const SceneTable calibrate =
      root.table_or_empty("calibrate").table_or_empty({"multi_contact", "fit of the multi-contact law"});
  MeasuredTable out{read_multi_contact_setup(root), read_multi_contact_fit(calibrate), {}};
  require_law_of_multi_contact(root, out.multi_contact, calibrate, out.fit);
  if (out.fit.best == LawForm::pair)
    calibrate.add_error("best", "the pair law is measured anyway: \"isotropic\" or \"directional\"");
  out.prior = read_law_prior(root, calibrate, out.fit);
  return out;
}

void read_multi_contact_laws(const Scene& scene, const SceneTable& root, PipelineSetup& setup) {
  const bool measures = root.has("configuration");
  for (const char* key : {"law", "configuration"})
    if (root.has(key) && !root.has("macro"))
      root.throw_error(
          key,
          "goes with [macro]: multi-contact laws are for many neighbours at once; a table alone is measured by "
          "kind = \"law-table\"");
  if (measures && root.has("law"))
    root.throw_error("law", "[[configuration]] measures a multi-contact law already; leave one of the two out");
  if (root.has("multi_contact") && !measures)
    root.throw_error("multi_contact", "goes with [[configuration]], which says what is measured");
  if (root.has("prior") && !measures)
    root.throw_error("prior", "goes with [[configuration]]: packings measured with many neighbours correct a library");
  if (root.has("law"))
    setup.table = read_multi_contact_law(
        scene,
        root.table(
            {"law", "existing multi-contact law of the macro scene, instead of `multi_contact` and `configuration`"}));
  if (measures) setup.measured_table = read_measured_table(root);
}

}  // namespace

PipelineSetup read_pipeline_setup(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    PipelineSetup setup;
    (void)root.choice(kKindKey, {"pipeline"});
    setup.title = root.title();
    setup.measure = read_measure_setup(root);
    setup.fit = read_fit_settings(root.table_or_empty({"calibrate", "fit of the law"}));
    read_multi_contact_laws(scene, root, setup);
    if (!root.has("macro")) return setup;
    const SceneTable macro = root.table({"macro", "macro scene that uses the law, and its resolved twin"});
    setup.macro = read_macro_setup(macro, setup.measure.spec);
    read_stages(root, macro, setup.macro->spec, !root.table_or_empty("material").has_errors());
    refuse_idle_test_keys(macro, root, {&setup.macro->spec});
    refuse_idle_keys(macro, !setup.macro->twins.empty(), setup.macro->bands > 0);
    refuse_idle_sizes(macro, {&*setup.macro});
    if (macro.has("kt") && !setup.measure.rotates())
      macro.add_error("kt", "goes with angles_deg: no tangential stiffness is measured in this scene");
    setup.macro->kept_states = setup.measure.kept_states;
    require_own_preparation(macro, *setup.macro);
    if (!root.has_errors()) require_macro_memory(macro, *setup.macro, setup.measure.spec);
    if (!root.has_errors()) require_room_for_images(macro, "bodies", *setup.macro, setup.measure.seed);
    return setup;
  });
}

}  // namespace softgrain

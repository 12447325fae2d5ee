#include "pipelines/kinds/material_models/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/io/text_file.h"
#include "pipelines/law/law_draws.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

namespace {

/// Keys of one kind of model mean nothing to others.
void require_own_keys(const SceneTable& t, ModelKind kind) {
  const auto only = [&](const char* key, std::initializer_list<ModelKind> kinds) {
    if (t.has(key) && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      t.add_error(key, "does not go with kind = \"" + to_string(kind) + "\"");
  };
  only("split", {ModelKind::cells, ModelKind::substitute, ModelKind::coarse, ModelKind::shells});
  only("places", {ModelKind::cells});
  only("start", {ModelKind::cells, ModelKind::mean_field});
  only("smallest", {ModelKind::substitute});
  only("mapped", {ModelKind::substitute});
  for (const char* key : {"table", "form", "scale"}) only(key, {ModelKind::shells});
  only("radii", {ModelKind::shells, ModelKind::cells});
  only("soft_share", {ModelKind::cells});
  only("bands", {ModelKind::cells, ModelKind::mean_field});
  only("card", {ModelKind::cells, ModelKind::mean_field, ModelKind::substitute});
}

CellCard read_card(const Scene& scene, const SceneTable& t, MaterialModelsScene& out) {
  const std::string path = scene.resolve(
      t.filled_text({"card", "card of the cell law, for cells, mean fields and mapped substitutes", "-"}));
  if (std::find(out.files.begin(), out.files.end(), path) == out.files.end()) {
    out.files.push_back(path);
    out.text += read_text(path);
  }
  return read_cell_card(path);
}

LawSources read_shells(const Scene& scene, const SceneTable& t, MaterialModelsScene& out) {
  LawSources law;
  const std::string path = scene.resolve(t.filled_text({"table", "shells: a law table", "-"}));
  law.forms = {t.choice<LawForm>({"form", "shells: form of the law"}, LawForm::directional)};
  law.laws = {law_of_key(t, "table", path)};
  if (std::find(out.files.begin(), out.files.end(), path) == out.files.end()) {
    out.files.push_back(path);
    out.text += law.text();
  }
  law.range = RangePolicy::clamp;
  return law;
}

void read_bands(const SceneTable& t, MaterialModel& m) {
  m.bands = read_draw_count(t,
                            {"bands",
                             "cells, mean fields: number of draws of the card, whose numbers vary within their errors, "
                             "for error bands, 8 or more; each runs the model once more; 0: no bands"},
                            1000, m.bands);
  if (m.bands == 0 || !m.card) return;
  try {
    (void)cell_draws(*m.card, m.name, m.bands);  // what the card does not tell, before anything runs
  } catch (const InputError& e) {
    t.add_error("bands", e.what());
  }
}

MaterialModel read_model(const Scene& scene, const SceneTable& t, MaterialModelsScene& out) {
  MaterialModel m;
  m.name = read_variant_name(t);
  m.kind = t.choice<ModelKind>({"kind", "kind of the model"});
  if (t.has("variants")) m.variants = t.texts({"variants", "names of the variants that are run with the model", "all"});
  require_own_keys(t, m.kind);
  m.split = t.number({"split", "grains below this share of the largest radius are fines; not for mean fields"},
                     Unit::none, Range{0.0, 1.0, true, true}, m.split);
  m.places = t.choice<ModelPlaces>(
      {"places", "cells: positions of the coarse grains, `\"truth\"` (of the reference) or `\"own\"`"}, m.places);
  m.start = t.choice<ModelStart>({"start",
                                  "cells, mean fields: start from the `\"pressure\"` of the reference, or from its "
                                  "`\"density\"` (solid fraction and grading alone)"},
                                 m.start);
  m.smallest = t.number({"smallest", "substitutes: smallest radius over the largest of the material, below `split`",
                         "0.2, at most 0.6 `split`"},
                        Unit::none, Range{0.0, m.split, true, true}, std::min(m.smallest, 0.6 * m.split));
  m.soft_share = t.number(
      {"soft_share",
       "cells with `places = \"own\"`: volume share of soft particles (fines without a grain) among all particles"},
      Unit::none, Range{0.0, 0.6, false, false}, 0.0);
  if (m.soft_share > 0.0 && m.places == ModelPlaces::truth)
    t.add_error("soft_share", "soft bodies are at places of their own: places = \"own\"");
  if (m.kind == ModelKind::cells && m.soft_share == 0.0)
    t.refuse({"radii"}, "are those of soft bodies: goes with soft_share above 0");
  m.mapped = t.flag({"mapped", "substitutes: map stresses by the equation of state"}, false);
  if (m.kind == ModelKind::substitute && !m.mapped)
    t.refuse({"card"}, "says the equation of state that stresses are mapped by: goes with mapped = true");
  m.scale = t.number({"scale", "shells: factor on their radii after they are placed"}, Unit::none,
                     Range{0.0, 2.0, true, false}, m.scale);
  const std::vector<double> radii = t.numbers({"radii",
                                               "shells, and cells with `soft_share`: smallest and largest radius of "
                                               "the soft particles, over the largest grain"},
                                              Unit::none, Range{0.0, 2.0, true, false}, {0.2, 0.6});
  if (radii.size() != 2 || !(radii[0] < radii[1]))
    t.add_error("radii", "the smallest and the largest shell, in this order");
  else
    m.radii = {radii[0], radii[1]};
  if (m.kind == ModelKind::shells)
    m.law = read_shells(scene, t, out);
  else if (m.kind != ModelKind::coarse && (m.kind != ModelKind::substitute || m.mapped))
    m.card = read_card(scene, t, out);
  read_bands(t, m);
  return m;
}

}  // namespace

bool is_named(const MaterialVariant& v, const std::string& name) { return name == v.name || name == v.packings; }

MaterialModelsScene read_material_models_scene(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    (void)root.choice(kKindKey, {"material-models"});
    MaterialModelsScene out;
    out.material = read_material(root, false);
    if (root.has("blind"))
      out.blind =
          root.texts({"blind", "names of variants that the laws were not measured on; they have tables of their own"});
    const auto require_variants = [&](const SceneTable& t, const char* key, const std::vector<std::string>& names) {
      for (const std::string& name : names)
        if (std::none_of(out.material.variants.begin(), out.material.variants.end(),
                         [&](const MaterialVariant& v) { return is_named(v, name); }))
          t.add_error(key, "'" + name + "' is no variant");
    };
    require_variants(root, "blind", out.blind);
    std::set<std::string> names;
    for (const SceneTable& t : root.tables({"model",
                                            "a model of the material, run on every variant and loading, sample by "
                                            "sample, from the initial state of the reference"})) {
      if (!names.insert(t.text("name", "")).second) t.add_error("name", "is used twice");
      MaterialModel m = read_model(scene, t, out);
      require_variants(t, "variants", m.variants);
      const auto rolls = [](const MaterialVariant& v) { return v.setup.spec.rolling.friction > 0.0; };
      if (m.kind == ModelKind::shells && std::ranges::any_of(out.material.variants, rolls))
        t.add_error("kind", "goes without mu_r: soft particles are measured with grains that roll freely");
      out.models.push_back(std::move(m));
    }
    if (out.models.empty()) root.add_error("model", "give at least one [[model]]");
    return out;
  });
}

}  // namespace softgrain

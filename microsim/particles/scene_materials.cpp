#include "microsim/particles/scene_materials.h"

namespace softgrain {

namespace {

Material read_material(const SceneTable& t, const std::string& name, int dimension) {
  Material m;
  m.name = name;
  m.rigid = t.flag("rigid", false);
  if (dimension == 2 && t.is_text("density"))
    t.mistake("density", "disks have a mass over their area: a number, kg/m^2");
  m.density = t.number("density", dimension == 3 ? Unit::density : Unit::none, Range::positive(), 0.0);
  if (m.rigid) {
    for (const char* key : {"E", "nu"})
      if (t.has(key)) t.mistake(key, "a rigid material has none");
    return m;
  }
  if (!t.has("E") && !t.has("nu")) return m;  // enough for laws that need no elasticity
  m.youngs_modulus = t.number("E", Unit::pressure, Range::positive());
  m.poisson_ratio = t.number("nu", Unit::none, Range{-1.0, 0.5, true, false});
  return m;
}

}  // namespace

std::vector<Material> read_materials(const SceneTable& root, int dimension) {
  std::vector<Material> out;
  const SceneTable tables = root.table_or_empty("material");
  for (const std::string& name : tables.keys()) {
    if (name == "rigid") tables.mistake(name, "this name is taken by the rigid material that is always there");
    out.push_back(read_material(tables.named(name), name, dimension));
  }
  if (out.empty() && !root.sound()) root.reject("material", "without any, nothing else can be read");
  Material rigid;
  rigid.name = "rigid";
  rigid.rigid = true;
  out.push_back(rigid);
  return out;
}

std::int32_t material_index(const std::vector<Material>& materials, const SceneTable& table, const std::string& key) {
  const std::string name = table.text(key);
  std::vector<std::string> known;
  for (const Material& m : materials) {
    if (m.name == name) return static_cast<std::int32_t>(known.size());
    known.push_back(m.name);
  }
  const std::string near = nearest_word(name, known);
  table.reject(key, "no such material" + (near.empty() ? "" : "; nearest is '" + near + "'"));
}

}  // namespace softgrain

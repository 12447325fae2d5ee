#include "microsim/particles/scene_materials.h"

#include <algorithm>
#include <array>

#include "common/contact/soft_contact_from_card.h"
#include "common/core/error.h"
#include "common/data/card_text.h"
#include "common/data/law_card.h"

namespace softgrain {

namespace {

Material read_material(const SceneTable& t, const std::string& name) {
  Material m;
  m.name = name;
  m.rigid = t.flag("rigid", false);
  m.density = t.number("density", Unit::density, Range::positive(), 0.0);
  if (m.rigid) {
    for (const char* key : {"E", "nu"})
      if (t.has(key)) t.reject(key, "a rigid material has none");
    return m;
  }
  if (!t.has("E") && !t.has("nu")) return m;  // enough for laws that need no elasticity
  m.youngs_modulus = t.number("E", Unit::pressure, Range::positive());
  m.poisson_ratio = t.number("nu", Unit::none, Range{-1.0, 0.5, true, false});
  return m;
}

/// What one table [[contact]] says about its pair.
struct PairOfMaterials {
  std::int32_t first = 0;
  std::int32_t second = 0;
  std::string text;  ///< "glass and steel"
};

PairOfMaterials read_pair(const SceneTable& t, const std::vector<Material>& materials) {
  const std::vector<std::string> names = t.texts("pair");
  if (names.size() != 2) t.reject("pair", "must name two materials");
  std::vector<std::string> known;
  for (const Material& m : materials) known.push_back(m.name);
  std::array<std::int32_t, 2> index{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto found = std::find(known.begin(), known.end(), names[k]);
    if (found == known.end()) {
      const std::string near = nearest_word(names[k], known);
      t.reject("pair", "no material '" + names[k] + "'" + (near.empty() ? "" : "; nearest is '" + near + "'"));
    }
    index[k] = static_cast<std::int32_t>(found - known.begin());
  }
  return {index[0], index[1], names[0] + " and " + names[1]};
}

double read_friction(const SceneTable& t) { return t.number("mu", Unit::none, Range::not_negative()); }
double read_restitution(const SceneTable& t) { return t.number("restitution", Unit::none, Range::closed(0.0, 1.0)); }

AnyLaw read_hertz(const SceneTable& t, const Material& a, const Material& b) {
  const double friction = read_friction(t);
  const double restitution = read_restitution(t);
  const bool rescaled = t.choice("tangential", {"mindlin", "rescaled"}, "mindlin") == "rescaled";
  for (const Material* m : {&a, &b})
    if (!m->rigid && !(m->youngs_modulus > 0.0))
      t.reject("pair", "the law needs E and nu of material '" + m->name + "'");
  if (a.rigid && b.rigid)
    t.reject("pair", "a contact of two rigid materials has no finite stiffness; use law = \"linear-spring\"");
  return hertz_law(HertzCoefficients::of(a, b, friction, restitution), rescaled);
}

AnyLaw read_linear(const SceneTable& t) {
  LinearSpring law;
  law.friction = read_friction(t);
  law.damping = LinearSpring::zeta(read_restitution(t));
  law.normal = t.number("normal_stiffness", Unit::stiffness, Range::positive());
  law.tangential = t.number("tangential_stiffness", Unit::stiffness, Range::not_negative());
  if (law.friction > 0.0 && law.tangential == 0.0) t.reject("tangential_stiffness", "must be above 0 when mu is");
  return law;
}

SoftContact read_card_law(const Scene& scene, const SceneTable& t, PairKind kind) {
  const double modulus = t.number("E", Unit::pressure, Range::positive());
  const double friction = read_friction(t);
  const double damping = t.number("damping", Unit::none, Range::closed(0.0, 1.0));
  const bool secant = t.choice("kt", {"initial", "secant"}) == "secant";
  const std::optional<Beyond> beyond = read_beyond(t);
  const LawCard card = load_card(scene.resolve(t.text("file")));
  try {
    return make_soft_contact(card, kind, modulus, friction, damping, secant, beyond);
  } catch (const Error& e) {
    t.reject("file", e.what());
  }
}

void set_card_law(const Scene& scene, const SceneTable& t, const std::vector<Material>& materials,
                  const PairOfMaterials& pair, LawSet& laws) {
  const PairKind kind =
      t.choice("kind", {"soft-solid", "soft-soft"}) == "soft-solid" ? PairKind::soft_solid : PairKind::soft_soft;
  SoftContact law = read_card_law(scene, t, kind);
  if (kind == PairKind::soft_soft) {
    laws.set(pair.first, pair.second, law);
    return;
  }
  if (pair.first == pair.second) t.reject("pair", "a soft-solid contact needs two different materials");
  const std::int32_t soft = material_index(materials, t, "which_soft");
  if (soft != pair.first && soft != pair.second) t.reject("which_soft", "must be one of the pair");
  const std::int32_t solid = pair.first + pair.second - soft;
  law.i_is_soft = true;
  laws.set(soft, solid, law, true);
  law.i_is_soft = false;
  laws.set(solid, soft, law, true);
}

void read_contact(const Scene& scene, const SceneTable& t, const std::vector<Material>& materials, SceneLaws& out) {
  const PairOfMaterials pair = read_pair(t, materials);
  const std::int32_t before = out.laws.index(pair.first, pair.second);
  if (before != LawSet::kNoContact)
    t.reject("pair", "has a law already: " + out.description[static_cast<std::size_t>(before)]);
  if (out.laws.size() + 2 > static_cast<std::int32_t>(LawSet::kMostLaws))
    t.reject("pair", "more than 64 laws in one scene");
  const std::string law = t.choice("law", {"hertz-tsuji", "linear-spring", "law-card"});
  const Material& a = materials[static_cast<std::size_t>(pair.first)];
  const Material& b = materials[static_cast<std::size_t>(pair.second)];
  if (law == "hertz-tsuji") out.laws.set(pair.first, pair.second, read_hertz(t, a, b));
  if (law == "linear-spring") out.laws.set(pair.first, pair.second, read_linear(t));
  if (law == "law-card") set_card_law(scene, t, materials, pair, out.laws);
  out.description.resize(static_cast<std::size_t>(out.laws.size()),
                         law + " of " + pair.text + " (" + t.where("pair") + ")");
}

}  // namespace

std::vector<Material> read_materials(const SceneTable& root) {
  std::vector<Material> out;
  const SceneTable tables = root.table_or_empty("material");
  for (const std::string& name : tables.keys()) {
    if (name == "rigid") tables.reject(name, "this name is taken by the rigid material that is always there");
    out.push_back(read_material(tables.named(name), name));
  }
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

SceneLaws read_contacts(const Scene& scene, const std::vector<Material>& materials) {
  SceneLaws out;
  out.laws = LawSet(static_cast<std::int32_t>(materials.size()));
  for (const SceneTable& t : scene.root().tables("contact")) read_contact(scene, t, materials, out);
  return out;
}

}  // namespace softgrain

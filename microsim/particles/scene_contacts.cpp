#include "microsim/particles/scene_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "microsim/particles/scene_soft_laws.h"

namespace softgrain {

namespace {

Material read_material(const SceneTable& t, const std::string& name, int dimension) {
  Material m;
  m.name = name;
  m.rigid = t.flag("rigid", false);
  if (dimension == 2 && t.is_text("density"))
    t.add_error("density", "disks have a mass over their area: a number, kg/m^2");
  m.density = t.number("density", dimension == 3 ? Unit::density : Unit::none, Range::positive(), 0.0);
  if (m.rigid) {
    for (const char* key : {"E", "nu"})
      if (t.has(key)) t.add_error(key, "a rigid material has none");
    return m;
  }
  if (!t.has("E") && !t.has("nu")) return m;  // enough for laws that need no elasticity
  m.youngs_modulus = t.number("E", Unit::pressure, Range::positive());
  m.poisson_ratio = t.number("nu", Unit::none, kPoissonRange);
  return m;
}

}  // namespace

std::vector<Material> read_materials(const SceneTable& root, int dimension) {
  std::vector<Material> out;
  const SceneTable tables = root.table_or_empty("material");
  for (const std::string& name : tables.keys()) {
    if (name == "rigid") tables.add_error(name, "this name is taken by the rigid material that is always there");
    out.push_back(read_material(tables.named(name), name, dimension));
  }
  if (out.empty() && root.has_errors()) root.throw_error("material", "without any, nothing else can be read");
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
  table.throw_error(key, "no such material" + (near.empty() ? "" : "; nearest is '" + near + "'"));
}

namespace {

PairOfMaterials read_pair(const SceneTable& t, const std::vector<Material>& materials) {
  const std::vector<std::string> names = t.texts("pair");
  if (names.size() != 2) t.throw_error("pair", "must name two materials");
  std::vector<std::string> known;
  for (const Material& m : materials) known.push_back(m.name);
  std::array<std::int32_t, 2> index{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto found = std::find(known.begin(), known.end(), names[k]);
    if (found == known.end()) {
      const std::string near = nearest_word(names[k], known);
      t.throw_error("pair", "no material '" + names[k] + "'" + (near.empty() ? "" : "; nearest is '" + near + "'"));
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
      t.throw_error("pair", "the law needs E and nu of material '" + m->name + "'");
  if (a.rigid && b.rigid)
    t.throw_error("pair", "a contact of two rigid materials has no finite stiffness; use law = \"linear-spring\"");
  return hertz_law(HertzCoefficients::of(a, b, friction, restitution), rescaled);
}

AnyLaw read_linear(const SceneTable& t) {
  LinearSpring law;
  law.friction = read_friction(t);
  law.damping = LinearSpring::zeta(read_restitution(t));
  law.normal = t.number("normal_stiffness", Unit::stiffness, Range::positive());
  if (law.friction > 0.0 || t.has("tangential_stiffness"))  // of no friction it may be left out: it has no effect
    law.tangential = t.number("tangential_stiffness", Unit::stiffness, Range::not_negative());
  if (law.friction > 0.0 && law.tangential == 0.0) t.add_error("tangential_stiffness", "must be above 0 when mu is");
  return law;
}

/// A key that means nothing unless something else is above 0 (or there): needed then, refused otherwise.
double read_when(const SceneTable& t, const std::string& key, Unit unit, bool used, const char* without) {
  if (used) return t.number(key, unit, Range::positive());
  if (t.has(key)) t.add_error(key, without);
  return 0.0;
}

template <bool kFriction, bool kRolling>
AnyLaw read_cohesive(const SceneTable& t, double friction) {
  CohesiveDisk<kFriction, kRolling> law;
  law.friction = friction;
  law.normal = t.number("normal_stiffness", Unit::stiffness, Range::positive());
  law.tangential =
      read_when(t, "tangential_stiffness", Unit::stiffness, kFriction, "has no effect without friction (mu = 0)");
  law.damping = t.number("zeta", Unit::none, Range::not_negative());
  law.adhesion = t.number("adhesion", Unit::force, Range::not_negative());
  law.range = read_when(t, "range", Unit::length, law.adhesion > 0.0, "has no effect without adhesion");
  law.rolling = read_when(t, "rolling_stiffness", Unit::none, kRolling, "");
  law.rolling_limit = read_when(t, "rolling_limit", Unit::length, kRolling,
                                "is the limit of a resistance to rolling: give rolling_stiffness too");
  return law;
}

AnyLaw read_cohesive(const SceneTable& t) {
  const double friction = read_friction(t);
  const bool rolling = t.has("rolling_stiffness");
  if (friction > 0.0) return rolling ? read_cohesive<true, true>(t, friction) : read_cohesive<true, false>(t, friction);
  if (rolling) t.add_error("rolling_stiffness", "needs friction (mu above 0): disks that slide freely do not roll");
  return read_cohesive<false, false>(t, friction);
}

/// Spheres that move in a plane are spheres still; only laws that are linear in the overlap hold for disks as well.
void require_dimension(const SceneTable& t, const std::string& law, int dimension) {
  if (dimension == 3 && law == "cohesive")
    t.add_error("law", "\"cohesive\" is a law of disks in the plane: give the scene dimension = 2");
  if (dimension == 2 && (law == "hertz-tsuji" || law == "law-card"))
    t.add_error("law", "\"" + law +
                           "\" is a law of spheres; a scene with dimension = 2 has \"linear-spring\" and \"cohesive\"");
}

void read_contact(const SceneTable& t, const std::vector<Material>& materials, int dimension, SoftLawReader& soft,
                  SceneLaws& out) {
  const PairOfMaterials pair = read_pair(t, materials);
  const std::int32_t before = out.laws.index(pair.first, pair.second);
  if (before != LawSet::kNoContact)
    t.throw_error("pair", "has a law already: " + out.description[static_cast<std::size_t>(before)]);
  if (out.laws.size() + 2 > static_cast<std::int32_t>(LawSet::kMostLaws))
    t.throw_error("pair", "more than 64 laws in one scene");
  const std::string law = t.choice("law", {"hertz-tsuji", "linear-spring", "cohesive", "law-card"});
  require_dimension(t, law, dimension);
  const Material& a = materials[static_cast<std::size_t>(pair.first)];
  const Material& b = materials[static_cast<std::size_t>(pair.second)];
  if (law == "hertz-tsuji") out.laws.set(pair.first, pair.second, read_hertz(t, a, b));
  if (law == "linear-spring") out.laws.set(pair.first, pair.second, read_linear(t));
  if (law == "cohesive") out.laws.set(pair.first, pair.second, read_cohesive(t));
  if (law == "law-card") soft.read(t, pair);
  const auto laws = static_cast<std::size_t>(out.laws.size());
  out.description.resize(laws, law + " of " + pair.text + " (" + t.where("pair") + ")");
  out.scopes.resize(laws,
                    law == "cohesive" && t.number("adhesion", Unit::force) > 0.0 ? LawScope::grains : LawScope::any);
}

/// Elastic constants of materials whose contacts do not go by them. They describe the material and may stay, but a
/// user who changes them should know that nothing else changes.
void remark_on_idle_elasticity(const SceneTable& root, SceneLaws& out) {
  std::set<std::string> elastic;
  const std::vector<SceneTable> contacts = root.tables("contact");
  for (const SceneTable& t : contacts)
    if (t.text("law") == "hertz-tsuji")
      for (const std::string& name : t.texts("pair")) elastic.insert(name);
  if (contacts.empty()) return;
  const SceneTable tables = root.table_or_empty("material");
  for (const std::string& name : tables.keys()) {
    const SceneTable t = tables.named(name);
    if (elastic.contains(name)) continue;
    for (const char* key : {"E", "nu", "rigid"})
      if (t.has(key))
        out.remarks.push_back(
            fmt::format("{}: {} of [material.{}] has no effect: none of its contacts has law = "
                        "\"hertz-tsuji\"",
                        t.where(key), key, name));
  }
}

}  // namespace

SceneLaws read_contacts(const Scene& scene, const std::vector<Material>& materials, int dimension) {
  SceneLaws out;
  out.laws = LawSet(static_cast<std::int32_t>(materials.size()));
  SoftLawReader soft(scene, materials, out);
  const SceneTable root = scene.root();
  for (const SceneTable& t : root.tables("contact"))
    t.section([&] { read_contact(t, materials, dimension, soft, out); });
  if (!root.has_errors()) soft.require_whole();
  if (!root.has_errors()) remark_on_idle_elasticity(root, out);
  return out;
}

std::vector<std::string> contact_law_files(const Scene& scene) {
  std::vector<std::string> files;
  for (const SceneTable& t : scene.root().tables("contact"))
    if (t.has("file")) files.push_back(scene.resolve(t.text("file")));
  return files;
}

}  // namespace softgrain

#include "microsim/particles/scene_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "common/contact/rolling_scene.h"
#include "common/core/error.h"
#include "common/io/scene.h"
#include "microsim/particles/scene_soft_laws.h"

namespace softgrain {

namespace {

Material read_material(const SceneTable& t, const std::string& name, int dimension) {
  Material m;
  m.name = name;
  m.rigid = t.flag({"rigid", "the material does not deform in contacts; a material `\"rigid\"` always exists"}, false);
  if (dimension == 2 && t.is_text("density"))
    t.add_error("density", "disks have a mass over their area: a number, kg/m^2");
  m.density = t.number({"density", "density of particles of this material; of disks mass over area (a number, kg/m^2)",
                        "- for particles"},
                       dimension == 3 ? Unit::density : Unit::none, Range::positive(), 0.0);
  if (m.rigid) {
    t.refuse({"E", "nu"}, "a rigid material has none");
    return m;
  }
  if (!t.has("E") && !t.has("nu")) return m;  // enough for laws that need no elasticity
  m.youngs_modulus = t.number({"E", "Young's modulus; needed by `hertz-tsuji`"}, Unit::pressure, Range::positive());
  m.poisson_ratio = t.number({"nu", "Poisson's ratio; needed by `hertz-tsuji`"}, Unit::none, kPoissonRange);
  return m;
}

}  // namespace

std::vector<Material> read_materials(const SceneTable& root, int dimension) {
  std::vector<Material> out;
  const SceneTable tables =
      root.table_or_empty({"material", "materials of particles and walls, a table with a free name each"});
  for (const std::string& name : tables.keys()) {
    tables.require_line(name, name);
    if (name == "rigid") tables.add_error(name, "this name is taken by the rigid material that is always there");
    out.push_back(read_material(tables.named({name, "properties of the material of this name"}), name, dimension));
  }
  if (out.empty() && root.has_errors()) root.throw_error("material", "without any, nothing else can be read");
  Material rigid;
  rigid.name = "rigid";
  rigid.rigid = true;
  out.push_back(rigid);
  return out;
}

std::int32_t material_index(const std::vector<Material>& materials, const SceneTable& table, const Key& key) {
  const std::string name = table.text(key);
  std::vector<std::string> known;
  for (const Material& m : materials) {
    if (m.name == name) return static_cast<std::int32_t>(known.size());
    known.push_back(m.name);
  }
  const std::string near = nearest_word(name, known);
  table.throw_error(key.name, "no such material" + (near.empty() ? "" : "; nearest is '" + near + "'"));
}

namespace {

PairOfMaterials read_pair(const SceneTable& t, const std::vector<Material>& materials) {
  const std::vector<std::string> names = t.texts({"pair", "names of two materials"});
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

const Key kTangentialStiffnessKey{"tangential_stiffness",
                                  "`linear-spring`, `cohesive`: tangential stiffness (K_T); needed with friction only"};

double read_friction(const SceneTable& t) {
  return t.number({"mu", "friction coefficient", "-; law table: as measured"}, Unit::none, Range::friction());
}
double read_restitution(const SceneTable& t) {
  return t.number({"restitution", "`hertz-tsuji`, `linear-spring`: coefficient of restitution"}, Unit::none,
                  Range::closed(0.0, 1.0));
}
double read_normal_stiffness(const SceneTable& t) {
  return t.number({"normal_stiffness", "`linear-spring`, `cohesive`: normal stiffness (K_N)"}, Unit::stiffness,
                  Range::positive());
}

/// mu_r, kr_ratio and rolling_damping of a law whose contacts have this friction and restitution.
RollingResistance read_rolling(const SceneTable& t, double friction, double restitution, int dimension) {
  constexpr const char* kDamping = "rolling_damping";
  RollingResistance rolling;
  if (dimension == 2) {
    t.refuse({"mu_r", "kr_ratio", kDamping}, "is of spheres: disks resist rolling with law = \"cohesive\"");
    return rolling;
  }
  read_rolling_resistance(t, friction, rolling);
  rolling.damping =
      t.number({kDamping, "with `mu_r`: dashpot constant of rolling over that of the contact times R12^2"}, Unit::none,
               Range::closed(0.0, 1000.0), rolling.damping);
  if (!t.has("mu_r")) t.refuse({kDamping}, "goes with mu_r: nothing resists rolling");
  if (restitution >= 1.0) t.refuse({kDamping}, "goes with restitution below 1: the contact has no dashpot");
  return rolling;
}

AnyLaw read_hertz(const SceneTable& t, const Material& a, const Material& b) {
  const double friction = read_friction(t);
  const double restitution = read_restitution(t);
  const bool rescaled =
      t.choice({"tangential",
                "`hertz-tsuji`: `\"mindlin\"` is the total form, as published; `\"rescaled\"` never creates energy"},
               {"mindlin", "rescaled"}, "mindlin") == "rescaled";
  for (const Material* m : {&a, &b})
    if (!m->rigid && !(m->youngs_modulus > 0.0))
      t.throw_error("pair", "the law needs E and nu of material '" + m->name + "'");
  if (a.rigid && b.rigid)
    t.throw_error("pair", "a contact of two rigid materials has no finite stiffness; use law = \"linear-spring\"");
  return hertz_law(HertzCoefficients::of(a, b, friction, restitution, read_rolling(t, friction, restitution, 3)),
                   rescaled);
}

AnyLaw read_linear(const SceneTable& t, int dimension) {
  LinearSpring law;
  law.friction = read_friction(t);
  const double restitution = read_restitution(t);
  law.damping = LinearSpring::zeta(restitution);
  law.normal = read_normal_stiffness(t);
  if (law.friction > 0.0 || t.has("tangential_stiffness"))  // of no friction it may be left out: it has no effect
    law.tangential = t.number(kTangentialStiffnessKey, Unit::stiffness, Range::not_negative());
  if (law.friction > 0.0 && law.tangential == 0.0) t.add_error("tangential_stiffness", "must be above 0 when mu is");
  const RollingResistance rolling = read_rolling(t, law.friction, restitution, dimension);
  if (!(rolling.friction > 0.0)) return law;
  return LinearSpringLaw<true>{law.normal, law.tangential, law.friction, law.damping, rolling};
}

/// A key that means nothing unless something else is above 0 (or there): needed then, refused otherwise.
double read_when(const SceneTable& t, const Key& key, Unit unit, bool used, const char* without) {
  if (used) return t.number(key, unit, Range::positive());
  if (t.has(key.name)) t.add_error(key.name, without);
  return 0.0;
}

template <bool kFriction, bool kRolling>
AnyLaw read_cohesive(const SceneTable& t, double friction) {
  CohesiveDisk<kFriction, kRolling> law;
  law.friction = friction;
  law.normal = read_normal_stiffness(t);
  law.tangential =
      read_when(t, kTangentialStiffnessKey, Unit::stiffness, kFriction, "has no effect without friction (mu = 0)");
  law.damping = t.number({"zeta", "`cohesive`: damping in contact, as a fraction of critical damping"}, Unit::none,
                         Range::closed(0.0, 100.0));
  law.adhesion = t.number({"adhesion", "`cohesive`: adhesion force F0"}, Unit::force, Range::not_negative());
  law.range = read_when(t,
                        {"range",
                         "`cohesive`: range D0 of the attraction, with adhesion only; law table: `\"reject\"` "
                         "(default) or `\"clamp\"` for solid fractions that were not measured"},
                        Unit::length, law.adhesion > 0.0, "has no effect without adhesion");
  law.rolling =
      read_when(t, {"rolling_stiffness", "`cohesive`: K_r [N m] of a rolling resistance, which needs friction"},
                Unit::none, kRolling, "");
  law.rolling_limit =
      read_when(t, {"rolling_limit", "`cohesive`: limit mu_r of the rolling resistance; goes with `rolling_stiffness`"},
                Unit::length, kRolling, "is the limit of a resistance to rolling: give rolling_stiffness too");
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
    t.throw_error("pair", "more than " + std::to_string(LawSet::kMostLaws) + " laws in one scene");
  const std::string law = t.choice(
      {"law",
       "law of the contact; `\"law-card\"`: law card or law table; for disks `\"linear-spring\"` or `\"cohesive\"`"},
      {"hertz-tsuji", "linear-spring", "cohesive", "law-card"});
  require_dimension(t, law, dimension);
  const Material& a = materials[static_cast<std::size_t>(pair.first)];
  const Material& b = materials[static_cast<std::size_t>(pair.second)];
  if (law == "hertz-tsuji") out.laws.set(pair.first, pair.second, read_hertz(t, a, b));
  if (law == "linear-spring") out.laws.set(pair.first, pair.second, read_linear(t, dimension));
  if (law == "cohesive") out.laws.set(pair.first, pair.second, read_cohesive(t));
  if (law == "law-card") soft.read(t, pair);
  const auto laws = static_cast<std::size_t>(out.laws.size());
  out.description.resize(laws, law + " of " + pair.text + " (" + t.where("pair") + ")");
  const auto attracts = [](const AnyLaw& any) {
    return std::visit([](const auto& one) { return reach_of(one) > 0.0; }, any);
  };
  const bool far = law == "cohesive" && attracts(out.laws.law(out.laws.index(pair.first, pair.second)));
  out.scopes.resize(laws, far ? LawScope::grains : LawScope::any);
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
  for (const SceneTable& t : root.tables(
           {"contact",
            "contact law of a pair of materials; one per pair that can touch, there are no default mixing rules"}))
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

// The table of kinds, and a scene given to the wrong command: the message names the right one.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/core/error.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/results/set_summary.h"

namespace softgrain {
namespace {

std::string complaint(const std::string& kind, const std::string& command) {
  try {
    (void)kind_of(Scene::parse("kind = \"" + kind + "\"\n", "s.toml"), command);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Kinds, EveryOneIsWholeAndNamedOnce) {
  std::set<std::string> names;
  for (const SceneKind& k : scene_kinds()) {
    EXPECT_TRUE(names.insert(k.name).second) << k.name;
    EXPECT_TRUE(k.run != nullptr && k.check != nullptr && k.read != nullptr) << k.name;
    EXPECT_EQ(complaint(k.name, k.command), "") << k.name;
    EXPECT_EQ(complaint(k.name, "run"), "") << k.name;
    EXPECT_STRNE(k.starter, "") << k.name;
    EXPECT_STREQ(kind_of(Scene::parse("kind = \"" + std::string(k.name) + "\"\n", "s.toml")).name, k.name);
  }
}

void expect_explained(const std::vector<RecordMember>& members, const std::string& of) {
  std::set<std::string> paths;
  for (const RecordMember& m : members) {
    EXPECT_TRUE(paths.insert(m.path).second) << of << ": " << m.path;
    EXPECT_NE(m.meaning, "") << of << ": " << m.path;
    if (m.number) {
      EXPECT_NE(m.unit, "") << of << ": " << m.path << " is a number without unit";
    }
  }
}

TEST(Kinds, EveryMemberOfASummaryHasItsMeaningAndUnit) {
  for (const SceneKind& k : scene_kinds()) {
    const std::vector<RecordMember> members = summary_members(k);
    expect_explained(members, k.name);
    EXPECT_GT(members.size(), members_of<AnySummary>().size()) << k.name << " names no member of its own";
    for (const char* of_every_kind : {"status", "title", "kind", "provenance.seed"})
      EXPECT_EQ(std::ranges::count(members, of_every_kind, &RecordMember::path), 1) << k.name << ": " << of_every_kind;
  }
  expect_explained(members_of<SetSummary>(), "several runs");
}

TEST(Kinds, MembersWithinRecordsAreNamedByTheirPaths) {
  const std::vector<RecordMember> members = summary_members(kind_of(Scene::parse("kind = \"pipeline\"\n", "s.toml")));
  const auto unit = [&](const std::string& path) {
    const auto at = std::ranges::find(members, path, &RecordMember::path);
    return at == members.end() ? "no member " + path : at->unit;
  };
  EXPECT_EQ(unit("forces.NAME[].force"), "N");
  EXPECT_EQ(unit("laws.NAME.normal.a_per_degree"), "N/degree");
  EXPECT_EQ(unit("macro.stages[].modulus_begin.mean"), "as the quantity");
  EXPECT_EQ(unit("macro.seconds"), "s");
  EXPECT_EQ(unit("entries[].laws[].m0.value"), "1");
}

TEST(Kinds, TheCommandsThatRunAKindAreNamed) {
  EXPECT_EQ(complaint("cohesive-powder", "macrosim"),
            "s.toml:1: kind = \"cohesive-powder\": scenes of this kind run with softgrain run or microsim, not with "
            "macrosim");
  EXPECT_NE(complaint("pipeline", "macrosim").find("softgrain run, not with macrosim"), std::string::npos);
  EXPECT_NE(complaint("macro", "microsim").find("softgrain run or macrosim"), std::string::npos);
}

/// What the command line asks for and the kind has no use for.
std::string idle_options(const std::string& kind, const CommonOptions& options) {
  try {
    refuse_idle_options(kind_of(Scene::parse("kind = \"" + kind + "\"\n", "s.toml")), options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Kinds, OptionsThatAKindHasNoUseForAreRefusedInOneMessage) {
  CommonOptions law;
  law.law = "law.toml";
  law.bands = 20;
  EXPECT_EQ(idle_options("pipeline", law), "--law, --bands: not for scenes of kind \"pipeline\"; goes with \"macro\"");
  EXPECT_EQ(idle_options("macro", law), "");
  CommonOptions lammps;
  lammps.engine = "lammps";
  lammps.ranks = 2;
  EXPECT_EQ(idle_options("particles", lammps),
            "--engine, --ranks: not for scenes of kind \"particles\"; goes with \"macro\", \"material\"");
  for (const char* kind : {"macro", "material"}) EXPECT_EQ(idle_options(kind, lammps), "");
  CommonOptions twins;
  twins.twin_cache = "twins";
  EXPECT_NE(idle_options("material", twins).find("--twin-cache: not for scenes of kind \"material\""),
            std::string::npos);
}

/// What the reader of its kind says of a scene.
std::string errors_of(const std::string& text) {
  const Scene scene = Scene::parse(text, "s");
  try {
    kind_of(scene).read(scene);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

struct Mistaken {
  const char* scene;
  const char* message;
};

/// Values, words, units, unknown keys, missing ones and checks that span keys; of each kind.
constexpr Mistaken kMistaken[] = {
    {R"(kind = "soft-particle"
titel = "x"
[packing]
beta = 0.9
raddius = 1.0
rmax = "20 mm"
[material]
E = "3 m"
[measure]
relaxation = "leest-work"
[measure.soft_solid]
deltas = [0.1, 0.05]
angles_deg = [0.0, 200]
)",
     R"(s:2: unknown key 'titel' at the top level; nearest known key is 'title'
s:4: beta = 0.9: must be above 1
s:5: unknown key 'raddius' in [packing]; known keys are beta, count, exponent, placement, polydispersity, rmax, shell_radius, sizes, trials
s:6: rmax = "20 mm": the shell (shell_radius = 0.016 m) must be larger than the largest grain
s:8: E = "3 m": unknown unit 'm', known are Pa, kPa, MPa, GPa, N/m^2, N/mm^2, bar, and must be above 0
s:10: relaxation = "leest-work": must be "least-work", "slow-dynamics", "damped" or "published"; nearest is "least-work"
s:12: deltas = [ 0.1, 0.05 ]: values must ascend
s:13: angles_deg = 200: must be from -90 to 90)"},
    {R"(kind = "pipeline"
[measure]
[calibrate]
replicates = -3
[macro]
bodies = 0
)",
     R"(s:2: soft_solid: neither soft_solid nor soft_soft is measured; give at least one
s:4: replicates = -3: must be a whole number from 0 to 1000000
s:6: bodies = 0: must be a whole number from 1 to 10000000)"},
    {R"(kind = "law-table"
[multi_contact]
packings_min = 5
packings_max = 2
pionts = 3
[[configuration]]
arrangement = "one"
partner = "plane"
ratio = 2
overlap = 0.3
[[configuration]]
partner = "solid"
overlap = 3
[[variant]]
packings = 0
)",
     R"(s:4: packings_max = 2: must be at least packings_min
s:5: unknown key 'pionts' in [multi_contact]; nearest known key is 'points'
s:9: ratio = 2: a plane has no radius; leave it out
s:11: missing key 'arrangement' in [[configuration]]
s:13: overlap = 3: must be above 0 and below 1
s:15: packings = 0: must be a whole number from 2 to 2)"},
    {R"(kind = "hierarchy"
seed = "x"
[hierarchy]
levels = 1
[fixed_point]
tolerance = 2
[check]
overlaps = [0.2, 0.1]
)",
     R"(s:2: seed = "x": must be a whole number from 0 to 1000000000000
s:4: levels = 1: must be a whole number from 2 to 100
s:6: tolerance = 2: must be above 0 and below 1
s:8: overlaps = [ 0.2, 0.1 ]: must ascend)"},
    {R"(kind = "material"
[grains]
count = 3
[packing]
preparation = "lammps"
[test]
strain = 0.1
[[stage]]
kind = "unload"
)",
     R"(s:3: count = 3: must be a whole number from 8 to 100000000
s:7: strain = 0.1: goes without [[stage]], which says the whole test
s:8: strain: missing; give strain or stress
s:9: kind = "unload": there is no stage before it whose way it could go)"},
    {R"(kind = "material"
[grains]
ratio = 2
[[loading]]
name = "pressed"
strian = 0.1
[[loading]]
name = "pressed"
test = "shear"
[[loading.stage]]
kind = "isotropic"
strain = 0.01
[[stage]]
kind = "isotropic"
strain = 0.01
[[variant]]
name = "a"
test = "shear"
loadings = ["presed", "pressed", "pressed"]
[[variant]]
name = "b"
loadings = []
)",
     R"(s:6: unknown key 'strian' in [[loading]]; nearest known key is 'strain'
s:8: name = "pressed": is used twice
s:9: test = "shear": goes without [[stage]], which says the whole test
s:13: stage: goes without [[loading]]: give [[loading.stage]], or a loading of its own
s:18: test = "shear": goes without [[loading]], which says what is tested
s:19: loadings = [ "presed", "pressed", "pressed" ]: no [[loading]] 'presed'; nearest is 'pressed'
s:22: loadings = []: at least one is needed)"},
    {R"(kind = "macro"
seed = -1
[macro]
preparation = "lammps"
construction = "voids"
strain = 0
[output]
snapshot = 3
)",
     R"(s:2: seed = -1: must be a whole number from 0 to 1000000000000
s:4: preparation = "lammps": "lammps" goes with construction "mixed": holes are filled in a packing that is compacted
s:6: strain = 0: must be from 1e-09 to 0.5
s:8: unknown key 'snapshot' in [output]; nearest known key is 'snapshots')"},
    {R"(kind = "macro-comparison"
[macro]
test = "sheer"
[[scene]]
name = "a b"
[[scene]]
samples = 0
[law]
forms = ["pair", "isotrop"]
)",
     R"(s:3: test = "sheer": must be "oedometric", "isotropic", "shear", "undrained", "simple-shear" or "direct-shear"; nearest is "shear"
s:5: name = "a b": letters, digits and '-' only: it becomes part of file names
s:7: samples = 0: must be a whole number from 1 to 10000
s:8: table: give a law table, a law card, or both)"},
    {R"(kind = "material-law"
samples = 0
[grains]
count = 2000
ratoi = 6
[law]
split = 1.0
form = "pore"
[test]
test = "shear"
)",
     R"(s:2: samples = 0: must be a whole number from 1 to 10000
s:5: unknown key 'ratoi' in [grains]; nearest known key is 'ratio'
s:7: split = 1: must be above 0 and below 1
s:8: form = "pore": must be "porosity" or "pores"; nearest is "pores"
s:10: test = "shear": the law is measured in oedometric compression (and the fines in shear))"},
    {R"(kind = "recipe"
samples = 0
[grains]
count = 2000
ratio = 6
[levels]
ratio = 20
mixtures = [0.5]
[test]
test = "shear"
[shells]
form = "isotrop"
)",
     R"(s:2: samples = 0: must be a whole number from 1 to 10000
s:7: ratio = 20: must be from 1.5 to 10
s:8: mixtures = [ 0.5 ]: at least three shares are needed: w_inf and xi are fitted to them
s:10: test = "shear": levels are measured in oedometric compression (and one of them in shear)
s:12: form = "isotrop": must be "pair", "isotropic" or "directional"; nearest is "isotropic")"},
    {R"(kind = "material-models"
blind = ["gap"]
[grains]
count = 200
[[model]]
name = "a"
kind = "coarse"
places = "own"
[[model]]
name = "a"
kind = "substitute"
smallest = 0.4
[[model]]
name = "b"
kind = "cell"
)",
     R"(s:2: blind = [ "gap" ]: 'gap' is no variant
s:4: count = 200: 200 grains are too few for a periodic cell: packed, its shortest side is about 4.03 radii of the largest, and images of that one must be two diameters apart, 4.1 radii: 630 or more have room ([grains] count)
s:8: places = "own": does not go with kind = "coarse"
s:10: name = "a": is used twice
s:12: smallest = 0.4: must be above 0 and below 0.333333333333333
s:15: kind = "cell": must be "cells", "substitute", "mean-field", "coarse" or "shells"; nearest is "cells")"},
    {R"(kind = "inverse"
[packing]
count = 1
[search]
mu = [0.6, 0.1]
beta = [3]
budgett = 3
[target]
delta = [0.1, 0.05, 0.2]
force = [1, 2]
)",
     R"(s:3: count = 1: must be a whole number from 2 to 100000
s:5: mu = [ 0.6, 0.1 ]: must be a range of two rising values [low, high]
s:6: beta = [ 3 ]: must be a range of two rising values [low, high]
s:7: unknown key 'budgett' in [search]; nearest known key is 'budget'
s:10: force = [ 1, 2 ]: must have as many values as delta (3))"},
    {R"(kind = "grain-box"
[material]
radius_min = "2 mm"
radius_max = "1 mm"
[box]
grains = 3
[solver]
method = "fasst"
refresh = 3
[loading]
increment = 0.01
increments = [0.01]
)",
     R"(s:4: radius_max = "1 mm": must not be below radius_min
s:6: grains = 3: must be a whole number from 8 to 10000000
s:8: method = "fasst": must be "fast" or "published"; nearest is "fast"
s:12: increments = [ 0.01 ]: give increment or increments, not both)"},
    {R"(kind = "cohesive-powder"
[disks]
count = 1
[contact]
zetta = 3
[assembly]
method = 3
start_speed = 3
[[variant]]
name = "a"
[[variant]]
name = "a"
[variant.disks]
diameter_min = 7
[variant.published]
Phi_error = 0.1
)",
     R"(s:3: count = 1: must be a whole number from 2 to 1000000 (in the variant "a")
s:5: unknown key 'zetta' in [contact]; nearest known key is 'zeta' (in the variant "a")
s:7: method = 3: must be a whole number from 1 to 2 (in the variant "a")
s:12: name = "a": is used twice
s:14: diameter_min = 7: must be from 0.001 to 1 (in the variant "a")
s:16: Phi_error = 0.1: without the value Phi)"},
    {R"(kind = "particles"
gravity = [0, 0]
[material.glass]
nu = 0.9
densty = 3
[[wall]]
shape = "plain"
material = "rigid"
[[contact]]
pair = ["glass", "glas"]
[[particle]]
material = "gless"
radius = "-1 mm"
[[particle]]
material = "glass"
radius = "1 mm"
[time]
end = "0 s"
[output]
record = 3
)",
     R"(s:2: gravity = [ 0, 0 ]: must have three components
s:3: missing key 'E' in [material.glass]
s:4: nu = 0.9: must be above -1 and at most 0.5
s:5: unknown key 'densty' in [material.glass]; nearest known key is 'density'
s:7: shape = "plain": must be "plane" or "sphere-inside"; nearest is "plane"
s:10: pair = [ "glass", "glas" ]: no material 'glas'; nearest is 'glass'
s:12: material = "gless": no such material; nearest is 'glass'
s:14: missing key 'position' in [[particle]]
s:18: end = "0 s": must be above 0
s:20: record = 3: must be true or false)"}};

TEST(Kinds, SayAllMistakesOfASceneAtOnce) {
  std::set<std::string> kinds;
  for (const Mistaken& m : kMistaken) {
    EXPECT_EQ(errors_of(m.scene), m.message);
    kinds.insert(kind_of(Scene::parse(m.scene, "s")).name);
  }
  EXPECT_EQ(kinds.size(), scene_kinds().size()) << "one scene of each kind";
}

/// Titles stand in reports, pictures and files for LAMMPS: no characters that move the cursor of a terminal.
TEST(Kinds, TitlesHaveNoControlCharacters) {
  for (const Mistaken& m : kMistaken)
    for (const char* title : {"\\u001b[2Jb", "a\\nb", "a\\tb", "a\\u009bb"}) {
      const std::string text = errors_of("title = \"" + std::string(title) + "\"\n" + m.scene);
      EXPECT_NE(text.find("s:1: title = \""), std::string::npos) << text;
      EXPECT_NE(text.find("must be one line of text, without control characters"), std::string::npos) << text;
      EXPECT_EQ(text.find('\x1b'), std::string::npos) << title;
    }
  EXPECT_EQ(errors_of(std::string("title = \"one line\"\n") + kMistaken[0].scene).find("title = "), std::string::npos);
}

TEST(Kinds, UnknownOnesAreNamedWithTheNearest) {
  EXPECT_NE(complaint("pipline", "run").find("nearest is \"pipeline\""), std::string::npos)
      << complaint("pipline", "run");
  EXPECT_THROW((void)kind_of(Scene::parse("seed = 1\n", "s.toml"), "run"), InputError);
}

}  // namespace
}  // namespace softgrain

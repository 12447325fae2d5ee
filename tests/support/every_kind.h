// One tiny scene of every kind that a command runs, each about a second: for tests that hold for all of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "common/core/random.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/kinds.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_comparison.h"
#include "tests/support/tiny_hierarchy.h"
#include "tests/support/tiny_law_table.h"
#include "tests/support/tiny_pipeline.h"

namespace softgrain::test {

inline constexpr const char* kTinySoftParticle = R"(kind = "soft-particle"
seed = 1
[packing]
trials = 100
polydispersity = 4.0
count = 2
beta = 8.0
[measure]
relaxation = "least-work"
rotation = "cumulative"
[measure.soft_solid]
deltas = [0.15, 0.25]
tangential_deltas = [0.25]
angles_deg = [-0.5, -0.05, 0.05, 0.5]
[measure.soft_soft]
deltas = [0.3]
[reference]
relaxation = "published"
count = 1
[reference.soft_solid]
deltas = [0.15, 0.25]
)";

inline constexpr const char* kTinyMacro = R"(kind = "macro"
seed = 1
contents = 1
law = "law.toml"
[macro]
bodies = 6
steps = 1
strain = 0.08
increments_per_step = 3
resolved = ["shelled"]
)";

inline constexpr const char* kTinyPowder = R"(kind = "cohesive-powder"
seed = 1
samples = 2
[disks]
count = 60
solid_fraction = 0.36
[contact]
kappa = 1e3
mu = 0.5
[assembly]
method = 2
aggregation_kappa = 1e2
stiffening_time = 20.0
edge_speed_cap = 0.05
pressure = 0.1
[analysis]
mesh = 10
)";

inline constexpr const char* kTinyPowderVariants = R"(kind = "cohesive-powder"
samples = 1
[disks]
count = 60
solid_fraction = 0.36
[contact]
cohesive = false
kappa = 1e3
mu = 0.5
[analysis]
scattering = false
holes = false
[[variant]]
name = "rough"
published = { Phi = 0.81, Phi_error = 0.01, z = 2.6 }
[[variant]]
name = "smooth"
contact = { mu = 0.0 }
)";

inline constexpr const char* kTinyGrainBox = R"(kind = "grain-box"
seed = 5
[box]
grains = 60
[generation]
pressure = "10 MPa"
increment = 5e-4
window = 4
saturation = 0.1
[loading]
increment = 1e-3
end_strain = 0.01
probe_every = 4
[[variant]]
name = "a"
[[variant]]
name = "b"
mu = 0.6
)";

/// Grains fall into a sphere that a rising plane cuts.
inline std::string tiny_particles(const std::string& end = "0.6") {
  std::string text = R"(kind = "particles"
gravity = [0.0, 0.0, -9.81]
[material.glass]
density = 2500.0
E = "1 MPa"
nu = 0.2
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.8
mu = 0.4
tangential = "rescaled"
[[wall]]
shape = "sphere-inside"
center = [0.0, 0.0, 0.0]
radius = 0.1
material = "glass"
[[wall]]
shape = "plane"
point = [0.0, 0.0, -0.06]
normal = [0.0, 0.0, 1.0]
material = "glass"
motion = "velocity"
velocity = [0.0, 0.0, 0.01]
[output]
every = 0.01
[checkpoint]
every_steps = 500
[time]
step = 2e-5
end = )" + end + "\n";
  RandomStream random(4, RandomPurpose::test, 0);
  for (int n = 0; n < 60; ++n) {
    std::string position;
    for (const int k : {n % 4, n / 4 % 4, n / 16})
      position += (position.empty() ? "" : ", ") + std::to_string(0.026 * (k - 1.5) + 1e-3 * random.uniform());
    text += "[[particle]]\nmaterial = \"glass\"\nradius = " + std::to_string(0.010 + 0.002 * random.uniform()) +
            "\nposition = [" + position + "]\n";
  }
  return text;
}

/// Cohesive disks that resist rolling fall into a circle that a line cuts.
inline std::string tiny_disks(const std::string& end = "60.0") {
  std::string text = R"(kind = "particles"
dimension = 2
gravity = [0.0, -0.05]
[material.powder]
density = 1.2732395447351628
[[contact]]
pair = ["powder", "powder"]
law = "cohesive"
normal_stiffness = 1e3
tangential_stiffness = 1e3
mu = 0.5
zeta = 0.8
adhesion = 1.0
range = 1e-2
rolling_stiffness = 0.1
rolling_limit = 5e-3
[[contact]]
pair = ["powder", "rigid"]
law = "linear-spring"
restitution = 0.3
mu = 0.5
normal_stiffness = 1e3
tangential_stiffness = 1e3
[[wall]]
shape = "sphere-inside"
center = [0.0, 0.0]
radius = 6.0
material = "rigid"
[[wall]]
shape = "plane"
point = [0.0, -4.0]
normal = [0.0, 1.0]
material = "rigid"
[output]
every = 3.0
[checkpoint]
every_steps = 500
[time]
step = 3e-3
end = )" + end + "\n";
  RandomStream random(5, RandomPurpose::test, 0);
  for (int n = 0; n < 36; ++n)
    text += "[[particle]]\nmaterial = \"powder\"\nradius = " + std::to_string(0.3 + 0.2 * random.uniform()) +
            "\nposition = [" + std::to_string(1.1 * (n % 6 - 2.5) + 0.1 * random.uniform()) + ", " +
            std::to_string(1.1 * (n / 6 - 2.5) + 0.1 * random.uniform()) + "]\nspin = 0.1\n";
  return text;
}

inline constexpr const char* kTinyMaterial = R"(kind = "material"
seed = 1
samples = 2
[grains]
count = 80
ratio = 1.5
[packing]
preparation = "fast"
[test]
steps = 2
increments_per_step = 2
[[stage]]
kind = "isotropic"
strain = 0.02
[[stage]]
kind = "triaxial"
strain = 0.02
[output]
snapshots = 2
)";

inline constexpr const char* kTinyMaterialLaw = R"(kind = "material-law"
seed = 1
samples = 2
[grains]
count = 120
ratio = 1.6
[law]
split = 0.8
mixtures = [0.2, 0.4, 0.7]
cells = 40
shear_strain = 0.04
[packing]
preparation = "fast"
[test]
steps = 3
increments_per_step = 2
strain = 0.05
preload_steps = 1
)";

/// The small scene of a kind that `softgrain new` writes, where that is tiny enough for tests.
inline std::string starter_scene(const std::string& kind) {
  for (const SceneKind& k : scene_kinds())
    if (kind == k.name) return "kind = \"" + kind + "\"\n" + k.starter;
  ADD_FAILURE() << "no kind " << kind;
  return "";
}

/// A text with one part in place of another, which must be there.
inline std::string with_part(std::string text, const std::string& part, const std::string& other) {
  const auto at = text.find(part);
  if (at == std::string::npos)
    ADD_FAILURE() << part << " is not in " << text;
  else
    text.replace(at, part.size(), other);
  return text;
}

/// The starter of a recipe with stages in place of its test.
inline std::string staged_recipe(const std::string& stages) {
  return with_part(with_part(starter_scene("recipe"), "\nstrain = 0.05\n", "\n"), "\npreload_steps = 1\n", "\n") +
         stages;
}

struct KindScene {
  std::string name;
  std::string command;
  std::string text;
  int status = 0;        ///< of the undisturbed run: 3 where so little was measured that a law stays underdetermined
  bool instant = false;  ///< it ends within milliseconds: no signal finds it with kept tasks
};

/// Names of tests, instead of their bytes.
inline void PrintTo(const KindScene& s, std::ostream* out) { *out << s.name; }

inline std::vector<KindScene> every_kind() {
  std::vector<KindScene> kinds{{"pipeline", "", kTinyPipeline, 3},
                               {"soft-particle", "", kTinySoftParticle, 0},
                               {"macro", "", kTinyMacro, 0},
                               {"material", "", kTinyMaterial, 0},
                               {"material-law", "", kTinyMaterialLaw, 3},
                               {"recipe", "", starter_scene("recipe"), 0},
                               {"material-models", "", starter_scene("material-models"), 0},
                               {"macro-comparison", "", kTinyComparison, 0},
                               {"law-table", "", std::string(kTinyLawTable) + kTinyLawFit, 0},
                               {"hierarchy", "", kTinyHierarchy, 3},
                               {"inverse", "", starter_scene("inverse"), 0},
                               {"particles", "", tiny_particles(), 0},
                               {"disks", "", tiny_disks(), 0},
                               {"powder", "", kTinyPowder, 0},
                               {"powder-variants", "", kTinyPowderVariants, 0},
                               {"grain-box", "", kTinyGrainBox, 0}};
  std::set<std::string> found;
  for (KindScene& k : kinds) {
    const Scene scene = Scene::parse(k.text, k.name);
    const SceneKind& kind = kind_of(scene);
    k.command = kind.command;
    found.insert(kind.name);
  }
  EXPECT_EQ(found.size(), scene_kinds().size()) << "every kind of the table needs a tiny scene here";
  return kinds;
}

inline bool is_slow(const KindScene& k) {
  return k.name == "law-table" || k.name == "hierarchy" || k.name == "material-law" || k.name == "recipe";
}

/// Those that take about a second.
inline std::vector<KindScene> quick_kinds() {
  std::vector<KindScene> kinds = every_kind();
  std::erase_if(kinds, is_slow);
  return kinds;
}

/// Quick ones that a signal finds in the middle, with kept tasks.
inline std::vector<KindScene> quick_kinds_with_tasks() {
  std::vector<KindScene> kinds = quick_kinds();
  std::erase_if(kinds, [](const KindScene& k) { return k.instant; });
  return kinds;
}

/// Those that take several seconds.
inline std::vector<KindScene> slow_kinds() {
  std::vector<KindScene> kinds = every_kind();
  std::erase_if(kinds, [](const KindScene& k) { return !is_slow(k); });
  return kinds;
}

inline std::string name_of_kind(const ::testing::TestParamInfo<KindScene>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// The scene of a kind with what it needs beside it; arguments for the program.
class KindRuns {
 public:
  explicit KindRuns(KindScene kind) : kind_(std::move(kind)) {
    write_text_atomic(directory_.file("scene.toml"), kind_.text);
    save_card(synthetic::card(), directory_.file("law.toml"));
  }
  [[nodiscard]] std::string out(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] std::vector<std::string> arguments(const std::string& name,
                                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{kind_.command, directory_.file("scene.toml"), "--out", out(name), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] const KindScene& kind() const { return kind_; }

 private:
  TemporaryDirectory directory_;
  KindScene kind_;
};

}  // namespace softgrain::test

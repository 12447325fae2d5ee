// Tiny scenes that together have every place where a key may stand: for tests that go over all keys.
#pragma once

#include <string>
#include <vector>

#include "common/data/cell_card.h"
#include "common/io/text_file.h"
#include "tests/support/every_kind.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {

/// In the folder of every scene: a law card, a packing, a list of sizes, a sieve analysis, measured forces.
inline void write_keyed_files(const TemporaryDirectory& directory) {
  save_card(synthetic::card(), directory.file("law.toml"));
  std::string packing = "x [mm],y [mm],z [mm],r [mm],kind\n";
  for (int k = 0; k < 27; ++k)
    packing += std::to_string(20 + 31 * (k % 3)) + "," + std::to_string(20 + 31 * (k / 3 % 3)) + "," +
               std::to_string(20 + 31 * (k / 9)) + "," + (k % 4 == 0 ? "16,soft\n" : "15.5,solid\n");
  write_text_atomic(directory.file("bodies.csv"), packing);
  write_text_atomic(directory.file("sieves.csv"), "sieve,retained [g]\n14,0\n8,30\n6,40\npan,45\n");
  write_text_atomic(directory.file("other-bodies.csv"), packing.substr(0, packing.rfind('\n', packing.size() - 2) + 1));
  LawCard other = synthetic::card();
  for (PairLaw& law : other.pairs) law.delta_max *= 0.9;
  save_card(other, directory.file("other-law.toml"));
  CellCard cells = read_cell_card(SOFTGRAIN_SOURCE_DIR "/results/material_law/cell_law.toml");
  cells.preparations = {{"slow", {0.97, 0.01, 0.95, 0.99}}};
  write_cell_card(cells, directory.file("cells.toml"));
}

inline constexpr const char* kMaterialHead = R"(kind = "material"
seed = 1
[grains]
count = 80
ratio = 1.5
[packing]
preparation = "fast"
[test]
steps = 2
increments_per_step = 2
strain = 0.02
)";

/// Stages of all, and a variant with nothing of its own but what its preparation follows from.
inline std::string material_variants() {
  return std::string(kMaterialHead).substr(0, std::string(kMaterialHead).find("strain")) + R"([[stage]]
kind = "isotropic"
strain = 0.02
[[stage]]
kind = "unload"
strain = 0.01
[[stage]]
kind = "hold"
[[variant]]
name = "a"
preparation = "slow"
mu = 0.5
)";
}

inline std::string material_loadings() {
  return std::string(kMaterialHead) + R"([equation]
spans = [3.0]
[[equation.onset]]
span = 5.0
value = 0.65
standard_error = 0.01
[[variant]]
name = "a"
[[variant]]
name = "b"
ratio = 2.0
loadings = ["sheared"]
[[loading]]
name = "pressed"
[[loading]]
name = "sheared"
test = "shear"
preload = 0.01
[[loading]]
name = "staged"
[[loading.stage]]
kind = "triaxial"
strain = 0.02
lateral_stress = 1000.0
[[loading.stage]]
kind = "cycles"
count = 1
strain = 0.01
)";
}

inline std::string comparison_stages() {
  const std::string text = kTinyComparison;
  return text.substr(0, text.find("strain")) + R"([[stage]]
kind = "oedometric"
strain = 0.05
[[stage]]
kind = "axes"
strain_x = 0.01
stress_z = 500.0
[[scene]]
)";
}

inline std::string comparison_packing() {
  return R"(kind = "macro-comparison"
[packing]
polydispersity = 3.0
trials = 200
[law]
card = "law.toml"
[macro]
packing = "bodies.csv"
steps = 2
strain = 0.1
increments_per_step = 1
resolved = false
[[scene]]
)";
}

inline std::string macro_cells() {
  return R"(kind = "macro"
law = "cells.toml"
[macro]
bodies = 40
boundary = "periodic"
preparation = "fast"
start_pressure = 1e-4
solid_polydispersity = 3
steps = 3
strain = 0.06
[fines]
share = 0.4
)";
}

inline std::string material_law_memory() {
  std::string text = kTinyMaterialLaw;
  text.replace(text.find("cells = 40\n"), 11, "memory = true\n");
  return text;
}

inline std::string macro_table() {
  return std::string("kind = \"macro\"\nlaw = \"") + SOFTGRAIN_SOURCE_DIR +
         "/tests/reference/law/two_fractions.toml\"\n" + R"([macro]
bodies = 12
steps = 1
resolved = false
[macro.solid_sizes]
form = "log-normal"
radius_median = "12 mm"
geometric_deviation = 1.3
radius_min = "9 mm"
radius_max = "16 mm"
[[stage]]
kind = "consolidation"
stress = [200.0, 200.0, 300.0]
[[stage]]
kind = "triaxial"
stress = 500.0
[[stage]]
kind = "unload"
stress = 400.0
[[stage]]
kind = "reload"
)";
}

inline std::string models_scene() {
  return starter_scene("material-models") + "[[model]]\nname = \"cells\"\nkind = \"cells\"\nsplit = 0.8\ncard = \"" +
         SOFTGRAIN_SOURCE_DIR +
         "/results/material_law/cell_law.toml\"\n[[model]]\nname = \"mean\"\nkind = "
         "\"mean-field\"\ncard = \"" +
         SOFTGRAIN_SOURCE_DIR + "/results/material_law/cell_law.toml\"\n[[variant]]\nname = \"a\"\n";
}

inline std::string recipe_constituents() {
  return R"(kind = "recipe"
[grains]
count = 150
[levels]
ratio = 1.6
mixtures = [0.25, 0.5, 0.75]
[packing]
preparation = "fast"
[check]
grains = 300
[shells]
levels = 2
[[constituent]]
name = "a"
mass_share = 0.6
sizes = { form = "power-law", exponent = 3.5, radius_min = "2 mm", radius_max = "4 mm" }
[[constituent]]
name = "b"
mass_share = 0.4
density = 3000.0
sizes = { form = "fuller", exponent = 0.5, radius_min = "1.5 mm", radius_max = "3 mm" }
)";
}

inline std::string recipe_materials() {
  return R"(kind = "recipe"
[material]
E = 5e9
[grains]
count = 150
[levels]
ratio = 1.6
mixtures = [0.25, 0.5, 0.75]
[packing]
preparation = "fast"
[check]
grains = 300
[[constituent]]
name = "a"
mass = 3.0
E = 9e9
nu = 0.2
sizes = { form = "power-law", exponent = 3.5, radius_min = "2 mm", radius_max = "4 mm" }
[[constituent]]
name = "b"
mass = 2.0
mu = 0.4
sizes = { form = "fuller", exponent = 0.5, radius_min = "1.5 mm", radius_max = "3 mm" }
)";
}

inline std::string material_constituents() {
  return R"(kind = "material"
samples = 1
[grains]
count = 60
[packing]
preparation = "fast"
[test]
strain = 0.02
steps = 4
[[constituent]]
name = "a"
mass_share = 0.6
E = 9e5
mu = 0.5
sizes = { form = "power-law", exponent = 3.5, radius_min = "2 mm", radius_max = "4 mm" }
[[constituent]]
name = "b"
mass_share = 0.4
nu = 0.2
density = 3000.0
sizes = { form = "fuller", exponent = 0.5, radius_min = "1.5 mm", radius_max = "3 mm" }
)";
}

inline std::string recipe_stages() {
  const std::string scene = staged_recipe(R"([[stage]]
kind = "oedometric"
stress = 1000.0
modulus_stress = [400.0, 900.0]
[[stage]]
kind = "unload"
stress = 200.0
)");
  return with_part(with_part(scene, "title = \"A small recipe\"\nseed = 1\n", ""), "[check]\ngrains = 300\n",
                   "[check]\ngrains = 0\n");
}

inline std::string drawn_particles() {
  return R"(kind = "particles"
gravity = [0.0, 0.0, -9.81]
seed = 2
[material.soft]
density = 1500.0
[material.stone]
density = 2500.0
E = "1 MPa"
nu = 0.2
[[contact]]
pair = ["soft", "stone"]
law = "law-card"
file = "law.toml"
kind = "soft-solid"
which_soft = "soft"
E = 5e5
mu = 0.3
damping = 0.1
kt = "initial"
[[contact]]
pair = ["stone", "stone"]
law = "hertz-tsuji"
restitution = 0.5
mu = 0.3
[[particle]]
material = "soft"
radius = 0.02
position = [0.03, 0.03, 0.03]
[[particle]]
material = "stone"
radius = 0.02
position = [0.064, 0.031, 0.03]
velocity = [0.0, 0.5, 0.0]
[[particle]]
material = "stone"
radius = 0.02
position = [0.1025, 0.031, 0.03]
[particles]
material = "stone"
count = 10
[particles.sizes]
form = "classes"
[[particles.sizes.class]]
radius = 0.01
volume_share = 0.4
[[particles.sizes.class]]
radius_min = 0.008
radius_max = 0.009
volume_share = 0.6
[cell]
size = [0.2, 0.2, 0.2]
periodic = [true, true, true]
[time]
end = 0.02
)";
}

inline std::string grain_box_triaxial() {
  const std::string text = kTinyGrainBox;
  return text.substr(0, text.find("[loading]")) + R"([loading]
test = "triaxial"
lateral_stress = "12 MPa"
increments = [1e-3, 5e-4]
stage_strains = [0.004]
end_strain = 0.01
[solver]
method = "published"
)";
}

inline std::string grain_box_polyaxial() {
  const std::string text = kTinyGrainBox;
  return text.substr(0, text.find("[loading]")) + R"([loading]
test = "polyaxial"
strain_rates = [0.0, 0.0, 1.0]
control = ["stress", "stress", "strain"]
stresses = [12e6, 12e6, 0.0]
increment = 1e-3
end_strain = 0.01
)";
}

inline std::string soft_particle_sizes() {
  return R"(kind = "soft-particle"
[packing]
trials = 100
beta = 8.0
count = 2
[packing.sizes]
form = "sieve-curve"
openings = [0.004, 0.008, 0.014]
passing = [0.0, 0.4, 1.0]
[measure]
relaxation = "damped"
[measure.soft_solid]
deltas = [0.1, 0.2]
)";
}

/// The same with a file that leaves the unit, the meaning and the smallest size to keys.
inline std::string soft_particle_sieves() {
  std::string text = soft_particle_sizes();
  const std::string lists = "openings = [0.004, 0.008, 0.014]\npassing = [0.0, 0.4, 1.0]\n";
  text.replace(text.find(lists), lists.size(),
               "file = \"sieves.csv\"\ncolumn = \"retained\"\nunit = \"mm\"\nsmallest = \"4 mm\"\n");
  return text;
}

inline std::string pipeline_multi_contact() {
  const std::string text = kTinyPipeline;
  return text + "resolved = false\n" + R"([multi_contact]
relaxation = "damped"
packings_min = 4
[[configuration]]
arrangement = "scattered"
partner = "mixed"
overlap = 0.1
neighbours = 6
[[configuration]]
arrangement = "one"
partner = "plane"
overlap = 0.3
[[configuration]]
arrangement = "one"
partner = "solid"
overlap = 0.3
path = "slide"
)";
}

inline std::string law_table_variants() {
  return std::string(kTinyLawTable) + R"([[plan]]
configuration = "one-plane"
depth = 0.5
packings = 3
[[variant]]
beta = 5.0
packings = 2
[calibrate]
min_packings = 2
)";
}

inline std::vector<KindScene> keyed_scenes() {
  std::vector<KindScene> scenes = every_kind();
  const auto add = [&](const char* name, const std::string& text) {
    scenes.push_back({name, kind_of(Scene::parse(text, name)).command, text, 0});
  };
  add("material-variants", material_variants());
  add("material-loadings", material_loadings());
  add("comparison-stages", comparison_stages() + "[scene.law]\ncard = \"other-law.toml\"\n[[scene]]\nname = \"b\"\n");
  add("comparison-packing", comparison_packing());
  add("macro-cells", macro_cells());
  add("material-law-memory", material_law_memory());
  add("macro-table", macro_table());
  add("models", models_scene());
  add("recipe-constituents", recipe_constituents());
  add("recipe-materials", recipe_materials());
  add("material-constituents", material_constituents());
  add("recipe-stages", recipe_stages());
  add("particles-drawn", drawn_particles());
  add("grain-box-triaxial", grain_box_triaxial());
  add("grain-box-polyaxial", grain_box_polyaxial());
  add("soft-particle-sizes", soft_particle_sizes());
  add("soft-particle-sieves", soft_particle_sieves());
  add("pipeline-crowd", pipeline_multi_contact());
  add("law-table-variants", law_table_variants());
  return scenes;
}

}  // namespace softgrain::test

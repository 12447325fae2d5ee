// Every scene in pipelines/, made small, gives the same bits in every file whatever the number of threads and whatever
// is shown or recorded on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

/// A scene of pipelines/ in a form of about a second. A new scene there needs a row here.
struct SmallForm {
  std::string file;
  std::string command;
  std::vector<std::string> overrides;
  int status = 0;          ///< 3 where a small form measures too little for a law
  bool by_default = true;  ///< false: even so small it takes several seconds
};

/// Names of tests, instead of their bytes.
inline void PrintTo(const SmallForm& s, std::ostream* out) { *out << s.file; }

const std::vector<std::string> kSmallPacking{"packing.count=2", "packing.polydispersity=4", "packing.trials=100",
                                             "packing.beta=8"};
const std::vector<std::string> kSmallMacro{"macro.bodies=8", "macro.samples=2", "macro.steps=2"};
const std::vector<std::string> kSmallPowder{"samples=1", "disks.count=60", "contact.kappa=1e3"};
const std::vector<std::string> kTwoDeltas{"measure.soft_solid.deltas=[0.1,0.2]", "measure.soft_soft.deltas=[0.2,0.3]"};

std::vector<std::string> with(std::vector<std::string> all, const std::vector<std::vector<std::string>>& more) {
  for (const auto& part : more) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::vector<SmallForm> small_forms() {
  const std::vector<std::string> rotated{"measure.soft_solid.tangential_deltas=[0.2]",
                                         "measure.soft_solid.angles_deg=[-1.0,0.05]"};
  const std::vector<std::string> soft_rotated{"measure.soft_soft.tangential_deltas=[0.3]",
                                              "measure.soft_soft.angles_deg=[0.05]"};
  const std::vector<std::string> table_law{
      "macro.bands=8",
      "multi_contact.packings_min=4",
      "multi_contact.packings_max=4",
      "multi_contact.increment=0.05",
      "multi_contact.settle_time=5",
      "multi_contact.tolerance=0.1",
      "calibrate.multi_contact.replicates=10",
      R"(configuration=[{arrangement="one",partner="plane",overlap=0.45},{arrangement="cube",partner="plane",overlap=0.3},{arrangement="one",partner="solid",ratio=1.0,overlap=0.45},{arrangement="one",partner="soft",ratio=1.0,overlap=0.55}])"};
  const std::vector<std::string> quick_rest{"measure.least_work.settle_time=5", "measure.least_work.path_settle_time=5",
                                            "measure.least_work.settle_time_rotated=2"};
  // Deep enough for laws, so that a macro run follows.
  const std::vector<std::string> deep{"packing.count=4",
                                      "packing.polydispersity=5",
                                      "packing.trials=100",
                                      "packing.beta=8",
                                      "measure.soft_solid.deltas=[0.2,0.3,0.35,0.4,0.45]",
                                      "measure.soft_soft.deltas=[0.3,0.4,0.45,0.5,0.55,0.6]",
                                      "calibrate.min_packings=2",
                                      "calibrate.replicates=10",
                                      "measure.soft_solid.tangential_deltas=[0.35,0.4,0.45]",
                                      "measure.soft_solid.angles_deg=[-0.05,0.05]",
                                      "measure.soft_soft.tangential_deltas=[0.5,0.55,0.6]",
                                      "measure.soft_soft.angles_deg=[-0.05,0.05]"};
  const std::vector<std::string> reference{"reference.count=1", "reference.soft_solid.deltas=[0.2]"};
  const std::vector<std::string> unrotated_reference{"reference.soft_solid.tangential_deltas=[]"};
  const std::vector<std::string> method2 = with(kSmallPowder, {{"assembly.time_max=2000"}});
  const std::string plane = R"({arrangement="one",partner="plane",overlap=0.3})";
  const std::string two = R"({arrangement="opposite",partner="plane",overlap=0.2})";
  const std::string soft = R"({arrangement="one",partner="soft",overlap=0.4})";
  const std::string solid = R"({arrangement="one",partner="solid",overlap=0.4})";
  const std::vector<std::string> multi_contact{
      "packing.polydispersity=3",     "packing.trials=100",           "packing.beta=8",
      "multi_contact.packings_min=4", "multi_contact.packings_max=4", "multi_contact.points=4",
      "multi_contact.increment=0.05"};
  const auto box = [](const std::string& variants) {
    return std::vector<std::string>{"box.grains=60",
                                    "loading.increment=1e-3",
                                    "loading.end_strain=0.004",
                                    "generation.increment=5e-4",
                                    "generation.window=4",
                                    "generation.saturation=0.1",
                                    variants};
  };
  return {
      {"calibration.toml", "run", with(deep, {quick_rest}), 3},
      {"four_decades.toml", "run",
       with(multi_contact, {{"configuration=[" + plane + "," + solid + "," + soft + "]", "hierarchy.levels=2",
                             "hierarchy.form=isotropic", "hierarchy.inner_radius=0.3", "hierarchy.replicates=4",
                             "fixed_point.iterations=2", "fixed_point.tolerance=0.9", "check.packings=1",
                             "check.overlaps=[0.2,0.3]"}}),
       3, false},
      {"glass_beads.toml", "microsim", box(R"(variant=[{name="4MPa"},{name="rough",wall_mu=0.3}])"), 0},
      {"glass_beads_comparison.toml", "microsim",
       box(R"(variant=[{name="frictionless",mu=0.0},{name="reference-rule",coulomb="reference"}])"), 0},
      {"glass_beads_sliding.toml", "microsim",
       with(box(R"(variant=[{name="isotropic",friction_path="isotropic",torsion=false}])"), {{"arrangements=2"}}), 0},
      {"glass_beads_small.toml",
       "microsim",
       {"box.grains=60", "loading.increment=1e-3", "loading.end_strain=0.004", "generation.increment=5e-4",
        "generation.window=4", "generation.saturation=0.1"},
       0},
      {"inverse.toml",
       "run",
       {"packing.count=3", "packing.polydispersity=4", "measure.relaxation=damped", "measure.damped.increment=0.02",
        "target.delta=[0.2,0.3,0.4]", "target.force=[0.3,1.0,2.5]", "target.error=[0.2,0.5,1.0]",
        "search.trials=[100,2000]", "search.budget=13", "search.design=11", "search.replicates=20"},
       0},
      {"law_table.toml", "run",
       with(multi_contact,
            {{"configuration=[" + plane + "," + two + "," + soft + "]", "calibrate.replicates=2", "variant=[]",
              "multi_contact.orientations=2", R"(plan=[{configuration="opposite-plane",depth=0.6,packings=5}])"}}),
       0, false},
      {"law_library.toml", "run",
       with(multi_contact, {{"configuration=[" + plane + "," + two + "," + soft + "]", "calibrate.replicates=2"}}), 3,
       false},
      {"macro_vs_resolved.toml", "run",
       with(
           {"packing.polydispersity=4", "packing.trials=300", "packing.count=2", "macro.bodies=8", "macro.samples=2"},
           {{R"(scene=[{test="oedometric",strain=0.2,steps=2},{test="shear",preload=0.06,preload_steps=1,strain=0.1,steps=1}])",
             "law.range=clamp"}}),
       0},
      {"extreme_polydispersity.toml", "run",
       with(
           {"packing.polydispersity=4", "packing.trials=300", "packing.count=2", "macro.bodies=40"},
           {{R"(scene=[{name="two",resolved=["shelled"],strain=0.2,steps=2},{name="four",strain=0.2,steps=2,law={table="../results/hierarchy/law_table.toml",forms=["directional"]}}])",
             "law.range=clamp"}}),
       0},
      {"material.toml",
       "run",
       {"samples=2", "grains.count=80", "grains.ratio=2", "test.steps=3",
        R"(loading=[{name="pressed"},{name="sheared",test="shear",strain=0.03}])"},
       0},
      {"material_four_decades.toml",
       "run",
       {"samples=2", "grains.count=80", "test.steps=4", "equation.spans=[2]", "equation.largest_span=1.7",
        "equation.replicates=40",
        R"(variant=[{name="a",ratio=1.2},{name="b",ratio=1.4},{name="c",ratio=1.7},{name="d",ratio=2,samples=1}])"},
       0},
      {"material_law.toml",
       "run",
       {"samples=1", "grains.count=120", "grains.ratio=1.6", "law.split=0.8", "law.mixtures=[0.2,0.4,0.7]",
        "law.cells=40", "test.steps=3", "test.preload_steps=1"},
       0,
       false},
      {"graded_sand.toml",
       "run",
       {"samples=1", "grains.count=150", "levels.mixtures=[0.25,0.5,0.75]", "law.cells=40", "law.replicates=40",
        R"(grains.sizes={form="fuller",exponent=0.5,radius_min="0.45 mm",radius_max="1 mm"})", "levels.ratio=1.6",
        "test.steps=4", "test.preload_steps=1", "check.grains=300", "check.samples=1", "macro.grains=40",
        "macro.samples=1"},
       0,
       false},
      {"sand_modulus.toml",
       "run",
       {"samples=1", "grains.count=150", "levels.mixtures=[0.25,0.5,0.75]", "law.cells=40", "law.replicates=40",
        R"(grains.sizes={form="fuller",exponent=0.5,radius_min="0.45 mm",radius_max="1 mm"})", "levels.ratio=1.6",
        "test.steps=4", "check.grains=300", "check.samples=1", "macro.grains=40", "macro.samples=1"},
       0,
       false},
      {"uhpc.toml",
       "run",
       {"samples=1", "grains.count=150", "levels.mixtures=[0.25,0.5,0.75]", "law.cells=40", "law.replicates=40",
        R"(grains.sizes={form="fuller",exponent=0.23,radius_min="0.23 mm",radius_max="0.5 mm"})", "levels.ratio=1.6",
        "test.steps=4", "test.preload_steps=1", "check.grains=0", "macro.grains=40", "macro.samples=1",
        "shells.levels=2", "shells.ratio=2"},
       3,
       false},
      {"mixed_materials.toml",
       "run",
       {"samples=1", "grains.count=80", R"(stage=[{kind="oedometric",stress="50 MPa",steps=2}])",
        R"(constituent=[{name="a",mass=3,E="90 GPa",mu=0.5,density=2600,sizes={form="power-law",exponent=3.5,radius_min="1 mm",radius_max="1.5 mm"}},{name="b",mass=2,E="40 GPa",nu=0.1,sizes={form="power-law",exponent=3.5,radius_min="0.8 mm",radius_max="1.2 mm"}}])"},
       0},
      {"uhpc_constituents.toml",
       "run",
       {"samples=1", "grains.count=150", "levels.ratio=1.6", "levels.mixtures=[0.25,0.5,0.75]", "law.cells=40",
        "law.replicates=40", "test.steps=4", "test.preload_steps=1", "check.grains=0", "macro.grains=40",
        "macro.samples=1",
        R"(constituent=[{name="a",mass_share=0.6,sizes={form="log-normal",radius_median="1.2 mm",geometric_deviation=1.3,radius_min="1 mm",radius_max="1.5 mm"}},{name="b",mass_share=0.4,sizes={form="log-normal",radius_median="0.8 mm",geometric_deviation=1.3,radius_min="0.7 mm",radius_max="1 mm"}}])"},
       3,
       false},
      {"material_published.toml",
       "run",
       {"samples=1", "grains.count=80", "packing.start_pressure=1e-3", "test.steps=4",
        R"(variant=[{name="equal"},{name="power",sizes={form="power-law",exponent=3.5,radius_min="8 mm",radius_max="16 mm"}}])"},
       0},
      {"material_study.toml",
       "run",
       {"samples=1", "grains.count=80", "grains.ratio=2", "test.steps=3",
        R"(variant=[{name="base"},{name="slow",preparation="slow"}])"},
       0},
      {"material_truth.toml",
       "run",
       {"samples=1", "grains.count=60", "grains.ratio=2", "test.steps=2",
        R"(variant=[{name="base"},{name="few",ratio=1.5,loadings=["oedometric","unloading"]}])"},
       0},
      {"material_vs_models.toml",
       "run",
       {"samples=1", "grains.count=120", "grains.ratio=2", "test.steps=2", "blind=[]", R"(loading=[{name="pressed"}])",
        R"(variant=[{name="base"}])",
        R"(model=[{name="coarse",kind="coarse",split=0.8},{name="cells",kind="cells",split=0.8,card="../results/material_law/cell_law.toml"}])"},
       0},
      {"packing_study.toml", "microsim", with(kSmallPacking, {{"measure.soft_solid.deltas=[0.1,0.2]"}}), 0},
      {"press_test_library.toml",
       "run",
       {"macro.bodies=20", "macro.bands=8",
        R"(stage=[{kind="oedometric",strain=0.04,steps=2},{kind="unload",strain=0.01,steps=1}])"},
       0,
       false},
      {"press_test_macro.toml",
       "run",
       {"macro.bodies=20", "macro.bands=8",
        R"(stage=[{kind="oedometric",strain=0.04,steps=2},{kind="unload",strain=0.01,steps=1}])"},
       0,
       false},
      {"powder_consolidation.toml", "microsim",
       with(kSmallPowder, {{"only=[\"rr-dense\"]", "assembly.pressures=[0.1,1.0,0.1]"}}), 0},
      {"powder_method1.toml", "microsim", with(kSmallPowder, {{"samples=2", "analysis.mesh=10"}}), 0},
      {"powder_method2.toml", "microsim", method2, 0},
      {"powder_method2_variants.toml", "microsim", with(method2, {{"only=[\"p0\",\"rr-p001\"]"}}), 0},
      {"powder_series_b.toml", "microsim", with(method2, {{"assembly.stiffening_time=20"}}), 0},
      {"powder_table.toml", "microsim", with(kSmallPowder, {{"only=[\"grains-mu05\",\"rr-mu015\"]"}}), 0},
      {"powder_variants.toml", "microsim", with(kSmallPowder, {{"only=[\"phi-052\",\"equal-disks\"]"}}), 0},
      {"published.toml", "run",
       with(deep, {kSmallMacro,
                   quick_rest,
                   reference,
                   unrotated_reference,
                   {"reference.soft_soft.deltas=[0.3]", "reference.soft_soft.tangential_deltas=[]"}}),
       3},
      {"quickstart.toml", "run", with(deep, {kSmallMacro, quick_rest, reference, table_law}), 3},
      {"relaxation_check.toml", "microsim",
       with(kSmallPacking, {kTwoDeltas, reference, {"reference.soft_soft.deltas=[0.2]"}}), 0},
      {"relaxation_study.toml", "microsim", with(kSmallPacking, {kTwoDeltas, quick_rest, rotated, soft_rotated}), 0},
      {"rotation_study.toml", "microsim",
       with(kSmallPacking, {{"measure.soft_solid.deltas=[0.1,0.2]", "measure.rotation=cumulative"}, rotated}), 0},
  };
}

class Determinism : public ::testing::TestWithParam<SmallForm> {
 protected:
  void run(const std::string& name, const std::string& threads, bool quiet) const {
    const SmallForm& form = GetParam();
    std::vector<std::string> words{form.command, std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/" + form.file,
                                   "--out",      directory_.file(name),
                                   "--threads",  threads};
    if (quiet) words.emplace_back("--quiet");
    for (const std::string& o : form.overrides) words.insert(words.end(), {"--set", o});
    const std::string errors = directory_.file(name + ".txt");
    const int status = wait_for(start_program(words, errors_to(errors)));
    ASSERT_TRUE(ended_with(status, form.status)) << form.file << ": " << status << "\n" << read_text(errors);
  }
  void expect_same(const std::string& a, const std::string& b) const {
    expect_same_runs(directory_.file(a), directory_.file(b));
  }

  TemporaryDirectory directory_;
};

TEST_P(Determinism, ThreeThreadsAndALogChangeNothing) {
  run("one", "1", true);
  run("three", "3", false);
  expect_same("one", "three");
}

using SlowDeterminism = Determinism;

TEST_P(SlowDeterminism, AnyNumberOfThreadsWithAndWithoutOutput) {
  run("one", "1", true);
  for (const char* threads : {"1", "2", "3", "8"})
    for (const bool quiet : {true, false}) {
      const std::string name = std::string(threads) + (quiet ? "-quiet" : "-log");
      run(name, threads, quiet);
      expect_same("one", name);
    }
}

std::string name_of(const ::testing::TestParamInfo<SmallForm>& info) {
  std::string name = info.param.file.substr(0, info.param.file.find('.'));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::vector<SmallForm> default_forms() {
  std::vector<SmallForm> forms = small_forms();
  std::erase_if(forms, [](const SmallForm& f) { return !f.by_default; });
  return forms;
}

INSTANTIATE_TEST_SUITE_P(Pipelines, Determinism, ::testing::ValuesIn(default_forms()), name_of);
INSTANTIATE_TEST_SUITE_P(Pipelines, SlowDeterminism, ::testing::ValuesIn(small_forms()), name_of);

TEST(DeterminismTable, HasEveryScene) {
  std::set<std::string> there;
  for (const auto& entry : fs::directory_iterator(std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines"))
    if (entry.path().extension() == ".toml") there.insert(entry.path().filename().string());
  std::set<std::string> listed;
  for (const SmallForm& form : small_forms()) listed.insert(form.file);
  EXPECT_EQ(there, listed) << "a scene of pipelines/ has no small form, or a small form no scene";
}

}  // namespace

// Tests in stages that nobody thought of: random lists on materials, laws, cells and LAMMPS, every strain and stress of
// every recorded point as it was asked for. Runs in LAMMPS are skipped where softgrain-lammps was not built.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/core/random.h"
#include "common/core/vec.h"
#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// What one axis is asked to do in a stage: a nominal strain from its start, or a stress at its end.
struct AskedAxis {
  bool by_stress = false;
  double value = 0.0;
  bool as_at_begin = false;  ///< the stress stays what it was
  int as_when_began = -1;    ///< the stress goes to what it was when this stage began
};

struct AskedStage {
  std::array<AskedAxis, 3> axis{};
  int steps = 2;
  bool logarithmic = false;
  bool isotropic_strain = false;  ///< by the mean of the stresses
};

/// A list as the scene has it, and what it asks for.
struct StageList {
  std::string text;
  std::vector<AskedStage> stages;
};

/// Draws lists that a packing can go through: all begin under load; stresses of single axes stay within a factor of
/// `spread` and one of each other, strains are small. `pressure` is what the lists are scaled by [Pa].
class Lists {
 public:
  Lists(std::uint64_t number, double pressure, double spread)
      : random_(2026, RandomPurpose::test, number), pressure_(pressure), spread_(spread) {}

  StageList draw() {
    consolidation();
    const int more = 2 + pick(3);
    for (int k = 0; k < more; ++k) one_more();
    return std::move(list_);
  }

 private:
  int pick(int of) { return static_cast<int>(random_.uniform() * of) % of; }
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  double stress() { return pressure_ * between(0.8, 0.8 * (1.0 + spread_)); }
  /// As many digits as the scene has.
  static double rounded(double x) { return std::stod(fmt::format("{:.5g}", x)); }

  AskedStage& begin(const std::string& kind, bool counted = true) {
    AskedStage stage;
    stage.steps = 1 + pick(3);
    list_.text += fmt::format("[[stage]]\nkind = \"{}\"\n", kind);
    if (counted) list_.text += fmt::format("steps = {}\nincrements_per_step = {}\n", stage.steps, 1 + pick(3));
    list_.stages.push_back(stage);
    return list_.stages.back();
  }
  double give(const std::string& key, double value) {
    list_.text += fmt::format("{} = {:.5g}\n", key, value);
    return rounded(value);
  }
  static void hold_sides(AskedStage& stage) {
    for (const std::size_t k : {0U, 1U}) stage.axis[k] = {true, 0.0, true, -1};
  }

  void consolidation() {
    AskedStage& s = begin("consolidation");
    const Vec3 p{{rounded(stress()), rounded(stress()), rounded(stress())}};
    list_.text += fmt::format("stress = [{:.5g}, {:.5g}, {:.5g}]\n", p[0], p[1], p[2]);
    for (std::size_t k = 0; k < 3; ++k) s.axis[k] = {true, p[static_cast<int>(k)], false, -1};
  }
  void oedometric() {
    AskedStage& s = begin("oedometric");
    s.axis[2].value = give("strain", between(0.002, 0.01));
  }
  void triaxial() {
    AskedStage& s = begin("triaxial");
    hold_sides(s);
    s.axis[2].value = give("strain", between(0.002, 0.01));
  }
  void isotropic() {
    AskedStage& s = begin("isotropic");
    s.isotropic_strain = pick(2) == 0;
    const double value =
        s.isotropic_strain ? give("stress", pressure_ * between(1.6, 2.5)) : give("strain", between(0.001, 0.005));
    for (AskedAxis& axis : s.axis) axis = {s.isotropic_strain, value, false, -1};
  }
  void shear() {
    AskedStage& s = begin("shear");
    s.logarithmic = true;
    s.axis[2].value = give("strain", between(0.001, 0.005));
    s.axis[0].value = -s.axis[2].value;
  }
  void axes() {
    AskedStage& s = begin("axes");
    s.axis[0] = {true, give("stress_x", stress()), false, -1};
    s.axis[1].value = give("strain_y", between(-0.002, 0.003));
    if (pick(2) == 0)
      s.axis[2] = {true, give("stress_z", stress()), false, -1};
    else
      s.axis[2].value = give("strain_z", between(0.001, 0.006));
  }
  void hold() {
    AskedStage& s = begin("hold", false);
    s.steps = 1;
    if (pick(2) == 0) return;
    list_.text += "by = \"stress\"\n";
    for (AskedAxis& axis : s.axis) axis = {true, 0.0, true, -1};
  }
  /// A compression and the way back by strain, and forth to where that began.
  void loop() {
    const bool sides = pick(2) == 0;
    sides ? triaxial() : oedometric();
    const auto back = [&](AskedStage& s) {
      if (sides) hold_sides(s);
    };
    AskedStage& unload = begin("unload");
    const double strain = give("strain", between(0.0005, 0.0015));
    unload.axis[2].value = -strain;
    back(unload);
    const int at = static_cast<int>(list_.stages.size()) - 1;
    AskedStage& reload = begin("reload");
    reload.axis[2].value = strain / (1.0 + strain);
    if (sides)
      for (const std::size_t k : {0U, 1U}) reload.axis[k] = {true, 0.0, false, at};
  }

  void one_more() {
    switch (pick(8)) {
      case 0:
        return oedometric();
      case 1:
        return triaxial();
      case 2:
        return isotropic();
      case 3:
        return shear();
      case 4:
        return axes();
      case 5:
        return hold();
      case 6:
        return consolidation();
      default:
        return loop();
    }
  }

  RandomStream random_;
  double pressure_;
  double spread_;  ///< of the stresses of single axes: what the matter bears
  StageList list_;
};

Vec3 stress_at(const MacroCurve& c, std::size_t k) { return {{c.stress_x[k], c.stress_y[k], c.stress_axial[k]}}; }
Vec3 strain_at(const MacroCurve& c, std::size_t k) { return {{c.strain_x[k], c.strain_y[k], c.strain_z[k]}}; }

/// All points of all stages; `tolerance` of the relaxations, a third of it for stress.
void expect_as_asked(const MacroCurve& c, const StageList& list, double tolerance, double least) {
  ASSERT_TRUE(c.usable) << c.note;
  std::size_t points = 1;
  for (const AskedStage& s : list.stages) points += static_cast<std::size_t>(s.steps);
  ASSERT_EQ(c.strain.size(), points);
  std::vector<std::size_t> began;
  std::size_t first = 0;
  for (std::size_t number = 0; number < list.stages.size(); ++number) {
    const AskedStage& s = list.stages[number];
    began.push_back(first);
    for (int n = 1; n <= s.steps; ++n) {
      const std::size_t at = first + static_cast<std::size_t>(n);
      const double way = static_cast<double>(n) / s.steps;
      SCOPED_TRACE(fmt::format("stage {}, step {} of {}", number + 1, n, s.steps));
      EXPECT_EQ(c.stage[at], static_cast<double>(number));
      Vec3 asked;
      for (int k = 0; k < 3; ++k) {
        const AskedAxis& axis = s.axis[static_cast<std::size_t>(k)];
        if (!axis.by_stress) {
          const double length = (1.0 - strain_at(c, at)[k]) / (1.0 - strain_at(c, first)[k]);
          const double expected = s.logarithmic ? std::exp(-way * axis.value) : 1.0 - way * axis.value;
          EXPECT_NEAR(length, expected, 1e-9) << "strain along "
                                              << "xyz"[k];
          continue;
        }
        const double from = stress_at(c, first)[k];
        const double target = axis.as_at_begin ? from
                              : axis.as_when_began >= 0
                                  ? stress_at(c, began[static_cast<std::size_t>(axis.as_when_began)])[k]
                                  : axis.value;
        asked[k] = (1.0 - way) * from + way * target;
      }
      const double scale = std::max({asked[0], asked[1], asked[2], least});
      const Vec3 off = stress_at(c, at) - asked;
      const double mean = (off[0] + off[1] + off[2]) / 3.0;
      for (int k = 0; k < 3; ++k) {
        if (!s.axis[static_cast<std::size_t>(k)].by_stress) continue;
        EXPECT_LE(std::abs(s.isotropic_strain ? mean : off[k]), 1.01 * tolerance / 3.0 * scale) << "stress along "
                                                                                                << "xyz"[k];
      }
      if (!s.isotropic_strain) continue;
      for (int k = 0; k < 2; ++k)
        EXPECT_NEAR((1.0 - strain_at(c, at)[k]) / (1.0 - strain_at(c, first)[k]),
                    (1.0 - strain_at(c, at)[2]) / (1.0 - strain_at(c, first)[2]), 1e-9);
    }
    first += static_cast<std::size_t>(s.steps);
  }
}

constexpr std::uint64_t kLists = 10;
constexpr double kTolerance = 1e-3;

class RandomStages : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }

  /// A scene head in front of every list; `of_run` names the file of the curve.
  void go_through(const std::string& kind, const std::function<std::string(std::uint64_t)>& head, double pressure,
                  double least, const std::string& command, const std::string& curves, const std::string& more = "",
                  double spread = 1.0) {
    for (std::uint64_t number = 0; number < kLists; ++number) {
      const StageList list = Lists(number, pressure, spread).draw();
      SCOPED_TRACE(kind + ", list " + std::to_string(number) + "\n" + list.text);
      write_text_atomic(file("scene.toml"), head(number) + list.text);
      const std::string out = file(kind + std::to_string(number));
      const ProgramOutcome outcome =
          run_the_program(command + " '" + file("scene.toml") + "' --quiet --threads 1 --out '" + out + "' " + more);
      ASSERT_EQ(outcome.status, 0) << outcome.output;
      expect_as_asked(load_macro(out + "/" + curves).at(0), list, kTolerance, least);
    }
  }

  /// Walls and periodic cells in turn.
  static std::string law_scene(std::uint64_t number) {
    return fmt::format(
        "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nbodies = 100\nstart_pressure = 3e-3\n"
        "tolerance = {}\nresolved = false\nboundary = \"{}\"\n",
        kTolerance, number % 2 == 0 ? "walls" : "periodic");
  }

  TemporaryDirectory directory_;
};

TEST_F(RandomStages, OfLawsAreAsAsked) {
  save_card(synthetic::card(), file("law.toml"));
  go_through("law", law_scene, 4000.0, 1500.0, "macrosim", "macro.h5");
}

TEST_F(RandomStages, OfMaterialsAreAsAsked) {
  const auto head = [](std::uint64_t number) {
    return fmt::format(
        "kind = \"material\"\n[grains]\ncount = 150\nratio = 2\n[packing]\npreparation = \"{}\"\nstart_pressure = "
        "1e-3\n[test]\ntolerance = {}\n",
        number % 2 == 0 ? "fast" : "frictionless", kTolerance);
  };
  go_through("material", head, 1000.0, 500.0, "run", "material.h5");
}

TEST_F(RandomStages, OfCellsAreAsAsked) {
  CellCard card;
  const auto exact = [](double x) { return Estimate{x, 0.01 * x, 0.98 * x, 1.02 * x}; };
  card.modulus = exact(0.0447);
  card.exponent = exact(1.75);
  card.void_ratio = exact(0.567);
  card.excess_alone = exact(0.6155);
  card.excess_many = exact(0.3075);
  card.excess_decay = exact(0.355);
  card.friction = exact(0.6);
  card.stiffness = exact(1.0);
  card.lateral_ratio = exact(0.48);
  card.pressure_low = 1e-4;
  card.pressure_high = 1e-2;
  card.mixture_high = 4.0;
  card.poisson_ratio = card.grain_friction = 0.3;
  card.preparation = "fast";
  card.start_pressure = 1e-4;
  card.split = 1.0 / 3.0;
  card.fines_ratio = 4.0;
  card.fines_sizes = "power law r^-3.5";
  card.samples = 3;
  write_cell_card(card, file("cells.toml"));
  const auto head = [](std::uint64_t number) {
    return fmt::format(
        "kind = \"macro\"\nlaw = \"cells.toml\"\n[material]\nE = 5e5\n[fines]\nshare = 0.4\n[macro]\nbodies = "
        "40\npreparation = \"fast\"\n"
        "start_pressure = 1e-4\nsolid_radius_max = 0.016\nsolid_polydispersity = 3\ntolerance = {}\n"
        "boundary = \"{}\"\n",
        kTolerance, number % 2 == 0 ? "walls" : "periodic");
  };
  go_through("cells", head, 300.0, 50.0, "macrosim", "macro.h5", "", 0.2);  // cells bear little deviator
}

TEST_F(RandomStages, InLammpsAreAsAsked) {
  const std::string program = std::filesystem::path(SOFTGRAIN_PROGRAM).parent_path().string() + "/softgrain-lammps";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "softgrain-lammps was not built: " << program;
  save_card(synthetic::card(), file("law.toml"));
  go_through("lammps", law_scene, 4000.0, 1500.0, "macrosim", "macro.h5", "--engine lammps");
}

/// Soft particles do not bear before their threshold: a triaxial test that begins so is none with standing sides.
TEST_F(RandomStages, SidesThatBeginWithoutStressAreFreeInBothEngines) {
  save_card(synthetic::card(), file("law.toml"));
  write_text_atomic(file("scene.toml"),
                    "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nbodies = 60\nsoft_share = 1.0\nresolved = "
                    "false\n[[stage]]\nkind = \"triaxial\"\nstrain = 0.2\nsteps = 4\nincrements_per_step = 5\n");
  const std::string program = std::filesystem::path(SOFTGRAIN_PROGRAM).parent_path().string() + "/softgrain-lammps";
  for (const std::string engine : {"softgrain", "lammps"}) {
    if (engine == "lammps" && !std::filesystem::exists(program)) continue;
    const ProgramOutcome outcome = run_the_program("macrosim '" + file("scene.toml") + "' --quiet --threads 1 --out '" +
                                                   file(engine) + "' --engine " + engine);
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;  // 3: it bears nothing at its end
    const MacroCurve c = load_macro(file(engine) + "/macro.h5").at(0);
    ASSERT_TRUE(c.usable) << c.note;
    EXPECT_NE(c.note.find("began without stress along x, y"), std::string::npos) << c.note;
    ASSERT_EQ(c.strain.size(), 5U);
    for (std::size_t k = 0; k < c.strain.size(); ++k) {
      EXPECT_LE(std::abs(c.stress_x[k]), 0.02) << engine << ", " << k;
      EXPECT_LE(std::abs(c.stress_y[k]), 0.02) << engine << ", " << k;
    }
    EXPECT_LT(c.strain_x.back(), -0.01) << engine;
    EXPECT_NEAR(c.strain_z.back(), 0.2, 1e-9);
  }
}

/// What a law does not know is said where its numbers may be taken for that.
TEST_F(RandomStages, ALawWithoutUnloadingBranchSaysSo) {
  save_card(synthetic::card(), file("law.toml"));
  const std::string head =
      "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nbodies = 30\nstart_pressure = 3e-3\nresolved = false\n";
  const std::string load = "[[stage]]\nkind = \"oedometric\"\nstrain = 0.01\nsteps = 2\n";
  const auto run = [&](const std::string& name, const std::string& scene) {
    write_text_atomic(file("scene.toml"), scene);
    const ProgramOutcome outcome =
        run_the_program("macrosim '" + file("scene.toml") + "' --quiet --threads 1 --out '" + file(name) + "'");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return read_text(file(name) + "/summary.json");
  };
  const std::string words = "the pair law has no unloading branch";
  const std::string unload = load + "[[stage]]\nkind = \"unload\"\nstrain = 0.002\nsteps = 2\n";
  EXPECT_NE(run("unloads", head + unload).find(words), std::string::npos);
  EXPECT_EQ(run("loads", head + load).find(words), std::string::npos);
  EXPECT_EQ(run("solid", head + "soft_share = 0.0\n" + unload).find(words), std::string::npos);
}

/// Friction of the scene is not that of the grains inside its soft particles.
TEST_F(RandomStages, ASweepOverFrictionSaysWhatItChanges) {
  save_card(synthetic::card(), file("law.toml"));
  write_text_atomic(file("scene.toml"),
                    "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nbodies = 20\nsteps = 1\nstrain = 0.02\n"
                    "start_pressure = 3e-3\nresolved = false\n");
  const auto sweep = [&](const std::string& over) {
    return run_the_program("sweep '" + file("scene.toml") + "' --threads 1 --out '" + file("out") + "' --over " + over);
  };
  const std::string words = "macro.mu changes the friction between the particles of the scene alone";
  const ProgramOutcome mu = sweep("macro.mu=0.1,0.3");
  EXPECT_EQ(mu.status, 0) << mu.output;
  EXPECT_NE(unwrapped(mu.output).find(words), std::string::npos) << mu.output;
  EXPECT_NE(read_text(file("out") + "/summary.json").find(words), std::string::npos);
  EXPECT_EQ(unwrapped(sweep("macro.wall_mu=0.1,0.3").output).find(words), std::string::npos);
}

}  // namespace

// The same thing said in another way has the same result: scenes in parts and in other units, size distributions and
// press tests as other laboratories write them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/io/hdf5_file.h"
#include "common/io/text_file.h"
#include "macrosim/macro_packing.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRounding = 1e-9;  ///< of sums in another order, and what a relaxation makes of them

class SaidOtherwise : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }

  void run(const std::string& command, const std::string& name) const {
    const ProgramOutcome done = run_the_program(fmt::format("{} --quiet --threads 1 --out '{}'", command, file(name)));
    ASSERT_EQ(done.status, 0) << name << "\n" << done.output;
  }
  void run_scene(const std::string& scene, const std::string& name) const {
    write_text_atomic(file(name + ".toml"), scene);
    run(fmt::format("run '{}'", file(name + ".toml")), name);
  }

  TemporaryDirectory directory_;
};

std::string stage(const std::string& name, double strain, int steps) {
  return fmt::format("[[stage]]\nkind = \"oedometric\"\nname = \"{}\"\nstrain = {:.17g}\nsteps = {}\n", name, strain,
                     steps);
}

const std::string kWhole = stage("whole", 0.03, 3);
/// Strains of stages are over the length that a stage begins with.
const std::string kParts = stage("first", 0.01, 1) + stage("rest", 1.0 - 0.97 / 0.99, 2);

/// Stresses of one curve are `factor` times those of the other.
void expect_same(const MacroCurve& curve, const MacroCurve& other, double factor, double rounding) {
  ASSERT_EQ(curve.strain.size(), other.strain.size());
  EXPECT_GT(curve.stress_axial.back(), curve.stress_axial.front()) << "nothing was compressed";
  for (std::size_t k = 0; k < curve.strain.size(); ++k) {
    EXPECT_NEAR(other.strain[k], curve.strain[k], rounding);
    for (const auto column : {&MacroCurve::stress_axial, &MacroCurve::stress_lateral})
      EXPECT_NEAR((other.*column)[k], factor * (curve.*column)[k], rounding * factor * (curve.*column)[k]) << k;
  }
}

/// With moduli that are a power of two apart the bits are the same.
TEST_F(SaidOtherwise, GrainsTakeATestInPartsAndStressesGoWithE) {
  const auto scene = [](const std::string& modulus, const std::string& stages) {
    return "kind = \"material\"\nsamples = 1\n[material]\nE = " + modulus +
           "\n[grains]\ncount = 80\nratio = 1.5\n[packing]\npreparation = \"fast\"\n" + stages;
  };
  run_scene(scene("\"1 MPa\"", kWhole), "whole");
  run_scene(scene("1e6", kParts), "parts");
  run_scene(scene("\"256 MPa\"", kWhole), "stiff");
  const auto curve = [&](const std::string& name) { return load_macro(file(name) + "/material.h5").at(0); };
  expect_same(curve("whole"), curve("parts"), 1.0, kRounding);
  expect_same(curve("whole"), curve("stiff"), 256.0, 0.0);
}

TEST_F(SaidOtherwise, CellsTakeATestInPartsAndStressesGoWithE) {
  const auto scene = [](const std::string& modulus, const std::string& stages) {
    return fmt::format(
        "kind = \"macro\"\nlaw = \"{}/results/material_law/cell_law_memory.toml\"\n[material]\nE = {}\n[fines]\nshare "
        "= "
        "0.4\npreparation = \"fast\"\n[macro]\nbodies = 40\nboundary = \"periodic\"\nresolved = false\nsoft_share = "
        "0.3\nsolid_polydispersity = 2\nsoft_polydispersity = 2\nstart_pressure = 1e-4\n{}",
        SOFTGRAIN_SOURCE_DIR, modulus, stages);
  };
  run_scene(scene("\"1 MPa\"", kWhole), "whole");
  run_scene(scene("1e6", kParts), "parts");
  run_scene(scene("\"256 MPa\"", kWhole), "stiff");
  const auto curve = [&](const std::string& name) { return load_macro(file(name) + "/macro.h5").at(0); };
  expect_same(curve("whole"), curve("parts"), 1.0, kRounding);
  expect_same(curve("whole"), curve("stiff"), 256.0, 0.0);
}

/// Radii of the first sample, smallest first.
std::vector<double> radii_of(const std::string& path) {
  const MacroPacking packing = read_macro_packing(h5::open_file(path).open("sample_0"));
  std::vector<double> out;
  for (const MacroBody& b : packing.bodies) out.push_back(b.r);
  std::sort(out.begin(), out.end());
  return out;
}

TEST_F(SaidOtherwise, ASieveCurveDrawsTheSameGrainsHoweverItIsWritten) {
  const std::vector<std::pair<const char*, const char*>> tables{
      {"passing", "opening [mm],passing [%]\n4,100\n2.8,86\n2,61\n1.4,34\n1,14\n0.71,0\n"},
      {"finest-first", "opening [mm],passing [%]\n0.71,0\n1,14\n1.4,34\n2,61\n2.8,86\n4,100\n"},
      {"micrometres", "opening [um];passing\n4000;1\n2800;0,86\n2000;0,61\n1400;0,34\n1000;0,14\n710;0\n"},
      {"retained", "opening [mm],retained [g]\n4,0\n2.8,7\n2,12.5\n1.4,13.5\n1,10\n0.71,7\n"},
      {"cumulative", "opening [mm],cumulative retained [%]\n4,0\n2.8,14\n2,39\n1.4,66\n1,86\n0.71,100\n"}};
  std::vector<double> first;
  for (const auto& [name, table] : tables) {
    const std::string csv = std::string(name) + ".csv";
    write_text_atomic(file(csv), table);
    run_scene(
        "kind = \"material\"\nsamples = 1\n[material]\nE = \"70 GPa\"\n[grains]\ncount = 400\nsizes = { form = "
        "\"sieve-curve\", file = \"" +
            csv + "\" }\n[packing]\npreparation = \"frictionless\"\n[test]\nstrain = 0.002\nsteps = 1\n",
        name);
    const std::vector<double> radii = radii_of(file(name) + "/material_initial.h5");
    if (first.empty()) first = radii;
    ASSERT_EQ(radii.size(), first.size()) << name;
    for (std::size_t k = 0; k < radii.size(); ++k) EXPECT_NEAR(radii[k], first[k], 1e-12 * first[k]) << name;
  }
}

/// Readings of three samples: their numbers are in mm and mN.
struct Readings {
  std::string sample;
  std::vector<std::pair<double, double>> points;
};

std::vector<Readings> three_samples() {
  std::vector<Readings> out{{"A", {}}, {"B", {}}, {"C", {}}};
  for (std::size_t s = 0; s < out.size(); ++s)
    for (int k = 1; k <= 14; ++k) {
      const double delta = 0.02 * k;
      const double law = std::max(0.0, std::pow(delta, 3.0) - std::pow(0.07, 3.0));
      const double noise = 2.0 * std::sin(7.0 * k + 3.0 * static_cast<double>(s));
      out[s].points.emplace_back(16.0 * delta, 9e4 * law * (0.95 + 0.05 * static_cast<double>(s)) + noise);
    }
  return out;
}

TEST_F(SaidOtherwise, APressTestGivesTheSameLawHoweverItsTableIsOrdered) {
  const std::string head = "# kind = soft-solid\n# Rs = 16 mm\n# E = 0.5 MPa\n";
  const std::vector<Readings> samples = three_samples();
  const auto table = [&](const std::string& name, const std::string& rows) {
    write_text_atomic(file(name + ".csv"), head + rows);
    return "'" + file(name + ".csv") + "' ";
  };
  const auto calibrate = [&](const std::string& name, const std::string& files) {
    run("calibrate " + files + "--set replicates=100", name);
    return load_card(file(name) + "/law.toml").pairs.at(0).normal;
  };
  std::string plain = "sample; hn [mm]; Fn [mN]\n";
  std::string turned = "Fn [N]; sample; hn [um]\n";
  std::string mixed = plain;
  std::string files;
  for (const Readings& r : samples) {
    std::string own = "hn [mm]; Fn [mN]\n";
    for (const auto& [hn, fn] : r.points) {
      plain += fmt::format("{}; {:.4f}; {:.3f}\n", r.sample, hn, fn);
      turned += fmt::format("{:.6f}; {}; {:.1f}\n", 1e-3 * fn, r.sample, 1e3 * hn);
      own += fmt::format("{:.4f}; {:.3f}\n", hn, fn);
    }
    files += table(r.sample, own);
  }
  for (std::size_t k = 0; k < samples.front().points.size(); ++k)
    for (const Readings& r : samples)
      mixed += fmt::format("{}; {:.4f}; {:.3f}\n", r.sample, r.points[k].first, r.points[k].second);
  const ThresholdPowerLaw law = calibrate("plain", table("plain", plain));
  EXPECT_GT(law.a.value, 0.0);
  EXPECT_LT(law.b.low, law.b.high);
  for (const auto& [name, inputs] :
       {std::pair{"turned", table("turned", turned)}, {"mixed", table("mixed", mixed)}, {"files", files}}) {
    const ThresholdPowerLaw other = calibrate(name, inputs);
    for (const auto number : {&ThresholdPowerLaw::a, &ThresholdPowerLaw::b, &ThresholdPowerLaw::delta}) {
      const Estimate& e = law.*number;
      const Estimate& o = other.*number;
      EXPECT_NEAR(o.value, e.value, 1e-9 * std::abs(e.value)) << name;
      EXPECT_NEAR(o.low, e.low, 1e-6 * (e.high - e.low)) << name;
      EXPECT_NEAR(o.high, e.high, 1e-6 * (e.high - e.low)) << name;
    }
  }
}

}  // namespace

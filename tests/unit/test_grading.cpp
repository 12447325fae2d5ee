// Size distributions of every form: passing, numbers, drawing, files.
#include "common/packing/grading.h"

#include <gsl/gsl_cdf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/io/text_file.h"
#include "common/packing/grading_scene.h"
#include "common/packing/sieve_table.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using softgrain::test::TemporaryDirectory;

std::vector<Grading> all_forms() {
  return {Grading::power_law(3.5, 0.001, 0.006),
          Grading::power_law(1.0, 0.001, 0.006),
          Grading::power_law(4.0, 0.001, 0.006),
          Grading::fuller(0.5, 0.001, 0.006),
          Grading::log_normal(0.003, 1.4, 0.001, 0.008),
          Grading::sieve_curve({0.0005, 0.001, 0.002, 0.004}, {0.0, 0.2, 0.2, 1.0}),
          Grading::classes({{0.001, 0.001, 4.0, 0.3}, {0.004, 0.005, 2.0, 0.7}}),
          Grading::classes({{0.001, 0.003, 1.0, 0.6}, {0.002, 0.004, 4.0, 0.4}})};
}

/// The volume that passes, summed over a million numbers.
double passing_by_sums(const Grading& g, double r) {
  constexpr int kMany = 1000000;
  double below = 0.0;
  double all = 0.0;
  for (int k = 0; k < kMany; ++k) {
    const double x = g.radius((k + 0.5) / kMany);
    all += cube(x);
    if (x < r) below += cube(x);
  }
  return below / all;
}

TEST(Grading, PassingIsTheVolumeOfTheNumbers) {
  for (const Grading& g : all_forms())
    for (const double share : {0.1, 0.35, 0.6, 0.9}) {
      const double r = g.smallest() * std::pow(g.largest() / g.smallest(), share);
      EXPECT_NEAR(g.passing(r), passing_by_sums(g, r), 2e-4) << to_string(g.form()) << " at " << share;
    }
}

TEST(Grading, EndsPassNothingAndAll) {
  for (const Grading& g : all_forms()) {
    EXPECT_EQ(g.passing(g.smallest()), 0.0) << to_string(g.form());
    EXPECT_NEAR(g.passing(1.0001 * g.largest()), 1.0, 1e-14) << to_string(g.form());
    EXPECT_DOUBLE_EQ(g.radius(0.0), g.smallest()) << to_string(g.form());
    EXPECT_NEAR(g.radius(1.0), g.largest(), 1e-12 * g.largest()) << to_string(g.form());
  }
}

TEST(Grading, AgreesWithTheClosedForms) {
  const PowerLawRadii law{3.5, 0.001, 0.006};
  const Grading g = Grading::power_law(3.5, 0.001, 0.006);
  for (const double u : {0.05, 0.5, 0.95}) EXPECT_NEAR(g.radius(u), law.radius(u), 1e-15) << u;
  const Grading fuller = Grading::fuller(0.5, 1e-9, 0.004);
  EXPECT_NEAR(fuller.passing(0.001), 0.5, 1e-3);  // Fuller's curve: the square root of D/Dmax
  const Grading log_normal = Grading::log_normal(0.003, 1.4, 0.0003, 0.03);
  for (const double r : {0.002, 0.003, 0.0045})
    EXPECT_NEAR(log_normal.passing(r), gsl_cdf_ugaussian_P(std::log(r / 0.003) / std::log(1.4)), 3e-5) << r;
}

TEST(Grading, AnExponentIsOneOfASinglePowerLaw) {
  EXPECT_EQ(Grading::power_law(2.0, 0.001, 0.006).exponent(), 2.0);
  EXPECT_EQ(Grading::fuller(0.37, 0.001, 0.006).exponent(), 4.0 - 0.37);
  EXPECT_EQ(Grading::classes({{0.001, 0.002, 3.2, 1.0}}).exponent(), 3.2);
  EXPECT_EQ(Grading::sieve_curve({0.001, 0.002}, {0.0, 1.0}).exponent(), 4.0);
  EXPECT_EQ(Grading::sieve_curve({0.001, 0.002, 0.004}, {0.0, 0.4, 1.0}).exponent(), std::nullopt);
  EXPECT_EQ(Grading::log_normal(0.003, 1.4, 0.002, 0.004).exponent(), std::nullopt);
  EXPECT_EQ(Grading::list({0.001}).exponent(), std::nullopt) << "all alike";
}

TEST(Grading, SamplesFollowWhatWasAsked) {
  for (const Grading& g : all_forms()) {
    double worst = 0.0;
    for (std::uint64_t sample = 0; sample < 20; ++sample) {
      RandomStream random(7, RandomPurpose::test, sample);
      worst = std::max(worst, g.largest_difference(g.draw(400, random)));
    }
    // One grain of the largest size is a step of this height that no sample of 400 can do without.
    const double step = cube(g.largest()) / (400.0 * g.mean_volume());
    EXPECT_LT(worst, 1.1 * step) << to_string(g.form());
    EXPECT_GT(worst, 0.05 * step) << to_string(g.form());
  }
}

TEST(Grading, FourHundredGrainsOfUsualSpreadsAreWithinOnePercent) {
  // Ratios of sizes of 2 to 2.5, as macro scenes have: half the share of the largest grain bounds it from below.
  for (const Grading& g :
       {Grading::power_law(3.5, 0.008, 0.016), Grading::fuller(0.5, 0.002, 0.004),
        Grading::log_normal(0.003, 1.2, 0.002, 0.004), Grading::sieve_curve({0.002, 0.003, 0.004}, {0.0, 0.4, 1.0})})
    for (std::uint64_t sample = 0; sample < 20; ++sample) {
      RandomStream random(9, RandomPurpose::test, sample);
      EXPECT_LT(g.largest_difference(g.draw(400, random)), 0.01) << g.text();
    }
}

TEST(Grading, GrainsDrawnIndependentlyAreSeveralTimesFurtherOff) {
  const Grading g = Grading::power_law(3.5, 0.008, 0.016);
  double stratified = 0.0;
  double independent = 0.0;
  for (std::uint64_t sample = 0; sample < 20; ++sample) {
    RandomStream random(9, RandomPurpose::test, sample);
    stratified += g.largest_difference(g.draw(400, random)) / 20.0;
    std::vector<double> radii;
    for (int k = 0; k < 400; ++k) radii.push_back(g.radius(random.uniform()));
    independent += g.largest_difference(radii) / 20.0;
  }
  EXPECT_GT(independent, 4.0 * stratified);
}

TEST(Grading, PassesWhatItsTextSays) {
  for (const Grading& g : all_forms()) {
    const Grading again = read_grading(Scene::parse(g.text(), "text").root());
    EXPECT_EQ(again.text(), g.text());
    EXPECT_EQ(again.form(), g.form());
    for (const double u : {0.0, 0.3, 0.9}) EXPECT_EQ(again.radius(u), g.radius(u)) << g.text();
  }
}

TEST(Grading, TheSameShapeInOtherUnits) {
  const Grading g = Grading::power_law(3.5, 0.001, 0.006);
  EXPECT_TRUE(g.same_shape(0.016, Grading::power_law(3.5, 0.0001, 0.0006), 0.0016));
  EXPECT_FALSE(g.same_shape(0.016, Grading::power_law(3.5, 0.0001, 0.0006), 0.016));
  EXPECT_FALSE(g.same_shape(0.016, Grading::power_law(3.0, 0.001, 0.006), 0.016));
  EXPECT_TRUE(g.same_shape(1.0, Grading::fuller(0.5, 0.001, 0.006), 1.0));
}

TEST(Grading, DisksCountByTheirArea) {
  const Grading g = Grading::classes({{1.0, 1.0, 3.0, 0.5}, {2.0, 2.0, 3.0, 0.5}}, 2);
  RandomStream random(1, RandomPurpose::test, 0);
  const std::vector<double> radii = g.draw(500, random);
  EXPECT_EQ(std::count(radii.begin(), radii.end(), 1.0), 400);
  EXPECT_NEAR(g.largest_difference(radii), 0.0, 1e-9);
  const Grading fuller = Grading::fuller(1.0, 0.5, 1.0, 2);
  EXPECT_NEAR(fuller.passing(0.75), 0.5, 1e-12);
}

TEST(Grading, WhatIsNoDistributionIsRefused) {
  EXPECT_THROW((void)Grading::power_law(3.5, 0.0, 0.006), InputError);
  EXPECT_THROW((void)Grading::power_law(3.5, 0.007, 0.006), InputError);
  EXPECT_THROW((void)Grading::list({}), InputError);
  EXPECT_THROW((void)Grading::list({1e-120}), InputError);
  EXPECT_THROW((void)Grading::power_law(20.0, 1e-90, 1e90), InputError);
  EXPECT_THROW((void)Grading::log_normal(1e-3, 1.01, 1.0, 2.0), InputError);
  EXPECT_THROW((void)Grading::classes({{1.0, 2.0, 4.0, -1.0}}), InputError);
}

TEST(Grading, DrawingIsWithoutBias) {
  const Grading g = Grading::power_law(3.5, 0.001, 0.01);
  constexpr int kSamples = 4000;
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
    RandomStream random(8, RandomPurpose::test, sample);
    double cubes = 0.0;
    for (const double r : g.draw(50, random)) cubes += cube(r) / 50.0;
    sum += cubes / kSamples;
    squares += cubes * cubes / kSamples;
  }
  const double error = std::sqrt((squares - sum * sum) / kSamples);
  EXPECT_NEAR(sum, g.mean_volume(), 3.0 * error);
  EXPECT_LT(error, 0.02 * g.mean_volume());
}

TEST(Grading, AListComesBackAsItIs) {
  const std::vector<double> radii{0.003, 0.001, 0.002, 0.002};
  RandomStream random(1, RandomPurpose::test, 0);
  EXPECT_EQ(Grading::list(radii).draw(4, random), (std::vector<double>{0.001, 0.002, 0.002, 0.003}));
}

class GradingFile : public ::testing::Test {
 protected:
  Grading sieves(const std::string& text) {
    write_text_atomic(directory_.file("curve.csv"), text);
    return read_sieve_file(directory_.file("curve.csv")).grading;
  }
  std::string complaint(const std::string& text) {
    try {
      (void)sieves(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  TemporaryDirectory directory_;
};

TEST_F(GradingFile, ASieveCurveIsRead) {
  const Grading g = sieves("opening [mm],passing [%]\n4,100\n0.5,0\n2,60\n1,20 %\n");
  EXPECT_NEAR(g.passing(0.001), 0.6, 1e-12);
  EXPECT_NEAR(g.passing(0.0005), 0.2, 1e-12);
  EXPECT_NEAR(g.passing(0.5e-3 * std::sqrt(2.0)), 0.4, 1e-12);  // straight over the logarithm
  EXPECT_EQ(g.smallest(), 0.00025);
  const Grading shares = sieves("sieve [um];passing\n250;0\n4000;1\n");
  EXPECT_NEAR(shares.passing(0.0005), 0.5, 1e-12);
  EXPECT_EQ(sieves("opening [Inch],passing\n1,0\n4,100\n").largest(), 0.0508);
  EXPECT_EQ(sieves("opening [mm],passing [kg]\n1,0\n2,3\n4,12\n").passing(0.001), 0.25);
}

TEST_F(GradingFile, WhatIsNoSieveCurveIsSaid) {
  const std::string head = "opening [mm],passing [%]\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {head + "1,0\n2,60\n4,50\n8,100\n", "curve.csv:4: passing falls to 50 % on a wider sieve ("},
      {head + "1,5\n4,100\n", "the curve goes from 5 % to 100 %; it must go from 0 to 100 %"},
      {head + "1,0\n4,95\n", "add the size that is above all grains"},
      {head + "1,0\n2,0.3\n4,1\n", "shares, with 1 for all, leave percent out of the title"},
      {head + "1,0\n2,40\n2,50\n4,100\n", "the sieve of 2 mm is there twice ("},
      {head + "1,100\n2,40\n4,0\n", "looks like what is retained in all"},
      {head + "0.5,5\n1,15\n2,50\n4,20\n8,10\n", "looks like what each sieve retains"},
      {head + "0,0\n4,100\n", "or give smallest = \"... mm\""},
      {"opening [mm],retained [%]\n1,0\n4,100\n", "or give largest = \"... mm\""},
      {"opening,passing [%]\n1,0\n4,100\n", "no unit: give unit = \"mm\""},
      {"opening [kg],passing [%]\n1,0\n4,100\n", "e.g. opening [mm]"},
      {"opening [mm],passing [N]\n1,0\n4,100\n", "not [N]"},
      {"opening [mm],passing [m]\n1,0\n4,100\n", "not [m]"},
      {"opening [mm],passing [%],finer [%]\n1,0,5\n4,100,100\n",
       "\"passing [%]\" and \"finer [%]\" both say what passes"},
      {"opening [mm],size [mm],passing [%]\n1,2,0\n4,5,100\n", "both say the opening"},
      {head + "1,0\n4,101\n", "101 passes; allowed: 0 to 100 %"},
      {"opening [mm],passing\n1,0\n4,101\n", "a share; write \"passing [%]\" for percent"},
      {head + "-1,0\n4,100\n", "curve.csv:2: an opening must be positive"},
      {head + "1,0\n4,\n", "curve.csv:3: what passes is missing"},
      {head + "4,100\n", "at least two sieves"},
      {"# moisture [%] = 3\n" + head + "1,0\n4,100\n", "curve.csv:1: comment \"moisture [%] = 3\" is not understood"},
      {"opening [mm],passing [%],moisture\n1,0,1\n4,100,1\n", "column \"moisture\" is not understood"},
      {"opening [mm],percent passing\n1,0\n4,101\n", "101 passes; allowed: 0 to 100 %"}};
  for (const auto& [text, words] : cases)
    EXPECT_NE(complaint(text).find(words), std::string::npos) << text << "\n" << complaint(text);
}

/// Sums of what sieves retain end where a spreadsheet rounded them to.
TEST_F(GradingFile, EndsOfACurveMayBeRounded) {
  for (const char* end : {"99.99999999999999", "100.00000000000001", "100%", "100 %", "100"})
    for (const char* start : {"0", "1e-14", "-1e-14", "0%"}) {
      const Grading g = sieves(std::string("opening [mm],passing [%]\n1,") + start + "\n2,40\n4," + end + "\n");
      EXPECT_NEAR(g.passing(0.5), 1.0, 1e-12) << start << " to " << end;
      EXPECT_NEAR(g.passing(0.001), 0.4, 1e-12) << start << " to " << end;
    }
  EXPECT_NE(complaint("opening [mm],passing [%]\n1,0\n4,99.9999\n").find("it must go from 0 to 100 %"),
            std::string::npos);
  EXPECT_NE(complaint("opening [mm],passing [%]\n1,0\n4,100.0001\n").find("allowed: 0 to 100 %"), std::string::npos);
  EXPECT_NEAR(sieves("opening [mm],passing [%]\n1,0\n2,100.00000000000001\n4,100\n").passing(1.0), 1.0, 1e-12);
}

TEST_F(GradingFile, ColumnsMaySayPercentByTheirName) {
  for (const char* name : {"percent passing", "percent passing [%]", "% passing", "passing %", "Percent finer",
                           "% finer", "cumulative passing [%]"}) {
    const Grading g = sieves(std::string("sieve size [mm];") + name + ";% retained\n1;0;40\n2;40;60\n4;100%;0\n");
    EXPECT_NEAR(g.passing(0.001), 0.4, 1e-12) << name;
  }
  EXPECT_NEAR(sieves("opening [mm],passing\n1,0\n2,40%\n4,100 %\n").passing(0.001), 0.4, 1e-12);
}

TEST_F(GradingFile, AListMayHaveCounts) {
  const auto list = [&](const std::string& text) {
    write_text_atomic(directory_.file("list.csv"), text);
    return read_radii(directory_.file("list.csv"));
  };
  RandomStream random(1, RandomPurpose::test, 0);
  for (const char* head : {"radius [mm],count", "diameter [mm];number", "r [mm],n", "radius [mm],frequency [%]"}) {
    const bool semicolon = std::string(head).find(';') != std::string::npos;
    const Grading g = list(std::string(head) + (semicolon ? "\n1;100\n2;5\n3;1\n" : "\n1,100\n2,5\n3,1\n"));
    const std::vector<double> radii = g.draw(300, random);
    const double unit = head[0] == 'd' ? 0.0005 : 0.001;
    EXPECT_NEAR(static_cast<double>(std::count(radii.begin(), radii.end(), unit)), 283.0, 1.0) << head;
    EXPECT_NEAR(static_cast<double>(std::count(radii.begin(), radii.end(), 2.0 * unit)), 14.0, 1.0) << head;
    EXPECT_NEAR(static_cast<double>(std::count(radii.begin(), radii.end(), 3.0 * unit)), 3.0, 1.0) << head;
    EXPECT_EQ(stored_grading(g.text()), g) << head;
  }
  EXPECT_EQ(list("radius [mm],count\n1,1\n2,1\n"), list("radius [mm]\n1\n2\n"));
  EXPECT_EQ(list("radius [mm],count\n1,3\n2,0\n").pieces().size(), 1U);
  for (const char* text :
       {"radius [mm],count\n1,-1\n", "radius [mm],count\n1,\n", "radius [mm],count\n1,0\n",
        "radius [mm],count [kg]\n1,2\n", "radius [mm],mass\n1,2\n", "# mean = 3 mm\nradius [mm]\n1\n"})
    EXPECT_THROW((void)list(text), InputError) << text;
}

TEST(GradingScene, EveryFormIsRead) {
  const auto read = [](const std::string& text) {
    const Scene scene = Scene::parse(text, "s.toml");
    const Grading g = read_grading(scene.root());
    scene.root().finish();
    return g;
  };
  const std::string ends = "radius_min = \"1 mm\"\nradius_max = \"6 mm\"\n";
  EXPECT_EQ(read("form = \"power-law\"\nexponent = 3.5\n" + ends).pieces()[0].exponent, 3.5);
  EXPECT_EQ(read("form = \"fuller\"\nexponent = 0.5\n" + ends).pieces()[0].exponent, 3.5);
  EXPECT_EQ(read("form = \"log-normal\"\nradius_median = 3e-3\ngeometric_deviation = 1.4\n" + ends).pieces().size(),
            400U);
  const Grading gap = read(
      "form = \"classes\"\n[[class]]\nradius = 1e-3\nvolume_share = 0.3\n[[class]]\nradius_min = 4e-3\n"
      "radius_max = 5e-3\nvolume_share = 0.7\n");
  EXPECT_NEAR(gap.passing(2e-3), 0.3, 1e-15);
  EXPECT_EQ(read("form = \"list\"\nradii = [1e-3, 2e-3]\n").pieces().size(), 2U);
  EXPECT_NEAR(read("form = \"list\"\nradii = [1e-3, 2e-3]\ncounts = [8, 1]\n").passing(1.5e-3), 0.5, 1e-12);
  const Grading sieves = read("form = \"sieve-curve\"\nopenings = [\"1 mm\", \"4 mm\"]\npassing = [0.0, 1.0]\n");
  EXPECT_NEAR(sieves.passing(1e-3), 0.5, 1e-12);
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"form = \"sieve-curve\"\nopenings = [1e-3, 4e-3]\npassing = [0.0, 100.0]\n", "passing"},
      {"form = \"sieve-curve\"\nopenings = [1e-3, 4e-3]\npassing = [0.0]\n", "one for each"},
      {"form = \"sieve-curve\"\nopenings = [1e-3, 4e-3]\npassing = [1.0, 0.0]\n", "retained in all"},
      {"form = \"sieve-curve\"\nopenings = [1e-3, 4e-3]\npassing = [0.1, 1.0]\n", "s.toml:3: the curve goes from 10 %"},
      {"form = \"classes\"\n[[class]]\nradius = 1e-3\nvolume_share = 0.3\n", "add up to 0.3"},
      {"form = \"list\"\nradii = [1e-3]\ncounts = [1, 2]\n", "one for each"},
      {"form = \"list\"\nradii = []\n", "at least one radius"}};
  for (const auto& [text, words] : wrong) {
    try {
      (void)read(text);
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  }
  EXPECT_THROW((void)read("form = \"fuler\"\nexponent = 0.5\n" + ends), InputError);
  EXPECT_THROW((void)read("form = \"fuller\"\nexponent = 0.5\nradius_min = 2.0\nradius_max = 1.0\n"), InputError);
  EXPECT_THROW((void)read("form = \"classes\"\n"), InputError);
}

/// --set grains.sizes.file of a scene with values: what stands beside it, and the setting that replaces both.
TEST(GradingScene, AFileBesideValuesIsToldWithTheSettingThatReplacesThem) {
  const auto refused = [](const std::string& sizes) {
    const Scene scene = Scene::parse("[grains.sizes]\n" + sizes, "s.toml", {"grains.sizes.file=own.csv"});
    try {
      (void)scene.read([](const SceneTable& root) {
        const SceneTable t = root.table("grains").table("sizes");
        t.check([&] { (void)read_grading(t); });
        return 0;
      });
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string curve = refused("form = \"sieve-curve\"\nopenings = [1e-3, 4e-3]\npassing = [0.0, 1.0]\n");
  EXPECT_NE(curve.find("s.toml:3: openings = [ 0.001, 0.004 ]: goes without file"), std::string::npos) << curve;
  EXPECT_EQ(curve.find("passing ="), std::string::npos) << "said once: " << curve;
  EXPECT_NE(curve.find("--set 'grains.sizes={form=\"sieve-curve\",file=\"own.csv\"}'"), std::string::npos) << curve;
  const std::string list = refused("form = \"list\"\nradii = [1e-3]\ncounts = [1]\n");
  EXPECT_NE(list.find("radii = "), std::string::npos) << list;
  EXPECT_NE(list.find("--set 'grains.sizes={form=\"list\",file=\"own.csv\"}'"), std::string::npos) << list;
}

}  // namespace

// Which runs a sweep has, how they are called, and what is wrong with one that is asked for wrongly; numbers over runs.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "pipelines/law/terminal_plot.h"
#include "pipelines/runs/run_set.h"
#include "pipelines/runs/set_text.h"

namespace softgrain {
namespace {

std::vector<std::string> names_of(const RunPlan& plan) {
  std::vector<std::string> out;
  for (const PlannedRun& run : plan.runs) out.push_back(run.name);
  return out;
}

using Texts = std::vector<std::string>;

TEST(RunPlan, IsTheProductOfKeysAndSeedsFirstKeySlowest) {
  const RunPlan plan = make_plan({"macro.bodies=20,40", "material.mu=0.1"}, "3,5..6", {});
  EXPECT_EQ(names_of(plan), (Texts{"bodies=20_mu=0.1_seed=3", "bodies=20_mu=0.1_seed=5", "bodies=20_mu=0.1_seed=6",
                                   "bodies=40_mu=0.1_seed=3", "bodies=40_mu=0.1_seed=5", "bodies=40_mu=0.1_seed=6"}));
  EXPECT_EQ(plan.overrides(plan.runs[3]), (Texts{"macro.bodies=40", "material.mu=0.1"}));
  EXPECT_EQ(plan.runs[3].seed, 3U);
}

TEST(RunPlan, ValuesMayBeListsTextsAndRanges) {
  const RunPlan plan = make_plan({"a.deltas=[0.1,0.2],[0.3]", "E=\"0.5 MPa\",1e6", "n=2..4"}, "", {});
  EXPECT_EQ(plan.over[0].values, (Texts{"[0.1,0.2]", "[0.3]"}));
  EXPECT_EQ(plan.over[1].values, (Texts{"\"0.5 MPa\"", "1e6"}));
  EXPECT_EQ(plan.over[2].values, (Texts{"2", "3", "4"}));
  EXPECT_EQ(plan.runs.size(), 12U);
  EXPECT_EQ(plan.runs.front().name, "deltas=0.1-0.2-_E=0.5-MPa_n=2");
  EXPECT_FALSE(plan.runs.front().seed.has_value());
}

/// A path is no range of numbers, and no directory of its own.
TEST(RunPlan, PathsMakeOneDirectoryEach) {
  const RunPlan plan = make_plan({"law=../a/law.toml,../b/law.toml,../a+law.toml"}, "", {});
  EXPECT_EQ(names_of(plan), (Texts{"law=..-a-law.toml", "law=..-b-law.toml", "law=..-a+law.toml"}));
}

/// Other values that make the same word stay apart; keys with the same last part keep the rest.
TEST(RunPlan, NamesAreUnique) {
  EXPECT_EQ(names_of(make_plan({"law=a/b,a b"}, "", {})), (Texts{"law=a-b", "law=a-b-2"}));
  EXPECT_EQ(names_of(make_plan({"macro.mu=0.1", "material.mu=0.2"}, "", {})), (Texts{"macro.mu=0.1_material.mu=0.2"}));
}

std::string complaint(const Texts& over, const std::string& seeds, const Texts& set = {}, bool one_seed = false) {
  try {
    (void)make_plan(over, seeds, set, one_seed);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(RunPlan, SaysAllThatIsWrongAtOnce) {
  EXPECT_EQ(complaint({"mu", "n=1,,2", "n=3,3", "E=5..2", "x=1"}, "1..3,two,-1", {"x=2"}),
            "--over mu: must be of the form key=a,b,c\n"
            "--over n=1,,2: a value is empty\n"
            "--over n=3,3: the key is swept twice\n"
            "--over n=3,3: 3 is given twice\n"
            "--over E=5..2: 5..2: must rise\n"
            "--over x=1: the key is set by --set as well\n"
            "--seeds 1..3,two,-1: two: must be whole numbers, at least 0, such as 1..8 or 1,3,7\n"
            "--seeds 1..3,two,-1: -1: must be whole numbers, at least 0, such as 1..8 or 1,3,7");
  EXPECT_NE(complaint({}, "").find("nothing is swept"), std::string::npos);
  EXPECT_NE(complaint({"seed=1,2"}, "1..2").find("the key seed is swept"), std::string::npos);
  EXPECT_EQ(complaint({"seed=1,2"}, "", {}, true), "--seed: the key seed is swept by --over as well");
  EXPECT_EQ(complaint({"a=1,2"}, "", {"seed = 3"}, true), "--seed: the key seed is set by --set as well");
  EXPECT_EQ(complaint({"a=1,2"}, "1..2", {"seed=3"}), "--seeds: the key seed is set by --set as well");
  EXPECT_EQ(complaint({"a.seed=1,2"}, "", {"b.seed=3"}, true), "") << "other keys of that name";
  EXPECT_NE(complaint({"a=1..200", "b=1..200"}, "").find("40000 runs"), std::string::npos);
  EXPECT_NE(complaint({"a=1..99999999999"}, "").find("more than 10000 values"), std::string::npos);
}

RunPlan sampled(const Texts& over, const std::string& sample, const std::string& seeds = "") {
  return make_plan(over, seeds, {}, false, read_design(sample, 1),
                   [](const std::string& key, const std::string&) { return key == "bodies"; });
}

/// Names are short and those of a larger design; values are within the ranges, whole where the key asks for it.
TEST(RunPlan, ADesignNamesItsPointsByNumber) {
  const RunPlan plan = sampled({"mu=0.1..0.8", "E=1e6..1e8:log", "bodies=20..22", "law=a,b"}, "sobol:4", "3..4");
  EXPECT_EQ(names_of(plan),
            (Texts{"sample_001_seed=3", "sample_001_seed=4", "sample_002_seed=3", "sample_002_seed=4",
                   "sample_003_seed=3", "sample_003_seed=4", "sample_004_seed=3", "sample_004_seed=4"}));
  EXPECT_EQ(plan.over[1].range, "1e6..1e8:log");
  EXPECT_EQ(plan.over[0].values.size(), 4U);
  EXPECT_EQ(values_text(plan.over[0]), "0.1 to 0.8");
  EXPECT_EQ(values_text(plan.over[1]), "1e6 to 1e8, logarithmic");
  for (const PlannedRun& run : plan.runs) {
    EXPECT_GE(std::stod(run.values[0]), 0.1);
    EXPECT_LE(std::stod(run.values[0]), 0.8);
    EXPECT_GE(std::stod(run.values[1]), 1e6);
    EXPECT_EQ(run.values[2].size(), 2U) << run.values[2];
    EXPECT_TRUE(run.values[3] == "a" || run.values[3] == "b");
  }
  const RunPlan larger = sampled({"mu=0.1..0.8", "E=1e6..1e8:log", "bodies=20..22", "law=a,b"}, "sobol:5", "3..4");
  for (std::size_t k = 0; k < plan.runs.size(); ++k) {
    EXPECT_EQ(larger.runs[k].name, plan.runs[k].name);
    EXPECT_EQ(larger.runs[k].values, plan.runs[k].values);
  }
  EXPECT_EQ(names_of(sampled({"mu=0..1", "E=0..1"}, "saltelli:2")).back(), "sample_008");
}

TEST(RunPlan, RangesAndDesignsGoTogether) {
  EXPECT_EQ(complaint({"mu=0.1..0.8", "E=1e6..1e8:log"}, ""),
            "--over mu=0.1..0.8: 0.1..0.8: a range goes with --sample lhs:N, sobol:N or saltelli:N; without it give "
            "values a,b,c, or whole numbers 1..8\n"
            "--over E=1e6..1e8:log: 1e6..1e8:log: a range goes with --sample lhs:N, sobol:N or saltelli:N; without it "
            "give values a,b,c, or whole numbers 1..8");
  const auto refused = [](const Texts& over, const std::string& sample) -> std::string {
    try {
      (void)sampled(over, sample);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refused({"mu=0.8..0.1", "E=0..1:log", "law=a"}, "lhs:4"),
            "--over mu=0.8..0.1: 0.8..0.1: must rise\n"
            "--over E=0..1:log: 0..1:log: a logarithmic range must be above 0\n"
            "--over law=a: one value; with --sample give a range LOW..HIGH or LOW..HIGH:log, or a list");
  EXPECT_EQ(refused({"bodies=2.5..8"}, "lhs:4"),
            "--over bodies=2.5..8: the key takes whole numbers: both ends must be such");
  EXPECT_NE(refused({}, "lhs:4").find("--sample: goes with --over"), std::string::npos);
  EXPECT_NE(refused({"a=0..1", "b=0..1"}, "saltelli:5000").find("20000 runs are asked for"), std::string::npos);
  for (const char* wrong : {"lhs", "lhs:", "lhs:1", "lhs:4.5", "grid:8", "sobol:10001"})
    EXPECT_NE(refused({"a=0..1"}, wrong).find("must be lhs:N, sobol:N or saltelli:N"), std::string::npos) << wrong;
}

/// stress = 10 mu - log E, of a run per point of a design.
SetSummary linear_set(const std::string& sample) {
  const RunPlan plan = sampled({"mu=0..1", "E=1..10:log", "law=a,b"}, sample);
  SetSummary set;
  set.over = plan.over;
  set.design = {plan.design->text(), 1};
  for (const PlannedRun& run : plan.runs) {
    RunEntry one{.name = run.name, .status = RunStatus::good};
    for (std::size_t k = 0; k < 3; ++k) one.values[plan.over[k].key] = run.values[k];
    one.numbers = {{"stress", "Pa", 10.0 * std::stod(run.values[0]) - std::log(std::stod(run.values[1]))},
                   {"constant", "", 1.0}};
    set.runs.push_back(one);
  }
  return set;
}

TEST(RunPlan, SensitivityIsThatOfEveryNumberToEveryKey) {
  const std::vector<KeyEffect> effects = sensitivity_of(linear_set("sobol:32"));
  ASSERT_EQ(effects.size(), 6U);
  EXPECT_EQ(effects[0].number + effects[0].key, "stressmu");
  EXPECT_GT(effects[0].rank->low, 0.9);
  EXPECT_NEAR(effects[0].determination, 1.0, 1e-9) << "linear in mu and in log E";
  EXPECT_NEAR(effects[1].coefficient->value / effects[0].coefficient->value, -std::log(10.0) / 10.0, 0.02);
  EXPECT_FALSE(effects[0].total.has_value());
  EXPECT_FALSE(effects[2].rank.has_value());
  EXPECT_EQ(effects[2].reason, "the values of the key are not numbers");
  EXPECT_EQ(effects[3].reason, "the number does not vary");
  const std::vector<KeyEffect> few = sensitivity_of(linear_set("sobol:4"));
  EXPECT_EQ(few[0].reason, "4 points, at least 8 are needed");
  EXPECT_FALSE(few[0].rank.has_value());
}

/// A base point of which one run failed counts nowhere among the indices.
TEST(RunPlan, IndicesLeaveOutBasePointsWithARunThatIsNotGood) {
  SetSummary set = linear_set("saltelli:16");
  ASSERT_EQ(set.runs.size(), 80U);
  const std::vector<KeyEffect> effects = sensitivity_of(set);
  EXPECT_EQ(effects[0].points, 32U) << "points A and B";
  EXPECT_GT(effects[0].first->value, 0.8);
  EXPECT_EQ(effects[2].total->value, 0.0) << "the law does nothing here";
  set.runs[7].status = RunStatus::not_usable;
  const std::vector<KeyEffect> fewer = sensitivity_of(set);
  EXPECT_EQ(fewer[0].points, 32U) << "it was none of A or B";
  EXPECT_FALSE(fewer[0].first.has_value());
  EXPECT_EQ(fewer[0].reason, "15 base points, at least 16 are needed for Sobol indices");
  set.sensitivity = fewer;
  EXPECT_NE(sensitivity_text(set).find("rank correlation"), std::string::npos);
}

RunEntry entry(const std::string& mu, double stress, RunStatus status = RunStatus::good, double error = kNaN) {
  return {.name = mu, .values = {{"mu", mu}}, .status = status, .numbers = {{"stress", "Pa", stress, error}}};
}

/// Mean 4, deviation sqrt(((-2)^2 + 0 + 2^2)/2) = 2, error 2/sqrt(3); the run that is not usable counts nowhere.
TEST(RunPlan, NumbersOverRunsAreThoseOfTheGoodOnes) {
  const std::vector<RunEntry> runs{entry("0.1", 2.0), entry("0.2", 10.0, RunStatus::good, 0.5), entry("0.1", 4.0),
                                   entry("0.1", 6.0), entry("0.1", 1e9, RunStatus::not_usable)};
  const std::vector<PointEntry> points = points_of({{"mu", {"0.1", "0.2"}}}, runs);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].name, "mu = 0.1");
  EXPECT_EQ(points[0].runs, 4U);
  const NumberOverRuns& n = points[0].numbers.at(0);
  EXPECT_EQ(n.runs, 3U);
  EXPECT_DOUBLE_EQ(n.mean, 4.0);
  EXPECT_DOUBLE_EQ(n.spread, 2.0);
  EXPECT_DOUBLE_EQ(n.error, 2.0 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(n.least, 2.0);
  EXPECT_DOUBLE_EQ(n.largest, 6.0);
  EXPECT_DOUBLE_EQ(points[1].numbers.at(0).error, 0.5) << "of a single run its own, over its samples";
  EXPECT_TRUE(std::isnan(points[1].numbers.at(0).spread));
}

TEST(FlatScene, NamesKeysAsSetDoesAndWritesEqualNumbersAlike) {
  const auto a = flat_scene("seed = 1\n[macro]\nmu = 0.30\nlist = [1, 2.0]\n[[contact]]\nmu = 0.5\n", "s");
  EXPECT_EQ(a, (std::map<std::string, std::string>{
                   {"seed", "1"}, {"macro.mu", "0.3"}, {"macro.list", "[1, 2]"}, {"contact.0.mu", "0.5"}}));
  EXPECT_EQ(flat_scene("mu = 3e-1\n", "s"), flat_scene("mu = 0.3\n", "s"));
  EXPECT_THROW((void)flat_scene("mu = = 3\n", "s"), InputError);
}

/// Long names stand above their values: broken lines lose their columns.
TEST(SetText, NamesThatAreTooLongStandAboveTheirValues) {
  SetSummary set;
  const std::string name = "constrained modulus, upper half of the stress, unloading (levels-1-2-20)";
  for (const char* run : {"first", "second"}) {
    RunEntry entry;
    entry.name = run;
    entry.status = RunStatus::good;
    entry.numbers = {{"K0", "", 0.5, 0.01}, {name, "Pa", 1.918e8, 1.9e7}};
    set.runs.push_back(entry);
  }
  const std::string text = numbers_text(set);
  EXPECT_NE(text.find("\n  " + name + " [Pa]\n    "), std::string::npos) << text;
  EXPECT_NE(text.find("\n  K0\n    "), std::string::npos) << text;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), law::kTerminalColumns) << line;
  for (RunEntry& run : set.runs) run.numbers.pop_back();
  EXPECT_EQ(numbers_text(set).find("  K0\n"), std::string::npos) << "beside its values where there is room";
}

}  // namespace
}  // namespace softgrain

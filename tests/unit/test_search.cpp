// sweep --maximise: what is refused, rounds of points, the optimum of simulated results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/core/error.h"
#include "pipelines/runs/search.h"

namespace softgrain {
namespace {

CommonOptions search_options(const std::vector<std::string>& over, const std::string& maximise = "density") {
  CommonOptions options;
  options.inputs = {"scene.toml"};
  options.over = over;
  options.maximise = maximise;
  return options;
}

std::string refusal_of(const CommonOptions& options) {
  try {
    (void)search_goal(options);
    (void)search_plan(options, [](const auto&, const auto&) { return false; });
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// What runs would give whose density is f of the first two keys.
RunEntry simulated(const RunPlan& plan, const PlannedRun& run, const std::function<double(double, double)>& f) {
  RunEntry entry{.name = run.name, .directory = run.name};
  std::vector<double> x;
  for (std::size_t k = 0; k < plan.over.size(); ++k) {
    entry.values[plan.over[k].key] = run.values[k];
    std::string text = run.values[k];
    std::erase(text, '"');
    x.push_back(std::stod(text));
  }
  entry.status = RunStatus::good;
  entry.numbers = {{"coordination", "", 6.0}, {"density at the start", "", f(x.front(), x.back())}};
  return entry;
}

/// All rounds, as run_set() makes them.
SetSummary searched(const CommonOptions& options, bool whole, const std::function<double(double, double)>& f) {
  const TakesWholeNumbers takes_whole = [whole](const auto&, const auto&) { return whole; };
  const SearchGoal goal = search_goal(options);
  RunPlan all = search_plan(options, takes_whole);
  const RunRounds rounds = search_rounds(goal, takes_whole, 1);
  SetSummary out;
  for (const PlannedRun& run : all.runs) out.runs.push_back(simulated(all, run, f));
  for (RunPlan more = rounds.next(all, out.runs); !more.runs.empty(); more = rounds.next(all, out.runs)) {
    for (const PlannedRun& run : more.runs) out.runs.push_back(simulated(all, run, f));
    all.runs.insert(all.runs.end(), more.runs.begin(), more.runs.end());
  }
  rounds.conclude(all, out);
  return out;
}

TEST(Search, FindsTheTopOfOneKeyBetweenItsPoints) {
  CommonOptions options = search_options({"constituent.1.mass=100..300"});
  options.points = 11;
  const SetSummary set = searched(options, false, [](double x, double) { return 0.7 - std::abs(x - 171.0) / 500.0; });
  ASSERT_TRUE(set.search && set.search->usable);
  EXPECT_EQ(set.runs.size(), 11U);
  EXPECT_EQ(set.search->number, "density at the start");  // a part of the name is enough
  EXPECT_NEAR(set.search->keys[0].value, 171.0, 8.0);     // of a tent, to which no parabola fits
  EXPECT_LE(set.search->keys[0].low, set.search->keys[0].value);
  EXPECT_EQ(set.search->curve.x.size(), set.search->curve.high.size());
  EXPECT_NE(search_text(set).find("largest density at the start at constituent.1.mass = 1"), std::string::npos);
}

/// More points come closer together, where a ridge that suits the whole range would flatten the top.
TEST(Search, MorePointsComeNearerToASmoothTop) {
  CommonOptions options = search_options({"a=0..1"});
  const auto top = [](double a, double) { return std::exp(-std::pow((a - 0.3) / 0.2, 2)); };
  for (const std::int64_t points : {12, 20, 30}) {
    options.points = points;
    const SetSummary set = searched(options, false, top);
    ASSERT_TRUE(set.search && set.search->usable);
    // Twelve points may be seen as one parabola within their scatter: that is what noisy results need.
    EXPECT_NEAR(set.search->keys[0].value, 0.3, points == 12 ? 5e-3 : 1e-3) << points;
  }
}

TEST(Search, OfTwoKeysIsExactForAQuadraticResult) {
  CommonOptions options = search_options({"a=0..2", "b=1e-3..10:log"}, "");
  options.minimise = "density";
  const SetSummary set = searched(
      options, false, [](double a, double b) { return std::pow(a - 1.3, 2) + 0.2 * std::pow(std::log10(b) + 1.2, 2); });
  ASSERT_TRUE(set.search && set.search->usable);
  EXPECT_NEAR(set.search->keys[0].value, 1.3, 1e-2);
  EXPECT_NEAR(std::log10(set.search->keys[1].value), -1.2, 2e-2);
  EXPECT_LE(set.runs.size(), 18U);
}

TEST(Search, OfWholeNumbersRunsNoneTwice) {
  const SetSummary set =
      searched(search_options({"n=1..6"}), true, [](double n, double) { return -std::pow(n - 4.0, 2); });
  std::vector<std::string> names;
  for (const RunEntry& run : set.runs) names.push_back(run.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_NEAR(set.search->keys[0].value, 4.0, 0.5);
}

TEST(Search, AnOptimumAtAnEndIsSaid) {
  for (const auto& [range, end] :
       {std::pair{"a=0..2", 2.0}, std::pair{"a=0.2..0.9", 0.9}}) {  // 0.2 + (0.9 - 0.2) < 0.9
    const SetSummary set = searched(search_options({range}), false, [](double a, double) { return a; });
    EXPECT_EQ(set.search->keys[0].value, end);
    ASSERT_FALSE(set.head.warnings.empty());
    EXPECT_NE(set.head.warnings.front().find("widen the range"), std::string::npos) << range;
  }
}

TEST(Search, RefusesWhatDoesNotGoTogether) {
  CommonOptions sampled = search_options({"a=0..1"});
  sampled.sample = "lhs:4";
  EXPECT_NE(refusal_of(sampled).find("--sample"), std::string::npos);
  EXPECT_NE(refusal_of(search_options({})).find("one or two keys"), std::string::npos);
  EXPECT_NE(refusal_of(search_options({"a=0..1", "b=0..1", "c=0..1"})).find("one or two keys"), std::string::npos);
  EXPECT_NE(refusal_of(search_options({"a=1,2"})).find("range"), std::string::npos);
  EXPECT_EQ(refusal_of(search_options({"a=0..1"})), "");
  CommonOptions few = search_options({"a=0..1"});
  few.points = 4;
  EXPECT_NE(refusal_of(few).find("5 points"), std::string::npos);
  CommonOptions both = search_options({"a=0..1"});
  both.minimise = "density";
  EXPECT_NE(refusal_of(both).find("--minimise"), std::string::npos);
}

TEST(Search, AnUnknownResultIsAnsweredWithAllNames) {
  try {
    (void)searched(search_options({"a=0..1"}, "strength"), false, [](double a, double) { return a; });
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("coordination; density at the start"), std::string::npos) << e.what();
  }
}

/// Their summary says why the runs have no results; an unknown name is not the reason.
TEST(Search, WithoutAnyResultSaysThatThereIsNone) {
  const TakesWholeNumbers takes_whole = [](const auto&, const auto&) { return false; };
  const CommonOptions options = search_options({"a=0..1"});
  const RunPlan all = search_plan(options, takes_whole);
  const RunRounds rounds = search_rounds(search_goal(options), takes_whole, 1);
  SetSummary set;
  for (const PlannedRun& run : all.runs) {
    set.runs.push_back({.name = run.name, .directory = run.name, .status = RunStatus::not_usable});
    set.runs.back().values["a"] = run.values.front();
  }
  EXPECT_TRUE(rounds.next(all, set.runs).runs.empty());
  rounds.conclude(all, set);
  ASSERT_TRUE(set.search.has_value());
  EXPECT_FALSE(set.search->usable);
  EXPECT_EQ(set.search->number, "density");
  EXPECT_EQ(set.head.status, RunStatus::not_usable);
  EXPECT_NE(search_text(set).find("no point has the number"), std::string::npos) << search_text(set);
}

}  // namespace
}  // namespace softgrain

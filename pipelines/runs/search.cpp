#include "pipelines/runs/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "calibrate/bootstrap.h"
#include "calibrate/optimum_search.h"
#include "common/core/error.h"
#include "common/core/statistics.h"
#include "pipelines/runs/set_text.h"

namespace softgrain {

namespace {

using Unit01 = std::vector<double>;  ///< a point of the unit box, one coordinate per key

std::vector<SweptRange> ranges_of(const RunPlan& plan, const TakesWholeNumbers& takes_whole) {
  std::vector<SweptRange> out;
  for (const SweptKey& key : plan.over) {
    std::string ignored;
    auto range = range_of(key.range, ignored);
    if (!range) throw InputError(fmt::format("--over {}: a search needs a range LOW..HIGH", key.key));
    range->whole = takes_whole(key.key, value_at(*range, 0.5));
    out.push_back(*range);
  }
  return out;
}

double position(const SweptRange& range, double value) {
  return range.logarithmic ? std::log(value / range.low) / std::log(range.high / range.low)
                           : (value - range.low) / (range.high - range.low);
}

/// Exact at both ends, which is_at_end() tells by.
double value_of(const SweptRange& range, double u) {
  if (u <= 0.0) return range.low;
  if (u >= 1.0) return range.high;
  return range.logarithmic ? range.low * std::pow(range.high / range.low, u) : range.low + u * (range.high - range.low);
}

/// Where a text of value_at() lies in its range.
double position_of_text(const SweptRange& range, std::string text) {
  std::erase(text, '"');
  return position(range, std::stod(text));
}

std::vector<std::vector<std::string>> texts_of(const std::vector<Unit01>& points,
                                               const std::vector<SweptRange>& ranges) {
  std::vector<std::vector<std::string>> out;
  for (const Unit01& u : points) {
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < u.size(); ++k) texts.push_back(value_at(ranges[k], u[k]));
    if (std::ranges::find(out, texts) == out.end()) out.push_back(std::move(texts));  // whole numbers may coincide
  }
  return out;
}

/// The result of this name, or the first whose name holds the text; without a unit where no run has a result. Throws
/// InputError with all names.
RunValue result_named(const std::string& text, const std::vector<RunEntry>& entries) {
  const std::vector<RunValue> all = numbers_of(entries);
  if (all.empty()) return {.name = text, .unit = ""};  // the runs say why, and no other name would help
  for (const RunValue& v : all)
    if (v.name == text) return v;
  for (const RunValue& v : all)
    if (v.name.find(text) != std::string::npos) return v;
  throw InputError(fmt::format("no result is called '{}'; the runs are kept, --resume goes on with one of: {}", text,
                               join_text(all, "; ", &RunValue::name)));
}

/// Means over seeds need every run of a point: others are left out.
SearchedPoints searched_points(const RunPlan& plan, const std::vector<RunEntry>& entries, const std::string& number,
                               const std::vector<SweptRange>& ranges) {
  const std::size_t seeds = std::max<std::size_t>(1, plan.seeds.size());
  SearchedPoints out;
  for (std::size_t first = 0; first + seeds <= entries.size(); first += seeds) {
    std::vector<double> values;
    for (std::size_t s = 0; s < seeds; ++s) {
      const RunEntry& run = entries[first + s];
      const auto at = std::ranges::find(run.numbers, number, &RunValue::name);
      if (run.status == RunStatus::good && at != run.numbers.end() && std::isfinite(at->value))
        values.push_back(at->value);
    }
    if (values.size() < seeds) continue;
    Unit01 u;
    for (std::size_t k = 0; k < ranges.size(); ++k)
      u.push_back(position_of_text(ranges[k], entries[first].values.at(plan.over[k].key)));
    out.points.push_back(std::move(u));
    out.values.push_back(std::move(values));
  }
  return out;
}

std::vector<Unit01> points_there(const RunPlan& plan, const std::vector<SweptRange>& ranges) {
  std::vector<Unit01> out;
  for (const PlannedRun& run : plan.runs) {
    Unit01 u;
    for (std::size_t k = 0; k < ranges.size(); ++k) u.push_back(position_of_text(ranges[k], run.values[k]));
    if (std::ranges::find(out, u) == out.end()) out.push_back(std::move(u));
  }
  return out;
}

/// Of one key, over the fitted points.
SearchCurve search_curve(const OptimumEstimate& best, const SearchedPoints& data, const SweptRange& range) {
  constexpr int kSteps = 60;
  SearchCurve out;
  double low = 1.0;
  double high = 0.0;
  for (const std::size_t p : best.fitted) {
    low = std::min(low, data.points[p][0]);
    high = std::max(high, data.points[p][0]);
  }
  for (int k = 0; k <= kSteps; ++k) {
    const double u = low + (high - low) * k / kSteps;
    std::vector<double> drawn;
    for (std::size_t r = 1; r < best.surfaces.size(); ++r) drawn.push_back(best.surfaces[r].value({u})[0]);
    const auto [from, to] = interval95(drawn);
    out.x.push_back(value_of(range, u));
    out.y.push_back(best.surfaces.front().value({u})[0]);
    out.low.push_back(from);
    out.high.push_back(to);
  }
  return out;
}

OptimumSummary summary_of_search(const SearchGoal& goal, const RunValue& number, const SearchedPoints& data,
                                 const std::vector<SweptKey>& keys, const std::vector<SweptRange>& ranges,
                                 std::uint64_t seed) {
  OptimumSummary out;
  out.number = number.name;
  out.unit = number.unit;
  out.maximise = goal.maximise;
  out.points = static_cast<std::int64_t>(data.points.size());
  if (data.points.empty()) {
    out.reason = "no point has the number";
    return out;
  }
  const OptimumEstimate best = find_optimum(data, goal.maximise, seed);
  out.usable = best.usable;
  out.reason = best.message;
  if (!best.usable) return out;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const SweptRange& r = ranges[k];
    out.keys.push_back({.key = keys[k].key,
                        .unit = r.unit,
                        .value = value_of(r, best.u[k].value),
                        .low = value_of(r, best.u[k].low),
                        .high = value_of(r, best.u[k].high),
                        .from = r.low,
                        .to = r.high,
                        .logarithmic = r.logarithmic});
  }
  out.value = best.value.value;
  out.low = best.value.low;
  out.high = best.value.high;
  out.inside = best.inside;
  out.over_seeds = best.over_seeds;
  out.fitted = static_cast<std::int64_t>(best.fitted.size());
  if (keys.size() == 1) out.curve = search_curve(best, data, ranges.front());
  return out;
}

bool is_at_end(const SearchedKey& k) { return k.value <= k.from || k.value >= k.to; }

void add_remarks(SetSummary& summary) {
  const OptimumSummary& s = *summary.search;
  if (!s.usable) return summary.head.mark_unusable("no optimum: " + s.reason);
  for (const SearchedKey& k : s.keys)
    if (is_at_end(k))
      summary.head.warnings.push_back(fmt::format(
          "the optimum is at the end {:g} of the range of {}: what lies beyond is not known; widen the range", k.value,
          k.key));
  if (!s.over_seeds)
    summary.head.warnings.emplace_back(
        "the interval of the optimum holds the scatter of points about the fitted surface alone: what all runs of one "
        "seed have in common is not in it; --seeds 1..4 shows it");
}

}  // namespace

SearchGoal search_goal(const CommonOptions& options) {
  if (!options.maximise.empty() && !options.minimise.empty()) throw InputError("--maximise: goes without --minimise");
  const std::string option = options.maximise.empty() ? "--minimise" : "--maximise";
  const auto refuse = [&](bool given, const char* other) {
    if (given)
      throw InputError(fmt::format("{}: goes without {}: which points are run depends on results", option, other));
  };
  refuse(!options.sample.empty(), "--sample");
  refuse(options.jobs > 1, "--jobs");
  refuse(options.slurm, "--slurm");
  refuse(!options.only.empty(), "--only");
  if (options.over.empty() || options.over.size() > 2)
    throw InputError(fmt::format("{}: needs one or two keys with ranges, --over KEY=LOW..HIGH; {} given", option,
                                 options.over.size()));
  const std::size_t first = first_search_points(options.over.size()).size();
  const std::size_t points =
      options.points > 0 ? static_cast<std::size_t>(options.points) : search_points(options.over.size());
  if (points < first)
    throw InputError(fmt::format("--points {}: the first round of a search over {} key{} has {} points", points,
                                 options.over.size(), options.over.size() == 1 ? "" : "s", first));
  return {options.maximise.empty() ? options.minimise : options.maximise, options.minimise.empty(), points};
}

RunPlan search_plan(const CommonOptions& options, const TakesWholeNumbers& takes_whole) {
  // Read as a sample of the ranges, of which the points are replaced.
  RunPlan plan = make_plan(options.over, options.seeds, options.overrides, options.seed_given,
                           SampleDesign{.form = SampleForm::lhs, .points = 2, .seed = 0}, takes_whole);
  plan.design.reset();
  return plan_of_points(plan, texts_of(first_search_points(plan.over.size()), ranges_of(plan, takes_whole)));
}

RunRounds search_rounds(const SearchGoal& goal, const TakesWholeNumbers& takes_whole, std::uint64_t seed) {
  constexpr int kMostRounds = 8;
  const auto round = std::make_shared<int>(0);
  RunRounds out;
  out.next = [=](const RunPlan& all, const std::vector<RunEntry>& entries) {
    const std::vector<SweptRange> ranges = ranges_of(all, takes_whole);
    const std::string number = result_named(goal.number, entries).name;
    const std::vector<Unit01> there = points_there(all, ranges);
    std::vector<std::vector<std::string>> more;
    const OptimumEstimate best = find_optimum(searched_points(all, entries, number, ranges), goal.maximise, seed);
    while (best.usable && more.empty() && there.size() < goal.points && ++*round <= kMostRounds) {
      Unit01 optimum;
      for (const Estimate& u : best.u) optimum.push_back(u.value);
      more = texts_of(next_search_points(optimum, there, *round), ranges);
      std::erase_if(more, [&](const std::vector<std::string>& texts) {
        return std::ranges::any_of(all.runs, [&](const PlannedRun& run) { return run.values == texts; });
      });
      more.resize(std::min(more.size(), goal.points - there.size()));
    }
    return plan_of_points(all, more);
  };
  out.conclude = [=](const RunPlan& all, SetSummary& summary) {
    const std::vector<SweptRange> ranges = ranges_of(all, takes_whole);
    const RunValue number = result_named(goal.number, summary.runs);
    summary.search = summary_of_search(goal, number, searched_points(all, summary.runs, number.name, ranges), all.over,
                                       ranges, seed);
    add_remarks(summary);
  };
  return out;
}

TextTable search_table(const OptimumSummary& search) {
  TextTable out{{search.keys.front().key, search.number, "low (95 %)", "high (95 %)"}, {}};
  const SearchCurve& c = search.curve;
  for (std::size_t k = 0; k < c.x.size(); ++k)
    out.rows.push_back({fmt::format("{:.8g}", c.x[k]), fmt::format("{:.8g}", c.y[k]), fmt::format("{:.8g}", c.low[k]),
                        fmt::format("{:.8g}", c.high[k])});
  return out;
}

std::string search_text(const SetSummary& summary) {
  if (!summary.search) return "";
  const OptimumSummary& s = *summary.search;
  const std::string what = fmt::format("{} {}", s.maximise ? "largest" : "smallest", with_unit(s.number, s.unit));
  if (!s.usable) return what + ": not determined: " + s.reason + "\n";
  std::string text = what + " at";
  for (std::size_t k = 0; k < s.keys.size(); ++k) {
    const SearchedKey& key = s.keys[k];
    text += fmt::format("{} {} = {:.4g}{} (95 %: {:.4g} to {:.4g})", k > 0 ? "," : "", key.key, key.value,
                        key.unit.empty() ? "" : " " + key.unit, key.low, key.high);
  }
  text += fmt::format(": {:.5g} ({:.5g} to {:.5g})\n", s.value, s.low, s.high);
  return text + fmt::format("  {} of {} points fitted; {:.0f} % of the replicates have the optimum inside the range\n",
                            s.fitted, s.points, 100.0 * s.inside);
}

}  // namespace softgrain

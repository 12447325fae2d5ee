#include "pipelines/runs/set_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/text.h"
#include "common/io/scene.h"
#include "pipelines/law/terminal_plot.h"
#include "pipelines/runs/sample_design.h"

namespace softgrain {

namespace {

constexpr std::size_t kNumbersShown = 4;

/// One choice of values with what came out in the mean over seeds.
struct PointValue {
  const RunEntry* run = nullptr;
  double value = kNaN;  ///< NaN: a run is not good, or has no such number
};

double number_of(const RunEntry& run, const std::string& name) {
  const auto at = std::ranges::find(run.numbers, name, &RunValue::name);
  return run.status != RunStatus::good || at == run.numbers.end() ? kNaN : at->value;
}

/// In the order of the plan, in which the seeds of a point follow each other.
std::vector<PointValue> point_values(const SetSummary& summary, const std::string& number) {
  const std::size_t seeds = std::max<std::size_t>(1, summary.seeds.size());
  std::vector<PointValue> out;
  for (std::size_t first = 0; first + seeds <= summary.runs.size(); first += seeds) {
    double sum = 0.0;
    for (std::size_t s = 0; s < seeds; ++s) sum += number_of(summary.runs[first + s], number);
    out.push_back({&summary.runs[first], sum / static_cast<double>(seeds)});
  }
  return out;
}

std::optional<SampleForm> form_of(const SetSummary& summary) {
  if (!summary.design) return std::nullopt;
  return parse_enum<SampleForm>(summary.design->sample.substr(0, summary.design->sample.find(':')));
}

/// The points that were chosen independently and have the number. `group`: points of Saltelli's design that belong to
/// one base point, A and B first.
std::vector<PointValue> independent(const std::vector<PointValue>& points, bool saltelli, std::size_t group) {
  std::vector<PointValue> out;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (std::isfinite(points[p].value) && (!saltelli || p % group < 2)) out.push_back(points[p]);
  return out;
}

/// The values of a key as numbers; empty where one is none.
std::vector<double> column_of(const SweptKey& key, const std::vector<PointValue>& points) {
  std::vector<double> out;
  for (const PointValue& point : points) {
    std::string text = point.run->values.at(key.key);
    std::erase_if(text, [](char c) { return c == '"' || c == '\''; });
    const auto value = quantity_of_any_unit(text);
    if (!value) return {};
    out.push_back(key.range.ends_with(":log") ? std::log(*value) : *value);
  }
  return out;
}

/// Base points of which every run has the number.
SobolSample sobol_sample(const std::vector<PointValue>& points, std::size_t keys) {
  const std::size_t group = keys + 2;
  SobolSample out{.a = {}, .b = {}, .mixed = std::vector<std::vector<double>>(keys)};
  for (std::size_t first = 0; first + group <= points.size(); first += group) {
    const auto at = [&](std::size_t k) { return points[first + k].value; };
    bool whole = true;
    for (std::size_t k = 0; k < group; ++k) whole = whole && std::isfinite(at(k));
    if (!whole) continue;
    out.a.push_back(at(0));
    out.b.push_back(at(1));
    for (std::size_t k = 0; k < keys; ++k) out.mixed[k].push_back(at(k + 2));
  }
  return out;
}

/// Adds rank correlations and the regression to the effects of one number, one per key.
void add_correlations(const SetSummary& summary, const std::vector<PointValue>& points,
                      std::vector<KeyEffect>& effects) {
  std::vector<double> y;
  for (const PointValue& point : points) y.push_back(point.value);
  std::vector<std::vector<double>> columns;
  std::vector<std::size_t> keys;  ///< of the columns
  for (std::size_t k = 0; k < summary.over.size(); ++k) {
    KeyEffect& effect = effects[k];
    effect.points = points.size();
    std::vector<double> column = column_of(summary.over[k], points);
    if (points.size() < kLeastRanked)
      effect.reason = fmt::format("{}, at least {} are needed", counted(points.size(), "point"), kLeastRanked);
    else if (!varies(y))
      effect.reason = "the number does not vary";
    else if (column.empty())
      effect.reason = "the values of the key are not numbers";
    else if (!varies(column))
      effect.reason = "the key does not vary";
    if (!effect.reason.empty()) continue;
    effect.rank = rank_correlation(column, y);
    keys.push_back(k);
    columns.push_back(std::move(column));
  }
  const auto fit = standardised_regression(columns, y);
  for (std::size_t c = 0; fit && c < keys.size(); ++c) {
    effects[keys[c]].coefficient = fit->coefficients[c];
    effects[keys[c]].determination = fit->determination;
  }
  if (fit || keys.empty()) return;
  const std::size_t needed = least_regressed(keys.size());
  const std::string why = points.size() < needed ? fmt::format("{}, at least {} are needed for a regression",
                                                               counted(points.size(), "point"), needed)
                                                 : std::string("no regression: keys depend on each other");
  for (const std::size_t k : keys) append_part(effects[k].reason, why, "; ");
}

void add_indices(const SobolSample& sample, std::uint64_t seed, std::uint64_t stream, std::vector<KeyEffect>& effects) {
  const auto indices = sobol_indices(sample, seed, stream);
  for (std::size_t k = 0; k < effects.size(); ++k) {
    if (indices) {
      effects[k].first = indices->first[k];
      effects[k].total = indices->total[k];
    } else if (sample.a.size() < kLeastBasePoints) {
      append_part(effects[k].reason, fmt::format("{} base points, at least {} are needed for Sobol indices",
                                                 sample.a.size(), kLeastBasePoints));
    }
  }
}

bool is_determined(const KeyEffect& e) { return e.rank || e.coefficient || e.first; }

}  // namespace

std::vector<KeyEffect> sensitivity_of(const SetSummary& summary) {
  std::vector<KeyEffect> out;
  if (summary.over.empty()) return out;
  const bool saltelli = form_of(summary) == SampleForm::saltelli;
  const std::size_t group = summary.over.size() + 2;
  std::uint64_t stream = 0;
  for (const RunValue& number : numbers_of(summary.runs)) {
    std::vector<KeyEffect> effects;
    for (const SweptKey& key : summary.over) effects.push_back({.number = number.name, .key = key.key});
    const std::vector<PointValue> points = point_values(summary, number.name);
    add_correlations(summary, independent(points, saltelli, group), effects);
    if (saltelli)
      add_indices(sobol_sample(points, summary.over.size()), static_cast<std::uint64_t>(summary.design->seed), stream++,
                  effects);
    out.insert(out.end(), effects.begin(), effects.end());
  }
  return out;
}

std::string sensitivity_text(const SetSummary& summary) {
  if (summary.sensitivity.empty()) return "";
  if (std::ranges::none_of(summary.sensitivity, is_determined))
    return fmt::format("sensitivity: not determined: {}\n", summary.sensitivity.front().reason);
  const bool saltelli = form_of(summary) == SampleForm::saltelli;
  const std::vector<RunValue> numbers = numbers_of(summary.runs);
  std::string text = "sensitivity, with 95 % intervals:\n";
  for (std::size_t n = 0; n < std::min(numbers.size(), kNumbersShown); ++n) {
    std::vector<std::vector<std::string>> rows(1, {"", "rank correlation"});
    if (saltelli)
      rows.front().insert(rows.front().end(), {"Sobol, first order", "Sobol, total"});
    else
      rows.front().emplace_back("regression");
    for (const KeyEffect& e : summary.sensitivity) {
      if (e.number != numbers[n].name) continue;
      rows.push_back({short_key(summary.over, e.key), effect_text(e.rank)});
      if (saltelli)
        rows.back().insert(rows.back().end(), {effect_text(e.first), effect_text(e.total)});
      else
        rows.back().push_back(effect_text(e.coefficient));
    }
    text += "  " + numbers[n].name + "\n" + law::aligned(rows, 4);
  }
  return text;
}

}  // namespace softgrain

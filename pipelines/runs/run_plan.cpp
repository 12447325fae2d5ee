#include "pipelines/runs/run_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr std::size_t kMostRuns = 10000;

using Texts = std::vector<std::string>;

/// Splits a text at commas outside brackets and quotes.
Texts split_values(const std::string& text) {
  Texts parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
  }
  for (std::string& part : parts) part = trimmed(part);
  return parts;
}

std::optional<std::int64_t> whole_number(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "2..5" as 2, 3, 4, 5; another text as it is. `problem`: what is wrong with it.
Texts expanded(const std::string& text, std::string& problem) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return {text};
  const auto low = whole_number(text.substr(0, dots));
  const auto high = whole_number(text.substr(dots + 2));
  if (!low || !high) return {text};
  if (*high < *low) problem = fmt::format("{}: must rise", text);
  if (!problem.empty() || static_cast<std::uint64_t>(*high - *low) >= kMostRuns) {
    if (problem.empty()) problem = fmt::format("{}: more than {} values", text, kMostRuns);
    return {};
  }
  Texts out;
  for (std::int64_t k = *low; k <= *high; ++k) out.push_back(std::to_string(k));
  return out;
}

/// The values of a list; mistakes go to `problems`, behind `option`.
Texts read_values(const std::string& list, const std::string& option, Texts& problems) {
  Texts out;
  for (const std::string& part : split_values(list)) {
    std::string problem = part.empty() ? "a value is empty" : "";
    const Texts values = problem.empty() ? expanded(part, problem) : Texts{};
    if (!problem.empty()) problems.push_back(option + ": " + problem);
    out.insert(out.end(), values.begin(), values.end());
  }
  std::set<std::string> seen;
  for (const std::string& value : out)
    if (!seen.insert(value).second) problems.push_back(fmt::format("{}: {} is given twice", option, value));
  return out;
}

std::string key_of(const std::string& setting) { return trimmed(setting.substr(0, setting.find('='))); }

/// Whole numbers are values of a list, other ranges have no values of their own.
void refuse_ranges(const Texts& values, const std::string& option, Texts& problems) {
  for (const std::string& value : values) {
    std::string ignored;
    if (range_of(value, ignored))
      problems.push_back(
          fmt::format("{}: {}: a range goes with --sample lhs:N, sobol:N or saltelli:N; without it give "
                      "values a,b,c, or whole numbers 1..8",
                      option, value));
  }
}

/// A key of a design: a range, or a list.
SweptKey sampled_key(const std::string& key, const std::string& text, const std::string& option, Texts& problems) {
  std::string problem;
  if (range_of(text, problem)) {
    if (!problem.empty()) problems.push_back(option + ": " + problem);
    return {key, {}, text};
  }
  SweptKey out{key, read_values(text, option, problems)};
  if (out.values.size() == 1)
    problems.push_back(option + ": one value; with --sample give a range LOW..HIGH or LOW..HIGH:log, or a list");
  return out;
}

std::vector<SweptKey> read_keys(const Texts& over, const Texts& set, bool sampled, Texts& problems) {
  std::vector<SweptKey> keys;
  for (const std::string& text : over) {
    const std::string option = "--over " + text;
    const std::string key = key_of(text);
    if (text.find('=') == std::string::npos || key.empty()) {
      problems.push_back(option + ": must be of the form key=a,b,c");
      continue;
    }
    if (std::ranges::any_of(keys, [&](const SweptKey& known) { return known.key == key; }))
      problems.push_back(option + ": the key is swept twice");
    if (std::ranges::any_of(set, [&](const std::string& one) { return key_of(one) == key; }))
      problems.push_back(option + ": the key is set by --set as well");
    const std::string values = trimmed(text.substr(text.find('=') + 1));
    if (sampled) {
      keys.push_back(sampled_key(key, values, option, problems));
      continue;
    }
    keys.push_back({key, read_values(values, option, problems)});
    refuse_ranges(keys.back().values, option, problems);
  }
  return keys;
}

std::vector<std::uint64_t> read_seeds(const std::string& text, Texts& problems) {
  std::vector<std::uint64_t> seeds;
  if (text.empty()) return seeds;
  const std::string option = "--seeds " + text;
  for (const std::string& one : read_values(text, option, problems)) {
    const auto value = whole_number(one);
    if (!value || *value < 0)
      problems.push_back(fmt::format("{}: {}: must be whole numbers, at least 0, such as 1..8 or 1,3,7", option, one));
    else
      seeds.push_back(static_cast<std::uint64_t>(*value));
  }
  return seeds;
}

/// A part of the name of a directory.
std::string file_word(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
                       c == '-' || c == '+' || c == '_';
    if (plain)
      out += c;
    else if (c != '"' && c != '\'' && !out.empty() && out.back() != '-')
      out += '-';
  }
  constexpr std::size_t kLong = 60;
  return out.substr(0, kLong);
}

std::string run_name(const RunPlan& plan, const PlannedRun& run) {
  std::string out;
  const auto add = [&](const std::string& key, const std::string& value) {
    append_part(out, file_word(key) + "=" + file_word(value), "_");
  };
  for (std::size_t k = 0; k < plan.over.size(); ++k) add(short_key(plan.over, plan.over[k].key), run.values[k]);
  if (run.seed) add("seed", std::to_string(*run.seed));
  return out;
}

/// Every run with every seed.
std::vector<PlannedRun> with_seeds(const RunPlan& plan, std::vector<PlannedRun> runs) {
  if (plan.seeds.empty()) return runs;
  std::vector<PlannedRun> seeded;
  for (const PlannedRun& run : runs)
    for (const std::uint64_t seed : plan.seeds) {
      seeded.push_back(run);
      seeded.back().seed = seed;
    }
  return seeded;
}

/// One run for every choice of values, not yet named.
std::vector<PlannedRun> product_of(const RunPlan& plan) {
  std::vector<PlannedRun> runs(1);
  for (const SweptKey& one : plan.over) {
    std::vector<PlannedRun> more;
    for (const PlannedRun& run : runs)
      for (const std::string& value : one.values) {
        more.push_back(run);
        more.back().values.push_back(value);
      }
    runs = std::move(more);
  }
  return with_seeds(plan, std::move(runs));
}

/// The range of a key that was read before, and what is wrong with it for a key of whole numbers.
std::optional<SweptRange> sampled_range(const SweptKey& key, const TakesWholeNumbers& takes_whole, Texts& problems) {
  std::string ignored;
  auto range = range_of(key.range, ignored);
  if (!range) return std::nullopt;
  range->whole = takes_whole(key.key, value_at(*range, 0.5));
  if (range->whole && (range->low != std::floor(range->low) || range->high != std::floor(range->high)))
    problems.push_back(
        fmt::format("--over {}={}: the key takes whole numbers: both ends must be such", key.key, key.range));
  return range;
}

/// The points of the design, not yet with seeds. Their values become those of the keys.
std::vector<PlannedRun> sampled_runs(RunPlan& plan, const TakesWholeNumbers& takes_whole, Texts& problems) {
  const std::vector<std::vector<double>> points = unit_points(*plan.design, plan.over.size());
  std::vector<PlannedRun> runs(points.size());
  for (std::size_t k = 0; k < plan.over.size(); ++k) {
    SweptKey& key = plan.over[k];
    const auto range = sampled_range(key, takes_whole, problems);
    std::set<std::string> seen;
    Texts values;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const auto at = static_cast<std::size_t>(points[p][k] * static_cast<double>(key.values.size()));
      const std::string value =
          range ? value_at(*range, points[p][k]) : key.values[std::min(at, key.values.size() - 1)];
      runs[p].values.push_back(value);
      if (seen.insert(value).second) values.push_back(value);
    }
    if (range) key.values = std::move(values);
  }
  return runs;
}

/// sample_001, ...: the number of a point does not change with the size of the design.
std::string sample_name(std::size_t point, const PlannedRun& run) {
  return fmt::format("sample_{:03}{}", point + 1, run.seed ? fmt::format("_seed={}", *run.seed) : "");
}

/// Values that make the same word get a number.
void name_runs(RunPlan& plan) {
  const std::size_t seeds = std::max<std::size_t>(1, plan.seeds.size());
  for (std::size_t k = 0; plan.design && k < plan.runs.size(); ++k)
    plan.runs[k].name = sample_name(k / seeds, plan.runs[k]);
  if (plan.design) return;
  std::set<std::string> taken;
  for (PlannedRun& run : plan.runs) {
    const std::string name = run_name(plan, run);
    run.name = name;
    for (int k = 2; !taken.insert(run.name).second; ++k) run.name = fmt::format("{}-{}", name, k);
  }
}

void require_few(const RunPlan& plan, Texts& problems) {
  double runs = plan.seeds.empty() ? 1.0 : static_cast<double>(plan.seeds.size());
  if (plan.design)
    runs *= static_cast<double>(plan.design->runs(plan.over.size()));
  else
    for (const SweptKey& one : plan.over) runs *= static_cast<double>(one.values.size());
  if (runs > static_cast<double>(kMostRuns))
    problems.push_back(fmt::format("{:.0f} runs are asked for, at most {} go into one sweep", runs, kMostRuns));
}

/// --seed and --seeds go before the key of the scene, which would say one thing and do nothing.
void refuse_other_seeds(const RunPlan& plan, const std::string& seeds, const Texts& set, bool one_seed,
                        Texts& problems) {
  const char* const option = !seeds.empty() ? "--seeds" : one_seed ? "--seed" : nullptr;
  if (option == nullptr) return;
  if (std::ranges::any_of(plan.over, [](const SweptKey& one) { return one.key == "seed"; }))
    problems.push_back(fmt::format("{}: the key seed is swept by --over as well", option));
  if (std::ranges::any_of(set, [](const std::string& one) { return key_of(one) == "seed"; }))
    problems.push_back(fmt::format("{}: the key seed is set by --set as well", option));
}

}  // namespace

std::vector<std::string> RunPlan::overrides(const PlannedRun& run) const {
  Texts out;
  for (std::size_t k = 0; k < over.size(); ++k) out.push_back(over[k].key + "=" + run.values[k]);
  return out;
}

RunPlan plan_of_points(const RunPlan& keys, const std::vector<Texts>& points) {
  RunPlan plan = keys;
  plan.runs.clear();
  for (SweptKey& key : plan.over) key.values.clear();
  for (const Texts& point : points) {
    plan.runs.push_back({.name = "", .values = point, .seed = {}});
    for (std::size_t k = 0; k < point.size(); ++k)
      if (std::ranges::find(plan.over[k].values, point[k]) == plan.over[k].values.end())
        plan.over[k].values.push_back(point[k]);
  }
  plan.runs = with_seeds(plan, std::move(plan.runs));
  name_runs(plan);
  return plan;
}

RunPlan make_plan(const Texts& over, const std::string& seeds, const Texts& set, bool one_seed,
                  const std::optional<SampleDesign>& design, const TakesWholeNumbers& takes_whole) {
  Texts problems;
  RunPlan plan;
  plan.design = design;
  plan.over = read_keys(over, set, design.has_value(), problems);
  plan.seeds = read_seeds(seeds, problems);
  refuse_other_seeds(plan, seeds, set, one_seed, problems);
  if (over.empty() && seeds.empty()) problems.emplace_back("nothing is swept: give --over key=a,b,c or --seeds 1..8");
  if (design && over.empty()) problems.emplace_back("--sample: goes with --over key=LOW..HIGH");
  require_few(plan, problems);
  if (!problems.empty()) throw InputError(join_text(problems, "\n"));
  if (design) {
    plan.runs = with_seeds(plan, sampled_runs(plan, takes_whole, problems));
    if (!problems.empty()) throw InputError(join_text(problems, "\n"));
  } else {
    plan.runs = product_of(plan);
  }
  name_runs(plan);
  return plan;
}

}  // namespace softgrain

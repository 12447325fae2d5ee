#include "pipelines/runs/run_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
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

std::vector<SweptKey> read_keys(const Texts& over, const Texts& set, Texts& problems) {
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
    keys.push_back({key, read_values(text.substr(text.find('=') + 1), option, problems)});
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
  if (plan.seeds.empty()) return runs;
  std::vector<PlannedRun> seeded;
  for (const PlannedRun& run : runs)
    for (const std::uint64_t seed : plan.seeds) {
      seeded.push_back(run);
      seeded.back().seed = seed;
    }
  return seeded;
}

/// Values that make the same word get a number.
void name_runs(RunPlan& plan) {
  std::set<std::string> taken;
  for (PlannedRun& run : plan.runs) {
    const std::string name = run_name(plan, run);
    run.name = name;
    for (int k = 2; !taken.insert(run.name).second; ++k) run.name = fmt::format("{}-{}", name, k);
  }
}

void require_few(const RunPlan& plan, Texts& problems) {
  double runs = plan.seeds.empty() ? 1.0 : static_cast<double>(plan.seeds.size());
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

RunPlan make_plan(const Texts& over, const std::string& seeds, const Texts& set, bool one_seed) {
  Texts problems;
  RunPlan plan;
  plan.over = read_keys(over, set, problems);
  plan.seeds = read_seeds(seeds, problems);
  refuse_other_seeds(plan, seeds, set, one_seed, problems);
  if (over.empty() && seeds.empty()) problems.emplace_back("nothing is swept: give --over key=a,b,c or --seeds 1..8");
  require_few(plan, problems);
  if (!problems.empty()) throw InputError(join_text(problems, "\n"));
  plan.runs = product_of(plan);
  name_runs(plan);
  return plan;
}

}  // namespace softgrain

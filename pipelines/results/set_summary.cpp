#include "pipelines/results/set_summary.h"

#include <algorithm>

#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

NumberOverRuns over_runs(const RunValue& of, const std::vector<RunEntry>& runs) {
  NumberOverRuns out{.name = of.name, .unit = of.unit};
  std::vector<double> values;
  double own_error = kNaN;
  for (const RunEntry& run : runs)
    for (const RunValue& v : run.numbers)
      if (v.name == of.name && std::isfinite(v.value)) {
        values.push_back(v.value);
        own_error = v.error;
      }
  const MeanError m = mean_error(values);
  out.runs = m.n;
  if (values.empty()) return out;
  out.mean = m.mean;
  out.spread = m.deviation;
  out.error = m.n > 1 ? m.error : own_error;
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  out.least = *least;
  out.largest = *largest;
  return out;
}

}  // namespace

std::vector<RunValue> numbers_of(const std::vector<RunEntry>& runs) {
  std::vector<RunValue> out;
  for (const RunEntry& run : runs)
    for (const RunValue& v : run.numbers)
      if (std::ranges::none_of(out, [&](const RunValue& known) { return known.name == v.name; })) out.push_back(v);
  return out;
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

std::string short_key(const std::vector<SweptKey>& over, const std::string& key) {
  const auto same =
      std::ranges::count_if(over, [&](const SweptKey& one) { return last_part(one.key) == last_part(key); });
  return same > 1 ? key : last_part(key);
}

std::string effect_text(const std::optional<EffectSize>& effect) {
  if (!effect) return "not determined";
  const auto rounded = [](double x) { return std::round(100.0 * x) / 100.0 + 0.0; };  // no -0.00
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", rounded(effect->value), rounded(effect->low), rounded(effect->high));
}

std::string values_text(const SweptKey& key) {
  if (key.range.empty()) return join_text(key.values);
  const std::size_t dots = key.range.find("..");
  const std::size_t end = key.range.find(":log");
  return key.range.substr(0, dots) + " to " + key.range.substr(dots + 2, end - dots - 2) +
         (end == std::string::npos ? "" : ", logarithmic");
}

std::string point_name(const std::vector<SweptKey>& over, const std::map<std::string, std::string>& values) {
  std::string out;
  for (const SweptKey& one : over)
    if (const auto at = values.find(one.key); at != values.end())
      append_part(out, short_key(over, one.key) + " = " + at->second, ", ");
  return out.empty() ? "all runs" : out;
}

std::vector<PointEntry> points_of(const std::vector<SweptKey>& over, const std::vector<RunEntry>& runs) {
  std::vector<PointEntry> out;
  for (const RunEntry& run : runs) {
    if (std::ranges::any_of(out, [&](const PointEntry& p) { return p.values == run.values; })) continue;
    PointEntry point{.name = point_name(over, run.values), .values = run.values};
    std::vector<RunEntry> good;
    for (const RunEntry& other : runs) {
      if (other.values != run.values) continue;
      ++point.runs;
      if (other.status == RunStatus::good) good.push_back(other);
    }
    for (const RunValue& number : numbers_of(good)) point.numbers.push_back(over_runs(number, good));
    out.push_back(std::move(point));
  }
  return out;
}

}  // namespace softgrain

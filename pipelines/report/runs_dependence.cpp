// How numbers of several runs depend on the keys that were swept.
#include "pipelines/report/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "common/data/law_words.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"

namespace softgrain::report {

namespace {

constexpr std::size_t kDependent = 4;  ///< drawings of numbers over keys, for each key alike

const NumberOverRuns* find(const PointEntry& point, const std::string& number) {
  const auto at = std::find_if(point.numbers.begin(), point.numbers.end(),
                               [&](const NumberOverRuns& v) { return v.name == number; });
  return at == point.numbers.end() ? nullptr : &*at;
}

/// A value of a key as a number with what stands behind it: 16 and "mm" of "16 mm".
struct Quantity {
  double value = 0.0;
  std::string unit;
};

std::optional<Quantity> quantity_of(const std::string& text) {
  const std::size_t quote = text.size() > 1 && (text.front() == '"' || text.front() == '\'') ? 1 : 0;
  const std::string bare = text.substr(quote, text.size() - 2 * quote);
  char* end = nullptr;
  const double value = std::strtod(bare.c_str(), &end);
  if (end == bare.c_str() || !std::isfinite(value)) return std::nullopt;
  std::string unit(end);
  unit.erase(0, unit.find_first_not_of(' '));
  return Quantity{value, unit};
}

/// The values of a key as numbers of one unit; empty where they are no such numbers, or one only.
std::vector<Quantity> numeric(const SweptKey& key) {
  std::vector<Quantity> out;
  for (const std::string& text : key.values) {
    const auto q = quantity_of(text);
    if (!q || (!out.empty() && q->unit != out.front().unit)) return {};
    out.push_back(*q);
  }
  return out.size() > 1 ? out : std::vector<Quantity>{};
}

/// Whether the values span a decade or more and are all above zero.
bool asks_for_logarithm(const std::vector<Quantity>& values) {
  constexpr double kDecade = 10.0;
  double low = values.front().value;
  double high = low;
  for (const Quantity& q : values) low = std::min(low, q.value), high = std::max(high, q.value);
  return low > 0.0 && high >= kDecade * low;
}

/// Numbers of the values from the smallest to the largest: lines go along the axis, in whatever order runs were made.
std::vector<std::size_t> ascending(const std::vector<Quantity>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t v) { return values[v].value; });
  return order;
}

/// What a point has in the other keys.
std::string others_of(const SetSummary& set, const PointEntry& point, const std::string& key) {
  auto values = point.values;
  values.erase(key);
  return values.empty() ? "" : point_name(set.over, values);
}

std::string dependence_figure(const SetSummary& set, const SweptKey& key, const std::vector<Quantity>& values,
                              const RunValue& number, const std::string& id) {
  double largest = 0.0;
  for (const PointEntry& point : set.points)
    if (const NumberOverRuns* n = find(point, number.name)) largest = std::max(largest, std::abs(n->mean));
  const bool si = !number.unit.empty() && number.unit != "%";
  const SiPrefix prefix = si ? si_prefix(largest) : SiPrefix{};
  Plot plot({.id = id,
             .title = number.name,
             .x = {.label = with_unit(key.key, values.front().unit),
                   .scale = asks_for_logarithm(values) ? Scale::logarithmic : Scale::linear},
             .y = {.label = with_unit(number.name, si ? prefix.symbol + number.unit : number.unit)}});
  std::vector<Series> lines;
  for (const std::size_t v : ascending(values))
    for (const PointEntry& point : set.points) {
      const NumberOverRuns* n = find(point, number.name);
      if (n == nullptr || !std::isfinite(n->mean) || point.values.at(key.key) != key.values[v]) continue;
      const std::string others = set.design ? "" : others_of(set, point, key.key);
      auto at = std::find_if(lines.begin(), lines.end(), [&](const Series& s) { return s.label == others; });
      if (at == lines.end()) {
        Series s{.label = others, .hover = "", .x = {}, .y = {}};
        s.style = run_style(lines.size(), false);
        if (set.design) s.style.width = 0.0;  // other keys differ from point to point
        at = lines.insert(lines.end(), std::move(s));
      }
      at->x.push_back(values[v].value);
      at->y.push_back(n->mean / prefix.factor);
      at->y_error.push_back(n->error / prefix.factor);
    }
  for (Series& s : lines) plot.add(std::move(s));
  return plot.empty()
             ? ""
             : figure(plot.svg(), set.seeds.size() > 1 ? "Mean over seeds ± standard error."
                                                       : "± the standard error within a run, over its samples.");
}

}  // namespace

std::vector<std::string> dependence_figures(const SetSummary& set, const std::vector<RunValue>& numbers) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < set.over.size(); ++k) {
    const std::vector<Quantity> values = numeric(set.over[k]);
    if (values.empty()) continue;
    const std::size_t each = std::max<std::size_t>(1, kDependent / set.over.size());
    for (std::size_t n = 0; n < std::min(numbers.size(), each); ++n)
      out.push_back(dependence_figure(set, set.over[k], values, numbers[n], fmt::format("over-{}-{}", k, n)));
  }
  return out;
}

std::string differences_part(const SetSummary& set) {
  if (!set.paired || set.paired->numbers.empty()) return "";
  HtmlTable table({"number", "A", "B", "A − B", "95 %", "error of the difference over that of one value"});
  for (const PairedNumber& n : set.paired->numbers)
    table.row({with_unit(n.name, n.unit), format_with_error(n.a, n.error_a), format_with_error(n.b, n.error_b),
               format_with_error(n.difference, n.error),
               ends_text(n.low, n.high, {format_number, 3, " to ", "–", true}),
               std::isfinite(n.over_one()) ? format_number(n.over_one(), 2) : "–"});
  const std::string how = set.paired->paired ? "Errors are paired: " + set.paired->method + "."
                                             : "Errors are those of independent runs: " + set.paired->reason + ".";
  return "<h3>Differences</h3>\n" + table.html() +
         paragraph("A: " + set.runs.front().name + ", B: " + set.runs.back().name + ". " + how);
}

}  // namespace softgrain::report

// Several runs side by side: what differs, a table, every curve, and how numbers depend on the keys that were swept.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_values.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/set_summary.h"

namespace softgrain::report {
namespace {

constexpr std::size_t kColumns = 4;    ///< numbers in the table of runs
constexpr std::size_t kDependent = 4;  ///< drawings of numbers over keys, for each key alike
constexpr std::size_t kColours = 7;    ///< before dashes tell curves apart

const RunValue* find(const RunEntry& run, const std::string& number) {
  const auto at =
      std::find_if(run.numbers.begin(), run.numbers.end(), [&](const RunValue& v) { return v.name == number; });
  return at == run.numbers.end() ? nullptr : &*at;
}

const NumberOverRuns* find(const PointEntry& point, const std::string& number) {
  const auto at = std::find_if(point.numbers.begin(), point.numbers.end(),
                               [&](const NumberOverRuns& v) { return v.name == number; });
  return at == point.numbers.end() ? nullptr : &*at;
}

std::string differences_table(const SetSummary& set) {
  if (set.differences.empty()) return "";
  std::vector<std::string> header{"differs in"};
  for (const RunEntry& run : set.runs) header.push_back(run.name);
  HtmlTable table(header, header.size());
  for (const SweptKey& one : set.differences) {
    std::vector<std::string> row{one.key};
    row.insert(row.end(), one.values.begin(), one.values.end());
    table.row(row);
  }
  return table.html();
}

std::string runs_table(const SetSummary& set, const std::vector<RunValue>& numbers) {
  const std::size_t shown = std::min(numbers.size(), kColumns);
  std::vector<std::string> header{"run"};
  for (const SweptKey& one : set.over) header.push_back(one.key);
  if (!set.seeds.empty()) header.emplace_back("seed");
  header.emplace_back("status");
  for (std::size_t k = 0; k < shown; ++k) header.push_back(with_unit(numbers[k].name, numbers[k].unit));
  header.emplace_back("time");
  HtmlTable table(header);
  for (const RunEntry& run : set.runs) {
    std::vector<std::string> row{run.name};
    for (const SweptKey& one : set.over) row.push_back(run.values.contains(one.key) ? run.values.at(one.key) : "");
    if (!set.seeds.empty()) row.push_back(run.seed ? std::to_string(*run.seed) : "");
    row.push_back(to_string(run.status));
    for (std::size_t k = 0; k < shown; ++k) {
      const RunValue* v = find(run, numbers[k].name);
      row.push_back(v == nullptr ? "–" : format_with_error(v->value, v->error));
    }
    row.push_back(std::isfinite(run.seconds) ? format_seconds(run.seconds) : "");
    table.row(row);
  }
  return table.html();
}

/// Numbers that do not fit beside the runs.
std::string other_numbers_table(const SetSummary& set, const std::vector<RunValue>& numbers) {
  constexpr std::size_t kRuns = 6;
  if (numbers.size() <= kColumns || set.runs.size() > kRuns) return "";
  std::vector<std::string> header{"number"};
  for (const RunEntry& run : set.runs) header.push_back(run.name);
  HtmlTable table(header);
  for (std::size_t k = kColumns; k < numbers.size(); ++k) {
    std::vector<std::string> row{with_unit(numbers[k].name, numbers[k].unit)};
    for (const RunEntry& run : set.runs) {
      const RunValue* v = find(run, numbers[k].name);
      row.push_back(v == nullptr ? "–" : format_with_error(v->value, v->error));
    }
    table.row(row);
  }
  return table.html();
}

std::string norms_table(const SetSummary& set) {
  if (set.norms.empty()) return "";
  HtmlTable table({"run", "of", "off from " + set.reference, "no norm, because"}, 2);
  for (const RunNorm& n : set.norms)
    table.row({n.run, n.of, std::isfinite(n.percent) ? format_with_error(n.percent, n.error) + " %" : "–", n.reason});
  return table.html() + paragraph(
                            "Relative L2 difference: square root of ∫(run − reference)² over ∫ reference², mean over "
                            "samples ± standard error.");
}

std::string seeds_table(const SetSummary& set) {
  if (set.seeds.size() < 2) return "";
  const bool several = set.points.size() > 1;
  std::vector<std::string> header{"number", "mean", "spread", "standard error", "least", "largest", "runs"};
  if (several) header.insert(header.begin(), "of");
  HtmlTable table(header, several ? 2 : 1);
  for (const PointEntry& point : set.points)
    for (const NumberOverRuns& n : point.numbers) {
      std::vector<std::string> row{with_unit(n.name, n.unit),
                                   format_number(n.mean),
                                   format_number(n.spread, 2),
                                   format_number(n.error, 2),
                                   format_number(n.least),
                                   format_number(n.largest),
                                   fmt::format("{} of {}", n.runs, point.runs)};
      if (several) row.insert(row.begin(), point.name);
      table.row(row);
    }
  return "<h3>Over seeds</h3>\n" + table.html() +
         paragraph(
             "Spread: standard deviation between runs of different seeds; standard error: of their mean. Runs that "
             "are not usable are left out.");
}

// ------------------------------------------------------------------------------------------------------------ curves

/// A curve and the run that it is of.
struct CurveOfRun {
  std::size_t run = 0;
  RunCurve curve;
};

struct CurvePlot {
  std::string title;
  std::vector<CurveOfRun> curves;
};

/// Of all runs whose directories are there, by what is drawn together.
std::vector<CurvePlot> plots_of(const RunData& run, const SetSummary& set) {
  std::vector<CurvePlot> plots;
  for (std::size_t k = 0; k < set.runs.size(); ++k) {
    const std::filesystem::path directory = std::filesystem::path(run.directory) / set.runs[k].directory;
    std::error_code ignored;
    if (!std::filesystem::is_directory(directory, ignored)) continue;
    for (RunCurve& curve : curves_of(directory.string())) {
      const std::string title = curve.plot + (curve.name.empty() ? "" : ", " + curve.name);
      auto at = std::find_if(plots.begin(), plots.end(), [&](const CurvePlot& p) { return p.title == title; });
      if (at == plots.end()) at = plots.insert(plots.end(), {title, {}});
      at->curves.push_back({k, std::move(curve)});
    }
  }
  return plots;
}

/// Runs of one choice of values share a colour.
std::size_t point_of(const SetSummary& set, const RunEntry& run) {
  const auto at =
      std::find_if(set.points.begin(), set.points.end(), [&](const PointEntry& p) { return p.values == run.values; });
  return static_cast<std::size_t>(at - set.points.begin());
}

SeriesStyle style_of(std::size_t index, bool one_of_many) {
  return {.color = palette::cycle(index),
          .width = one_of_many ? 0.8 : 1.6,
          .dash = index < kColours ? "" : "6 3",
          .opacity = one_of_many ? 0.55 : 1.0,
          .marker = one_of_many ? Marker::none : Marker::circle,
          .marker_size = 2.2};
}

/// Mean of curves with the same abscissae, and a band of one standard deviation; nothing where they differ.
std::optional<Series> mean_of(const std::vector<const RunCurve*>& curves, double unit) {
  if (curves.size() < 2) return std::nullopt;
  const std::vector<double>& x = curves.front()->x;
  for (const RunCurve* c : curves) {
    if (c->x.size() != x.size()) return std::nullopt;
    for (std::size_t k = 0; k < x.size(); ++k)
      if (std::abs(c->x[k] - x[k]) > 1e-6 * std::abs(x.back() - x.front())) return std::nullopt;
  }
  Series s{.label = "", .hover = "", .x = x, .y = {}};
  for (std::size_t k = 0; k < x.size(); ++k) {
    std::vector<double> values;
    for (const RunCurve* c : curves) values.push_back(c->y[k] / unit);
    const MeanError m = mean_error(values);
    s.y.push_back(m.mean);
    s.band_low.push_back(m.mean - m.deviation);
    s.band_high.push_back(m.mean + m.deviation);
  }
  return s;
}

void add_means(Plot& plot, const SetSummary& set, const CurvePlot& of, double unit) {
  for (std::size_t p = 0; p < set.points.size(); ++p) {
    std::vector<const RunCurve*> curves;
    for (const CurveOfRun& one : of.curves)
      if (point_of(set, set.runs[one.run]) == p && set.runs[one.run].status == RunStatus::good)
        curves.push_back(&one.curve);
    auto mean = mean_of(curves, unit);
    if (!mean) continue;
    mean->label = set.points.size() > 1 ? set.points[p].name : "mean, and one standard deviation between seeds";
    mean->group = mean->label;
    mean->style = style_of(p, false);
    plot.add(std::move(*mean));
  }
}

std::string curve_figure(const SetSummary& set, const CurvePlot& of, std::size_t number) {
  double largest = 0.0;
  for (const CurveOfRun& one : of.curves)
    for (const double y : one.curve.y)
      if (std::isfinite(y)) largest = std::max(largest, std::abs(y));
  const RunCurve& first = of.curves.front().curve;
  const SiPrefix prefix = first.y_unit.empty() ? SiPrefix{} : si_prefix(largest);
  Plot plot(
      {.id = fmt::format("runs-{}", number),
       .title = of.title,
       .x = {.label = first.x_label},
       .y = {.label = first.y_unit.empty() ? first.y_label : first.y_label + " [" + prefix.symbol + first.y_unit + "]"},
       .width = 760.0,
       .height = 420.0});
  const bool seeds = set.seeds.size() > 1;
  for (const CurveOfRun& one : of.curves) {
    const RunEntry& run = set.runs[one.run];
    const std::size_t colour = set.points.empty() ? one.run : point_of(set, run);
    Series s{.label = seeds ? "" : run.name, .hover = run.name, .x = one.curve.x, .y = one.curve.y};
    for (double& y : s.y) y /= prefix.factor;
    s.style = style_of(colour, seeds);
    if (run.status != RunStatus::good) s.style.dash = "1 3", s.hover += " (" + to_string(run.status) + ")";
    if (seeds && set.points.size() > 1) s.group = set.points[colour].name;
    plot.add(std::move(s));
  }
  if (seeds) add_means(plot, set, of, prefix.factor);
  return figure(plot.svg(), seeds
                                ? "Thin: single runs; thick: their mean, with a band of one standard deviation between "
                                  "them. Means over the samples of each run."
                                : "One curve per run, the mean over its samples.");
}

// ------------------------------------------------------------------------------------------- numbers over swept keys

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

/// Over a decade and more, and above zero.
bool asks_for_logarithm(const std::vector<Quantity>& values) {
  constexpr double kDecade = 10.0;
  double low = values.front().value;
  double high = low;
  for (const Quantity& q : values) low = std::min(low, q.value), high = std::max(high, q.value);
  return low > 0.0 && high >= kDecade * low;
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
  for (std::size_t v = 0; v < key.values.size(); ++v)
    for (const PointEntry& point : set.points) {
      const NumberOverRuns* n = find(point, number.name);
      if (n == nullptr || !std::isfinite(n->mean) || point.values.at(key.key) != key.values[v]) continue;
      const std::string others = others_of(set, point, key.key);
      auto at = std::find_if(lines.begin(), lines.end(), [&](const Series& s) { return s.label == others; });
      if (at == lines.end()) {
        Series s{.label = others, .hover = "", .x = {}, .y = {}};
        s.style = style_of(lines.size(), false);
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

/// Where runs have no curves and no numeric key: the first number by run.
std::string by_run_figure(const SetSummary& set, const std::vector<RunValue>& numbers) {
  if (numbers.empty()) return "";
  Series s{.label = numbers.front().name, .hover = "", .x = {}, .y = {}};
  for (std::size_t k = 0; k < set.runs.size(); ++k)
    if (const RunValue* v = find(set.runs[k], numbers.front().name)) {
      s.x.push_back(static_cast<double>(k + 1));
      s.y.push_back(v->value);
      s.y_error.push_back(v->error);
    }
  s.style = {.color = palette::blue, .width = 0.0, .marker = Marker::circle};
  Plot plot(
      {.id = "runs-by-number",
       .title = numbers.front().name,
       .x = {.label = "run, in the order of the table", .low = 0.5, .high = 0.5 + static_cast<double>(set.runs.size())},
       .y = {.label = with_unit(numbers.front().name, numbers.front().unit)}});
  plot.add(std::move(s));
  return figure(plot.svg(), "± the standard error within a run, over its samples.");
}

/// To the reports of the runs, where they are there.
std::string links(const RunData& run, const SetSummary& set) {
  std::string out;
  for (const RunEntry& one : set.runs) {
    const std::filesystem::path page = std::filesystem::path(one.directory) / "report.html";
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::path(run.directory) / page, ignored)) continue;
    out += (out.empty() ? "" : ", ") + ("<a href=\"" + escape(page.string()) + "\">" + escape(one.name) + "</a>");
  }
  return out.empty() ? "" : "<p>Reports of the runs: " + out + ".</p>\n";
}

}  // namespace

bool is_set(const RunData& run) { return !run.summary_as<SetSummary>().runs.empty(); }

std::string runs_section(const RunData& run) {
  const auto set = run.summary_as<SetSummary>();
  if (set.runs.empty()) return "";
  const std::vector<RunValue> numbers = numbers_of(set.runs);
  std::vector<std::string> figures;
  for (const CurvePlot& plot : plots_of(run, set)) figures.push_back(curve_figure(set, plot, figures.size()));
  const std::vector<std::string> dependent = dependence_figures(set, numbers);
  if (figures.empty() && dependent.empty()) figures.push_back(by_run_figure(set, numbers));
  return section("runs", "Runs side by side",
                 differences_table(set) + runs_table(set, numbers) + other_numbers_table(set, numbers) +
                     norms_table(set) + links(run, set) + figure_row(figures) + figure_row(dependent) +
                     seeds_table(set));
}

std::vector<HeadLine> set_lines(const RunData& run) {
  const auto set = run.summary_as<SetSummary>();
  std::vector<HeadLine> lines;
  if (set.runs.empty()) return lines;
  const auto good =
      std::count_if(set.runs.begin(), set.runs.end(), [](const RunEntry& r) { return r.status == RunStatus::good; });
  std::string kind = set.kind.empty() ? "" : " of a scene of kind " + set.kind;
  lines.emplace_back("Runs", fmt::format("{} runs{}, {} of them good.", set.runs.size(), kind, good));
  for (const SweptKey& one : set.over) {
    std::string values;
    for (const std::string& value : one.values) values += (values.empty() ? "" : ", ") + value;
    lines.emplace_back("Varied", one.key + " = " + values + ".");
  }
  for (const PointEntry& point : set.points) {
    if (set.seeds.size() < 2 || point.numbers.empty() || set.points.size() > kColumns) continue;
    const NumberOverRuns& n = point.numbers.front();
    lines.emplace_back("Over seeds",
                       fmt::format("{}{}: {}{}, spread {}.", set.points.size() > 1 ? point.name + ": " : "", n.name,
                                   format_with_error(n.mean, n.error), n.unit.empty() ? "" : " " + n.unit,
                                   format_number(n.spread, 2)));
  }
  return lines;
}

}  // namespace softgrain::report

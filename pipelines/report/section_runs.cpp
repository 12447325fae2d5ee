// Several runs side by side: what differs, a table, every curve, and how numbers depend on the keys that were swept.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/core/text.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/set_summary.h"

namespace softgrain::report {
namespace {

constexpr std::size_t kColumns = 4;  ///< numbers in the table of runs

const RunValue* find(const RunEntry& run, const std::string& number) {
  const auto at = std::ranges::find_if(run.numbers, [&](const RunValue& v) { return v.name == number; });
  return at == run.numbers.end() ? nullptr : &*at;
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

/// Links to the reports of the runs, where they exist.
std::string links(const RunData& run, const SetSummary& set) {
  std::string out;
  for (const RunEntry& one : set.runs) {
    const std::filesystem::path page = std::filesystem::path(one.directory) / "report.html";
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::path(run.directory) / page, ignored)) continue;
    append_part(out, "<a href=\"" + escape(page.string()) + "\">" + escape(one.name) + "</a>", ", ");
  }
  return out.empty() ? "" : "<p>Reports of the runs: " + out + ".</p>\n";
}

}  // namespace

bool is_set(const RunData& run) { return !run.summary_as<SetSummary>().runs.empty(); }

std::string runs_section(const RunData& run) {
  const auto set = run.summary_as<SetSummary>();
  if (set.runs.empty()) return "";
  const std::vector<RunValue> numbers = numbers_of(set.runs);
  std::vector<std::string> figures = run_curve_figures(run, set);
  const std::vector<std::string> dependent = dependence_figures(set, numbers);
  if (figures.empty() && dependent.empty()) figures.push_back(by_run_figure(set, numbers));
  return section("runs", "Runs side by side",
                 "Curves of several runs in one plot, and the keys and numbers that differ.",
                 search_part(set) + differences_part(set) + differences_table(set) + runs_table(set, numbers) +
                     other_numbers_table(set, numbers) + norms_table(set) + links(run, set) + figure_row(figures) +
                     figure_row(dependent) + sensitivity_part(set) + seeds_table(set));
}

std::vector<HeadLine> set_lines(const RunData& run) {
  const auto set = run.summary_as<SetSummary>();
  std::vector<HeadLine> lines;
  if (set.runs.empty()) return lines;
  const auto good = std::ranges::count_if(set.runs, [](const RunEntry& r) { return r.status == RunStatus::good; });
  const std::string kind = run.kind().empty() ? "" : " of a scene of kind " + run.kind();
  lines.emplace_back("Runs", fmt::format("{}{}, {} of them good.", counted(set.runs.size(), "run"), kind, good));
  if (set.search && set.search->usable)
    for (const SearchedKey& key : set.search->keys)
      lines.emplace_back(
          kResultLabel,
          fmt::format("{} {} at {} = {}{} (95 %: {} to {}).", set.search->maximise ? "Largest" : "Smallest",
                      set.search->number, key.key, format_number(key.value, 4), key.unit.empty() ? "" : " " + key.unit,
                      format_number(key.low, 4), format_number(key.high, 4)));
  for (const SweptKey& one : set.over) lines.emplace_back("Varied", one.key + " = " + values_text(one) + ".");
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

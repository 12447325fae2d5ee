#include "pipelines/runs/set_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "common/core/text.h"
#include "pipelines/law/terminal_plot.h"
#include "pipelines/report/sections.h"
#include "pipelines/runs/search.h"

namespace softgrain {

namespace {

using Rows = std::vector<std::vector<std::string>>;

/// A, B, ..., Z, A2, B2, ...
std::string letter(std::size_t k) {
  constexpr std::size_t kLetters = 26;
  const std::string one(1, static_cast<char>('A' + k % kLetters));
  return k < kLetters ? one : one + std::to_string(k / kLetters + 1);
}

std::string cell_of(const RunEntry& run, const std::string& number) {
  for (const RunValue& v : run.numbers)
    if (v.name == number) return number_text(v.value, v.error);
  return "-";
}

std::string status_text(const RunEntry& run) { return run.status == RunStatus::good ? "" : to_string(run.status); }

/// A letter for each run, its name, and what it is not like the others in.
std::string legend(const SetSummary& summary) {
  Rows rows;
  for (std::size_t k = 0; k < summary.runs.size(); ++k)
    rows.push_back({letter(k), summary.runs[k].name, status_text(summary.runs[k])});
  return law::aligned(rows, 2, 3);
}

constexpr std::size_t kColumns = 5;       ///< runs beside each other; more stand below each other
constexpr std::size_t kShown = 15;        ///< differences
constexpr std::size_t kSampledRuns = 20;  ///< runs of a design in the terminal

/// Rows with a name in the first column; where they would be broken at the end of the line, each name stands above its
/// values.
std::string named_rows(Rows rows, std::size_t indent) {
  const auto lines_of = [](const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  };
  const std::string beside = law::aligned(rows, indent);
  if (std::ranges::max(lines_of(beside), {}, &std::string::size).size() <= law::kTerminalColumns) return beside;
  std::vector<std::string> names;
  for (std::vector<std::string>& row : rows) names.push_back(std::exchange(row.front(), ""));
  std::string text;
  const std::vector<std::string> values = lines_of(law::aligned(rows, 2 * indent));
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!names[k].empty()) text += std::string(indent, ' ') + names[k] + "\n";
    text += values[k] + "\n";
  }
  return text;
}

/// A row per number, a column per run.
std::string runs_across(const SetSummary& summary, const std::vector<RunValue>& numbers) {
  Rows rows(1, {""});
  for (std::size_t k = 0; k < summary.runs.size(); ++k) rows.front().push_back(letter(k));
  for (const RunValue& n : numbers) {
    rows.push_back({with_unit(n.name, n.unit)});
    for (const RunEntry& run : summary.runs) rows.back().push_back(cell_of(run, n.name));
  }
  return legend(summary) + named_rows(std::move(rows), 2);
}

/// A row per run, a column per number; as many as fit.
std::string runs_down(const SetSummary& summary, const std::vector<RunValue>& numbers) {
  const std::size_t shown = std::min<std::size_t>(numbers.size(), 4);
  std::string text;
  Rows rows(1, {"run", "status"});
  for (std::size_t k = 0; k < shown; ++k) {
    text += fmt::format("  ({}) {}\n", k + 1, with_unit(numbers[k].name, numbers[k].unit));
    rows.front().push_back(fmt::format("({})", k + 1));
  }
  const std::size_t runs = summary.design ? std::min(summary.runs.size(), kSampledRuns) : summary.runs.size();
  for (std::size_t r = 0; r < runs; ++r) {
    const RunEntry& run = summary.runs[r];
    rows.push_back({run.name, to_string(run.status)});
    for (std::size_t k = 0; k < shown; ++k) rows.back().push_back(cell_of(run, numbers[k].name));
  }
  if (summary.runs.size() > runs)
    text += fmt::format("  {} in table.csv\n", counted(summary.runs.size() - runs, "more run"));
  if (numbers.size() > shown)
    text += fmt::format("  {} in summary and report\n", counted(numbers.size() - shown, "more number"));
  return text + law::aligned(rows, 2, 2);
}

/// Mean, spread and standard error of every number over seeds.
std::string over_seeds(const SetSummary& summary) {
  Rows rows(1, {"", "mean", "spread", "standard error", "runs"});
  for (const PointEntry& point : summary.points) {
    if (summary.points.size() > 1) rows.push_back({point.name + ":"});
    for (const NumberOverRuns& n : point.numbers)
      rows.push_back({(summary.points.size() > 1 ? "  " : "") + with_unit(n.name, n.unit), number_text(n.mean, kNaN),
                      number_text(n.spread, kNaN), number_text(n.error, kNaN), std::to_string(n.runs)});
  }
  return law::aligned(rows, 2);
}

}  // namespace

std::string number_text(double value, double error) {
  return with_error(value, error > 0.0 ? if_finite(error) : std::nullopt, {.undefined = "-"});
}

std::string varied_text(const SetSummary& summary) {
  std::string text = summary.over.empty() ? "" : "sweep over " + join_text(summary.over, ", ", &SweptKey::key);
  if (summary.design) append_part(text, "sample " + summary.design->sample);
  if (!summary.seeds.empty()) append_part(text, counted(summary.seeds.size(), "seed"));
  return text;
}

std::string set_text(const SetSummary& summary) {
  return search_text(summary) + differences_text(summary) + numbers_text(summary) + sensitivity_text(summary);
}

std::string differences_text(const SetSummary& summary) {
  std::string text;
  for (const SweptKey& one : summary.over) text += fmt::format("varied: {} = {}\n", one.key, values_text(one));
  std::size_t shown = 0;
  for (const SweptKey& one : summary.differences) {
    if (++shown > kShown) continue;
    std::string values;
    for (std::size_t k = 0; k < one.values.size(); ++k)
      append_part(values, fmt::format("{} {}", letter(k), one.values[k]), ", ");
    text += fmt::format("differs: {}: {}\n", one.key, values);
  }
  if (shown > kShown) text += fmt::format("differs: {}\n", counted(shown - kShown, "more key"));
  return text;
}

std::string norms_text(const SetSummary& summary) {
  if (summary.norms.empty()) return "";
  std::string text = "against " + summary.reference + "\n";
  std::size_t k = 0;
  for (const RunEntry& run : summary.runs) {
    const std::string mark = letter(k++);
    for (const RunNorm& n : summary.norms)
      if (n.run == run.name)
        text += n.reason.empty() ? fmt::format("  {}  {}: off by {} %\n", mark, n.of, number_text(n.percent, n.error))
                                 : fmt::format("  {}  no norm: {}\n", mark, n.reason);
  }
  return text;
}

namespace {

std::string title_of(const RunCurve& c) { return c.plot + c.name; }

/// The curves of this title, a letter at the end of each.
std::string drawn_curves(const std::vector<std::pair<std::string, std::vector<RunCurve>>>& runs,
                         const std::string& title) {
  law::TerminalPlot plot;
  plot.utf8 = law::terminal_is_utf8();
  for (const auto& [mark, curves] : runs) {
    const auto at =
        std::ranges::find_if(curves, [&](const RunCurve& c) { return !c.x.empty() && title_of(c) == title; });
    if (at == curves.end()) continue;
    plot.x_label = at->x_label;
    plot.y_label =
        at->y_label + (at->y_unit.empty() ? "" : " [" + at->y_unit + "]") + (at->name.empty() ? "" : ", " + at->name);
    plot.curves.push_back({at->x, at->y, law::TerminalCurve::Look::line, 'o'});
    plot.curves.push_back({{at->x.back()}, {at->y.back()}, law::TerminalCurve::Look::marks, mark.front()});
  }
  return law::draw(plot);
}

}  // namespace

std::string curves_text(const SetSummary& summary, const std::string& base) {
  std::vector<std::pair<std::string, std::vector<RunCurve>>> runs;
  std::vector<std::string> titles;
  std::string name;
  for (std::size_t k = 0; k < std::min(summary.runs.size(), kColumns); ++k) {
    const std::filesystem::path directory = std::filesystem::path(base) / summary.runs[k].directory;
    std::error_code ignored;
    if (!std::filesystem::is_directory(directory, ignored)) continue;
    runs.emplace_back(letter(k), report::curves_of(directory.string()));
    for (const RunCurve& c : runs.back().second) {
      if (c.x.empty()) continue;
      if (titles.empty()) name = c.name;
      const bool wanted = titles.empty() || (c.in_terminal && c.name == name);
      if (wanted && std::ranges::find(titles, title_of(c)) == titles.end()) titles.push_back(title_of(c));
    }
  }
  std::string text;
  for (const std::string& title : titles) text += drawn_curves(runs, title);
  return text;
}

std::string numbers_text(const SetSummary& summary) {
  std::string text;
  const std::vector<RunValue> numbers = numbers_of(summary.runs);
  if (summary.seeds.size() > 1)
    text += over_seeds(summary);
  else
    text += summary.runs.size() <= kColumns ? runs_across(summary, numbers) : runs_down(summary, numbers);
  return text;
}

TextTable table_of(const SetSummary& summary) {
  TextTable table;
  const std::vector<RunValue> numbers = numbers_of(summary.runs);
  table.header = {"run"};
  for (const SweptKey& one : summary.over) table.header.push_back(one.key);
  table.header.insert(table.header.end(), {"seed", "status"});
  for (const RunValue& n : numbers) {
    table.header.push_back(with_unit(n.name, n.unit));
    table.header.push_back("standard error of " + n.name);
  }
  const auto text = [](double x) { return std::isfinite(x) ? fmt::format("{:.10g}", x) : std::string(); };
  for (const RunEntry& run : summary.runs) {
    std::vector<std::string> row{run.name};
    for (const SweptKey& one : summary.over) row.push_back(run.values.at(one.key));
    row.push_back(run.seed ? std::to_string(*run.seed) : "");
    row.push_back(to_string(run.status));
    for (const RunValue& n : numbers) {
      const auto at = std::ranges::find_if(run.numbers, [&](const RunValue& v) { return v.name == n.name; });
      row.push_back(at == run.numbers.end() ? "" : text(at->value));
      row.push_back(at == run.numbers.end() ? "" : text(at->error));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace softgrain

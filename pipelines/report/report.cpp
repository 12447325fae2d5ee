// The report of a run, and its figures and their tables as separate files.
#include "pipelines/report/report.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string_view>
#include <vector>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/report/figure_table.h"
#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/kind_results.h"

namespace softgrain::report {

namespace {

/// "Fn(Delta), soft-solid" -> "fn-delta-soft-solid".
std::string file_name(const std::string& title) {
  std::string out;
  for (const char c : title) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) != 0 && u < 128)
      out += static_cast<char>(std::tolower(u));
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out.empty() ? "figure" : out;
}

/// The accessible name of a figure, which is its title.
std::string label_of(const std::string& svg) {
  const std::string key = "aria-label=\"";
  const std::size_t begin = svg.find(key);
  if (begin == std::string::npos) return "figure";
  const std::size_t end = svg.find('"', begin + key.size());
  return end == std::string::npos ? "figure" : svg.substr(begin + key.size(), end - begin - key.size());
}

}  // namespace

namespace {

/// Below a plot. The script of the page puts the values in it that the page holds, so that it works without the file.
std::string table_link(const Figure& figure) {
  return std::string("<a class=\"csv\" href=\"") + kCurveFolder + "/" + figure.name + ".csv\" download=\"" +
         figure.name + ".csv\" aria-label=\"CSV: values of " + label_of(figure.svg) + "\">CSV</a>\n";
}

}  // namespace

BodyAndFigures figures_of(const std::string& html) {
  const std::string close = "</svg>";
  BodyAndFigures out;
  std::map<std::string, int> uses;
  std::size_t copied = 0;
  for (std::size_t at = html.find("<svg"); at != std::string::npos; at = html.find("<svg", at)) {
    const std::size_t end = html.find(close, at);
    if (end == std::string::npos) break;
    const auto [svg, table] = without_table(html.substr(at, end + close.size() - at));
    std::string name = file_name(label_of(svg));
    const int use = ++uses[name];
    if (use > 1) name += "-" + std::to_string(use);
    out.figures.push_back({name, svg + "\n", table});
    out.body += html.substr(copied, at - copied) + svg + (table.empty() ? "" : "\n" + table_link(out.figures.back()));
    copied = at = end + close.size();
  }
  out.body += html.substr(copied);
  return out;
}

namespace {

namespace fs = std::filesystem;

/// Spreadsheets take a CSV file for UTF-8 when it begins so.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string head_of(const fs::path& path) {
  std::ifstream file(path);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

/// Whether a file has the name that follows from a title (escaped).
bool is_named_after(const fs::path& path, const std::string& title) {
  static const std::regex number("-[0-9]+");
  const std::string own = file_name(title);
  const std::string name = path.stem().string();
  return name.starts_with(own) && (name == own || std::regex_match(name.substr(own.size()), number));
}

/// A figure of a report names itself: its file has the name that follows from its title.
bool is_figure(const fs::path& path) {
  if (path.extension() != ".svg") return false;
  const std::string head = head_of(path);
  return head.starts_with("<svg") && head.find("aria-label=\"") != std::string::npos &&
         is_named_after(path, label_of(head));
}

/// So does its table.
bool is_table(const fs::path& path) {
  if (path.extension() != ".csv") return false;
  const std::string head = head_of(path);
  if (!head.starts_with(kByteOrderMark)) return false;
  const auto title = title_of_table(head.substr(kByteOrderMark.size()));
  return title && is_named_after(path, escape(*title));
}

/// Removes files of an earlier report, and the directory when nothing else is in it.
void remove_files(const fs::path& directory, bool (*is)(const fs::path&)) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error))
    if (is(entry.path())) found.push_back(entry.path());
  for (const fs::path& file : found) {
    fs::remove(file, error);
    if (error) throw IoError(file.string() + ": of an earlier report, cannot be removed: " + error.message());
  }
  if (fs::is_directory(directory, error) && fs::is_empty(directory, error)) fs::remove(directory, error);
}

}  // namespace

void remove_figures(const std::string& run_directory) {
  remove_files(fs::path(run_directory) / kFigureFolder, is_figure);
  remove_files(fs::path(run_directory) / kCurveFolder, is_table);
}

void write_figures(const std::string& run_directory, const std::vector<Figure>& figures) {
  remove_figures(run_directory);
  const fs::path pictures = fs::path(run_directory) / kFigureFolder;
  const fs::path tables = fs::path(run_directory) / kCurveFolder;
  fs::create_directories(pictures);
  for (const Figure& figure : figures) {
    write_text_atomic((pictures / (figure.name + ".svg")).string(), figure.svg);
    if (figure.table.empty()) continue;
    fs::create_directories(tables);
    write_text_atomic((tables / (figure.name + ".csv")).string(), std::string(kByteOrderMark) + figure.table);
  }
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

/// Text of all sections, in the order of their parts: those that belong to no kind of scene, and those of every kind.
std::string sections_of(const RunData& run) {
  std::vector<ReportSection> sections{
      {Part::runs, runs_section},        {Part::source, own_data_section}, {Part::laws, laws_section},
      {Part::packings, packing_section}, {Part::packings, radii_section},  {Part::packings, sizes_section},
      {Part::packings, grading_section}, {Part::cost, cost_section},       {Part::provenance, provenance_section}};
  for (const KindResults& kind : results_of_kinds())
    sections.insert(sections.end(), kind.sections.begin(), kind.sections.end());
  std::stable_sort(sections.begin(), sections.end(),
                   [](const ReportSection& a, const ReportSection& b) { return a.part < b.part; });
  std::string body;
  for (const ReportSection& section : sections) body += section.html(run);
  return body;
}

}  // namespace

void write_report(const std::string& run_directory) {
  const RunData run = load_run(run_directory);
  std::string body = sections_of(run);
  body = heading_section(run) + warnings_section(run) + contents(body) + body + next_section(run) + notes_section(run);
  const std::string name = std::filesystem::weakly_canonical(run_directory).filename().string();
  const BodyAndFigures drawn = figures_of(body);
  write_figures(run_directory, drawn.figures);
  write_text_atomic(run_directory + "/report.html",
                    page("softgrain: " + name + (run.unfinished ? " (unfinished run)" : ""), drawn.body));
}

}  // namespace softgrain

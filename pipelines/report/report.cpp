// The report of a run, and its figures as separate files.
#include "pipelines/report/report.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <vector>

#include "common/core/error.h"
#include "common/io/text_file.h"
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

std::vector<Figure> figures_of(const std::string& html) {
  const std::string close = "</svg>";
  std::vector<Figure> figures;
  std::map<std::string, int> uses;
  for (std::size_t at = html.find("<svg"); at != std::string::npos; at = html.find("<svg", at)) {
    const std::size_t end = html.find(close, at);
    if (end == std::string::npos) break;
    const std::string svg = html.substr(at, end + close.size() - at);
    std::string name = file_name(label_of(svg));
    const int use = ++uses[name];
    if (use > 1) name += "-" + std::to_string(use);
    figures.push_back({name, svg + "\n"});
    at = end;
  }
  return figures;
}

namespace {

namespace fs = std::filesystem;

/// A figure of a report names itself: its file has the name that follows from its title.
bool is_figure(const fs::path& path) {
  if (path.extension() != ".svg") return false;
  std::ifstream file(path);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  if (!head.starts_with("<svg") || head.find("aria-label=\"") == std::string::npos) return false;
  static const std::regex number("-[0-9]+");
  const std::string own = file_name(label_of(head));
  const std::string name = path.stem().string();
  return name.starts_with(own) && (name == own || std::regex_match(name.substr(own.size()), number));
}

}  // namespace

void remove_figures(const std::string& run_directory) {
  const fs::path directory = fs::path(run_directory) / "figures";
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error))
    if (is_figure(entry.path())) found.push_back(entry.path());
  for (const fs::path& file : found) {
    fs::remove(file, error);
    if (error) throw IoError(file.string() + ": of an earlier report, cannot be removed: " + error.message());
  }
  if (fs::is_directory(directory, error) && fs::is_empty(directory, error)) fs::remove(directory, error);
}

void write_figures(const std::string& run_directory, const std::vector<Figure>& figures) {
  remove_figures(run_directory);
  fs::create_directories(run_directory + "/figures");
  for (const Figure& figure : figures)
    write_text_atomic(run_directory + "/figures/" + figure.name + ".svg", figure.svg);
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
  write_figures(run_directory, figures_of(body));
  write_text_atomic(run_directory + "/report.html",
                    page("softgrain: " + name + (run.unfinished ? " (unfinished run)" : ""), body));
}

}  // namespace softgrain

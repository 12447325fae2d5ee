#include "pipelines/report/report.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "common/io/text_file.h"
#include "pipelines/report/figures.h"
#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/kind_results.h"

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

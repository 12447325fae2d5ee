#include "pipelines/kinds/law_table/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/data/law_words.h"
#include "pipelines/kinds/law_table/law_check.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using namespace report;

void check_multi_contact_file(const std::string& path, Findings& out) {
  const MultiContactMeasurements data = load_multi_contact(path);
  std::size_t open = 0;
  for (const MultiContactRun& run : data.runs)
    open += static_cast<std::size_t>(
        std::count_if(run.points.begin(), run.points.end(), [](const MultiContactPoint& p) { return !p.converged; }));
  out.add("kind", "multi-contact measurements",
          fmt::format("multi-contact measurements: {} configurations, {} packings, {} runs", data.configurations.size(),
                      data.packings.size(), data.runs.size()));
  if (open > 0) out.warn(fmt::format("{} recorded points did not converge", open));
}

std::string table_line(const LawTableEntry& entry) {
  const MultiContactLaw* best = entry.find(entry.best);
  if (best == nullptr) return "";
  std::string held_out;
  if (std::isfinite(best->error_held_out))
    held_out = fmt::format(" and by {} % on what was held out", format_number(100.0 * best->error_held_out, 2));
  return fmt::format("Solid fraction {}: form {}, off by {} % where it was fitted{}; h/Rs up to {}.",
                     format_number(entry.solid_fraction, 3), form_label(entry, *best),
                     format_number(100.0 * best->error_fitted, 2), held_out, format_number(entry.overlap_max, 2));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  if (run.law_table)
    for (const LawTableEntry& entry : run.law_table->entries)
      lines.emplace_back("Multi-contact law", table_line(entry));
  return lines;
}

std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  if (!run.law_table) return out;
  for (const LawTableEntry& entry : run.law_table->entries) {
    const MultiContactLaw* best = entry.find(entry.best);
    if (best == nullptr) continue;
    const std::string of =
        fmt::format(" ({} law at solid fraction {:.3g})", to_string(entry.best), entry.solid_fraction);
    out.push_back({"off where it was fitted" + of, "%", 100.0 * best->error_fitted});
    if (std::isfinite(best->error_held_out))
      out.push_back({"off on what was held out" + of, "%", 100.0 * best->error_held_out});
  }
  return out;
}

NextSteps next_of(const RunData& run) {
  return {"Take it in a scene, with error bars: `softgrain macrosim SCENE.toml --law " + run.directory +
              "/law_table.toml --bands 64`.",
          "What to measure next for that scene, most per second first: `softgrain law plan " + run.directory +
              "/law_table.toml --for SCENE.toml`."};
}

}  // namespace

KindResults law_table_results() {
  return {.files = {{.names = "(multi_contact|crowd)(_(variant|level)_[0-9]+)?\\.h5",
                     .is = [](const h5::Group& root) { return root.has("configurations"); },
                     .check = check_multi_contact_file},
                    {.names = "law(_table)?\\.toml", .check = check_laws},
                    {.names = "law_table\\.h5|law_table_level_[0-9]+\\.(toml|h5)"}},
          .sections = {{Part::several, law_table_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain

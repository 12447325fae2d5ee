// softgrain export RUN --to vtp|lammps-dump|lammps-data|csv: the states of a run as files for ParaView, OVITO and
// everything else. Makes no run directory of its own, so that the run's summary stays as it is.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/core/text.h"
#include "common/io/text_file.h"
#include "pipelines/export/export_files.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

/// Beside what is exported: RUN/export-vtp.
std::string default_directory(const std::string& run, ExportFormat format) {
  const std::filesystem::path path(run);
  const std::filesystem::path directory = std::filesystem::is_directory(path) ? path : path.parent_path();
  return (directory / export_folder(format)).string();
}

nlohmann::json to_json(const ExportedSeries& s) {
  nlohmann::json out{{"name", s.name},
                     {"kind", to_string(s.kind)},
                     {"states", s.states},
                     {"with_contacts", s.with_contacts},
                     {"open", s.files}};
  if (!s.remark.empty()) out["remark"] = s.remark;
  return out;
}

std::string text_of(const std::vector<ExportedSeries>& all, const std::string& directory) {
  std::string text;
  for (const ExportedSeries& s : all)
    text +=
        fmt::format("{} ({}): {}, {} with contacts; open {}{}\n", s.name, to_string(s.kind), counted(s.states, "state"),
                    s.with_contacts, join_text(s.files), s.remark.empty() ? "" : "; " + s.remark);
  return text + "files: " + directory + "\n";
}

}  // namespace

ExitStatus command_export(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw InputError("export: needs one run directory or file of states");
  const std::string& run = options.inputs.front();
  const ExportFormat format = export_format(options.to);
  const std::string directory = options.out.empty() ? default_directory(run, format) : options.out;
  const std::vector<ExportedSeries> all = export_states(run, format, directory);
  if (!options.json) {
    write_standard_output(text_of(all, directory));
    return ExitStatus::good;
  }
  nlohmann::json summary{{"command", "export"}, {"status", "good"}, {"to", options.to}, {"directory", directory}};
  summary["series"] = nlohmann::json::array();
  for (const ExportedSeries& s : all) summary["series"].push_back(to_json(s));
  write_standard_output(summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return ExitStatus::good;
}

}  // namespace softgrain

// softgrain export RUN --to vtp|lammps-dump|csv: the states of a run as files for ParaView, OVITO and everything else.
// Makes no run directory of its own, so that the run's summary stays as it is.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pipelines/export/export.h"
#include "pipelines/run_context.h"

namespace softgrain {

namespace {

/// Beside what is exported: RUN/export-vtp.
std::string default_directory(const std::string& run, const std::string& to) {
  const std::filesystem::path path(run);
  const std::filesystem::path directory = std::filesystem::is_directory(path) ? path : path.parent_path();
  return (directory / ("export-" + to)).string();
}

nlohmann::json to_json(const ExportedSeries& s) {
  return {{"name", s.name},
          {"kind", to_string(s.kind)},
          {"states", s.states},
          {"with_contacts", s.with_contacts},
          {"open", s.files}};
}

void print(const std::vector<ExportedSeries>& all, const std::string& directory) {
  for (const ExportedSeries& s : all) {
    std::string files;
    for (const std::string& f : s.files) files += (files.empty() ? "" : ", ") + f;
    std::printf("%s (%s): %lld states, %lld with contacts; open %s\n", s.name.c_str(), to_string(s.kind).c_str(),
                static_cast<long long>(s.states), static_cast<long long>(s.with_contacts), files.c_str());
  }
  std::printf("files: %s\n", directory.c_str());
}

}  // namespace

ExitStatus command_export(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("export: needs one run directory or file of states");
  const std::string& run = options.inputs.front();
  const ExportFormat format = export_format(options.to);
  const std::string directory = options.out.empty() ? default_directory(run, options.to) : options.out;
  const std::vector<ExportedSeries> all = export_states(run, format, directory);
  if (!options.json) {
    print(all, directory);
    return ExitStatus::good;
  }
  nlohmann::json summary{{"command", "export"}, {"status", "good"}, {"to", options.to}, {"directory", directory}};
  summary["series"] = nlohmann::json::array();
  for (const ExportedSeries& s : all) summary["series"].push_back(to_json(s));
  std::printf("%s\n", summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  return ExitStatus::good;
}

}  // namespace softgrain

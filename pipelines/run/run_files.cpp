#include "pipelines/run/run_context.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <system_error>

#include "common/core/error.h"
#include "common/core/text.h"
#include "macrosim/lammps_run/points_file.h"
#include "pipelines/export/export_files.h"
#include "pipelines/report/report.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/snapshots/snapshots.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

/// Names of the files that every kind of run leaves.
const std::regex& common_names() {
  static const std::regex names(
      "summary\\.json|report\\.html|(table|search)\\.(md|csv)|differences\\.csv|checkpoint\\.h5(\\.previous)?|work|\\."
      "run");
  return names;
}

/// Whether a file says how a run went, or is one that the command writes anew in any case.
bool is_rewritten(const std::string& name, const std::string& command) {
  static const std::regex always("summary\\.json|report\\.html|work|\\.run|checkpoint\\.h5(\\.previous)?");
  static const std::regex fits("law\\.(toml|h5)|law_table\\.(toml|h5)|(multi_contact|crowd)\\.h5");
  static const std::regex macro("macro(_initial)?\\.h5|states_macro\\.h5|lammps-[0-9]+");
  return std::regex_match(name, always) || (command == "calibrate" && std::regex_match(name, fits)) ||
         (command == "macrosim" && std::regex_match(name, macro));
}

/// The log begins with the name of the program.
bool was_run_directory(const fs::path& directory) {
  std::error_code ignored;
  if (!fs::is_regular_file(directory / "log.txt", ignored)) return false;
  std::ifstream log(directory / "log.txt");
  std::string line;
  return std::getline(log, line) && line.find(" softgrain ") != std::string::npos;
}

bool same_place(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

/// An input itself, or the other half of it.
bool is_input(const fs::path& file, const std::vector<std::string>& inputs) {
  return std::ranges::any_of(inputs, [&](const std::string& input) {
    const fs::path path(input);
    return same_place(file, path) ||
           (path.extension() == ".toml" && same_place(file, fs::path(path).replace_extension(".h5")));
  });
}

/// Whether the curves of a directory of LAMMPS, lammps-K or lammps-NAME-K, are there.
bool was_read(const fs::path& lammps) {
  const std::string name = lammps.filename();
  const std::size_t begin = name.find('-') + 1;
  const std::size_t end = name.rfind('-');
  const std::string scene = end < begin ? "" : "_" + name.substr(begin, end - begin);
  const auto there = [&](const std::string& file) { return fs::exists(lammps.parent_path() / file); };
  return there("material" + scene + ".h5") || (scene.empty() && there("macro.h5"));
}

/// Points that were recorded elsewhere, say, may have cost much: they are not thrown away unless their results are
/// there.
void refuse_to_lose_points(const std::vector<fs::path>& found) {
  for (const fs::path& old : found)
    if (old.filename().string().starts_with("lammps-") && !was_read(old))
      if (const auto points = lammps::count_points(old); points > 0)
        throw InputError(
            fmt::format("{} holds {} recorded points that were not read: --resume goes on with them; to begin "
                        "anew, remove it or choose another --out",
                        old.string(), points));
}

/// What stands beside a file of results under its name: the descriptions of its states for ParaView.
void add_descriptions(std::vector<fs::path>& found, const std::vector<std::string>& inputs) {
  for (std::size_t k = 0, results = found.size(); k < results; ++k) {
    if (found[k].extension() != ".h5") continue;
    for (const char* ending : {".xdmf", "_contacts.xdmf"}) {
      const fs::path beside = found[k].parent_path() / (found[k].stem().string() + ending);
      std::error_code error;
      if (fs::exists(beside, error) && !is_input(beside, inputs)) found.push_back(beside);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

/// Whether states stay that exports may be of. Those of a run of several lie in directories below, which have no part
/// in the next one.
bool keeps_states(const std::string& directory, const std::vector<fs::path>& found) {
  std::error_code error;
  return std::any_of(
      fs::directory_iterator(directory, error), fs::directory_iterator(), [&](const fs::directory_entry& entry) {
        return holds_states(entry.path().filename().string()) && std::ranges::find(found, entry.path()) == found.end();
      });
}

std::string listed(const std::vector<fs::path>& files) {
  return join_text(files, ", ", [](const fs::path& file) { return file.filename().string(); });
}

}  // namespace

void remove_earlier_run(const std::string& directory, const std::string& command,
                        const std::vector<std::string>& inputs) {
  std::vector<fs::path> found;
  std::vector<fs::path> lost;  // of them, what the new run does not replace
  bool reads_from_here = false;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    const std::string name = entry.path().filename();
    if (is_input(entry.path(), inputs)) {
      reads_from_here = true;
    } else if (std::regex_match(name, common_names()) || is_result_file(entry.path())) {
      found.push_back(entry.path());
      if (!is_rewritten(name, command)) lost.push_back(entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  std::sort(lost.begin(), lost.end());
  const std::string elsewhere = "; choose another --out, or move or remove them";
  if (!found.empty() && !was_run_directory(directory))
    throw InputError(directory +
                     ": holds files that no run of this program left there, and that a report would show as " +
                     "results of this run (" + listed(found) + ")" + elsewhere);
  if (!lost.empty() && (reads_from_here || command == "compare"))
    throw InputError(directory + ": holds results of an earlier run that do not belong to this one (" + listed(lost) +
                     ")" + elsewhere);
  refuse_to_lose_points(found);
  add_descriptions(found, inputs);
  // Figures go with the page that shows them, exported states with those that they were made from.
  const auto goes = [&](const auto& is) { return std::ranges::any_of(found, is); };
  if (goes([](const fs::path& file) { return file.filename() == "report.html"; })) report::remove_figures(directory);
  if (!found.empty() && !keeps_states(directory, found)) remove_exports_of(directory);
  for (const fs::path& file : found) {
    fs::remove_all(file, error);
    if (error) throw IoError(file.string() + ": of an earlier run, cannot be removed: " + error.message());
  }
}

}  // namespace softgrain

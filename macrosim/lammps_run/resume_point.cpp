#include "macrosim/lammps_run/resume_point.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "common/io/text_file.h"
#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/lammps_curve.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/lammps_run/script_parts.h"

namespace softgrain::lammps {

namespace {

namespace fs = std::filesystem;

/// The last round of a compaction whose restart file is there, and what comes next.
std::vector<std::string> last_round(const std::string& directory) {
  if (fs::exists(directory + "/" + kTouchingFile)) return {"-var", "prepared", "1"};
  if (!fs::exists(directory + "/" + kCompactionFile)) return {};
  std::istringstream in(read_text(directory + "/" + kCompactionFile));
  std::vector<std::string> settings;
  for (std::string line; std::getline(in, line) && !in.eof();) {
    std::istringstream words(line);
    std::int64_t round = 0;
    std::string over;
    std::string passes;
    if (words >> round >> over >> passes && fs::exists(fmt::format("{}/restart.compaction.{}", directory, round)))
      settings = {"-var", "round_done", std::to_string(round), "-var", "next_pressure",
                  over,   "-var",       "passes_under",        passes};
  }
  return settings;
}

}  // namespace

ResumePoint find_resume_point(const std::string& directory, const std::string& key, std::int64_t points,
                              const std::vector<MacroStage>& stages, const std::vector<std::string>& more) {
  auto rows = read_points(directory, key, more);
  const auto there = [&](const std::string& file) { return fs::exists(directory + "/" + file); };
  const bool early = !rows.empty() && ended_early(rows.back());
  if (early || static_cast<std::int64_t>(rows.size()) >= points) {
    if (there(kEndFile)) return {true, {}};
    if (early) rows.pop_back();  // the script would go on beyond it
  }
  while (!rows.empty() && !there(fmt::format("restart.{}", rows.size() - 1))) rows.pop_back();
  fs::remove(directory + "/" + kEndFile);
  if (rows.empty()) return {false, last_round(directory)};
  write_points(directory, key, rows, more);
  ResumePoint out{false, {"-var", "from", std::to_string(rows.size() - 1)}};
  if (stages.empty()) return out;
  const auto begins = begin_settings(stages, rows);
  out.settings.insert(out.settings.end(), begins.begin(), begins.end());
  return out;
}

}  // namespace softgrain::lammps

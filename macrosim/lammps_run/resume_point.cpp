#include "macrosim/lammps_run/resume_point.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "common/io/text_file.h"
#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/lammps_curve.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/lammps_run/script_parts.h"
#include "macrosim/pressing.h"

namespace softgrain::lammps {

namespace {

namespace fs = std::filesystem;

/// A row of the table of a compaction.
struct CompactionRound {
  std::int64_t number = 0;
  double next_pressure = 0.0;     ///< next pressure over the final one of the compaction
  std::int64_t passes_under = 0;  ///< number of passes under it so far
};

/// Complete rows of the table of a compaction.
std::vector<CompactionRound> rounds_of(const std::string& directory) {
  std::vector<CompactionRound> rounds;
  if (!fs::exists(directory + "/" + kCompactionFile)) return rounds;
  std::istringstream in(read_text(directory + "/" + kCompactionFile));
  for (std::string line; std::getline(in, line) && !in.eof();) {
    std::istringstream words(line);
    CompactionRound round;
    if (words >> round.number >> round.next_pressure >> round.passes_under) rounds.push_back(round);
  }
  return rounds;
}

/// The last round whose restart file is there, and what comes next.
std::vector<std::string> last_round(const std::string& directory) {
  if (fs::exists(directory + "/" + kTouchingFile)) return {"-var", "prepared", "1"};
  std::vector<std::string> settings;
  for (const CompactionRound& r : rounds_of(directory))
    if (fs::exists(fmt::format("{}/restart.compaction.{}", directory, r.number)))
      settings = {"-var", "round_done",    fmt::format("{}", r.number),
                  "-var", "next_pressure", fmt::format("{}", r.next_pressure),
                  "-var", "passes_under",  fmt::format("{}", r.passes_under)};
  return settings;
}

}  // namespace

double compaction_share(const std::string& directory) {
  // Of all passes about two fifths are made under the first pressure and a third under the last one.
  constexpr double kFirst = 0.4;
  constexpr double kLast = 0.7;
  if (fs::exists(directory + "/" + kTouchingFile)) return 1.0;
  const auto rounds = rounds_of(directory);
  if (rounds.empty()) return 0.0;
  const double first = std::log(rounds.front().next_pressure / kPressureFall);
  return first > 0.0 ? kLast - (kLast - kFirst) * std::log(rounds.back().next_pressure) / first : kLast;
}

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

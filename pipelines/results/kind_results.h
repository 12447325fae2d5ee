// What runs of a kind of scene leave behind, as check, report, export and the removal of earlier runs know it: files,
// sections of a report, and a few numbers and curves by which runs are set side by side.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/limits.h"
#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"
#include "common/io/json_record.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {

/// One number that a run came to.
struct RunValue {
  std::string name;  ///< "axial stress at the end", with "(law)" behind it where several engines have one
  std::string unit;
  double value = kNaN;
  double error = kNaN;
};

void fields(auto&& visit, Of<RunValue> auto& v) {
  visit("name", v.name, Means{"name of the result"});
  visit("unit", v.unit, Means{"unit of the result; empty: a plain number"});
  visit("value", v.value, Means{"value", "as `unit` says"});
  visit("standard_error", v.error,
        Means{"standard error within the run; null: one sample, or not said", "as `unit` says"});
}

/// One curve of a run. Runs share a plot where its title agrees, and a colour rule where the name does.
struct RunCurve {
  std::string plot;     ///< title
  std::string x_label;  ///< label of the x axis, with unit
  std::string y_label;  ///< label of the y axis, without unit
  std::string y_unit;   ///< SI, or empty
  std::string name;     ///< name of the curve in the run: an engine, a kind of contact; empty: there is one
  std::vector<double> x;
  std::vector<double> y;
  bool in_terminal = false;  ///< drawn in the terminal too, beside the first curve of a run
};

class Findings;

namespace report {
struct RunData;
}

enum class SnapshotChoice {
  all,
  last  ///< the last state of every series
};

using VisitSnapshot = std::function<void(const Snapshot&)>;

/// Files that runs of a kind leave in their directory.
struct ResultFile {
  const char* names = "";  ///< regular expression; nobody else gives a file such a name
  bool says_so = false;    ///< the name may be anybody's: the file itself must say that this program wrote it
  /// Whether an HDF5 file is one, whatever its name; null: no HDF5 file, or none that is looked into.
  bool (*is)(const h5::Group& root) = nullptr;
  /// What is in it, for `check`. Throws IoError.
  void (*check)(const std::string& path, Findings& out) = nullptr;
  /// Its states, for pictures and export; null: it holds none. Throws IoError.
  void (*visit)(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit) = nullptr;
};

/// Parts of a report in their order: what came out before what it was made from. Sections of one part keep the order of
/// the kinds, and of the list of each kind.
enum class Part {
  runs,          ///< one run of several
  source,        ///< data that the run was given
  answer,        ///< what a search found
  macro,         ///< scenes that use a law
  several,       ///< several scenes or contacts, beside each other
  measurements,  ///< what laws are fitted to
  laws,          ///< fitted laws
  methods,       ///< methods of measuring, compared
  tests,         ///< tests of resolved materials
  packings,      ///< packings and their sizes
  states,        ///< states of resolved scenes
  cost,
  provenance
};

/// A part of the report; an empty string where a run holds nothing of it.
struct ReportSection {
  Part part;
  std::string (*html)(const report::RunData& run);
};

/// Label and text of a line at the head of the report.
using HeadLine = std::pair<std::string, std::string>;

/// Label of the lines that say the result of a run; they are the first ones.
inline constexpr const char* kResultLabel = "Result";

/// Two sentences on what to do next, with commands in backquotes; empty where the run is not of the kind.
using NextSteps = std::vector<std::string>;

struct KindResults {
  std::vector<ResultFile> files{};
  std::vector<ReportSection> sections{};
  /// What came out, a few lines; null: nothing is said.
  std::vector<HeadLine> (*lines)(const report::RunData& run) = nullptr;
  /// Numbers by which a run is set beside others, those that matter most first; null: none.
  std::vector<RunValue> (*values)(const report::RunData& run) = nullptr;
  std::vector<RunCurve> (*curves)(const report::RunData& run) = nullptr;
  /// In what two runs of this kind differ, with paired errors where they can be paired, else with those of independent
  /// runs and the reason; `keys`: the keys of their scenes, and "seed", that differ. Null: not offered. Throws IoError.
  PairedSummary (*differences)(const report::RunData& a, const report::RunData& b,
                               const std::vector<std::string>& keys) = nullptr;
  /// Next steps for the end of the report of a run of this kind; `run`: its directory.
  NextSteps (*next)(const report::RunData& run) = nullptr;
  const char* kind = "";  ///< value of the key `kind` in scenes
};

/// Results of every kind; see kinds/kinds.cpp.
const std::vector<KindResults>& results_of_kinds();

/// What a file of this name is among the results of any kind; null: none.
const ResultFile* result_file(const std::string& name);
/// What an HDF5 file is among the results of any kind, by its content, whatever its name; null: none.
const ResultFile* result_file_of(const h5::Group& root);
/// Whether a file is a result of this program, by its name and, where other programs may use that name, by its content.
bool is_result_file(const std::filesystem::path& path);

}  // namespace softgrain

// The input script of LAMMPS that carries out the test of a macro scene, as macrosim/compression.h does.
#pragma once

#include <string>

#include "macrosim/lammps_run/data_file.h"
#include "macrosim/macro_packing.h"

namespace softgrain::lammps {

/// Names of the files of a scene, all in one directory: the script needs nothing from elsewhere.
inline constexpr const char* kScriptFile = "scene.in";
inline constexpr const char* kDataFile = "bodies.data";
inline constexpr const char* kLawsFile = "laws.toml";
inline constexpr const char* kSpringsFile = "springs.txt";  ///< springs of a preparation with friction
inline constexpr const char* kPointsFile = "points.txt";
inline constexpr const char* kPointsCopy = "points.copy";
inline constexpr const char* kCompactionFile = "compaction.txt";
inline constexpr const char* kPreparedFile = "prepared.txt";
inline constexpr const char* kTouchingFile = "prepared.done";  ///< says that the file above and its restart are whole
inline constexpr const char* kEndFile = "end.done";            ///< says that bodies and contacts of the end are whole
inline constexpr const char* kDivergedFile = "diverged.txt";
inline constexpr const char* kLogFile = "lammps.log";

/// Said by the script when the compaction does not reach its pressure.
inline constexpr const char* kNotJammed = "the preparation did not reach its pressure";

/// What a script is made from.
struct ScriptScene {
  const MacroSpec& spec;
  const MacroPacking& packing;
  const BodyTypes& types;
  std::string title;        ///< title for human readers
  std::string key;          ///< key of scene, seed, law and sample: the head of points.txt carries it
  std::int64_t states = 0;  ///< number of states kept for pictures, besides the last one
};

/// Lines of at most 110 columns, with comments; what may be changed stands at its head.
std::string script_text(const ScriptScene& scene);

/// Names of the files with the bodies and contacts of a state: recorded point `point`, or "end".
std::string bodies_file(const std::string& point);
std::string contacts_file(const std::string& point);

}  // namespace softgrain::lammps

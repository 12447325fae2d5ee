// What a kind of scene is to the commands: the table in kinds/kinds.h lists them all.
#pragma once

#include <algorithm>
#include <cctype>
#include <functional>
#include <string>
#include <vector>

#include "common/io/key_record.h"
#include "common/io/record_members.h"
#include "common/io/scene.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

/// Which results of a kind can be kept for other runs; an option that names a folder for others is refused.
struct KeptBetweenRuns {
  bool measurements = false;  ///< --law-cache: measurements of law tables, tests of materials
  bool packings = false;      ///< --packing-cache
  bool twins = false;         ///< --twin-cache
};

struct SceneKind {
  const char* name = "";  ///< value of the key `kind`
  /// Command that its runs record, and that runs it as `softgrain run` does: "run", "microsim" or "macrosim".
  const char* command = "";
  /// Reads the scene, runs it, writes what came out and the report; see the folder of the kind. Throws Error.
  std::function<ExitStatus(const Scene& scene, const CommonOptions& options)> run{};
  /// What follows from the scene without running it. Throws InputError, IoError.
  std::function<void(const Scene& scene, const CommonOptions& options, Findings& out)> check{};
  /// Reads the scene to its last key, but no file that it names (a law, states): what a reader makes of any text.
  /// Throws InputError.
  std::function<void(const Scene& scene)> read{};
  /// Throws all that run() refuses before it begins, files that the scene names included; empty: as `read`.
  std::function<void(const Scene& scene, const CommonOptions& options)> refuse{};
  KindResults results{};
  /// Members of its summary.json beside those that every kind has (softgrain schema --summary).
  std::vector<RecordMember> (*summary)() = nullptr;
  bool takes_law = false;     ///< whether --law and --bands go with it
  bool takes_engine = false;  ///< whether --engine and what belongs to it do
  KeptBetweenRuns keeps{};
  /// What scenes must have, as TOML, before keys that go by it are asked for: one each (softgrain schema).
  std::vector<std::string> explored_from{""};
  /// A small scene that runs in seconds, as TOML without `kind`: one table's name or one key with its value a line.
  /// Files are named as by a scene of pipelines/ (softgrain new).
  const char* starter = "";
};

/// All keys of the kind, by what its reader asks for.
inline std::vector<ExploredKey> keys_of(const SceneKind& kind) {
  std::vector<std::string> starts;
  for (const std::string& start : kind.explored_from)
    starts.push_back(std::string("kind = \"") + kind.name + "\"\n" + start);
  return explore_keys(starts, [&](const Scene& s) { kind.read(s); });
}

/// For SceneKind::explored_from: stages of a test, of all or in one of several tables ("loading").
inline std::string explored_stages(const std::string& table = "") {
  const std::string one = table.empty() ? "" : "[[" + table + "]]\nname = \"NAME\"\n";
  return one + "[[" + (table.empty() ? "" : table + ".") + "stage]]\nkind = \"triaxial\"\nstrain = 0.1\n";
}

// Names of [[variant]] tables.

/// Files carry such names besides words of their own; file systems take 255 characters.
inline constexpr std::size_t kLongestFileName = 100;

/// Notes a name too long for files, so that a run does not end where it would write the first one.
inline void require_short_name(const SceneTable& t, const std::string& name) {
  if (name.size() > kLongestFileName)
    t.add_error("name", "must have at most " + std::to_string(kLongestFileName) + " characters: files carry it");
}

/// The key "name", fit to be that of a file: letters, digits, '-', '_' and '.', which does not lead. Throws InputError.
inline std::string read_variant_name(const SceneTable& variant) {
  std::string name = variant.text(
      {"name", "its name, which results and files carry: letters, digits, `-`, `_` and `.`, no `.` first"});
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (!plain || name.front() == '.')
    variant.add_error("name", "must be made of letters, digits, '-', '_' and '.', which does not lead");
  require_short_name(variant, name);
  return name;
}

}  // namespace softgrain

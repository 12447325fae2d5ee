// Where a result came from, and what a file holds: written into every output.
#pragma once

#include <cstdint>
#include <string>

#include "common/core/enum_names.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

inline constexpr int kSchemaVersion = 1;

struct Provenance {
  std::string version;
  std::string commit;
  std::string compiler;
  int threads = 1;
  std::uint64_t seed = 0;
  std::string command;
  std::string kind;  ///< kind of the scene; empty where no scene was run. A summary says it itself
  std::string scene;
};

/// `with_kind`: as files have it; the summary of a run has its kind elsewhere.
void fields(auto&& visit, Of<Provenance> auto& p, bool with_kind = false) {
  visit("version", p.version, Means{"version of softgrain"});
  visit("commit", p.commit, Means{"git commit at build time, \"unknown\" without git"});
  visit("compiler", p.compiler, Means{"compiler and flags"});
  visit("threads", p.threads, Means{"number of threads", "1"});
  visit("seed", p.seed, Means{"seed of the run", "1"});
  visit("command", p.command, Means{"command line as given"});
  if (with_kind) visit("kind", p.kind, Means{"kind of the scene"});
  visit("scene", p.scene, Means{"whole scene, overrides applied"});
}

/// Version, commit, compiler and flags are filled in; the rest is the caller's.
Provenance build_provenance();

/// Writes a group "provenance" with schema version.
void write_provenance(const h5::Group& root, const Provenance& provenance);

/// Throws IoError unless the file is of this kind and of a schema that is known.
void require_format(const h5::Group& root, const std::string& format, const std::string& path);
/// Marks a file as such.
void write_format(const h5::Group& root, const std::string& format);

}  // namespace softgrain

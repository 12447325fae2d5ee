// Where a result came from, and what a file holds: written into every output.
#pragma once

#include <cstdint>
#include <string>

#include "common/core/enum_names.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

inline constexpr int kSchemaVersion = 1;

struct Provenance {
  std::string version;   ///< version of softgrain
  std::string commit;    ///< git commit at build time, "unknown" without git
  std::string compiler;  ///< compiler and flags
  int threads = 1;
  std::uint64_t seed = 0;
  std::string command;  ///< command line as given
  std::string kind;     ///< kind of the scene; empty where no scene was run. A summary says it itself
  std::string scene;    ///< whole scene, overrides applied
};

/// `with_kind`: as files have it; the summary of a run has its kind elsewhere.
void fields(auto&& visit, Of<Provenance> auto& p, bool with_kind = false) {
  visit("version", p.version);
  visit("commit", p.commit);
  visit("compiler", p.compiler);
  visit("threads", p.threads);
  visit("seed", p.seed);
  visit("command", p.command);
  if (with_kind) visit("kind", p.kind);
  visit("scene", p.scene);
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

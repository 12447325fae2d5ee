// Law runs of a macro scene, and runs of resolved grains, by LAMMPS: what it needs is written to the run directory, run
// there, and read back.
#pragma once

#include <string>
#include <vector>

#include "pipelines/kinds/macro/stage.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// How LAMMPS is to be used.
struct LammpsEngine {
  std::int64_t ranks = 1;
  bool write_only = false;
  std::string program;  ///< softgrain-lammps; empty when only files are written
};

/// --engine, --ranks (of the smallest scene, which has so many bodies, one each at least) and --write-only; nothing for
/// our own engine. Throws InputError.
std::optional<LammpsEngine> read_engine(const CommonOptions& options, std::int64_t bodies);

/// LAMMPS strains axes alone. Throws InputError for a test that slides.
void refuse_sliding(const MacroSpec& spec);

/// What all samples share.
struct LammpsRuns {
  MacroSetup setup;  ///< with the increments of runs by laws, law_spec()
  const NamedLaws& law;
  double inner_solid_fraction = 1.0;
  std::string title;              ///< title of the scene, for people
  std::string identity;           ///< scene, seed and law: tables of another one are refused
  std::string name = "macro";     ///< name of the runs, as MacroRuns::name
  std::string folder = "lammps";  ///< folder of the samples; the number of a sample follows
};

/// DIR/FOLDER-K of sample K.
std::string lammps_directory(const RunContext& context, std::int64_t sample, const std::string& folder = "lammps");

/// The scene of a run, its seed, and what else determines it: LammpsRuns::identity.
std::string lammps_identity(const Provenance& provenance, const std::string& more);

/// What remains to be done with what was written.
std::string written_text(const std::string& directories);

/// The bodies, laws and script of every sample, to lammps_directory(). What an earlier part of the same run left there
/// is kept. Throws IoError.
void write_lammps_files(const LammpsRuns& runs, const std::vector<MacroPacking>& packings, const RunContext& context);

/// Runs what write_lammps_files() wrote, one sample after another, from the last recorded point on. With preparation
/// "lammps" the packings are those that LAMMPS prepared afterwards. Throws IoError when LAMMPS fails, UnusableResult
/// when bodies are lost or do not jam, Interrupted.
std::vector<RunOutcome> run_with_lammps(const LammpsRuns& runs, const LammpsEngine& engine,
                                        std::vector<MacroPacking>& packings, const RunContext& context);

/// Who ran it, for the summary; with the release of LAMMPS that the log of the first sample in `directory` names.
EngineUse engine_use(const LammpsEngine& engine, const std::string& directory);

}  // namespace softgrain

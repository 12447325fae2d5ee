// The macro part of a run: samples with laws, their resolved twins, and what they have in common.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/data/snapshot.h"
#include "macrosim/macro_packing.h"
#include "macrosim/macro_system.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/run/run.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

/// Packings number 0 .. count-1 of a seed, to fill soft particles with.
std::vector<ShellPacking> make_contents(const SoftParticleSpec& spec, std::int64_t count, std::uint64_t seed);

/// Made by an earlier part of this run, which kept it as `task`, taken from the packings that runs share, or made now;
/// `key`: all that determines it.
MacroPacking kept_packing(const std::string& key, const std::string& task, const Run& run,
                          const std::function<MacroPacking()>& make);

/// The starting states of all samples, the same for all engines (with preparation "lammps": where bodies are placed
/// before it); they are kept in the store until the run has ended, under the name of `file` without its extension.
/// `title`: what progress says.
std::vector<MacroPacking> prepare_packings(const MacroSetup& setup, const Run& run, const std::string& file,
                                           const std::string& title = "preparing macro samples");

/// Writes them to DIR/`file`.
void save_packings(const std::vector<MacroPacking>& packings, const Run& run, const std::string& file);

/// Both.
std::vector<MacroPacking> make_macro_packings(const MacroSetup& setup, const Run& run, const std::string& file);

/// Bodies whose sizes a distribution says, as they are drawn; `of`: before what they are called.
std::vector<DrawnSizes> drawn_sizes(const MacroSetup& setup, std::uint64_t seed, const std::string& of = "");

/// Solid fraction of the contents, their mean; 1 without any.
double mean_solid_fraction(const std::vector<ShellPacking>& contents);

/// The spec of runs by laws, in any engine. They relax in a moment: where their increments are coarse, the way is.
MacroSpec law_spec(const MacroSetup& setup);

/// One scene with all its engines.
struct MacroRuns {
  const MacroSetup& setup;
  const std::vector<MacroPacking>& packings;  ///< one per sample
  const std::vector<ShellPacking>& contents;  ///< contents of soft particles
  std::uint64_t seed = 1;
  std::string name;        ///< name of checkpoints and of progress: "macro", or that of the scene
  std::string progress{};  ///< what progress says of laws instead: which of several packings
};

/// A run and the states of it that are kept.
struct RunOutcome {
  MacroCurve curve;
  std::vector<Snapshot> states;
};

/// The state at the end of a curve, with the names that people and files give it; `runs`: as MacroRuns::name.
Snapshot named_state(const MacroSystem& macro, const MacroPacking& packing, const MacroCurve& curve,
                     const std::string& runs);

/// Curves of these laws alone, on all samples, law by law: no pictures, nothing twice.
std::vector<MacroCurve> run_laws(const MacroRuns& runs, const std::vector<NamedLaws>& laws, const std::string& title,
                                 const Run& run);

/// Every law, then every twin, each on all samples; where the setup says cells, these as engine "law"; goes on from
/// checkpoints of recorded points. States that are kept for pictures go to DIR/`states_file`. `before`: runs of another
/// engine, whose curves and states come first.
std::vector<MacroCurve> run_engines(const MacroRuns& runs, const std::vector<NamedLaws>& laws, const Run& run,
                                    const std::string& states_file, std::vector<RunOutcome> before = {});

struct LawDraws;
struct BandRecord;

/// Runs all samples with the laws (none with cells) and the twins asked for, filled with `contents`; saves
/// DIR/macro.h5, DIR/macro_initial.h5 (the common starting states) and DIR/states_macro.h5. Laws with `draws` get
/// bands, which `records` tell of.
std::vector<MacroCurve> run_macro_stage(const MacroSetup& setup, const std::vector<NamedLaws>& laws,
                                        const std::vector<ShellPacking>& contents, const Run& run,
                                        const std::vector<LawDraws>& draws, std::vector<BandRecord>& records);

}  // namespace softgrain

// The measuring part of a law table: packings, pilot, and runs of every configuration in parallel until the means are
// known well enough. What is finished is kept, for --resume and for --law-cache.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/data/multi_contact_measurements.h"
#include "microsim/multi_contact_experiment.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/run/result_cache.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// A level of a hierarchy whose soft particles hold soft particles; or another series of the same run, with a file of
/// its own.
struct MultiContactLevel {
  std::function<SoftContent(const ShellPacking&, std::int64_t packing)>
      fill;  ///< the content that is made of a packing of grains alone; empty: that packing
  InnerLaws laws;
  std::string tag;                       ///< all that decides `fill` and `laws`, for the cache
  std::string file = kMultiContactFile;  ///< name of the file in the run directory
};

/// Measures and saves DIR/multi_contact.h5 (or the file of the level). All configurations use the packings 0, 1, ... of
/// one pool of setup.packings_max; soft neighbour number k of packing p holds packing (p + 1 + k) mod packings_max.
/// Recorded overlaps follow from a pilot of three packings and are the same for all of them. Batches of packings are
/// added to a configuration until its target is met. Results do not depend on the number of threads. `left_out` gets a
/// sentence for each run that broke off (a grain was squeezed out of its shell...). `known`: packings 0, 1, ... that
/// are there already, of the same soft particle and seed, and in the end the whole pool. Throws UnusableResult when
/// more than half of a configuration's packings broke off, Interrupted.
MultiContactMeasurements run_multi_contact_stage(const MultiContactSetup& setup, const Run& run,
                                                 std::vector<std::string>& left_out, std::vector<ShellPacking>& known,
                                                 const MultiContactLevel* level = nullptr);

// Where on the path of a multi-contact measurement states are recorded: dense around the onset of force, which a coarse
// pilot finds.

/// The loading that a configuration begins with, without what follows and without its name: what a pilot measures.
MultiContactConfiguration loading_part(const MultiContactConfiguration& configuration);

/// Equal shares on every stage.
MultiContactPlan coarse_plan(const MultiContactConfiguration& configuration);

/// Share of each stage at which force sets in: the first recorded state where the force on the neighbours that moved,
/// averaged over them and all runs, exceeds 1e-3 of that at the end of the stage; 1 where none does.
std::vector<double> onset_shares(const MultiContactConfiguration& configuration,
                                 const std::vector<MultiContactRun>& runs);

/// `points` shares per stage, none closer than `increment`: loading has half of them within 50 % of the onset and the
/// others evenly beyond, unloading and reloading go evenly, slides geometrically from 1/100 (and may be closer).
/// Stages beyond those of `onsets` count as having none.
MultiContactPlan recording_plan(const MultiContactConfiguration& configuration, const std::vector<double>& onsets,
                                std::int64_t points, double increment);

// Runs with several neighbours that are kept: the way of one while it lasts, and finished ones that neither this run
// nor later ones need measure again.

/// Raised whenever the same key would give another result: contact laws, relaxation, packing, what is recorded. The
/// test of cached results holds a run of this number.
inline constexpr int kMultiContactSchema = 3;

/// Everything that determines a run, as text. `contents` says what the bodies hold (seed and packing of the centre and
/// of its soft neighbours, and the tag of a level that adds inner soft particles). Neither names nor threads matter.
std::string multi_contact_run_key(const SoftParticleSpec& spec, const MultiContactConfiguration& configuration,
                                  const MultiContactPlan& plan, const MultiContactOptions& options,
                                  const std::string& contents);

/// How one is kept: reading it throws IoError for a file that holds no single run.
const KeptForm<MultiContactRun>& kept_multi_contact_run();

/// The name of its file.
inline std::string multi_contact_run_name(const std::string& key) {
  return SharedResults::name(kept_multi_contact_run().prefix, key);
}

/// run_multi_contact() from where task `name` was left off, or from the beginning. What is kept while it lasts is
/// removed at the end: keeping the result is left to the caller.
MultiContactRun run_kept_multi_contact(const TaskStore& store, const std::string& name,
                                       MultiContactExperiment& experiment, const MultiContactPlan& plan,
                                       const MultiContactOptions& options,
                                       const std::function<void(double share)>& progress);

// Every member of what a multi-contact run is made of, for the keys of what is kept of it.

SOFTGRAIN_EVERY_MEMBER(SoftParticleSpec, shell_radius, youngs_modulus, poisson_ratio, friction, density, restitution,
                       sizes, exponent, polydispersity, rmax_over_shell, beta, trials, placement)
SOFTGRAIN_EVERY_MEMBER(MultiContactPartner, kind, ratio, direction, smooth, on)
SOFTGRAIN_EVERY_MEMBER(MultiContactStage, move, overlap, slide, roll)
SOFTGRAIN_EVERY_MEMBER(MultiContactConfiguration, name, partners, stages, centre_free, held_out, turning)
SOFTGRAIN_EVERY_MEMBER(MultiContactOptions, relaxation, increment, tolerance, tolerance_between, max_passes,
                       least_stiffness, approach_speed, step_factor, settle_time)

}  // namespace softgrain

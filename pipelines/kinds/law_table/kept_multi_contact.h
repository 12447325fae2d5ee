// Runs with several neighbours that are kept: the way of one while it lasts, and finished ones that neither this run
// nor later ones need measure again.
#pragma once

#include <functional>
#include <string>

#include "common/data/multi_contact_measurements.h"
#include "microsim/multi_contact_experiment.h"
#include "pipelines/run/run.h"

namespace softgrain {

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

}  // namespace softgrain

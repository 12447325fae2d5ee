// Where on the path of a multi-contact measurement states are recorded: dense around the onset of force, which a coarse
// pilot finds.
#pragma once

#include "common/data/multi_contact_measurements.h"
#include "microsim/multi_contact_experiment.h"

namespace softgrain {

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

}  // namespace softgrain

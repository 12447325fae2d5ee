// Where on the path of a crowd measurement states are recorded: dense around the onset of force, which a coarse pilot
// finds.
#pragma once

#include "common/data/crowd_measurements.h"
#include "microsim/crowd_experiment.h"

namespace softgrain {

/// The loading that a configuration begins with, without what follows and without its name: what a pilot measures.
CrowdConfiguration loading_part(const CrowdConfiguration& configuration);

/// Equal shares on every stage.
CrowdPlan coarse_plan(const CrowdConfiguration& configuration);

/// Share of each stage at which force sets in: the first recorded state where the force on the neighbours that moved,
/// averaged over them and all runs, exceeds 1e-3 of that at the end of the stage; 1 where none does.
std::vector<double> onset_shares(const CrowdConfiguration& configuration, const std::vector<CrowdRun>& runs);

/// `points` shares per stage, none closer than `increment`: loading has half of them within 50 % of the onset and the
/// others evenly beyond, unloading and reloading go evenly, slides geometrically from 1/100 (and may be closer).
/// Stages beyond those of `onsets` count as having none.
CrowdPlan recording_plan(const CrowdConfiguration& configuration, const std::vector<double>& onsets,
                         std::int64_t points, double increment);

}  // namespace softgrain

// softgrain check of what is measured with several neighbours: of law tables, and of every level of a hierarchy.
#pragma once

#include <string>

#include "pipelines/kinds/law_table/crowd_scene.h"
#include "pipelines/kinds/soft_particle/cost.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Counts, overlaps, memory, and what the table will lack; returns the trial of its first packing.
MeasureTrial check_crowd(const CrowdSetup& setup, Findings& out);

/// The same without the packing and its trial: counts, overlaps, and what the table will lack.
void check_configurations(const CrowdSetup& setup, Findings& out);

/// Core seconds of a configuration with one packing.
double seconds_per_packing(const CrowdConfiguration& configuration, const CrowdSetup& setup, double pass_seconds);

/// Adds what the packings take, `times` over.
void spend_on_packings(const CrowdSetup& setup, const MeasureTrial& trial, double times, Findings& out);

/// Adds what the runs take, `times` over; `part`: their name among the parts of the time.
void spend_on_crowd(const CrowdSetup& setup, const MeasureTrial& trial, double times, const std::string& part,
                    Findings& out);

}  // namespace softgrain

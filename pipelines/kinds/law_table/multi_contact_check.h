// softgrain check of what is measured with several neighbours: of law tables, and of every level of a hierarchy.
#pragma once

#include <string>

#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/kinds/soft_particle/cost.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Counts, overlaps, memory, and what the table will lack; returns the trial of its first packing.
MeasureTrial check_multi_contact(const MultiContactSetup& setup, Findings& out);

/// Checks counts, overlaps, and what the table will lack. Unlike check_multi_contact() it makes no packing and no
/// trial.
void check_configurations(const MultiContactSetup& setup, Findings& out);

/// Core seconds of a configuration with one packing.
double seconds_per_packing(const MultiContactConfiguration& configuration, const MultiContactSetup& setup,
                           double pass_seconds);

/// Adds what the packings take, `times` over.
void spend_on_packings(const MultiContactSetup& setup, const MeasureTrial& trial, double times, Findings& out);

/// Adds what the runs take, `times` over; `part`: their name among the parts of the time.
void spend_on_multi_contact(const MultiContactSetup& setup, const MeasureTrial& trial, double times,
                            const std::string& part, Findings& out);

}  // namespace softgrain

// What multi-contact measurements say in numbers: mean forces, how well they are known, where force sets in, what they
// cost.
#pragma once

#include <string>
#include <vector>

#include "common/data/multi_contact_measurements.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/kinds/law_table/summary.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Mean over runs of the force per neighbour, averaged over the neighbours, in units of E Rs^2.
struct MeanForce {
  double mean = 0.0;
  double standard_error = 0.0;  ///< infinite for less than two runs
  std::int64_t runs = 0;
};

/// Mean force at the end of the loading that the configuration begins with (its largest overlap).
MeanForce mean_end_force(const MultiContactConfiguration& configuration, const std::vector<MultiContactRun>& runs);

/// Whether the standard error is within `target` times the mean.
bool met(const MeanForce& force, double target);

/// Numbers per configuration, and totals: packings used, mean force and standard error at the largest overlap, onset,
/// share of converged points, cost.
MultiContactSummary summary_of(const MultiContactMeasurements& data, double target);

/// Sentences about what must not be overlooked: targets missed, points that did not converge.
std::vector<std::string> multi_contact_remarks(const MultiContactMeasurements& data, double target);

/// A line per configuration.
std::string multi_contact_text(const MultiContactMeasurements& data);

// softgrain check of what is measured with several neighbours: of law tables, and of every level of a hierarchy.

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

// What crowd measurements say in numbers: mean forces, how well they are known, where force sets in, what they cost.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/data/crowd_measurements.h"
#include "pipelines/kinds/law_table/crowd_scene.h"

namespace softgrain {

/// Mean over runs of the force per neighbour, averaged over the neighbours, in units of E Rs^2.
struct MeanForce {
  double mean = 0.0;
  double standard_error = 0.0;  ///< infinite for less than two runs
  std::int64_t runs = 0;
};

/// At the end of the loading that the configuration begins with (its largest overlap).
MeanForce mean_end_force(const CrowdConfiguration& configuration, const std::vector<CrowdRun>& runs);

/// Whether the standard error is within `target` times the mean.
bool met(const MeanForce& force, double target);

/// Per configuration: packings used, mean force and standard error at the largest overlap, onset, share of converged
/// points, cost; and totals.
nlohmann::json crowd_json(const CrowdMeasurements& data, double target);

/// Sentences about what must not be overlooked: targets missed, points that did not converge.
std::vector<std::string> crowd_remarks(const CrowdMeasurements& data, double target);

/// A line per configuration.
std::string crowd_text(const CrowdMeasurements& data);

}  // namespace softgrain

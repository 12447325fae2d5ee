// Sizes as they were asked for, and as they came out.
#pragma once

#include <string>
#include <vector>

#include "common/data/measurements.h"
#include "common/packing/grading.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Grains of one kind, asked for by a distribution.
struct DrawnSizes {
  std::string of;  ///< "solid grains"
  Grading asked;
  std::vector<std::vector<double>> samples;  ///< radii
  std::string unit = "m";                    ///< unit of the diameters in the summary
  double scale = 1.0;                        ///< diameters in the summary over twice the radii here
};

/// Sizes as the summary says them.
std::vector<SizesSummary> summaries_of(const std::vector<DrawnSizes>& all);
/// What `check` says of them.
void add_sizes(Findings& out, const std::vector<DrawnSizes>& all);

/// Grains in shells; none where no distribution was asked for.
std::vector<DrawnSizes> shell_sizes(const SoftParticleSpec& spec, const std::vector<PackingInfo>& packings);

/// What kept tasks of a run hold to; empty without a distribution.
template <class Spec>
std::string sizes_text(const Spec& spec) {
  return spec.sizes ? spec.sizes->text() : "";
}

}  // namespace softgrain

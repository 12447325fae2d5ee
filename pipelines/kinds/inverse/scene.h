// Scene of kind "inverse": which soft particle gives a target curve?
#pragma once

#include <string>
#include <vector>

#include "calibrate/inverse_search.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// A quantity of the soft particle that may be searched.
struct SearchParameter {
  std::string name;  ///< key in [search]
  double low = 0.0;  ///< range
  double high = 0.0;
  bool logarithmic = false;  ///< spread evenly in its logarithm

  /// Value of the parameter at a coordinate in [0, 1], and the coordinate of a value.
  [[nodiscard]] double value(double u) const;
  [[nodiscard]] double coordinate(double value) const;
  /// Puts it into a soft particle; whole numbers are rounded.
  void set(SoftParticleSpec& spec, double value) const;
};

struct InverseSetup {
  std::string title;
  MeasureSetup measure;  ///< protocols; what is not searched of the soft particle
  Relaxation relaxation = Relaxation::least_work;
  MeasurementPlan plan;  ///< the target's overlaps
  PairKind kind = PairKind::soft_solid;
  InverseTarget target;  ///< forces in N
  std::vector<SearchParameter> search;
  std::int64_t packings = 8;  ///< packings of each evaluation
  std::int64_t budget = 40;   ///< evaluations
  std::int64_t design = 20;   ///< number of these evaluations that are spread over the whole box at first
  std::int64_t batch = 6;     ///< evaluations between two looks at the surface
  std::int64_t confirm = 8;   ///< packings of the last evaluation, with other random numbers
  int replicates = 400;
  std::vector<std::string> remarks;
};

/// The soft particle at a point of the box.
SoftParticleSpec spec_at(const InverseSetup& setup, const std::vector<double>& u);

/// Throws InputError: nothing to search, ranges that cannot be drawn, a target without points, more...
InverseSetup read_inverse(const Scene& scene);

/// Searches, measures once more at the answer with other packings, writes measurements.h5 (of that), evaluations.csv,
/// summary.json and the report. Status 3 when the target is not reached.
SceneKind inverse_kind();

/// What follows from the scene without running it.
void check_inverse(const InverseSetup& setup, Findings& out);

}  // namespace softgrain

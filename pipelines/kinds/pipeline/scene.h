// A whole pipeline scene.
#pragma once

#include <optional>
#include <string>

#include "calibrate/threshold_fit.h"
#include "common/io/scene.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

struct PipelineSetup {
  std::string title;
  MeasureSetup measure;
  FitOptions fit;
  std::optional<MacroSetup> macro;  ///< without [macro]: measurement and fit only
  /// [law]: a table from elsewhere, of which the macro scene takes the law of crowds too, beside the pair law measured
  /// here.
  std::optional<LawSources> crowd;
};

/// Reads a scene of kind "pipeline" to the last key. Throws BadInput.
PipelineSetup read_pipeline_setup(const Scene& scene);

/// Writes measurements.h5, law.toml, law.h5, macro.h5, macro_initial.h5, summary.json and the report. Status not_usable
/// when points did not converge, a law is not good, or a curve is not usable.
SceneKind pipeline_kind();

}  // namespace softgrain

// A whole pipeline scene.
#pragma once

#include <optional>
#include <string>

#include "calibrate/threshold_fit.h"
#include "common/io/scene.h"
#include "pipelines/kinds/law_table/law_prior.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// A small law table that the run measures itself.
struct MeasuredTable {
  MultiContactSetup multi_contact;
  MultiContactFitOptions fit;
  std::optional<LawLibrary> prior{};  ///< what its packings correct
};

struct PipelineSetup {
  std::string title;
  MeasureSetup measure;
  FitOptions fit;
  std::optional<MacroSetup> macro;  ///< empty without [macro]: measurement and fit only
  /// Where the multi-contact law comes from that the macro scene is run with beside the pair law: [law], a table from
  /// elsewhere, or [multi_contact] and [[configuration]], measured here. At most one of the two.
  std::optional<LawSources> table;
  std::optional<MeasuredTable> measured_table;
};

/// Reads a scene of kind "pipeline" to the last key. Throws InputError.
PipelineSetup read_pipeline_setup(const Scene& scene);

/// Writes measurements.h5, law.toml, law.h5, macro.h5, macro_initial.h5, with [[configuration]] multi_contact.h5,
/// law_table.toml and law_table.h5, then summary.json and the report. Status not_usable when points did not converge, a
/// law is not good, or a curve is not usable.
SceneKind pipeline_kind();

}  // namespace softgrain

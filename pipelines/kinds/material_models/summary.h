// What models of materials came to: summary.json of their run, which the report reads back.
#pragma once

#include "pipelines/kinds/material/summary.h"
#include "pipelines/kinds/material_models/scene.h"

namespace softgrain {

/// One model of one variant: errors against the mean of the truth, what it cost beside it. NaN: not defined.
struct ModelScore {
  std::string variant;
  std::string model;
  ModelKind kind = ModelKind::cells;
  bool blind = false;
  std::string remark;        ///< why nothing was run; or what to mind
  std::int64_t samples = 0;  ///< samples that truth and model came through; 0: nothing is known
  std::int64_t bodies = 0;
  double axial = 0.0;        ///< square root of sum (model - truth)^2/sum truth^2 of points beyond 1 % strain
  double axial_error = 0.0;  ///< standard error, of the same in every sample
  double lateral = 0.0;      ///< relative error of the lateral stress, as `axial`
  double lateral_error = 0.0;
  double axial_at_2 = 0.0;    ///< model/truth - 1 at 2 % strain
  double axial_at_end = 0.0;  ///< model/truth - 1 at the end of the first stage
  double ratio_at_2 = 0.0;    ///< q/p, model/truth - 1
  double ratio_at_6 = 0.0;
  double unloading = 0.0;    ///< secant modulus of the first unloading, model/truth - 1
  double truth_error = 0.0;  ///< standard error of the mean axial stress of the truth at the end, relative
  double evaluations = 0.0;  ///< truth over model: of contacts, or faces of cells
  double seconds = 0.0;      ///< truth over model, tests alone
  double seconds_all = 0.0;  ///< truth over model, preparations included
};

void fields(auto&& visit, Of<ModelScore> auto& s) {
  visit("variant", s.variant);
  visit("model", s.model);
  visit("kind", s.kind);
  visit("blind", s.blind);
  visit("remark", s.remark);
  visit("samples", s.samples);
  visit("bodies", s.bodies);
  visit("axial", s.axial);
  visit("axial_standard_error", s.axial_error);
  visit("lateral", s.lateral);
  visit("lateral_standard_error", s.lateral_error);
  visit("axial_at_2", s.axial_at_2);
  visit("axial_at_end", s.axial_at_end);
  visit("q_over_p_at_2", s.ratio_at_2);
  visit("q_over_p_at_6", s.ratio_at_6);
  visit("unloading", s.unloading);
  visit("truth_error", s.truth_error);
  visit("evaluations", s.evaluations);
  visit("seconds", s.seconds);
  visit("seconds_with_preparation", s.seconds_all);
}

struct MaterialModelsSummary {
  MaterialSummary material;
  std::vector<ModelScore> scores;
};

void fields(auto&& visit, Of<MaterialModelsSummary> auto& s) {
  fields(visit, s.material);
  visit("models", s.scores);
}

}  // namespace softgrain

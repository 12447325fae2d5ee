// What models of materials came to: summary.json of their run, which the report reads back.
#pragma once

#include "common/core/limits.h"
#include "pipelines/kinds/material/summary.h"
#include "pipelines/kinds/material_models/scene.h"

namespace softgrain {

/// One model of one variant: errors against the mean of the truth, what it cost beside it. NaN: not defined, or of a
/// version that did not compare it.
struct ModelScore {
  std::string variant;
  std::string model;
  ModelKind kind = ModelKind::cells;
  bool blind = false;
  std::string remark;
  std::int64_t samples = 0;
  std::int64_t bodies = 0;
  double axial = kNaN;  ///< square root of sum (model - truth)^2/sum truth^2 of points beyond 1 % strain
  double axial_error = kNaN;
  double lateral = kNaN;
  double lateral_error = kNaN;
  double axial_at_2 = kNaN;  ///< model/truth - 1 at 2 % strain
  double axial_at_end = kNaN;
  double ratio_at_2 = kNaN;  ///< model/truth - 1 at 2 % strain of the first stage that shears
  double ratio_at_6 = kNaN;
  double volume = kNaN;  ///< loss of volume in that stage where it is triaxial, model - truth
  double unloading = kNaN;
  double truth_error = kNaN;
  double band = kNaN;
  double inside = kNaN;
  double evaluations = kNaN;  ///< truth over model: of contacts, or faces of cells
  double seconds = kNaN;      ///< truth over model, tests alone
  double seconds_all = kNaN;  ///< truth over model, preparations included
};

/// ModelScore::volume in percent of the volume; empty where it is not defined.
std::string volume_text(const ModelScore& s);

void fields(auto&& visit, Of<ModelScore> auto& s) {
  visit("variant", s.variant, Means{"name of the variant"});
  visit("model", s.model, Means{"name of the model"});
  visit("kind", s.kind, Means{"kind of the model"});
  visit("blind", s.blind, Means{"whether nothing of the truth was used for it"});
  visit("remark", s.remark, Means{"why nothing was run; or what to know about it"});
  visit("samples", s.samples, Means{"samples that truth and model came through; 0: nothing is known", "1"});
  visit("bodies", s.bodies, Means{"bodies of a sample of the model", "1"});
  visit("axial", s.axial,
        Means{"relative L2 error of the axial stress beyond 1 % strain, against the mean of the truth", "1"});
  visit("axial_standard_error", s.axial_error, Means{"standard error of it", "1"});
  visit("lateral", s.lateral, Means{"relative L2 error of the lateral stress beyond 1 % strain", "1"});
  visit("lateral_standard_error", s.lateral_error, Means{"standard error of it", "1"});
  visit("axial_at_2", s.axial_at_2, Means{"axial stress at 2 % strain, model/truth - 1", "1"});
  visit("axial_at_end", s.axial_at_end, Means{"axial stress at the end of the first stage, model/truth - 1", "1"});
  visit("q_over_p_at_2", s.ratio_at_2,
        Means{"q/p at 2 % strain of the first stage that shears (shear, undrained, triaxial), model/truth - 1", "1"});
  visit("q_over_p_at_6", s.ratio_at_6, Means{"q/p at 6 % strain of that stage, model/truth - 1", "1"});
  visit(
      "volume", s.volume,
      Means{"loss of volume over the volume at its beginning, in that stage where it is triaxial, model - truth", "1"});
  visit("unloading", s.unloading, Means{"secant modulus of the first unloading, model/truth - 1", "1"});
  visit("truth_error", s.truth_error,
        Means{"standard error of the mean axial stress of the truth at the end, relative", "1"});
  visit("band", s.band,
        Means{"half width of the 95 % band of the axial stress by draws of the card, relative to the truth over the "
              "curve as the error is",
              "1"});
  visit("inside", s.inside, Means{"share of the points beyond 1 % strain, of all samples, within that band", "1"});
  visit("evaluations", s.evaluations, Means{"contact evaluations, or faces of cells, truth over model", "1"});
  visit("seconds", s.seconds, Means{"time of the tests, truth over model", "1"});
  visit("seconds_with_preparation", s.seconds_all, Means{"time with preparations, truth over model", "1"});
}

struct MaterialModelsSummary {
  MaterialSummary material;
  std::vector<ModelScore> scores;
};

void fields(auto&& visit, Of<MaterialModelsSummary> auto& s) {
  fields(visit, s.material);
  visit("models", s.scores, Means{"errors and costs of each model for each variant"});
}

}  // namespace softgrain

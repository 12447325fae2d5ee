// Friction of faces between cells, from curves of stress ratios measured on fines alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/data/law_card.h"

namespace softgrain {

struct FaceFrictionTrial {
  double friction = 0.0;   ///< mu_f
  double stiffness = 0.0;  ///< chi
};

/// The curves of the cell law for each trial, all of a trial in one row; an empty row where the law gives none.
using FaceFrictionModel = std::function<std::vector<std::vector<double>>(const std::vector<FaceFrictionTrial>&)>;

struct FaceFrictionData {
  std::vector<std::vector<double>> samples;  ///< one row per sample, as the model gives it; not a number: not measured
  std::vector<double> weight;                ///< weight of the squared residual at each point of a row
};

struct FaceFrictionFit {
  bool usable = false;
  std::string message = "not run";
  Estimate friction;          ///< mu_f
  Estimate stiffness;         ///< chi
  std::vector<double> model;  ///< curves of the law with these values
  std::vector<double> mean;   ///< mean of the samples
  double deviation = 0.0;     ///< root mean square of model less mean, by the weights
  int evaluations = 0;        ///< evaluations of the model
};

/// Least squares for ln mu_f and ln chi: the model is evaluated at 3 x 3 values around a guess, between which every
/// point of a curve is a parabola in each parameter; the minimum of that surface is the next guess, and the 3 x 3 close
/// in on it once it lies among them (to 15 % on either side, where the surface is as good as the model). Noise of
/// relaxations so does no harm, as it would to derivatives. The samples are fitted on the last surface too: their
/// scatter gives errors, and Student's intervals, in the logarithms; infinite for one sample.
/// Throws InputError for rows that do not fit together. Not usable, with the reason: the law gives no curve, curves
/// that do not determine both (a flat surface, a minimum beyond 0.02 to 5 and 0.02 to 50), samples that disagree by
/// more than the surface holds.
FaceFrictionFit fit_face_friction(const FaceFrictionModel& model, const FaceFrictionData& data,
                                  const FaceFrictionTrial& start = {0.6, 1.5});

}  // namespace softgrain

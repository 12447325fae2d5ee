// Pores that fines leave beside coarse grains, from the onsets of fines, coarse grains and mixtures of both.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "common/data/law_card.h"

namespace softgrain {

/// Names of the groups of a StateFit; mixtures with their ratio of solid volumes V_f/V_c.
struct MixtureGroups {
  struct Mixture {
    std::string name;
    double ratio = 0.0;
  };
  std::string fines;
  std::string coarse;
  std::vector<Mixture> mixtures;
};

/// One mixture: W/V_c as measured, and as fitted.
struct MixturePores {
  std::string name;
  double ratio = 0.0;  ///< V_f/V_c
  Estimate pores;      ///< W/V_c
  double fitted = 0.0;
};

/// The form at one ratio, with its 95 % interval.
struct ExcessPoresBand {
  double ratio = 0.0;
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct ExcessPoresFit {
  bool usable = false;
  std::string message = "not run";
  Estimate void_ratio;  ///< e_J = (1 - phi_J)/phi_J of the fines
  Estimate alone;       ///< e_c: the same of the coarse grains
  Estimate many;        ///< w_inf
  Estimate decay;       ///< xi
  std::vector<MixturePores> mixtures;
  std::vector<ExcessPoresBand> band;  ///< the form from 0 to beyond the largest ratio
  double deviation = 0.0;             ///< root mean square of W/V_c about the form
  /// e_J, e_c, w_inf and ln xi of StateFit::replicates, in their order; the last two are not a number without a refit.
  std::vector<std::array<double, 4>> replicates;
  double widening = 1.0;  ///< factor on intervals of w_inf and xi: sqrt(chi^2 over degrees of freedom) where above 1
};

/// W/V_c = w_inf + (e_c - w_inf) exp(-(V_f/V_c)/xi), with W/V_c = [(1 - phi_J)/phi_J (V_f + V_c) - e_J V_f]/V_c of
/// every mixture: least squares for w_inf >= 0 and ln xi, weighted by the errors of W/V_c (their correlation through
/// e_J is left aside). Intervals are Student's about the fit, from refits to the replicates of `states`, widened where
/// the form misses the mixtures by more than their errors. With one sample of each group all weigh the same, and errors
/// are infinite. Throws InputError for groups that `states` does not have, fewer than three mixtures, ratios that are
/// not above 0. Not usable, with the reason: a mixture that leaves no excess pores, xi that the mixtures do not
/// determine.
ExcessPoresFit fit_excess_pores(const StateFit& states, const MixtureGroups& groups);

}  // namespace softgrain

// One form of crowd law fitted to averaged states, and fitted again to packings drawn with replacement.
#pragma once

#include <string>
#include <vector>

#include "calibrate/crowd_fit.h"
#include "calibrate/crowd_states.h"
#include "calibrate/least_squares.h"

namespace softgrain {

/// Which configurations a fit looks at.
using StateSelection = std::vector<const CrowdStates*>;

/// (law - mean)/sigma of all loading states and neighbours, sigma^2 = error^2 + (eps F)^2 + (eps F_largest/10)^2; every
/// configuration counts alike, however many neighbours it has.
std::vector<double> crowd_residuals(const CrowdModel& model, const StateSelection& selection, double discrepancy);

/// Root mean square of (law - mean) over that of the mean, loading states.
double crowd_error(const CrowdModel& model, const CrowdStates& states);

/// States of a configuration in which every overlap has only grown so far: a law without memory speaks of these.
std::vector<const CrowdState*> loading_states(const CrowdStates& states);

/// What would put a law right on one configuration, by least squares over its loading states.
FormOffset form_offset(const CrowdModel& model, const CrowdStates& states, double discrepancy);

/// Parameters of the planes: ln a, b, delta and the coupling that the form has.
LeastSquaresFit fit_planes(CrowdModel& model, const StateSelection& selection, double discrepancy, bool thorough);

/// Weights per ratio and one exponent of solid or soft neighbours; `ratios` ascending (soft: of |ln ratio|).
/// `thorough`: every strategy when the first one does not come to a minimum.
LeastSquaresFit fit_partners(CrowdModel& model, PartnerKind kind, const std::vector<double>& ratios,
                             const StateSelection& selection, double discrepancy, bool thorough);

/// Whether a law of this form is fitted to a configuration: the pair law knows one contact only.
bool serves(const CrowdStates& c, Crowd form);

/// And all its neighbours are of this kind; planes are those with the friction of the grains.
bool serves(const CrowdStates& c, Crowd form, PartnerKind kind);

/// Configurations of planes that this form is fitted to.
StateSelection plane_selection(const std::vector<CrowdStates>& states, Crowd form);

/// Size of a neighbour as the tables know it: soft ones the same from either side.
double table_ratio(const CrowdPartner& p);

/// What was fitted of one kind of neighbour: ln w by ratio, then m.
struct PartnerFit {
  PartnerKind kind = PartnerKind::solid;  ///< plane: planes without friction
  std::vector<double> ratios;
  LeastSquaresFit fit;    ///< not run without such neighbours
  std::size_t first = 0;  ///< of its parameters among all
};

/// The parameters of one form, as one row: planes, then those of each kind of neighbour.
struct FormFit {
  CrowdModel model;
  LeastSquaresFit planes;
  std::vector<PartnerFit> partners;  ///< solid, soft, planes without friction

  [[nodiscard]] std::vector<double> parameters() const;
  /// Why it is not the minimum that it should be, or not the only one; empty when it is.
  [[nodiscard]] std::string trouble() const;
};

/// Planes first, then each kind of neighbour; of crowds around free shells in the end all together, with those that mix
/// kinds. `thorough`: every strategy for the planes, and for the neighbours when the first one does not come to a
/// minimum. `without`: a configuration that is left out.
FormFit fit_form(Crowd form, const std::vector<CrowdStates>& states, double discrepancy, bool thorough,
                 const CrowdModel& start, const CrowdStates* without = nullptr);

/// Whether a form is fitted to all its configurations at once.
bool all_together(const std::vector<CrowdStates>& states, Crowd form);

/// Such a fit from a near one on: to states of other draws, or without one of them.
FormFit refitted(const FormFit& near, const std::vector<CrowdStates>& states, double discrepancy,
                 const CrowdStates* without = nullptr);

/// How often each packing counts in replicate `r`.
std::vector<double> packing_weights(std::size_t packings, std::uint64_t seed, int r);

/// Refits that came to their minimum.
struct FormRefits {
  std::vector<std::vector<double>> columns;  ///< one per parameter, a value per refit
  std::vector<int> draws;                    ///< number of the replicate behind each
  int failed = 0;                            ///< the others, which count nowhere

  /// One more, of this draw.
  void take(const FormFit& fit, int draw);
};

/// Refits to packings drawn with replacement, from the fit to all of them: as many as options.replicates that come to a
/// minimum, or those of twice as many draws. A draw in which a configuration has no state left counts as failed.
FormRefits refit_form(const CrowdMeasurements& data, const std::vector<CrowdStates>& all, Crowd form,
                      const FormFit& full, const CrowdFitOptions& options);

}  // namespace softgrain

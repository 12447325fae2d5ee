// Fits laws of soft particles with several contacts to multi-contact measurements and says how well they predict what
// they have not seen.
#pragma once

#include <string>
#include <vector>

#include "calibrate/least_squares.h"
#include "calibrate/multi_contact_states.h"
#include "common/contact/multi_contact_prediction.h"
#include "common/data/multi_contact_law.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

struct MultiContactFitOptions {
  double discrepancy = 0.05;  ///< what a law may be off besides the noise: share of the force, and a tenth of it of the
                              ///< largest force of the configuration
  int min_packings = 4;
  int replicates = 40;  ///< bootstrap over packings; 0: intervals from the covariance alone
  std::uint64_t seed = 1;
  WantedForm best{};  ///< the form to prefer; empty: the one that predicts fitted loadings best when each is left out
  /// Largest error on held-out loadings and when loadings are left out one by one; above it a law is called inaccurate.
  double largest_error = 0.5;
};

/// All three forms for the packings of `data`, best one named: the one that is asked for, or predicts fitted loadings
/// best when each is left out. Planes fix pressure and coupling; solid spheres, then soft neighbours, their constants w
/// and m at each ratio that was measured. Configurations marked as held out are predicted. Throws InputError when there
/// is no configuration with one plane, or too few packings.
LawTableEntry fit_multi_contact_laws(const MultiContactMeasurements& data, const MultiContactFitOptions& options = {});

/// Says again how far off a law is on the configurations of its MultiContactLaw::errors that were measured, after its
/// numbers have been changed; errors of other configurations stay. `discrepancy`: as in MultiContactFitOptions.
void judge_again(MultiContactLaw& law, const MultiContactMeasurements& measured, double discrepancy);

// One form of law fitted to averaged states, and fitted again to packings drawn with replacement.

/// The configurations that a fit takes.
using StateSelection = std::vector<const MultiContactStates*>;

/// (law - mean)/sigma of all loading states and neighbours, sigma^2 = error^2 + (eps F)^2 + (eps F_largest/10)^2; every
/// configuration counts alike, however many neighbours it has.
std::vector<double> multi_contact_residuals(const MultiContactModel& model, const StateSelection& selection,
                                            double discrepancy);

/// Root mean square of (law - mean) over that of the mean, loading states.
double multi_contact_error(const MultiContactModel& model, const MultiContactStates& states);

/// States of a configuration in which every overlap has only grown so far: a law without memory speaks of these.
std::vector<const MultiContactState*> loading_states(const MultiContactStates& states);

/// What would put a law right on one configuration, by least squares over its loading states.
FormOffset form_offset(const MultiContactModel& model, const MultiContactStates& states, double discrepancy);

/// Parameters of the planes: ln a, b, delta and the coupling that the form has. `settle`: a fit that stalls may end in
/// a minimum on a threshold (LeastSquaresProblem::kinks); false where it only gives the start of another one.
LeastSquaresFit fit_planes(MultiContactModel& model, const StateSelection& selection, double discrepancy, bool thorough,
                           bool settle = true);

/// Weights per ratio and one exponent of solid or soft neighbours; `ratios` ascending (soft: of |ln ratio|).
/// `thorough`: every strategy when the first one does not come to a minimum.
LeastSquaresFit fit_partners(MultiContactModel& model, PartnerKind kind, const std::vector<double>& ratios,
                             const StateSelection& selection, double discrepancy, bool thorough, bool settle = true);

/// Whether a law of this form is fitted to a configuration: the pair law knows one contact only.
bool serves(const MultiContactStates& c, LawForm form);

/// Whether a law of this form is fitted to a configuration, and all its neighbours are of this kind. Planes are those
/// with the friction of the grains.
bool serves(const MultiContactStates& c, LawForm form, PartnerKind kind);

/// Configurations of planes that this form is fitted to.
StateSelection plane_selection(const std::vector<MultiContactStates>& states, LawForm form);

/// Size of a neighbour as the tables know it: soft ones the same from either side.
double table_ratio(const MultiContactPartner& p);

/// What was fitted of one kind of neighbour: ln w by ratio, then m.
struct PartnerFit {
  PartnerKind kind = PartnerKind::solid;  ///< plane: planes without friction
  std::vector<double> ratios;
  LeastSquaresFit fit;    ///< not run without such neighbours
  std::size_t first = 0;  ///< index of its first parameter among all
};

/// The parameters of one form, as one row: planes, then those of each kind of neighbour.
struct FormFit {
  MultiContactModel model;
  LeastSquaresFit planes;
  std::vector<PartnerFit> partners;  ///< solid, soft, planes without friction

  [[nodiscard]] std::vector<double> parameters() const;
  /// Why it is not the minimum that it should be, or not the only one; empty when it is.
  [[nodiscard]] std::string trouble() const;
};

/// Planes first, then each kind of neighbour; of configurations around free shells in the end all together, with those
/// that mix kinds. `thorough`: every strategy for the planes, and for the neighbours when the first one does not come
/// to a minimum. `without`: a configuration that is left out.
FormFit fit_form(LawForm form, const std::vector<MultiContactStates>& states, double discrepancy, bool thorough,
                 const MultiContactModel& start, const MultiContactStates* without = nullptr);

/// Whether a form is fitted to all its configurations at once.
bool all_together(const std::vector<MultiContactStates>& states, LawForm form);

/// Fits all configurations at once, starting from a near fit: to states of other draws, or without one of them.
FormFit refitted(const FormFit& near, const std::vector<MultiContactStates>& states, double discrepancy,
                 const MultiContactStates* without = nullptr);

/// How often each packing counts in replicate `r`.
std::vector<double> packing_weights(std::size_t packings, std::uint64_t seed, int r);

/// Refits that came to their minimum.
struct FormRefits {
  std::vector<std::vector<double>> columns;  ///< one per parameter, a value per refit
  std::vector<int> draws;                    ///< number of the replicate behind each
  int failed = 0;                            ///< number of the other refits, which count nowhere

  /// Adds the refit of this draw.
  void take(const FormFit& fit, int draw);
};

/// Refits to packings drawn with replacement, from the fit to all of them: as many as options.replicates that come to a
/// minimum, or those of twice as many draws. A draw in which a configuration has no state left counts as failed.
FormRefits refit_form(const MultiContactMeasurements& data, const std::vector<MultiContactStates>& all, LawForm form,
                      const FormFit& full, const MultiContactFitOptions& options);

}  // namespace softgrain

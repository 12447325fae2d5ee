// The equation of state of a scene's materials: pressure over solid fraction, and where it begins at other spans.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "calibrate/onset_extrapolation.h"
#include "common/data/fields.h"
#include "common/data/macro_result.h"
#include "common/io/json_record.h"
#include "common/io/scene.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// [equation].
struct EquationSettings {
  bool asked = false;  ///< the scene has [equation]; without it a fit is made where tests allow one
  StateForm form = StateForm::porosity;
  double largest_span = 0.0;  ///< largest span that extrapolations use; 0: all
  std::vector<double> spans;  ///< spans to which onsets are extrapolated
  std::int64_t replicates = 400;
  std::vector<KnownOnset> onsets = {};  ///< onsets measured elsewhere; extrapolations use them
};

/// Throws InputError.
EquationSettings read_equation(const SceneTable& t);

/// A variant as the fit sees it.
struct EquationInput {
  std::string name;
  double span = 1.0;   ///< largest over smallest radius
  std::string family;  ///< variants that differ in the span alone
  std::vector<MacroCurve> curves;
  double exponent = 0.0;  ///< exponent of the power law of their sizes; 0: another form
};

void fields(auto&& visit, Of<Estimate> auto& e) {
  visit("value", e.value, Means{"value, in the unit of the quantity", "as the quantity"});
  visit("standard_error", e.standard_error, Means{"standard error; null: not known", "as the quantity"});
  range_field(visit, "interval", e.low, e.high, Means{"95 % interval; null: not known", "as the quantity"});
}

/// phi_J of one variant.
struct OnsetSummary {
  std::string name;
  double span = 0.0;
  int samples = 0;
  Estimate onset;
  double own_modulus = 0.0;
};

void fields(auto&& visit, Of<OnsetSummary> auto& s) {
  visit("name", s.name, Means{"name of the variant"});
  visit("span", s.span, Means{"largest over smallest radius", "1"});
  visit("samples", s.samples, Means{"number of samples", "1"});
  visit("onset", s.onset, Means{"solid fraction phi_J at which pressure begins", "1"});
  visit("own_K", s.own_modulus, Means{"K of this variant alone, n being that of all", "1"});
}

void fields(auto&& visit, Of<KnownOnset> auto& s) {
  visit("span", s.span, Means{"largest over smallest radius", "1"});
  visit("value", s.value, Means{"solid fraction phi_J at which pressure begins", "1"});
  visit("standard_error", s.standard_error, Means{"its standard error", "1"});
}

/// What one form of extrapolation says.
struct OnsetFormSummary {
  std::string form;
  bool usable = false;
  std::string message;
  std::vector<double> parameters;
  Estimate onset;
};

void fields(auto&& visit, Of<OnsetFormSummary> auto& s) {
  visit("form", s.form, Means{"form of the extrapolation"});
  visit("usable", s.usable, Means{"whether it could be fitted"});
  visit("message", s.message, Means{"why not"});
  visit("parameters", s.parameters, Means{"parameters of the form", "1"});
  visit("onset", s.onset, Means{"solid fraction phi_J that it gives", "1"});
}

/// phi_J at a span, from those of smaller ones.
struct ExtrapolationSummary {
  std::string family;
  double span = 0.0;
  double largest_fitted = 0.0;
  bool usable = false;
  std::string message;
  std::optional<Estimate> onset;
  std::optional<Estimate> measured;
  std::vector<OnsetFormSummary> forms;
};

void fields(auto&& visit, Of<ExtrapolationSummary> auto& s) {
  visit("family", s.family, Means{"variants that differ in the span alone"});
  visit("span", s.span, Means{"largest over smallest radius", "1"});
  visit("largest_fitted_span", s.largest_fitted, Means{"largest span that was used", "1"});
  visit("usable", s.usable, Means{"whether there is an estimate"});
  visit("message", s.message, Means{"why not"});
  visit("onset", s.onset, kLeftOut, Means{"solid fraction phi_J at that span", "1"});
  visit("measured", s.measured, kLeftOut, Means{"measured phi_J, where a variant has that span", "1"});
  visit("forms", s.forms, kLeftOut, Means{"what each form of extrapolation says"});
}

/// p/E = K x^n (porosity), x = (phi - phi_J)/(1 - phi_J), or K (1 - Vp/Vp_J)^n (pores).
struct EquationSummary {
  StateForm form = StateForm::porosity;
  bool usable = false;
  std::string message;
  Estimate modulus;
  Estimate exponent;
  double pressure_deviation = 0.0;
  double modulus_scatter = 0.0;
  double collapse_probability = 0.0;
  std::vector<OnsetSummary> onsets;
  std::vector<KnownOnset> known;  ///< onsets that the scene gives
  std::vector<ExtrapolationSummary> extrapolations;
};

void fields(auto&& visit, Of<EquationSummary> auto& s) {
  visit("form", s.form,
        Means{"porosity: p/E = K x^n with x = (phi - phi_J)/(1 - phi_J); pores: p/E = K (1 - Vp/Vp_J)^n"});
  visit("usable", s.usable, Means{"whether the fit is usable"});
  visit("message", s.message, Means{"why not"});
  visit("K", s.modulus, Means{"modulus K", "1"});
  visit("n", s.exponent, Means{"exponent n", "1"});
  visit("pressure_deviation", s.pressure_deviation, Means{"root mean square deviation of log p", "1"});
  visit("K_scatter", s.modulus_scatter, Means{"relative scatter of K between variants", "1"});
  visit("collapse_probability", s.collapse_probability, Means{"probability of a larger scatter of K by chance", "1"});
  visit("onsets", s.onsets, Means{"phi_J of each variant"});
  visit("onsets_measured_elsewhere", s.known, kLeftOut, Means{"phi_J of other spans that the scene gives"});
  visit("extrapolations", s.extrapolations, kLeftOut, Means{"phi_J at spans that were asked for"});
}

struct EquationResult {
  EquationSummary summary;
  StateFit fit;
};

/// Fits the equation of state to the compression that every sample starts with. It ends where the volume grows, or
/// where a stage begins that shears the sample or is held by stress at its sides. Empty where every sample has fewer
/// than four such points.
std::optional<EquationResult> equation_of(const std::vector<EquationInput>& variants, const EquationSettings& settings,
                                          std::uint64_t seed);

/// What was asked for and could not be extrapolated: a warning for each family.
std::vector<std::string> extrapolation_warnings(const EquationSummary& summary);

/// Whether a sample is usable and compressed over at least four points.
bool takes_part(const MacroCurve& curve);

/// The points of one sample that take part.
StateCurve state_curve(const MacroCurve& curve, const std::string& group, double span);

}  // namespace softgrain

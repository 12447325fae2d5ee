// What the stages of a test came to: moduli, strength, change of volume.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/data/macro_result.h"

namespace softgrain {

/// The slope that a stage defines; strains are logarithmic, compression positive.
enum class Modulus {
  constrained,  ///< M = d sigma_z / d eps_z, x and y standing
  young,        ///< E = d sigma_z / d eps_z, x and y at constant stress
  bulk,         ///< K = d p / d eps_v
  shear,        ///< G = d (sigma_z - sigma_x) / (2 d (eps_z - eps_x)); sliding: d sigma_xz / d gamma
  undrained,    ///< E_u = d (sigma_z - (sigma_x + sigma_y)/2) / d eps_z at constant volume
  axial,        ///< d sigma_z / d eps_z, whatever the other axes do
  none          ///< nothing is driven
};

template <>
inline constexpr auto enum_names<Modulus> = enum_name_list<Modulus>({{Modulus::constrained, "constrained"},
                                                                     {Modulus::young, "Young"},
                                                                     {Modulus::bulk, "bulk"},
                                                                     {Modulus::shear, "shear"},
                                                                     {Modulus::undrained, "undrained Young"},
                                                                     {Modulus::axial, "axial"},
                                                                     {Modulus::none, "none"}});

Modulus modulus_of(StageKind way);

/// Ways that change the shape of the sample rather than its volume.
inline bool shears(StageKind way) {
  return keeps_volume(way) || way == StageKind::triaxial || way == StageKind::direct_shear;
}

/// The stress whose change over the strain a modulus is: sigma_z; bulk: p; shear: (sigma_z - sigma_x)/2, sliding
/// sigma_xz; undrained: sigma_z - (sigma_x + sigma_y)/2.
const char* stress_of(Modulus modulus);

/// Results of one stage of one sample. p = (sigma_x + sigma_y + sigma_z)/3, q = sqrt(3 J2), which is |sigma_z -
/// sigma_x| where two axes bear alike; of tests that slide q has the shear stresses too. NaN where a result is not
/// defined.
struct StageResult {
  StageRecord record;
  double strain_begin = kNaN;  ///< nominal strain of z from the start of the test
  double strain_end = kNaN;
  double volumetric_begin = kNaN;  ///< loss of volume over the volume at the start of the test
  double volumetric_end = kNaN;
  double axial_end = kNaN;  ///< stress at the end [Pa]
  double lateral_end = kNaN;
  double lateral_ratio = kNaN;  ///< K0: lateral over axial stress at the end; where x and y stand
  /// Secant between two stresses [Pa]: those of the record; without any from half the stress at the end to the end
  /// (constrained, bulk, axial; from the begin where that is more), from the begin to half of the largest change
  /// (Young, shear, undrained: E50), and over the whole stage where the stress falls. NaN where the stage does not go
  /// through both.
  double modulus = kNaN;
  double modulus_from = kNaN;         ///< the stress where the interval begins; see stress_of() [Pa]
  double modulus_to = kNaN;           ///< stress where the interval ends [Pa]
  double modulus_begin = kNaN;        ///< tangent at the first point: of unload the unloading modulus [Pa]
  double modulus_end = kNaN;          ///< tangent at the last point, from few points and one side: scatters [Pa]
  double poisson_begin = kNaN;        ///< Young's way: -d(eps_x + eps_y)/(2 d eps_z) at the first point
  double ratio_peak = kNaN;           ///< largest q/p
  double ratio_peak_strain = kNaN;    ///< strain of z at the largest q/p; sliding: none, as z does not drive it
  double ratio_end = kNaN;            ///< q/p at the end
  double shear_end = kNaN;            ///< sliding: shear strain at the end, from the start of the test
  double friction_peak = kNaN;        ///< sliding: largest |sigma_xz|/sigma_z; its arc tangent is the angle of friction
  double friction_peak_shear = kNaN;  ///< sliding: shear strain there, from the start of the test
  double friction_end = kNaN;         ///< sliding: |sigma_xz|/sigma_z at the end
};

/// Change of stress over that of strain between two stresses (the second lies behind the first), straight between
/// points; NaN where the points do not go through both.
double secant_modulus(const std::vector<double>& strain, const std::vector<double>& stress, double from, double to);

/// Fall of the void ratio over a decade of stress, -(e2 - e1)/log10(s2/s1), between two stresses as secant_modulus()
/// finds them: the compression index Cc of a loading, the swelling index Cs of an unloading. NaN where the points do
/// not go through both, or a stress is not above 0.
double compression_index(const std::vector<double>& void_ratio, const std::vector<double>& stress, double from,
                         double to);

/// Results of every stage that has two points at least; empty for curves that do not say their stages. Tangents are
/// those of a parabola by least squares through the four points (or as many as there are) next to that end; where that
/// is no continuation of the points, of another sign than the secant of the last two or beyond thrice it, the secant.
std::vector<StageResult> stage_results(const MacroCurve& curve);

/// Means over the usable samples of one engine; empty where no sample has a value.
struct StageMeans {
  StageRecord record;
  std::optional<MeanError> strain_end;
  std::optional<MeanError> volumetric_end;
  std::optional<MeanError> axial_end;
  std::optional<MeanError> lateral_end;
  std::optional<MeanError> lateral_ratio;
  std::optional<MeanError> modulus;
  std::optional<MeanError> modulus_from;
  std::optional<MeanError> modulus_to;
  std::optional<MeanError> modulus_begin;
  std::optional<MeanError> modulus_end;
  std::optional<MeanError> poisson_begin;
  std::optional<MeanError> ratio_peak;
  std::optional<MeanError> ratio_peak_strain;
  std::optional<MeanError> ratio_end;
  std::optional<MeanError> shear_end;
  std::optional<MeanError> friction_peak;
  std::optional<MeanError> friction_peak_shear;
  std::optional<MeanError> friction_end;
};

/// visit(name, member of means, member of a sample's result) for every number of a stage that means are taken of; the
/// name is that of summaries.
void stage_numbers(auto&& visit) {
  using M = StageMeans;
  using R = StageResult;
  visit("modulus_secant", &M::modulus, &R::modulus, Means{"secant modulus of the stage", "Pa"});
  visit("modulus_stress_from", &M::modulus_from, &R::modulus_from,
        Means{"axial stress at which the interval of the modulus begins", "Pa"});
  visit("modulus_stress_to", &M::modulus_to, &R::modulus_to, Means{"axial stress at which it ends", "Pa"});
  visit("modulus_begin", &M::modulus_begin, &R::modulus_begin, Means{"modulus at the begin of the stage", "Pa"});
  visit("modulus_end", &M::modulus_end, &R::modulus_end, Means{"modulus at the end of the stage", "Pa"});
  visit("poisson_begin", &M::poisson_begin, &R::poisson_begin, Means{"Poisson's ratio at the begin of the stage", "1"});
  visit("axial_strain_end", &M::strain_end, &R::strain_end, Means{"axial strain at the end", "1"});
  visit("volumetric_strain_end", &M::volumetric_end, &R::volumetric_end, Means{"volumetric strain at the end", "1"});
  visit("axial_stress_end", &M::axial_end, &R::axial_end, Means{"axial stress at the end", "Pa"});
  visit("lateral_stress_end", &M::lateral_end, &R::lateral_end, Means{"lateral stress at the end", "Pa"});
  visit("K0_end", &M::lateral_ratio, &R::lateral_ratio,
        Means{"lateral over axial stress at the end of stages that keep the width", "1"});
  visit("q_over_p_peak", &M::ratio_peak, &R::ratio_peak, Means{"largest q/p", "1"});
  visit("axial_strain_at_peak", &M::ratio_peak_strain, &R::ratio_peak_strain,
        Means{"axial strain at the largest q/p", "1"});
  visit("q_over_p_end", &M::ratio_end, &R::ratio_end, Means{"q/p at the end", "1"});
  visit("shear_strain_end", &M::shear_end, &R::shear_end, Means{"shear strain at the end", "1"});
  visit("shear_over_normal_peak", &M::friction_peak, &R::friction_peak,
        Means{"largest shear stress over normal stress", "1"});
  visit("shear_strain_at_peak", &M::friction_peak_shear, &R::friction_peak_shear, Means{"shear strain there", "1"});
  visit("shear_over_normal_end", &M::friction_end, &R::friction_end,
        Means{"shear stress over normal stress at the end", "1"});
}

/// Stresses between which the modulus of a stage is taken, in words without numbers where they are its own: "2 MPa to 5
/// MPa", "upper half of the stress", "first half of the largest stress", "whole stage".
std::string modulus_interval(const StageMeans& stage);

/// A modulus, mean over samples: "650 +- 20 MPa", or "not determined (468 +- 45 MPa, 2 samples)" where they do not tell
/// it from 0.
std::string mean_modulus_text(const MeanError& modulus);

/// "constrained modulus 650 +- 20 MPa from 2.5 MPa to 5 MPa of axial stress (upper half of the stress)", or
/// why it is not determined; empty where the stage has none.
std::string modulus_text(const StageMeans& stage);

/// A tangent modulus of a stage that is to be judged [Pa].
struct NamedTangent {
  std::string stage;
  const char* where = "";  ///< "first" or "last" recorded point
  double value = kNaN;
};

/// What is wrong with tangents below 0, why, and what to do; empty where there are none.
std::string negative_tangents_text(const std::vector<NamedTangent>& tangents, const std::string& of = "");

/// Tangents that no packing can have below 0: at the begin of every stage that is driven, and at the end of those that
/// compress (constrained, bulk). Without those that samples do not tell from 0.
std::vector<NamedTangent> tangents_of(const std::vector<StageMeans>& stages);

std::vector<StageMeans> stage_means(const std::vector<MacroCurve>& curves, const std::string& engine);

/// Share of the largest p below which a point has no strength to speak of.
inline constexpr double kBearingShare = 0.01;

/// What of a test is drawn over one strain. As stages slide, z stands still or dilates: they have a drawing of their
/// own.
enum class StrainPart {
  whole,  ///< everything, over the recorded strain
  axial,  ///< stages that do not slide, over the strain of z
  shear   ///< stages that slide, over their shear strain
};

inline constexpr std::array<StrainPart, 2> kPartsOfStages{StrainPart::axial, StrainPart::shear};

/// The drawings that a test has; of tests in stages a part may have no points.
std::vector<StrainPart> strain_parts(MacroTest test);

/// Recorded points of a part, with the point that each of its stages begins at; empty where a part of stages has fewer
/// than two. Tests that slide as a whole have no axial part.
std::vector<std::size_t> points_of_stages(const MacroCurve& curve, StrainPart part);

/// What a part is drawn over, at all recorded points of the curve.
const std::vector<double>& strain_of_part(const MacroCurve& curve, StrainPart part);

/// The strain of a part in percent, as the label of an axis.
const char* strain_label(StrainPart part, MacroTest test);

/// Strain at the end of a curve: where it ends with a stage that slides, the shear strain, and what it is called.
struct EndStrain {
  double value = kNaN;
  const char* name = "strain";
};
EndStrain strain_at_end(const MacroCurve& curve);

/// The values at these points.
std::vector<double> values_at(const std::vector<double>& values, const std::vector<std::size_t>& points);

/// sigma_z - sigma_x of all recorded points; of stages that slide 2 sigma_xz, the difference of the principal stresses
/// where sigma_x = sigma_z.
std::vector<double> deviators(const MacroCurve& curve);

/// The same as it is drawn over the strain of a part: of stages that slide 2 sigma_xz also at the points that they
/// begin at, which belong to the stages before.
std::vector<double> deviators(const MacroCurve& curve, StrainPart part);

/// q/p of all recorded points; NaN where p is not above this share of its largest value: what bears next to nothing has
/// no strength to speak of. With 0 wherever p is above 0.
std::vector<double> stress_ratios(const MacroCurve& curve, double bearing = kBearingShare);

}  // namespace softgrain

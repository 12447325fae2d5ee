// The law of a soft contact as fitted: a card for people (TOML) and a table for programs (HDF5).
// Everything inside is dimensionless (physics: Fn = E Rs^2 f(Delta), kt = E Rs g(Delta)), so one card serves any E and
// Rs.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/core/law_range.h"
#include "common/core/statistics.h"
#include "common/data/measurements.h"
#include "common/data/pair_kind.h"
#include "common/io/provenance.h"

namespace softgrain {

class Scene;

/// Where 95 % intervals come from, as files and reports say it.
inline constexpr const char* kFromPackings = "bootstrap over packings";
inline constexpr const char* kFromSamples = "bootstrap over samples";  ///< source of the intervals of an experiment
inline constexpr const char* kFromResiduals = "bootstrap of residuals about the law";

/// Begin of the reason of a law whose tangential forces were measured, but say no stiffness.
inline constexpr const char* kNoStiffness = "tangential stiffness: not determined";

/// F(D) = 0 for D < delta, a D^b + c for D >= delta, with c = -a delta^b [SP 1.5]. Dimensionless.
struct ThresholdPowerLaw {
  Estimate a;
  Estimate b;
  Estimate c;
  Estimate delta;

  [[nodiscard]] double value(double overlap_ratio) const;
  [[nodiscard]] double derivative(double overlap_ratio) const;  ///< d value / d Delta, 0 below delta
};

/// How a contact unloads from its deepest Delta_max, and comes back: F = F(Delta_max) [(Delta - Delta_p)/(Delta_max -
/// Delta_p)]^exponent, 0 below Delta_p = delta + residual (Delta_max - delta); see UnloadingBranch. Dimensionless.
struct UnloadingLaw {
  Estimate residual;  ///< from 0 to kLargestResidual; its error holds that of the threshold, see residual_slope()
  Estimate exponent;  ///< at least least_unloading_exponent()
  double correlation = 0.0;  ///< of their errors
  double deepest = 0.0;      ///< mean Delta_max of the unloadings that it was fitted to; 0: not said
  int samples = 0;           ///< samples of which an unloading was fitted
  int points = 0;            ///< readings of unloading and reloading
};

/// How far the threshold takes the residual along, d residual/d delta = -(1 - residual)/(Delta_max - delta): what is
/// left after unloading is measured, Delta_p, and not its share of the depth.
constexpr double residual_slope(double residual, double deepest, double delta) {
  return -(1.0 - residual) / (deepest - delta);
}

/// The mean measured curve behind a law, one entry per Delta. Dimensionless.
struct LawTableRows {
  std::vector<double> delta;
  std::vector<double> force_mean;       ///< Fn/(E Rs^2)
  std::vector<double> force_deviation;  ///< sample standard deviation over packings
  std::vector<double> kt_initial_mean;  ///< kt/(E Rs), initial slope
  std::vector<double> kt_initial_deviation;
  std::vector<double> kt_secant_mean;  ///< kt/(E Rs), secant at PairLaw::secant_angle_deg
  std::vector<double> kt_secant_deviation;
};

/// 95 % band of one fitted curve, by bootstrap. Dimensionless; kept in the table (law.h5), not in the
/// card.
struct LawBandRows {
  std::string law;  ///< "normal", "tangential_initial" or "tangential_secant"
  std::vector<double> low;
  std::vector<double> high;
};

/// Names of the jointly fitted parameters, in the order of PairLaw::covariance.
inline constexpr std::array<const char*, 7> kLawParameterNames{"a_n",         "b_n",        "delta",     "a_t_initial",
                                                               "b_t_initial", "a_t_secant", "b_t_secant"};

/// Choice between the two tangential stiffnesses.
enum class TangentialSlope { initial, secant };

template <>
inline constexpr auto enum_names<TangentialSlope> =
    enum_name_list<TangentialSlope>({{TangentialSlope::initial, "initial"}, {TangentialSlope::secant, "secant"}});

inline constexpr double kThresholdsBelow = 1.0;  ///< limit of the thresholds of pair laws, in Delta
inline constexpr double kLargestDelta =
    2.0;  ///< largest Delta of a pair law: beyond, two bodies have passed each other

/// What was found for one pair kind.
struct PairLaw {
  PairKind kind = PairKind::soft_solid;
  LawStatus status = LawStatus::not_run;
  std::string reason;  ///< one sentence when it is not good
  ThresholdPowerLaw normal;
  ThresholdPowerLaw tangential_initial;  ///< slope at ht = 0, from angles up to initial_angle_deg
  ThresholdPowerLaw tangential_secant;   ///< secant at secant_angle_deg
  double initial_angle_deg = 0.05;
  double secant_angle_deg = kSecantAngle;
  bool has_tangential_initial = false;  ///< whether it was fitted; without both kt is assumed
  bool has_tangential_secant = false;
  /// kt/kn that runs take where neither was fitted; NaN: not said, see assumed_kt_ratio().
  double kt_ratio = std::numeric_limits<double>::quiet_NaN();
  std::optional<UnloadingLaw> unloading{};  ///< empty: not measured, the contact gives back what it took
  std::vector<double> covariance;  ///< 7 x 7 row-major over kLawParameterNames; rows of unfitted parameters are zero
  double delta_min = 0.0;          ///< validity: range of Delta that was fitted
  double delta_max = 0.0;
  Extrapolation beyond = Extrapolation::extrapolate;  ///< what the law does above delta_max
  double max_overlap = 0.0;  ///< largest grain overlap over the smaller radius inside that range
  int packings = 0;
  int points = 0;
  double chi2_per_dof = 0.0;
  double quality = 0.0;  ///< probability of a larger chi^2 (GSL), computed on packing means
  LawTableRows table;
  std::vector<double> band_delta;  ///< Delta of the bands; empty without replicates
  std::vector<LawBandRows> bands;
  std::string band_origin = kFromPackings;  ///< source of the bands and 95 % intervals of this pair
};

inline constexpr const char* kExperiment = "experiment";  ///< value of LawCard::relaxation for an experiment

struct LawCard {
  int schema = 1;
  SoftParticleSpec spec;                   ///< soft particle that was measured for the law
  std::string relaxation;                  ///< name of the relaxation that measured the law, or kExperiment
  TurnProtocol turn = TurnProtocol::slow;  ///< how tangential stiffnesses were measured; not of an experiment
  std::string intervals = kFromPackings;   ///< source of the 95 % intervals, for all pairs together
  std::vector<PairLaw> pairs;
  std::string table_id{};            ///< identifier of the .h5 that belongs to the card; may be empty
  std::vector<std::string> notes{};  ///< remarks from reading: parts of the .h5 that do not match an edited card

  [[nodiscard]] const PairLaw* find(PairKind kind) const;
  /// Whether none of our relaxations measured it, but somebody's experiment.
  [[nodiscard]] bool from_experiment() const { return relaxation == kExperiment; }
};

/// kt/kn of the contact of two elastic spheres at no load along the plane: 2 (1 - nu)/(2 - nu) [Mindlin 1949,
/// doi:10.1115/1.4009973].
constexpr double mindlin_ratio(double poisson_ratio) { return 2.0 * (1.0 - poisson_ratio) / (2.0 - poisson_ratio); }

/// Whether a tangential stiffness was measured.
inline bool has_tangential(const PairLaw& law) { return law.has_tangential_initial || law.has_tangential_secant; }

/// kt over the slope of the normal force where kt was not measured: what the card says, else Mindlin's ratio of its nu
/// (0.3 where that is not known).
double assumed_kt_ratio(const LawCard& card, const PairLaw& law);

/// Whether kt comes from the frozen turn of earlier versions, which lost half to two thirds of the drag at 1 degree.
bool has_frozen_kt(const LawCard& card);

/// "measured with the damped relaxation, kt by a slow turn", "from an experiment".
std::string measured_text(const LawCard& card);

/// Writes `law.toml` (card) and, beside it with extension .h5, the table. Atomic. Throws IoError.
void save_card(const LawCard& card, const std::string& toml_path, const Provenance& provenance = build_provenance());

/// Reads a card (and its table when the .h5 is there). Throws InputError with file:line for wrong content, and when the
/// .h5 is that of another card; IoError for files.
LawCard load_card(const std::string& toml_path);
LawCard load_card(const Scene& file);

}  // namespace softgrain

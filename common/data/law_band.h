// How sure a fitted law is at one overlap: 95 % intervals of its value and slope, from the bootstrap that
// the table beside a card keeps, else by linearised propagation of the covariance in the card.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/data/law_card.h"

namespace softgrain {

enum class LawPart { normal, tangential_initial, tangential_secant };
inline constexpr std::array kAllLawParts{LawPart::normal, LawPart::tangential_initial, LawPart::tangential_secant};

/// "normal", "tangential_initial", "tangential_secant": names in files.
const char* part_name(LawPart part);
const ThresholdPowerLaw& part_of(const PairLaw& law, LawPart part);
/// Whether the part was measured and could be fitted.
bool has_part(const PairLaw& law, LawPart part);

inline constexpr const char* kFromCovariance = "linearised from the covariance";

/// 95 % band of a law, dimensionless, over `delta`.
struct LawBand {
  std::vector<double> delta;
  std::vector<double> low;
  std::vector<double> high;
  std::string origin;  ///< PairLaw::band_origin or kFromCovariance
};

/// The band that was read with the card; empty when there is none.
std::optional<LawBand> stored_band(const PairLaw& law, LawPart part);

/// Linearised 95 % band at the given overlaps, never below zero; empty when the covariance is absent or zero.
std::optional<LawBand> linearised_band(const PairLaw& law, LawPart part, const std::vector<double>& delta);

/// 95 % interval at one overlap.
struct LawInterval {
  double low = 0.0;
  double high = 0.0;
  std::string origin = kFromCovariance;
};

/// 95 % interval of the value F(Delta). It comes from the stored band where that reaches (linear between its points),
/// else from linearisation. Empty when neither exists.
std::optional<LawInterval> value_interval(const PairLaw& law, LawPart part, double delta);

/// 95 % interval of the slope dF/dDelta = a b Delta^(b-1), linearised (never below zero); [0, 0] below the threshold;
/// empty without covariance.
std::optional<LawInterval> slope_interval(const PairLaw& law, LawPart part, double delta);

}  // namespace softgrain

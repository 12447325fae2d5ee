// 95 % error bars of a macro curve, as columns of its own: where they come from, each part by itself and all together.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/data/macro_result.h"

namespace softgrain {

enum class BandPart {
  law,          ///< packings that the law was measured on: draws of its numbers
  discrepancy,  ///< what its form is off by on configurations that no fit saw
  noise,        ///< chaos of paths: what the same run differs by when run again; only where that was run
  all           ///< together, in quadrature
};

template <>
inline constexpr auto enum_names<BandPart> = enum_name_list<BandPart>({{BandPart::law, "law"},
                                                                       {BandPart::discrepancy, "discrepancy"},
                                                                       {BandPart::noise, "noise"},
                                                                       {BandPart::all, "all"}});

enum class BandOf { axial, lateral };

template <>
inline constexpr auto enum_names<BandOf> = enum_name_list<BandOf>({{BandOf::axial, "axial"},
                                                                   {BandOf::lateral, "lateral"}});

/// The stress that a band is about.
const std::vector<double>& banded_stress(const MacroCurve& curve, BandOf of);

/// Low and high [Pa] at every recorded point.
struct MacroBand {
  std::vector<double> low;
  std::vector<double> high;
};

std::optional<MacroBand> band_of(const MacroCurve& curve, BandOf of, BandPart part);
void set_band(MacroCurve& curve, BandOf of, BandPart part, MacroBand band);

/// Independent parts about the stress of the curve: distances on either side in quadrature.
MacroBand together(const std::vector<double>& stress, const std::vector<MacroBand>& parts);

}  // namespace softgrain

#include "common/data/macro_band.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

std::string column(BandOf of, BandPart part, const char* side) {
  return "band_" + to_string(of) + "_" + to_string(part) + "_" + side;
}

}  // namespace

const std::vector<double>& banded_stress(const MacroCurve& curve, BandOf of) {
  return of == BandOf::axial ? curve.stress_axial : curve.stress_lateral;
}

std::optional<MacroBand> band_of(const MacroCurve& curve, BandOf of, BandPart part) {
  const auto low = curve.more.find(column(of, part, "low"));
  const auto high = curve.more.find(column(of, part, "high"));
  if (low == curve.more.end() || high == curve.more.end()) return std::nullopt;
  return MacroBand{low->second, high->second};
}

void set_band(MacroCurve& curve, BandOf of, BandPart part, MacroBand band) {
  curve.more[column(of, part, "low")] = std::move(band.low);
  curve.more[column(of, part, "high")] = std::move(band.high);
}

MacroBand together(const std::vector<double>& stress, const std::vector<MacroBand>& parts) {
  MacroBand out;
  for (std::size_t k = 0; k < stress.size(); ++k) {
    double below = 0.0;
    double above = 0.0;
    for (const MacroBand& p : parts) {
      below += std::pow(std::max(stress[k] - p.low[k], 0.0), 2);
      above += std::pow(std::max(p.high[k] - stress[k], 0.0), 2);
    }
    out.low.push_back(std::max(0.0, stress[k] - std::sqrt(below)));
    out.high.push_back(stress[k] + std::sqrt(above));
  }
  return out;
}

}  // namespace softgrain

#include "common/packing/grading_parts.h"

#include <algorithm>

namespace softgrain {

namespace {

constexpr int kSpheres = 3;

void scale_to(std::vector<SizePiece>& pieces, double share) {
  double all = 0.0;
  for (const SizePiece& p : pieces) all += p.volume;
  for (SizePiece& p : pieces) p.volume *= share / all;
}

}  // namespace

std::vector<SizePiece> pieces_between(const Grading& grading, double low, double high) {
  std::vector<SizePiece> out;
  for (const SizePiece& p : grading.pieces()) {
    if (p.low == p.high) {
      if (p.low >= low && p.low < high) out.push_back(p);
      continue;
    }
    const double from = std::max(low, p.low);
    const double to = std::min(high, p.high);
    if (!(from < to)) continue;
    out.push_back({from, to, p.exponent, p.volume * (p.passing(to, kSpheres) - p.passing(from, kSpheres))});
  }
  std::erase_if(out, [](const SizePiece& p) { return !(p.volume > 0.0); });
  return out;
}

Grading mixture_of(std::vector<SizePiece> coarse, std::vector<SizePiece> fines, double fines_share) {
  scale_to(coarse, 1.0 - fines_share);
  scale_to(fines, fines_share);
  coarse.insert(coarse.end(), fines.begin(), fines.end());
  return Grading::classes(std::move(coarse));
}

Grading sizes_or_power_law(const std::optional<Grading>& sizes, double exponent, double largest, double ratio) {
  return sizes ? *sizes : Grading::power_law(exponent, largest / ratio, largest);
}

}  // namespace softgrain

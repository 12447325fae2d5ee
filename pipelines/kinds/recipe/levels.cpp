#include "pipelines/kinds/recipe/scene.h"

#include <algorithm>
#include <cmath>

#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/packing/grading.h"

namespace softgrain {

namespace {

/// Largest radius of what is measured [m].
constexpr double kUnit = 0.01;

/// Equal shapes get equal numbers, whatever the last digits of their sizes.
double rounded(double x) {
  constexpr double kDigits = 1e11;
  return std::round(x * kDigits) / kDigits;
}

/// Pieces in units where `largest` is kUnit, with volumes that add up to 1.
std::vector<SizePiece> scaled(std::vector<SizePiece> pieces, double largest) {
  double all = 0.0;
  for (const SizePiece& p : pieces) all += p.volume;
  for (SizePiece& p : pieces) {
    p.low = kUnit * rounded(p.low / largest);
    p.high = kUnit * rounded(p.high / largest);
    p.volume = rounded(p.volume / all);
  }
  return pieces;
}

double share_between(const Grading& sizes, double low, double high) {
  double share = 0.0;
  for (const SizePiece& p : pieces_between(sizes, low, high)) share += p.volume;
  return share;
}

}  // namespace

std::vector<double> find_cuts(const Grading& sizes, double ratio, double least_share) {
  const double span = sizes.largest() / sizes.smallest();
  const auto slices = std::max(1.0, std::ceil(std::log(span) / std::log(ratio) - 1e-9));
  std::vector<double> cuts;
  for (double k = 1.0; k < slices; k += 1.0) {
    const double cut = sizes.largest() * std::pow(span, -k / slices);
    const double above = share_between(sizes, cut, cuts.empty() ? kInfinity : cuts.back());
    if (above >= least_share) cuts.push_back(cut);
  }
  if (!cuts.empty() && share_between(sizes, 0.0, cuts.back()) < least_share) cuts.pop_back();
  return cuts;
}

std::vector<RecipeLevel> levels_of(const Grading& sizes, const std::vector<double>& cuts) {
  std::vector<RecipeLevel> levels;
  double high = kInfinity;
  for (std::size_t k = 0; k <= cuts.size(); ++k) {
    const double low = k < cuts.size() ? cuts[k] : 0.0;
    RecipeLevel level{kInfinity, 0.0, 0.0, pieces_between(sizes, low, high)};
    high = low;
    if (level.pieces.empty()) continue;
    for (const SizePiece& p : level.pieces) {
      level.low = std::min(level.low, p.low);
      level.high = std::max(level.high, p.high);
      level.share += p.volume;
    }
    levels.push_back(std::move(level));
  }
  double all = 0.0;
  for (const RecipeLevel& level : levels) all += level.share;
  for (RecipeLevel& level : levels) level.share /= all;
  return levels;
}

Grading slice_of(const RecipeLevel& level) { return Grading::classes(scaled(level.pieces, level.high)); }

Grading pair_of(const RecipeLevel& coarse, const RecipeLevel& fine, double fines_share) {
  std::vector<SizePiece> fines = scaled(fine.pieces, coarse.high);
  return mixture_of(scaled(coarse.pieces, coarse.high), std::move(fines), fines_share);
}

double cut_of_pair(const RecipeLevel& coarse, const RecipeLevel& fine) {
  return 0.5 * (coarse.low + fine.high) / coarse.high;
}

Grading joined(const std::vector<RecipeLevel>& levels, std::size_t first, std::size_t count) {
  std::vector<SizePiece> pieces;
  for (std::size_t k = first; k < std::min(levels.size(), first + count); ++k)
    pieces.insert(pieces.end(), levels[k].pieces.begin(), levels[k].pieces.end());
  return Grading::classes(scaled(std::move(pieces), levels[first].high));
}

double mean_grain_volume(const std::vector<SizePiece>& pieces) {
  return kSphereVolume * Grading::classes(pieces).mean_volume();
}

}  // namespace softgrain

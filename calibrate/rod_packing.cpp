#include "calibrate/rod_packing.h"

#include <gsl/gsl_spline.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// Share of the chords of all spheres that are shorter than `length`; `squares`: mean r^2 of each piece.
double shorter(const std::vector<SizePiece>& pieces, const std::vector<double>& hits,
               const std::vector<double>& squares, double length) {
  const double r = 0.5 * length;
  double share = 0.0;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double longer = r * r * (1.0 - pieces[k].passing(r, 0)) / squares[k];
    share += hits[k] * (pieces[k].passing(r, 2) + longer);
  }
  return share;
}

}  // namespace

std::vector<double> chords_of(const Grading& sizes, std::size_t count) {
  if (count < 2) throw InputError("rods: two or more are needed");
  const std::vector<SizePiece>& pieces = sizes.pieces();
  std::vector<double> hits;  // by lines, of the spheres of each piece
  std::vector<double> squares;
  double all = 0.0;
  for (const SizePiece& piece : pieces) {
    squares.push_back(piece.mean_power(2));
    hits.push_back(piece.volume * squares.back() / piece.mean_power(3));
    all += hits.back();
  }
  for (double& h : hits) h /= all;
  // Shares at lengths of even steps of their logarithm; below the shortest they go as the square of the length.
  constexpr std::size_t kSteps = 4000;
  const double longest = 2.0 * sizes.largest();
  const double fall = std::log(0.02 * sizes.smallest() / sizes.largest());
  std::vector<double> length(kSteps + 1);
  std::vector<double> share(kSteps + 1);
  for (std::size_t i = 0; i <= kSteps; ++i) {
    length[i] = std::exp(fall * (1.0 - static_cast<double>(i) / kSteps));
    share[i] = i == kSteps ? 1.0 : shorter(pieces, hits, squares, length[i] * longest);
  }
  std::vector<double> chords(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double u = 1.0 - (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const auto i = static_cast<std::size_t>(std::lower_bound(share.begin(), share.end(), u) - share.begin());
    chords[k] = i == 0 ? length[0] * std::sqrt(u / share[0])
                       : length[i - 1] + (length[i] - length[i - 1]) * (u - share[i - 1]) / (share[i] - share[i - 1]);
  }
  return chords;
}

double rod_packing(const std::vector<double>& chords, double gap) {
  if (chords.empty() || !(gap > 0.0)) throw InputError("rods: none, or a gap that is not above 0");
  std::priority_queue<double> gaps;
  gaps.push(gap * chords.front());
  double space = gaps.top();
  double rods = chords.front();
  for (std::size_t k = 1; k < chords.size(); ++k) {
    const double widest = gaps.top();
    gaps.pop();
    const double least = gap * chords[k];
    const double rest = std::max(least, widest - least - chords[k]);
    gaps.push(least);
    gaps.push(rest);
    space += least + rest - widest;
    rods += chords[k];
  }
  return rods / (rods + space);
}

struct RodCurve::Spline {
  explicit Spline(std::size_t knots) : spline(gsl_spline_alloc(gsl_interp_cspline, knots)) {}
  Spline(const Spline&) = delete;
  Spline& operator=(const Spline&) = delete;
  ~Spline() { gsl_spline_free(spline); }
  gsl_spline* spline;
};

RodCurve::RodCurve(const Grading& sizes, std::size_t rods) {
  constexpr std::size_t kKnots = 28;
  constexpr double kStep = 1.1;  // of the gap
  const std::vector<double> chords = chords_of(sizes, rods);
  std::vector<double> log_gap;
  std::vector<double> log_void_ratio;
  for (std::size_t k = 0; k < kKnots; ++k) {
    const double gap = kLeastGap * std::pow(kStep, k);
    log_gap.push_back(std::log(gap));
    log_void_ratio.push_back(std::log(1.0 / rod_packing(chords, gap) - 1.0));
  }
  spline_ = std::make_unique<Spline>(kKnots);
  gsl_spline_init(spline_->spline, log_gap.data(), log_void_ratio.data(), kKnots);
}

RodCurve::~RodCurve() = default;
RodCurve::RodCurve(RodCurve&&) noexcept = default;
RodCurve& RodCurve::operator=(RodCurve&&) noexcept = default;

double RodCurve::at(double gap) const {
  const gsl_interp* knots = spline_->spline->interp;
  const double log_gap = std::clamp(std::log(gap), knots->xmin, knots->xmax);
  return 1.0 / (1.0 + std::exp(gsl_spline_eval(spline_->spline, log_gap, nullptr)));
}

}  // namespace softgrain

#include "calibrate/crowd_side_fits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibrate/least_squares.h"

namespace softgrain {

namespace {

/// Mean and scatter of a few values as an estimate.
Estimate mean_of(const std::vector<double>& values, double fallback) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  if (values.empty()) return {fallback, kUnknown, -kUnknown, kUnknown};
  double sum = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  double square = 0.0;
  for (const double v : values) square += (v - mean) * (v - mean);
  const double n = static_cast<double>(values.size());
  const double error = n > 1.0 ? std::sqrt(square / (n * (n - 1.0))) : 0.0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {mean, error, *low, *high};
}

/// d force/d overlap of the first neighbour over E Rs.
double normal_stiffness(const CrowdModel& model, const CrowdConfiguration& c, std::vector<double> overlap) {
  constexpr double kStep = 1e-5;
  overlap[0] += kStep;
  const double up = crowd_forces(model, c.partners, overlap)[0];
  overlap[0] -= 2.0 * kStep;
  return (up - crowd_forces(model, c.partners, overlap)[0]) / (2.0 * kStep);
}

/// The stiffness is the secant at 1 degree of rotation, ht = pi Rs/180, as in the law card.
constexpr double kSecantSlide = std::numbers::pi / 180.0;

struct SlideResult {
  double kt_ratio = 0.0;
  double friction = 0.0;
};

/// Tangential over normal force on the first neighbour, net of what was there before the slide.
double drag(const CrowdState& s, const CrowdState& before) {
  return s.mean[0] > 0.0 ? (s.tangential - before.tangential) / s.mean[0] : 0.0;
}

/// Drag at a slide, linear between recorded states and from nothing at rest.
double drag_at(const std::vector<const CrowdState*>& along, const CrowdState& before, double slide) {
  double last_slide = 0.0;
  double last = 0.0;
  for (const CrowdState* s : along) {
    const double now = drag(*s, before);
    if (s->slide >= slide) return last + (now - last) * (slide - last_slide) / (s->slide - last_slide);
    last_slide = s->slide;
    last = now;
  }
  return last * slide / last_slide;
}

/// From the state before the slide and those along it; false when the configuration does not slide, or nothing holds it
/// back.
bool slide_result(const CrowdStates& c, const CrowdModel& model, SlideResult& out) {
  const CrowdState* before = nullptr;
  std::vector<const CrowdState*> along;
  for (const CrowdState& s : c.states) {
    if (s.slide == 0.0)
      before = &s;
    else if (before != nullptr)
      along.push_back(&s);
  }
  if (along.empty()) return false;
  for (const CrowdState* s : along) out.friction = std::max(out.friction, drag(*s, *before));
  const double kn = normal_stiffness(model, *c.configuration, before->overlap);
  if (!(kn > 0.0) || !(out.friction > 0.0)) return false;
  out.kt_ratio = std::max(drag_at(along, *before, kSecantSlide), 0.0) * before->mean[0] / kSecantSlide / kn;
  return true;
}

/// Means over all configurations of one kind of neighbour that slide; `fallback` when there is none.
SlideLaw slide_law(const std::vector<CrowdStates>& states, const CrowdModel& model, PartnerKind kind,
                   const SlideLaw& fallback) {
  std::vector<double> kt;
  std::vector<double> friction;
  for (const CrowdStates& c : states) {
    SlideResult slide;
    if (c.states.empty() || c.configuration->held_out || !c.all_of(kind) || !slide_result(c, model, slide)) continue;
    kt.push_back(slide.kt_ratio);
    friction.push_back(slide.friction);
  }
  if (kt.empty()) return fallback;
  return {mean_of(kt, 0.0), mean_of(friction, 0.0)};
}

/// States of the retreat that follows the deepest one, every neighbour going back.
std::vector<const CrowdState*> retreat_states(const CrowdStates& c, const CrowdState*& deepest) {
  std::vector<const CrowdState*> out;
  for (const CrowdState& s : c.states) {
    if (deepest == nullptr || s.overlap[0] >= deepest->overlap[0]) {
      if (!out.empty()) break;  // reloaded
      deepest = &s;
    } else if (c.configuration->stages[static_cast<std::size_t>(s.stage)].name == "unload") {
      out.push_back(&s);
    }
  }
  return out;
}

/// s that best gives back a retreat, relative to the law at the deepest state; not above 5.
bool retreat_result(const CrowdStates& c, const CrowdModel& model, double& s) {
  const CrowdState* deepest = nullptr;
  const std::vector<const CrowdState*> states = retreat_states(c, deepest);
  if (states.size() < 3 || !(deepest->mean[0] > 0.0)) return false;
  const auto& partners = c.configuration->partners;
  const double end = crowd_forces(model, partners, deepest->overlap)[0];
  if (!(end > 0.0)) return false;
  LeastSquaresProblem problem;
  problem.residuals = states.size();
  problem.bounds = {{1.0, 5.0}};
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    for (std::size_t k = 0; k < states.size(); ++k) {
      std::vector<double> felt = deepest->overlap;
      for (std::size_t j = 0; j < felt.size(); ++j)
        felt[j] = std::max(felt[j] - p[0] * (felt[j] - states[k]->overlap[j]), 0.0);
      r[k] = crowd_forces(model, partners, felt)[0] / end - states[k]->mean[0] / deepest->mean[0];
    }
    return true;
  };
  LeastSquaresOptions options;
  options.thorough = false;
  s = fit_least_squares(problem, {{1.5}}, options).parameters[0];
  return true;
}

}  // namespace

void fit_sides(const std::vector<CrowdStates>& states, const CrowdModel& model, LawTableEntry& entry) {
  const SlideLaw unknown{mean_of({}, 0.3), mean_of({}, entry.spec.friction)};
  entry.slide_plane = slide_law(states, model, PartnerKind::plane, unknown);
  entry.slide_solid = slide_law(states, model, PartnerKind::solid, entry.slide_plane);
  entry.slide_soft = slide_law(states, model, PartnerKind::soft, entry.slide_solid);
  std::vector<double> retreat;
  for (const CrowdStates& c : states) {
    double s = 1.0;
    if (c.states.empty() || c.configuration->held_out || !c.all_of(PartnerKind::plane)) continue;
    if (retreat_result(c, model, s)) retreat.push_back(s);
  }
  entry.retreat = mean_of(retreat, 1.0);
}

}  // namespace softgrain

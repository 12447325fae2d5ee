#include "calibrate/multi_contact_side_fits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

#include "calibrate/bootstrap.h"
#include "calibrate/least_squares.h"
#include "common/core/few_samples.h"
#include "common/core/random.h"
#include "common/core/statistics.h"
#include "common/data/multi_contact_replicates.h"

namespace softgrain {

namespace {

/// Random numbers of these draws are other ones than those that draw packings.
constexpr std::uint64_t kSideStream = std::uint64_t{1} << 40U;

constexpr double kUnknown = std::numeric_limits<double>::infinity();

Estimate guessed(double value) { return {value, kUnknown, -kUnknown, kUnknown}; }

/// Taken over from another kind of neighbour: nothing is known of how far it is off.
SlideLaw borrowed(const SlideLaw& from) { return {guessed(from.kt_ratio.value), guessed(from.friction.value), false}; }

/// Mean over configurations; each draw takes as many of its own with replacement. `of` finds the values by
/// configuration. Widened for the few packings that there are.
template <class Of>
Estimate estimate_of(const SideValues& measured, const std::vector<SideValues>& drawn, int packings, std::uint64_t seed,
                     const Of& of) {
  Estimate out = guessed(mean_error(of(measured)).mean);
  std::vector<double> means;
  for (std::size_t r = 0; r < drawn.size(); ++r) {
    const std::vector<double>& values = of(drawn[r]);
    if (values.empty()) continue;
    RandomStream random(seed, RandomPurpose::bootstrap, kSideStream + static_cast<std::uint64_t>(r));
    Tally sample;
    for (std::size_t k = 0; k < values.size(); ++k) sample.add(values[random.below(values.size())]);
    means.push_back(sample.mean());
  }
  if (means.size() < kEnoughReplicates) return out;
  const auto [low, high] = interval95(means);
  const double factor = factor_of_several(packings);
  std::tie(out.low, out.high) = widened(out.value, low, high, factor, true);
  out.standard_error = scatter_of(means);
  return out;
}

/// d force/d overlap of the first neighbour over its force, times Rs.
double relative_stiffness(const MultiContactModel& model, const MultiContactConfiguration& c,
                          std::vector<double> overlap) {
  constexpr double kStep = 1e-5;
  const double force = multi_contact_forces(model, c.partners, overlap)[0];
  overlap[0] += kStep;
  const double up = multi_contact_forces(model, c.partners, overlap)[0];
  overlap[0] -= 2.0 * kStep;
  return force > 0.0 ? (up - multi_contact_forces(model, c.partners, overlap)[0]) / (2.0 * kStep * force) : 0.0;
}

/// The stiffness is the secant at 1 degree of rotation, ht = pi Rs/180, as in the law card.
constexpr double kSecantSlide = std::numbers::pi / 180.0;

struct SlideResult {
  double kt_ratio = 0.0;
  double friction = 0.0;
};

/// Tangential over normal force on the first neighbour, net of what was there before the slide.
double drag(const MultiContactState& s, const MultiContactState& before) {
  return s.mean[0] > 0.0 ? (s.tangential - before.tangential) / s.mean[0] : 0.0;
}

/// Drag at a slide, linear between recorded states and from nothing at rest.
double drag_at(const std::vector<const MultiContactState*>& along, const MultiContactState& before, double slide) {
  double last_slide = 0.0;
  double last = 0.0;
  for (const MultiContactState* s : along) {
    const double now = drag(*s, before);
    if (s->slide >= slide) return last + (now - last) * (slide - last_slide) / (s->slide - last_slide);
    last_slide = s->slide;
    last = now;
  }
  return last * slide / last_slide;
}

/// Pressed in first and then slid, nothing after: other paths are not those of the definitions.
bool slides_once(const MultiContactConfiguration& c) {
  return c.stages.size() > 1 && c.stages.back().move == MultiContactMove::slide &&
         std::all_of(c.stages.begin(), c.stages.end() - 1,
                     [](const MultiContactStage& s) { return s.move == MultiContactMove::load; });
}

/// The last state before the first neighbour slides or rolls, and those along its way.
struct MovedStates {
  const MultiContactState* before = nullptr;
  std::vector<const MultiContactState*> along;

  MovedStates(const MultiContactStates& c, double MultiContactState::*moved) {
    for (const MultiContactState& s : c.states) {
      if (s.*moved == 0.0)
        before = &s;
      else if (before != nullptr)
        along.push_back(&s);
    }
  }
};

/// False when the configuration does not slide, or nothing holds it back.
bool slide_result(const MultiContactStates& c, const MultiContactModel& model, SlideResult& out) {
  const auto [before, along] = MovedStates(c, &MultiContactState::slide);
  if (along.empty()) return false;
  for (const MultiContactState* s : along) out.friction = std::max(out.friction, drag(*s, *before));
  const double kn = relative_stiffness(model, *c.configuration, before->overlap);
  if (!(kn > 0.0) || !(out.friction > 0.0)) return false;
  out.kt_ratio = std::max(drag_at(along, *before, kSecantSlide), 0.0) / kSecantSlide / kn;
  return true;
}

/// R of a rolling contact over Rs, see SoftMultiContact: of equal soft particles and against all others 1.
double rolling_radius(const MultiContactPartner& p) {
  return p.kind == PartnerKind::soft ? 2.0 * p.ratio / (1.0 + p.ratio) : 1.0;
}

struct RollResult {
  double stiffness = 0.0;
  double friction = 0.0;
};

/// False when the configuration does not roll, or nothing holds it back.
bool roll_result(const MultiContactStates& c, RollResult& out) {
  const auto [before, along] = MovedStates(c, &MultiContactState::roll);
  if (along.empty()) return false;
  const double radius = rolling_radius(c.configuration->partners.front());
  double last_roll = 0.0;
  double last = 0.0;
  for (const MultiContactState* s : along) {
    const double now = s->moment - before->moment;
    if (s->roll >= kSecantSlide || s == along.back()) {
      const double share = std::min((kSecantSlide - last_roll) / (s->roll - last_roll), 1.0);
      out.stiffness = (last + share * (now - last)) / (last_roll + share * (s->roll - last_roll)) / (radius * radius);
      break;
    }
    last_roll = s->roll;
    last = now;
  }
  constexpr double kFar = 0.4;
  Tally limit;
  for (const MultiContactState* s : along)
    if (s->roll >= kFar * along.back()->roll && s->mean[0] > 0.0)
      limit.add((s->moment - before->moment) / (s->mean[0] * radius), 1.0);
  out.friction = limit.mean();
  return out.stiffness > 0.0 && out.friction > 0.0;
}

/// States of the first retreat, every neighbour going back from where the loading before it ended.
std::vector<const MultiContactState*> unloading_states(const MultiContactStates& c, const MultiContactState*& deepest) {
  std::vector<const MultiContactState*> out;
  for (const MultiContactState& s : c.states) {
    const MultiContactMove move = c.configuration->stages[static_cast<std::size_t>(s.stage)].move;
    if (move == MultiContactMove::unload)
      out.push_back(&s);
    else if (move != MultiContactMove::load || !out.empty())
      break;
    else
      deepest = &s;
  }
  if (deepest == nullptr) out.clear();
  return out;
}

double sum_of(const std::vector<double>& forces) { return std::accumulate(forces.begin(), forces.end(), 0.0); }

/// s that best gives back a retreat, relative to the law at the deepest state; not above 5. False when there is no
/// retreat, or its fit did not come to a minimum.
bool unloading_result(const MultiContactStates& c, const MultiContactModel& model, double& s) {
  const MultiContactState* deepest = nullptr;
  const std::vector<const MultiContactState*> states = unloading_states(c, deepest);
  if (states.size() < 3 || !(sum_of(deepest->mean) > 0.0)) return false;
  const auto& partners = c.configuration->partners;
  const double end = sum_of(multi_contact_forces(model, partners, deepest->overlap));
  if (!(end > 0.0)) return false;
  LeastSquaresProblem problem;
  problem.residuals = states.size();
  problem.bounds = {{1.0, 5.0}};
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    for (std::size_t k = 0; k < states.size(); ++k) {
      std::vector<double> felt = deepest->overlap;
      for (std::size_t j = 0; j < felt.size(); ++j)
        felt[j] = std::max(felt[j] - p[0] * (felt[j] - states[k]->overlap[j]), 0.0);
      r[k] =
          sum_of(multi_contact_forces(model, partners, felt)) / end - sum_of(states[k]->mean) / sum_of(deepest->mean);
    }
    return true;
  };
  LeastSquaresOptions options;
  options.thorough = false;
  const LeastSquaresFit fit = fit_least_squares(problem, {{1.5}}, options);
  s = fit.parameters[0];
  return fit.end == FitEnd::converged;
}

/// Every configuration of one kind of neighbour that slides, rolls or unloads.
SideValues::Slides slides(const std::vector<MultiContactStates>& states, const MultiContactModel& model,
                          PartnerKind kind) {
  SideValues::Slides out;
  for (const MultiContactStates& c : states) {
    if (c.states.empty() || c.configuration->held_out || !c.all_of(kind)) continue;
    SlideResult slide;
    if (slides_once(*c.configuration) && slide_result(c, model, slide)) {
      out.kt_ratio.push_back(slide.kt_ratio);
      out.friction.push_back(slide.friction);
    }
    if (RollResult roll; roll_result(c, roll)) {
      out.rolling.push_back(roll.stiffness);
      out.rolling_friction.push_back(roll.friction);
    }
    if (double s = 1.0; unloading_result(c, model, s)) out.unloading.push_back(s);
  }
  return out;
}

}  // namespace

SideValues side_values(const std::vector<MultiContactStates>& states, const MultiContactModel& model) {
  return {slides(states, model, PartnerKind::plane), slides(states, model, PartnerKind::solid),
          slides(states, model, PartnerKind::soft)};
}

void fit_sides(const SideValues& measured, const std::vector<SideValues>& drawn, std::uint64_t seed,
               LawTableEntry& entry) {
  const auto slide = [&](SideValues::Slides SideValues::*kind, const SlideLaw& fallback) -> SlideLaw {
    if ((measured.*kind).kt_ratio.empty()) return fallback;
    const auto part = [&](std::vector<double> SideValues::Slides::*quantity) {
      return estimate_of(
          measured, drawn, entry.packings,
          seed, [&](const SideValues& v) -> const auto& { return (v.*kind).*quantity; });
    };
    return {part(&SideValues::Slides::kt_ratio), part(&SideValues::Slides::friction)};
  };
  const auto roll = [&](SideValues::Slides SideValues::*kind, SlideLaw& law) {
    law.rolls = !(measured.*kind).rolling.empty();
    if (!law.rolls) return;
    const auto part = [&](std::vector<double> SideValues::Slides::*quantity) {
      return estimate_of(
          measured, drawn, entry.packings,
          seed, [&](const SideValues& v) -> const auto& { return (v.*kind).*quantity; });
    };
    law.rolling = part(&SideValues::Slides::rolling);
    law.rolling_friction = part(&SideValues::Slides::rolling_friction);
  };
  entry.slide_plane = slide(&SideValues::plane, {guessed(0.3), guessed(entry.spec.friction), false});
  entry.slide_solid = slide(&SideValues::solid, borrowed(entry.slide_plane));
  entry.slide_soft = slide(&SideValues::soft, borrowed(entry.slide_solid));
  roll(&SideValues::plane, entry.slide_plane);
  roll(&SideValues::solid, entry.slide_solid);
  roll(&SideValues::soft, entry.slide_soft);
  const auto unloading = [&](SideValues::Slides SideValues::*kind, Estimate& s) {
    if ((measured.*kind).unloading.empty()) return false;
    s = estimate_of(
        measured, drawn, entry.packings, seed, [&](const SideValues& v) -> const auto& { return (v.*kind).unloading; });
    return true;
  };
  entry.unloading = guessed(1.0);
  entry.unloading_measured = unloading(&SideValues::plane, entry.unloading);
  entry.slide_solid.has_unloading = unloading(&SideValues::solid, entry.slide_solid.unloading);
  entry.slide_soft.has_unloading = unloading(&SideValues::soft, entry.slide_soft.unloading);
}

}  // namespace softgrain

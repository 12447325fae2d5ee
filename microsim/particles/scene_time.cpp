#include "microsim/particles/scene_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/dynamics/time_step.h"

namespace softgrain {

namespace {

constexpr double kDefaultFraction = 0.05;
constexpr double kStepsPerImpact = 200.0;
constexpr double kStepsPerReach = 10.0;
constexpr double kMostSteps = 1e12;
constexpr double kForever = std::numeric_limits<double>::infinity();

const Key kStepKey{"step", "time step, or `\"auto\"`", "\"auto\""};

std::string shown(double value) {
  std::ostringstream out;
  out.precision(6);
  out << value;
  return out.str();
}

/// Diagonal of the box that holds all values: no two differ by more.
template <class Vector>
double spread(const std::vector<Vector>& values) {
  if (values.empty()) return 0.0;
  Vector low = values.front();
  Vector high = low;
  for (const Vector& v : values)
    for (int k = 0; k < static_cast<int>(low.v.size()); ++k) {
      low[k] = std::min(low[k], v[k]);
      high[k] = std::max(high[k], v[k]);
    }
  return std::sqrt(norm2(high - low));
}

/// What a constant acceleration leads to by the end, or over a way, whichever is less.
double speed_after(double acceleration, double end, double way) {
  return acceleration > 0.0 ? std::min(acceleration * end, std::sqrt(2.0 * acceleration * way)) : 0.0;
}

/// How much faster images of a body are than itself, over all periodic axes of a deforming cell.
template <int D>
double speed_of_images(const Cell<D>& cell) {
  double sum = 0.0;
  for (int k = 0; k < D; ++k) {
    if (!cell.periodic[static_cast<std::size_t>(k)]) continue;
    Vec<D> edge;
    for (int row = 0; row < D; ++row) edge[row] = cell.edges[row][k];
    sum += norm(cell.velocity_gradient * edge);
  }
  return sum;
}

/// What planes that a load drives towards the particles may reach.
template <int D>
double speed_of_loads(const Particles<D>& p, double end, double way) {
  double sum = 0.0;
  for (Slot w = p.first_plane(); w < p.size(); ++w)
    sum += speed_after(p.plane_load[at(w - p.first_plane())] * p.inverse_mass[at(w)], end, way);
  return sum;
}

template <int D>
double largest_relative_speed(const System<D>& s, double end) {
  std::vector<Vec<D>> places;
  for (const auto& sphere : s.particles.sphere) places.push_back(sphere.x);
  const double way = spread(places);
  return spread(s.particles.velocity) + speed_after(norm(s.gravity), end, way) + speed_of_images(s.cell) +
         speed_of_loads(s.particles, end, way);
}

/// Impact of two equal spheres of radius r and mass 1/inverse_mass under one law.
double impact_time(const AnyLaw& any, double r, double inverse_mass, double speed) {
  const PairBodies bodies{r, r, inverse_mass, inverse_mass};
  return std::visit([&](const auto& law) { return law.impact_time(bodies, speed); }, any);
}

/// Time in which a gap as wide as the shortest attraction closes.
template <int D>
double shortest_reach(const System<D>& s, double end) {
  double reach = kForever;
  for (std::int32_t k = 0; k < s.laws.size(); ++k) {
    const double own = std::visit([](const auto& law) { return reach_of(law); }, s.laws.law(k));
    if (own > 0.0) reach = std::min(reach, own);
  }
  const double speed = largest_relative_speed(s, end);
  return speed > 0.0 ? reach / speed : kForever;
}

/// Limit: StepLimit or SlideLimit.
template <int D, class Limit>
std::string limit_sentence(const Limit& limit, const System<D>& s, const std::vector<std::string>& law_description) {
  const double r = s.particles.sphere[static_cast<std::size_t>(limit.body)].r;
  return "set by particle " + std::to_string(limit.body) + " (radius " + shown(r) + " m) with " +
         law_description[static_cast<std::size_t>(limit.law)];
}

/// Contacts of the start, all that a body has together. `wanted`: the step that is to be judged.
template <int D>
void judge_contacts(const System<D>& s, double wanted, Dashpots dashpots, SceneTime& out) {
  if (!std::isfinite(wanted)) return;
  StableStep stable;
  try {
    stable = stable_step(s, wanted / kLargestStableShare, dashpots);
  } catch (const UnusableResult&) {
    return;  // no state to start from, as the run will say
  }
  out.stable_step = stable.step;
  if (stable.body >= 0)
    out.crowded = "particle " + std::to_string(stable.body) + " has " + std::to_string(stable.contacts) +
                  " contacts, which together are stiffer than one";
}

/// Number of steps that fill the time.
std::int64_t steps_to(const SceneTable& t, double end, double step) {
  const double steps = std::ceil(end / step * (1.0 - 1e-12));
  if (!(steps <= kMostSteps))
    t.throw_error("end", "takes " + shown(steps) + " steps of " + shown(step) + " s, at most " + shown(kMostSteps) +
                             " are allowed");
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(steps));
}

/// Takes the shorter one of two steps, with the sentence that says what set it.
void limit_to(double step, const std::string& sentence, double& wanted, SceneTime& out) {
  if (!(step < wanted)) return;
  wanted = step;
  out.limited_by = sentence;
}

template <int D>
void choose_step(const SceneTable& t, const System<D>& s, double fraction, SceneTime& out) {
  double wanted = kForever;
  limit_to(fraction * out.natural_time, out.stiffest, wanted, out);
  limit_to(kLargestStableShare * out.slide_step,
           shown(kLargestStableShare) + " of the largest stable step of a tangential spring, " + out.gripping, wanted,
           out);
  limit_to(out.contact_time / kStepsPerImpact,
           "set by the shortest impact: 1/" + shown(kStepsPerImpact) + " of " + shown(out.contact_time) + " s", wanted,
           out);
  limit_to(out.reach_time / kStepsPerReach,
           "set by the attraction at a distance: 1/" + shown(kStepsPerReach) + " of the " + shown(out.reach_time) +
               " s in which it is crossed",
           wanted, out);
  limit_to(out.end, "set by the end of the run", wanted, out);
  if (!std::isfinite(wanted)) t.throw_error("step", "\"auto\" needs a contact law that the particles take part in");
  judge_contacts(s, wanted, Dashpots::count, out);
  limit_to(kLargestStableShare * out.stable_step,
           "set by the contacts at the start: " + shown(kLargestStableShare) + " of their largest stable step, " +
               shown(out.stable_step) + " s" + (out.crowded.empty() ? "" : "; " + out.crowded),
           wanted, out);
  if (out.steps > 0) {
    out.step = wanted;
    return;
  }
  out.steps = steps_to(t, out.end, wanted);
  out.step = out.end / static_cast<double>(out.steps);
}

template <int D>
void take_step(const SceneTable& t, const System<D>& s, double largest, SceneTime& out) {
  out.step = t.number(kStepKey, Unit::time, Range::positive());
  out.is_given = true;
  out.limited_by = "given by the scene";
  const double limit = largest * out.natural_time;
  if (out.step > limit)
    t.throw_error("step",
                  "above the stable limit " + shown(limit) + " s = " + shown(largest) + " sqrt(m/k), " + out.stiffest);
  const double sliding = kLargestStableShare * out.slide_step;
  if (out.step > sliding)
    t.throw_error("step", "above the stable limit " + shown(sliding) + " s = " + shown(kLargestStableShare) +
                              " of the largest stable step of a tangential spring, " + out.gripping);
  judge_contacts(s, out.step, Dashpots::leave_out, out);
  const double crowded = kLargestStableShare * out.stable_step;
  if (out.step > crowded)
    t.throw_error("step", "above the stable limit " + shown(crowded) + " s = " + shown(kLargestStableShare) +
                              " of the largest stable step of the contacts at the start: " + out.crowded);
  if (out.steps == 0) out.steps = steps_to(t, out.end, out.step);
}

/// Disks have stiff dashpots, which chatter at longer steps: single contacts at 0.2, whole packs from 0.5 on.
template <int D>
constexpr double largest_fraction() {
  return D == 3 ? kLargestStepFraction : 0.2;
}

/// Either `end` or `steps`; what is not given is left at infinity and 0.
void read_extent(const SceneTable& t, SceneTime& out) {
  if (!t.has("steps")) {
    out.end = t.number({"end", "simulated time; either this or `steps`", "-"}, Unit::time, Range::positive());
    return;
  }
  if (t.has("end")) t.add_error("steps", "give either end or steps, not both");
  out.steps = t.count({"steps", "number of steps, in place of `end`"}, 1, static_cast<std::int64_t>(kMostSteps));
  out.end = kForever;
}

}  // namespace

template <int D>
double shortest_impact(const System<D>& s, double end) {
  const double speed = largest_relative_speed(s, end);
  double shortest = kForever;
  if (!(speed > 0.0)) return shortest;
  for (Slot i = 0; i < s.particles.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    for (std::int32_t m = 0; m < s.laws.materials(); ++m) {
      const std::int32_t law = s.laws.index(s.particles.material[u], m);
      if (law == LawSet::kNoContact) continue;
      shortest =
          std::min(shortest, impact_time(s.laws.law(law), s.particles.sphere[u].r, s.particles.inverse_mass[u], speed));
    }
  }
  return shortest;
}

template <int D>
SceneTime read_time(const SceneTable& t, const System<D>& system, const std::vector<std::string>& law_description,
                    bool valid) {
  SceneTime out;
  read_extent(t, out);
  const double fraction = t.number({"step_fraction",
                                    "with `step = \"auto\"`: step over sqrt(m/k) of the stiffest contact; an impact at "
                                    "the speeds in sight has at least 200 steps"},
                                   Unit::none, Range{0.0, largest_fraction<D>(), true, false}, kDefaultFraction);
  const Key warm_up{"warm_up_steps", "first steps, left out of the measured cost"};
  const bool automatic = !t.has("step") || (t.is_text("step") && t.text(kStepKey) == "auto");
  if (!automatic)
    t.refuse({"step_fraction"}, "goes with step = \"auto\", which follows from it; here the step is given");
  if (!valid || t.has_errors()) {
    if (!automatic) (void)t.number(kStepKey, Unit::time, Range::positive());
    (void)t.count(warm_up, 0, static_cast<std::int64_t>(kMostSteps), 0);
    return out;
  }
  const StepLimit limit = step_limit(system);
  out.natural_time = limit.body >= 0 ? limit.natural_time : kForever;
  if (limit.body >= 0) out.stiffest = limit_sentence(limit, system, law_description);
  const SlideLimit slide = slide_limit(system);
  out.slide_step = slide.step;
  if (slide.body >= 0) out.gripping = limit_sentence(slide, system, law_description);
  out.contact_time = shortest_impact(system, out.end);
  out.reach_time = shortest_reach(system, out.end);
  out.stable_step = kForever;
  if (automatic)
    choose_step(t, system, fraction, out);
  else
    take_step(t, system, largest_fraction<D>(), out);
  if (!std::isfinite(out.end)) out.end = static_cast<double>(out.steps) * out.step;
  out.warm_up_steps = t.count(warm_up, 0, out.steps - 1, 0);
  return out;
}

template double shortest_impact<2>(const System<2>&, double);
template double shortest_impact<3>(const System<3>&, double);
template SceneTime read_time<2>(const SceneTable&, const System<2>&, const std::vector<std::string>&, bool);
template SceneTime read_time<3>(const SceneTable&, const System<3>&, const std::vector<std::string>&, bool);

}  // namespace softgrain

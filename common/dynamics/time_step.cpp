#include "common/dynamics/time_step.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace softgrain {

namespace {

/// Overlap in units of the shell radius at which soft contacts are judged: near the end of their measured range.
constexpr double kSoftOverlap = 0.35;

/// The sums of a body pressed from six sides like this, the common case; whichever of the two is soft.
template <class Law>
MultiContactSum<3> crowded(const Law& law, ContactState<3> state) {
  MultiContactSum<3> sum;
  for (int side = 0; side < 6; ++side) {
    state.normal = {};
    state.normal[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
    law.share(state, law.i_is_soft, sum);
  }
  law.finish(sum);
  return sum;
}

struct ContactStiffness {
  double along = 0.0;   ///< of the normal spring, or more where another one sets a shorter step [N/m]
  double across = 0.0;  ///< of a tangential spring that is stiffer than the normal one, else 0 [N/m]
};

/// The stiffest of a contact, with which it loads or begins to unload. Springs of rolling are set by hand, and may be
/// as stiff as a scene likes: K_r m/I, I = 2/5 m r^2.
template <class Law>
ContactStiffness stiffness_of(const Law& law, const ContactState<3>& state, double radius) {
  const ContactResponse<3> r = steepest_response(law, state);
  ContactStiffness out{r.normal_stiffness, 0.0};
  if (has_grip(law) && r.tangential_stiffness > r.normal_stiffness) out.across = r.tangential_stiffness;
  if constexpr (Law::traits.has_rolling && !Law::traits.is_fitted)
    out.along = std::max(out.along, 2.5 * r.rolling_stiffness / (radius * radius));
  return out;
}

ContactStiffness stiffness_of(const AnyLaw& any, double radius, double inverse_mass, double overlap_ratio) {
  return std::visit(
      [&]<class Law>(const Law& law) -> ContactStiffness {
        ContactState<3> state;
        state.overlap = radius * (Law::traits.is_fitted ? kSoftOverlap : overlap_ratio);
        state.normal = {{1.0, 0.0, 0.0}};
        state.radius_i = state.radius_j = radius;
        state.constants = law.pair_constants({radius, radius, inverse_mass, inverse_mass});
        if constexpr (Law::traits.needs_particle_pass) {
          const MultiContactSum<3> sum = crowded(law, state);
          state.sum_i = state.sum_j = &sum;
          return stiffness_of(law, state, radius);
        } else if constexpr (Law::traits.acts_at_distance) {
          return {law.stiffest(radius), 0.0};
        } else {
          // Beyond the end of a clamped law the force stays and the way back grows: there it is less steep.
          if constexpr (Law::traits.has_unloading && Law::traits.has_onset)
            state.overlap = std::min(state.overlap, law.range.clamp_at() * state.constants.a);
          return stiffness_of(law, state, radius);
        }
      },
      any);
}

/// work(body, law, stiffness) for every body that forces move and every law that its material takes part in.
template <int D, class Work>
void for_pairings(const System<D>& s, double overlap_ratio, Work&& work) {
  const auto& p = s.particles;
  for (Slot i = 0; i < p.grains + p.shells; ++i) {
    const auto u = static_cast<std::size_t>(i);
    if (!(p.inverse_mass[u] > 0.0)) continue;
    for (std::int32_t m = 0; m < s.laws.materials(); ++m) {
      const std::int32_t law = s.laws.index(p.material[u], m);
      if (law == LawSet::kNoContact) continue;
      work(i, law, stiffness_of(s.laws.law(law), p.sphere[u].r, p.inverse_mass[u], overlap_ratio));
    }
  }
}

}  // namespace

template <int D>
StepLimit step_limit(const System<D>& s, double overlap_ratio) {
  StepLimit limit;
  double smallest = 0.0;
  for_pairings(s, overlap_ratio, [&](Slot i, std::int32_t law, const ContactStiffness& k) {
    const double t2 = 1.0 / (s.particles.inverse_mass[static_cast<std::size_t>(i)] * k.along);
    if (limit.body >= 0 && t2 >= smallest) return;
    smallest = t2;
    limit = {std::sqrt(t2), i, law, k.along};
  });
  return limit;
}

template <int D>
SlideLimit slide_limit(const System<D>& s, double overlap_ratio) {
  SlideLimit limit;
  const auto& p = s.particles;
  for_pairings(s, overlap_ratio, [&](Slot i, std::int32_t law, const ContactStiffness& k) {
    const auto u = static_cast<std::size_t>(i);
    const double r = p.sphere[u].r;
    const double step = 1.0 / std::sqrt(k.across * (p.inverse_mass[u] + r * r * p.inverse_inertia[u]));
    if (step < limit.step) limit = {step, i, law};
  });
  return limit;
}

template StepLimit step_limit<2>(const System<2>&, double);
template StepLimit step_limit<3>(const System<3>&, double);
template SlideLimit slide_limit<2>(const System<2>&, double);
template SlideLimit slide_limit<3>(const System<3>&, double);

}  // namespace softgrain

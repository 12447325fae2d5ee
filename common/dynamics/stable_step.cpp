#include "common/dynamics/time_step.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/dynamics/pair_loop.h"
#include "common/neighbours/spatial_order.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

/// A contact as springs and dashpots along and across its normal.
template <int D>
struct Joint {
  std::size_t i = 0;
  std::size_t j = 0;
  Vec<D> normal{};
  double arm_i = 0.0;
  double arm_j = 0.0;
  double kn = 0.0;        ///< [N/m]
  double kt = 0.0;        ///< twice the tangential stiffness, see stable_step [N/m]
  double eta = 0.0;       ///< damping constant in both directions [N s/m]
  double roll = 0.0;      ///< twice the stiffness of rolling, likewise [N m]
  double roll_eta = 0.0;  ///< damping constant of rolling [N m s]
};

/// What a law answers to a contact that does not move but for a normal speed of 1, which shows its dashpot.
template <class Source, class Pair, class Law, int D = Source::kDimension>
Joint<D> joint_of(const Source& source, const Law& law, std::size_t c, const Pair& pair, const ContactGeometry<D>& g,
                  Dashpots dashpots) {
  Joint<D> out{pair.i, pair.j, g.normal, g.arm_i, g.arm_j};
  ContactState<D> state = source.template state<Law::traits>(pair, c, g);
  state.normal_speed = 1.0;
  state.spring = {};
  if constexpr (Law::traits.needs_particle_pass) source.give_sums(pair, state);
  const ContactResponse<D> r = steepest_response(law, state);
  out.kn = std::max(r.normal_stiffness, 0.0);
  out.kt = has_grip(law) ? 2.0 * r.tangential_stiffness : 0.0;
  out.eta = dashpots == Dashpots::count ? std::max(r.elastic_force - r.normal_force, 0.0) : 0.0;
  if constexpr (Law::traits.has_rolling) out.roll = 2.0 * r.rolling_stiffness;
  if constexpr (requires { law.rolling_dashpot(out.eta, state.constants); })
    out.roll_eta = law.rolling_dashpot(out.eta, state.constants);
  return out;
}

/// work(joint) for every contact.
template <int D, class Work>
void for_joints(const System<D>& s, Dashpots dashpots, Work&& work) {
  for (const ContactSection& section : s.contacts.sections)
    with_pairs<D>(s, section, [&](const auto& law, const auto& source) {
      visit_pairs(
          source, 0.0, {section.begin, section.end},
          [&](std::size_t c, const auto& pair, const ContactGeometry<D>& g) {
            work(joint_of(source, law, c, pair, g, dashpots));
          },
          [](std::size_t) {});
    });
}

/// Where rk h^2/4 + rc h = 1.
double step_of(double rk, double rc) {
  const double sum = rc + std::sqrt(rc * rc + rk);
  return sum > 0.0 ? 2.0 / sum : std::numeric_limits<double>::infinity();
}

/// Sums over the contacts of a body. Two bodies share what a contact's ends do to each other: |a - b|^2 <= 2 |a|^2 +
/// 2 |b|^2 along the normal, and with both rotations 4 of each across it.
struct Sums {
  double push_k = 0.0;
  double push_c = 0.0;
  double turn_k = 0.0;
  double turn_c = 0.0;
  std::int64_t contacts = 0;
};

/// The least step over all bodies that their sums allow.
template <int D>
StableStep bound(const System<D>& s, Dashpots dashpots) {
  const auto& p = s.particles;
  std::vector<Sums> sums(p.sphere.size());
  for_joints(s, dashpots, [&](const Joint<D>& joint) {
    const double across = joint.kt > 0.0 ? 4.0 : 0.0;
    for (const auto& [u, arm] : {std::pair{joint.i, joint.arm_i}, std::pair{joint.j, joint.arm_j}}) {
      sums[u].push_k += std::max(2.0 * joint.kn, across * joint.kt);
      sums[u].push_c += std::max(2.0, across) * joint.eta;
      sums[u].turn_k += across * joint.kt * arm * arm + 2.0 * joint.roll;
      sums[u].turn_c += across * joint.eta * arm * arm + 2.0 * joint.roll_eta;
      ++sums[u].contacts;
    }
  });
  StableStep out;
  for (std::size_t u = 0; u < sums.size(); ++u) {
    const double push = step_of(sums[u].push_k * p.inverse_mass[u], sums[u].push_c * p.inverse_mass[u]);
    const double turn = step_of(sums[u].turn_k * p.inverse_inertia[u], sums[u].turn_c * p.inverse_inertia[u]);
    if (!(std::min(push, turn) < out.step)) continue;
    out = {std::min(push, turn), static_cast<Slot>(u), sums[u].contacts};
  }
  return out;
}

/// The mode of the network that breaks first, by power iteration. Motion is in units of the roots of the masses, so
/// that all is symmetric.
template <int D>
class Network {
 public:
  Network(const System<D>& s, Dashpots dashpots) {
    const auto& p = s.particles;
    for_joints(s, dashpots, [&](const Joint<D>& joint) { joints_.push_back(joint); });
    for (std::size_t u = 0; u < p.sphere.size(); ++u) {
      root_.push_back(std::sqrt(p.inverse_mass[u]));
      turn_root_.push_back(std::sqrt(p.inverse_inertia[u]));
    }
    push_.resize(root_.size());
    turn_.resize(root_.size());
  }

  StableStep run() {
    constexpr int kMost = 500;
    constexpr int kPatience = 10;
    constexpr double kSettled = 1e-3;
    start();
    double step = std::numeric_limits<double>::infinity();
    double before = step;
    for (int k = 0; k < kMost; ++k) {
      step = iterate(step);
      if (k % kPatience != kPatience - 1) continue;
      if (before - step < kSettled * step) break;
      before = step;
    }
    return describe(step);
  }

 private:
  /// Anything that no mode is at right angles to.
  void start() {
    double phase = 0.0;
    const auto next = [&phase] {
      phase = std::fmod(phase + 0.6180339887498949, 1.0);
      return phase - 0.5;
    };
    for (std::size_t u = 0; u < root_.size(); ++u) {
      for (double& x : push_[u].v) x = root_[u] > 0.0 ? next() : 0.0;
      for (double& x : turn_[u].v) x = turn_root_[u] > 0.0 ? next() : 0.0;
    }
    normalise();
  }

  void normalise() {
    double sum = 0.0;
    for (std::size_t u = 0; u < root_.size(); ++u) sum += norm2(push_[u]) + norm2(turn_[u]);
    const double scale = sum > 0.0 ? 1.0 / std::sqrt(sum) : 0.0;
    for (std::size_t u = 0; u < root_.size(); ++u) {
      push_[u] *= scale;
      turn_[u] *= scale;
    }
  }

  /// How the ends of a joint move against each other.
  [[nodiscard]] Vec<D> slip(const Joint<D>& o) const {
    const Rot<D> turn = turn_[o.i] * (turn_root_[o.i] * o.arm_i) + turn_[o.j] * (turn_root_[o.j] * o.arm_j);
    return push_[o.i] * root_[o.i] - push_[o.j] * root_[o.j] - cross(turn, o.normal);
  }

  [[nodiscard]] Rot<D> rolled(const Joint<D>& o) const {
    return turn_[o.i] * turn_root_[o.i] - turn_[o.j] * turn_root_[o.j];
  }

  /// One application of K h^2/4 + C h, h the step of the vector as it is; returns that.
  double iterate(double last) {
    double rk = 0.0;
    double rc = 0.0;
    for (const Joint<D>& o : joints_) {
      const Vec<D> v = slip(o);
      const double along = dot(v, o.normal) * dot(v, o.normal);
      const double across = norm2(v) - along;
      rk += o.kn * along + o.kt * across + o.roll * norm2(rolled(o));
      rc += o.eta * (o.kt > 0.0 ? along + across : along) + o.roll_eta * norm2(rolled(o));
    }
    const double step = std::min(step_of(rk, rc), last);
    if (std::isfinite(step)) apply(0.25 * step * step, step);
    return step;
  }

  void apply(double of_stiffness, double of_damping) {
    std::vector<Vec<D>> push(push_.size());
    std::vector<Rot<D>> turn(turn_.size());
    for (const Joint<D>& o : joints_) {
      const Vec<D> v = slip(o);
      const Vec<D> along = o.normal * dot(v, o.normal);
      const Vec<D> sheared = (v - along) * (o.kt > 0.0 ? of_stiffness * o.kt + of_damping * o.eta : 0.0);
      const Vec<D> force = along * (of_stiffness * o.kn + of_damping * o.eta) + sheared;
      const Rot<D> moment = cross(o.normal, sheared);
      const Rot<D> rolling = rolled(o) * (of_stiffness * o.roll + of_damping * o.roll_eta);
      push[o.i] += force * root_[o.i];
      push[o.j] -= force * root_[o.j];
      turn[o.i] += (rolling - moment * o.arm_i) * turn_root_[o.i];
      turn[o.j] -= (rolling + moment * o.arm_j) * turn_root_[o.j];
    }
    push_.swap(push);
    turn_.swap(turn);
    normalise();
  }

  [[nodiscard]] StableStep describe(double step) const {
    StableStep out{step, -1, 0};
    double most = 0.0;
    for (std::size_t u = 0; u < root_.size(); ++u) {
      const double moves = norm2(push_[u]) + norm2(turn_[u]);
      if (!(moves > most)) continue;
      most = moves;
      out.body = static_cast<Slot>(u);
    }
    for (const Joint<D>& o : joints_)
      for (const std::size_t u : {o.i, o.j}) out.contacts += static_cast<Slot>(u) == out.body ? 1 : 0;
    return out;
  }

  std::vector<Joint<D>> joints_;
  std::vector<double> root_;       ///< root of the inverse mass, per body
  std::vector<double> turn_root_;  ///< root of the inverse inertia, per body
  std::vector<Vec<D>> push_;
  std::vector<Rot<D>> turn_;
};

}  // namespace

template <int D>
StableStep stable_step(const System<D>& system, double enough, Dashpots dashpots) {
  System<D> s = system;
  const std::vector<Slot> order = spatial_order(s);  // many sweeps over the contacts: neighbours near in memory
  reorder_grains(s, order);
  update_neighbours(s);
  particle_pass(s);
  StableStep out = bound(s, dashpots);
  if (out.step < enough) out = Network<D>(s, dashpots).run();
  if (out.body >= 0 && out.body < s.particles.grains) out.body = order[static_cast<std::size_t>(out.body)];
  return out;
}

template StableStep stable_step<2>(const System<2>&, double, Dashpots);
template StableStep stable_step<3>(const System<3>&, double, Dashpots);

}  // namespace softgrain

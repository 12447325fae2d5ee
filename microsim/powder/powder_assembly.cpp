#include "microsim/powder/powder_assembly.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/core/error.h"
#include "common/dynamics/force_pass.h"

namespace softgrain {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double total_mass(const System<2>& s) {
  double mass = 0.0;
  for (const double m : s.particles.inverse_mass) mass += 1.0 / m;
  return mass;
}

double time_step(const System<2>& s, const PowderSpec& spec, const PowderOptions& options) {
  const double lightest = 1.0 / *std::max_element(s.particles.inverse_mass.begin(), s.particles.inverse_mass.end());
  return options.step * std::sqrt(lightest / spec.stiffness);
}

StressControl<2> control_of(const PowderState& state, const PowderPhase& phase, const PowderOptions& options) {
  StressControl<2> control;
  control.imposed = {{phase.pressure, phase.pressure}};
  control.reference_length = state.phase_edge;
  control.cell_mass = phase.fixed_cell ? kInfinite
                                       : options.cell_mass * total_mass(state.system) /
                                             std::sqrt(state.phase_edge[0] * state.phase_edge[1]);
  control.strain_rate_cap = phase.strain_rate_cap > 0.0 ? phase.strain_rate_cap : kInfinite;
  return control;
}

/// The criteria that do not hold, for people.
std::string unmet(const PowderResidual<2>& r, const PowderPhase& phase, bool together) {
  std::string text;
  const auto add = [&](const char* what, double value) {
    if (value < 1.0) return;
    text += (text.empty() ? "" : ", ") + std::string(what) + " " + std::to_string(value) + " times its limit";
  };
  add("net force", r.force);
  add("net moment", r.moment);
  add("pressure error", r.pressure);
  add("kinetic energy", r.kinetic);
  if (phase.one_aggregate && !together) text += (text.empty() ? "" : ", ") + std::string("more than one aggregate");
  return "phase " + phase.name + ": " + text;
}

PowderPoint point_of(const PowderState& state, const PowderSpec& spec, const Vec<2>& stress,
                     const PowderResidual<2>& r) {
  const PowderContacts c = powder_contacts(state.system, 1e-4, spec.cohesive);
  return {state.phase,
          state.system.time,
          powder_fraction(state.system),
          c.coordination,
          r.kinetic * kPowderKineticLimit * spec.force_scale(),
          stress};
}

/// Drag of the disks that are held: without rolling resistance those that hang by one contact, alone or with others
/// behind them, roll on until they meet a second one.
std::vector<double> drag_of(const System<2>& s, double drag, bool rolling) {
  std::vector<double> out(s.particles.sphere.size(), drag);
  if (rolling) return out;
  const std::vector<bool> loose = powder_rattlers(s);
  for (std::size_t u = 0; u < loose.size(); ++u)
    if (loose[u]) out[u] = 0.0;
  return out;
}

class Phase {
 public:
  Phase(PowderState& state, const PowderSpec& spec, const PowderPhase& phase, const PowderOptions& options)
      : state_(state),
        spec_(spec),
        phase_(phase),
        options_(options),
        control_(control_of(state, phase, options)),
        integrator_(time_step(state.system, spec, options), control_) {}

  /// Empty when the phase came to rest, else why not.
  std::string run(const std::function<void(const PowderState&)>& observer) {
    integrator_.initialise(state_.system);
    look();
    double next = state_.points.empty() ? 0.0 : state_.points.back().time + options_.record_every;
    for (bool first = true;; first = false) {
      look();
      if (!std::isfinite(residual_.kinetic)) throw NotUsable("powder: the motion diverged in phase " + phase_.name);
      const bool done = !first && at_rest();
      if (state_.system.time >= next || done) {
        state_.points.push_back(point_of(state_, spec_, integrator_.stress(), residual_));
        next = state_.system.time + options_.record_every;
        observer(state_);
        integrator_.initialise(state_.system);  // as a run does that goes on from here
      }
      if (done) return "";
      if (state_.system.time - state_.phase_start > options_.time_max)
        return unmet(residual_, phase_, one_aggregate(state_.system));
      settle();
      integrator_.advance(state_.system, options_.test_every);
    }
  }

  [[nodiscard]] const PowderResidual<2>& residual() const { return residual_; }
  [[nodiscard]] const Vec<2>& stress() const { return integrator_.stress(); }

 private:
  void look() {
    residual_ = powder_residual(state_.system, control_.imposed, integrator_.stress(), spec_.force_scale(), 1.0,
                                !phase_.fixed_cell);
  }
  /// Notes since when the cell keeps its lengths.
  void watch_cell() {
    constexpr double kStill = 1e-5;
    const auto& edges = state_.system.cell.edges;
    bool still = true;
    for (int k = 0; k < 2; ++k) still = still && std::abs(edges[k][k] - state_.still_edge[k]) <= kStill * edges[k][k];
    if (still) return;
    state_.still_edge = {{edges[0][0], edges[1][1]}};
    state_.still_since = state_.system.time;
  }
  /// Drag sets in when all has come together, and is taken off when something moves again.
  void settle() {
    constexpr double kHysteresis = 10.0;
    constexpr double kCell = 20.0;
    watch_cell();
    const double margin = state_.settling ? kHysteresis : 1.0;
    state_.settling = residual_.kinetic * kPowderKineticLimit < margin * options_.settle_kinetic &&
                      (phase_.fixed_cell || state_.system.time - state_.still_since >= options_.settle_after) &&
                      (!phase_.one_aggregate || state_.settling || one_aggregate(state_.system));
    if (state_.settling && options_.settle_drag > 0.0)
      integrator_.set_drag(kCell * options_.settle_drag, drag_of(state_.system, options_.settle_drag, spec_.rolling));
    else
      integrator_.set_drag(0.0, {});
  }
  [[nodiscard]] bool at_rest() const {
    return residual_.equilibrium() && (!phase_.one_aggregate || one_aggregate(state_.system));
  }

  PowderState& state_;
  const PowderSpec& spec_;
  const PowderPhase& phase_;
  const PowderOptions& options_;
  StressControl<2> control_;
  StressCellVerlet<2> integrator_;
  PowderResidual<2> residual_;
};

}  // namespace

std::vector<PowderPhase> powder_phases(const PowderSpec& spec, int method, double cap) {
  if (method == 1) return {{"compaction", false, false, spec.stress(), cap}};
  std::vector<PowderPhase> phases{{"aggregation", true, true, 0.0, 0.0}, {"free", false, false, 0.0, cap}};
  if (spec.stress() > 0.0) phases.push_back({"load", false, false, spec.stress(), cap});
  return phases;
}

PowderState start_powder(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  PowderState state;
  state.system = make_powder(spec, seed, sample);
  state.phase_edge = {{state.system.cell.edges[0][0], state.system.cell.edges[1][1]}};
  return state;
}

bool one_aggregate(const System<2>& s) {
  const auto n = static_cast<std::size_t>(s.particles.grains);
  std::vector<std::size_t> root(n);
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  std::size_t parts = n;
  for (const ContactRecord<2>& c : contact_records(s)) {
    const std::size_t a = find(static_cast<std::size_t>(c.i));
    const std::size_t b = find(static_cast<std::size_t>(c.j));
    if (a == b) continue;
    root[a] = b;
    --parts;
  }
  return parts <= 1;
}

PowderResult run_powder(PowderState& state, const PowderSpec& spec, const std::vector<PowderPhase>& phases,
                        const PowderOptions& options, const std::function<void(const PowderState&)>& observer) {
  PowderResult result;
  result.usable = true;
  while (state.phase < static_cast<std::int64_t>(phases.size())) {
    Phase phase(state, spec, phases[static_cast<std::size_t>(state.phase)], options);
    result.reason = phase.run(observer);
    result.residual = phase.residual();
    result.stress = phase.stress();
    if (!result.reason.empty()) {
      result.usable = false;
      break;
    }
    ++state.phase;
    state.phase_start = state.still_since = state.system.time;
    state.settling = false;
    state.phase_edge = {{state.system.cell.edges[0][0], state.system.cell.edges[1][1]}};
  }
  result.fraction = powder_fraction(state.system);
  result.contacts = powder_contacts(state.system, spec.rolling ? 1e-2 : 1e-4, spec.cohesive);
  return result;
}

}  // namespace softgrain

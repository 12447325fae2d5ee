#include "microsim/powder/powder_assembly.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/text.h"
#include "common/dynamics/force_pass.h"
#include "common/io/interrupt.h"
#include "common/neighbours/verlet_list.h"
#include "microsim/powder/powder_rigidity.h"

namespace softgrain {

namespace {

double total_mass(const System<2>& s) {
  double mass = 0.0;
  for (const double m : s.particles.inverse_mass) mass += 1.0 / m;
  return mass;
}

double time_step(const PowderState& state, const PowderOptions& options) {
  const auto& inverse_mass = state.system.particles.inverse_mass;
  const double lightest = 1.0 / *std::max_element(inverse_mass.begin(), inverse_mass.end());
  return options.step * std::sqrt(lightest / state.stiffness);
}

/// The law of another stiffness; the list of pairs and their histories stay as they are.
void install_law(PowderState& state, PowderSpec spec, double kappa) {
  spec.stiffness = kappa;
  state.system.laws = LawSet(1);
  state.system.laws.set(0, 0, powder_law(spec));
  ContactList<2>& list = state.system.contacts;
  const auto springs = list.spring;
  const auto memories = list.memory;
  adopt_list(state.system);
  list.spring = springs;
  list.memory = memories;
  state.stiffness = kappa;
}

StressControl<2> control_of(const PowderState& state, const PowderPhase& phase, const PowderOptions& options) {
  StressControl<2> control;
  control.imposed = {{phase.pressure, phase.pressure}};
  control.reference_length = state.phase_edge;
  control.cell_mass = phase.fixed_cell ? kInfinity : options.cell_inertia * total_mass(state.system);
  control.edge_speed_cap = phase.edge_speed_cap > 0.0 ? phase.edge_speed_cap : kInfinity;
  return control;
}

/// The criteria that do not hold, for people.
std::string unmet(const PowderResidual& r, const PowderPhase& phase, bool together) {
  std::string text;
  const auto add = [&](const char* what, double value) {
    if (value < 1.0) return;
    append_part(text, std::string(what) + " " + std::to_string(value) + " times its limit", ", ");
  };
  add("net force", r.force);
  add("net moment", r.moment);
  add("pressure error", r.pressure);
  add("kinetic energy", r.kinetic);
  if (phase.one_aggregate && !together) append_part(text, "more than one aggregate", ", ");
  return "phase " + phase.name + ": " + text;
}

/// Kinetic energy per disk relative to the moving cell, of all disks.
double mean_kinetic(const System<2>& s) {
  const auto& p = s.particles;
  double sum = 0.0;
  for (std::size_t u = 0; u < p.sphere.size(); ++u) {
    Vec<2> v = p.velocity[u];
    for (int k = 0; k < 2; ++k) v[k] -= s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
    sum += 0.5 * norm2(v) / p.inverse_mass[u] + 0.5 * p.spin[u][0] * p.spin[u][0] / p.inverse_inertia[u];
  }
  return sum / static_cast<double>(p.sphere.size());
}

PowderPoint point_of(const PowderState& state, const PowderSpec& spec, const Vec<2>& stress) {
  const PowderContacts c = powder_contacts(state.system, kPowderZeroForce, spec.cohesive);
  return {state.phase,    state.system.time,          powder_fraction(state.system),
          c.coordination, mean_kinetic(state.system), stress};
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

PowderStage stage_of(const PowderState& state, const PowderSpec& spec, const PowderPhase& phase) {
  const PowderContacts c = powder_contacts(state.system, kPowderZeroForce, spec.cohesive);
  const auto moduli = powder_moduli(state.system, powder_interactions(state.system, kPowderZeroForce));
  return {.phase = state.phase,
          .pressure = phase.pressure,
          .time = state.system.time,
          .fraction = powder_fraction(state.system),
          .coordination = c.coordination,
          .mean_repulsive = c.mean_repulsive,
          .mean_tensile = c.mean_tensile,
          .bulk = moduli ? moduli->bulk : kNaN,
          .shear = moduli ? moduli->shear : kNaN};
}

constexpr const char* kDoing = "bringing disks together";

class Phase {
 public:
  Phase(PowderState& state, const PowderSpec& spec, const PowderPhase& phase, const PowderOptions& options)
      : state_(state),
        spec_(spec),
        phase_(phase),
        options_(options),
        control_(control_of(state, phase, options)),
        integrator_(time_step(state, options), control_) {}

  /// Empty when the phase came to rest, else why not.
  std::string run(const RunKeeper<PowderState>& keeper, std::size_t phases) {
    integrator_.initialise(state_.system);
    double next = state_.points.empty() ? 0.0 : state_.points.back().time + options_.record_every;
    for (;;) {
      stop_if_interrupted(kDoing);
      look();
      if (!std::isfinite(residual_.kinetic))
        throw UnusableResult("powder: the motion diverged in phase " + phase_.name);
      const bool done = elapsed() > 0.0 && !stiffening() && at_rest();
      if (!recorded()) picture(done);  // a run that goes on from here has been pictured before it was saved
      if ((state_.system.time >= next || done) && !recorded()) {
        state_.points.push_back(point_of(state_, spec_, integrator_.stress()));
        next = state_.system.time + options_.record_every;
        keeper.at_point(state_, share_done(phases), kDoing);
        integrator_.initialise(state_.system);  // as a run does that goes on from here
      }
      if (done) return "";
      if (elapsed() > options_.time_max + phase_.stiffening)
        return unmet(residual_, phase_, one_aggregate(state_.system));
      settle();
      integrator_.advance(state_.system, stiffen());
    }
  }

  /// Residual and stress of the state as it is.
  void examine() {
    integrator_.initialise(state_.system);
    look();
  }

  [[nodiscard]] const PowderResidual& residual() const { return residual_; }
  [[nodiscard]] const Vec<2>& stress() const { return integrator_.stress(); }

 private:
  void look() {
    residual_ = powder_residual(state_.system, control_.imposed, integrator_.stress(),
                                spec_.force_scale(phase_.pressure), 1.0, !phase_.fixed_cell);
  }
  /// A run may go on from the very moment that it saved.
  [[nodiscard]] bool recorded() const {
    return !state_.points.empty() && state_.points.back().phase == state_.phase &&
           state_.points.back().time == state_.system.time;
  }
  [[nodiscard]] double share_done(std::size_t phases) const {
    constexpr double kUsual = 150.0;  // [T0] most phases take about so long
    return (static_cast<double>(state_.phase) + elapsed() / (elapsed() + kUsual)) / static_cast<double>(phases);
  }
  [[nodiscard]] double elapsed() const { return state_.system.time - state_.phase_start; }
  [[nodiscard]] bool stiffening() const { return state_.stiffness != phase_.stiffness; }

  /// Takes kappa a little further when it is on its way; returns how many steps to go until the next look.
  std::int64_t stiffen() {
    if (!stiffening()) return options_.test_every;
    constexpr double kGrowth = 0.01;  // largest change of ln kappa at once
    const double way = std::log(phase_.stiffness / state_.phase_stiffness);
    const double share = std::min(1.0, elapsed() / phase_.stiffening);
    set_stiffness(state_, spec_, share < 1.0 ? state_.phase_stiffness * std::exp(share * way) : phase_.stiffness);
    const double dt = time_step(state_, options_);
    integrator_ = StressCellVerlet<2>(dt, control_);
    integrator_.initialise(state_.system);
    const double pause = phase_.stiffening * kGrowth / std::abs(way);
    return static_cast<std::int64_t>(std::clamp(pause / dt, 1.0, static_cast<double>(options_.test_every)));
  }

  /// Keeps a picture at the start, after the phase, and whenever the solid fraction or what a recorded point says of
  /// the coordination has changed visibly.
  void picture(bool done) {
    constexpr double kVisible = 0.07;
    constexpr double kContacts = 1.0;
    auto& shots = state_.snapshots;
    const double z = state_.points.empty() ? 0.0 : state_.points.back().coordination;
    const bool same = !shots.time.empty() && std::abs(powder_fraction(state_.system) - last_fraction()) < kVisible &&
                      std::abs(z - state_.pictured) < kContacts;
    if (!shots.time.empty() && ((same && !done) || shots.time.back() == state_.system.time)) return;
    record_snapshot(shots, state_.system);
    state_.pictured = z;
  }
  [[nodiscard]] double last_fraction() const {
    const double* edges = &state_.snapshots.cell_edges[state_.snapshots.cell_edges.size() - 9];
    return powder_fraction(state_.system) * state_.system.cell.volume() / (edges[0] * edges[4]);
  }

  /// Notes since when the cell keeps its lengths, or a network that could bear its contacts.
  void watch_cell() {
    constexpr double kStill = 1e-4;
    const auto& edges = state_.system.cell.edges;
    bool still = true;
    for (int k = 0; k < 2; ++k) still = still && std::abs(edges[k][k] - state_.still_edge[k]) <= kStill * edges[k][k];
    if (still) return;
    const auto contacts = static_cast<std::int64_t>(contact_records(state_.system).size());
    if (contacts == state_.still_contacts && contacts >= spec_.disks) return;
    state_.still_edge = {{edges[0][0], edges[1][1]}};
    state_.still_contacts = contacts;
    state_.still_since = state_.system.time;
  }
  /// Kinetic energy per disk, in F1 a, below which motion is vibration of springs.
  [[nodiscard]] double vibration() const {
    const double f1 = spec_.force_scale(phase_.pressure);
    const double elastic = options_.settle_kinetic * f1 / state_.stiffness;
    return spec_.cohesive ? std::min(elastic, 0.1 * 0.5 * spec_.range / f1) : elastic;
  }
  /// Drag sets in when all has come together, and is taken off when something moves again.
  void settle() {
    constexpr double kHysteresis = 10.0;
    constexpr double kCell = 20.0;
    watch_cell();
    const double margin = state_.settling ? kHysteresis : 1.0;
    state_.settling = !stiffening() && residual_.kinetic * kPowderKineticLimit < margin * vibration() &&
                      (phase_.fixed_cell || state_.system.time - state_.still_since >= options_.settle_after) &&
                      (!phase_.one_aggregate || one_aggregate(state_.system));
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
  PowderResidual residual_;
};

}  // namespace

PowderResidual powder_residual(const System<2>& s, const Vec<2>& imposed, const Vec<2>& measured, double f1,
                               double largest_diameter, bool lengths_free) {
  PowderResidual out;
  const auto& p = s.particles;
  double kinetic = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    out.force = larger_or_nan(out.force, norm(static_cast<Vec<2>>(p.force[u])));
    out.moment = larger_or_nan(out.moment, std::sqrt(norm2(static_cast<Rot<2>>(p.torque[u]))));
    // Nothing slows a disk in free flight, nor its spin: it is a rattler, and the pack may rest without it.
    if (static_cast<Vec<2>>(p.force[u]) == Vec<2>{} && static_cast<Rot<2>>(p.torque[u]) == Rot<2>{}) continue;
    Vec<2> v = p.velocity[u];
    for (int k = 0; k < 2; ++k) v[k] -= s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
    kinetic += 0.5 * norm2(v) / p.inverse_mass[u] + 0.5 * norm2(static_cast<Rot<2>>(p.spin[u])) / p.inverse_inertia[u];
  }
  out.force /= kPowderForceLimit * f1;
  out.moment /= kPowderForceLimit * f1 * largest_diameter;
  out.kinetic =
      kinetic / static_cast<double>(std::max<Slot>(p.grains, 1)) / (kPowderKineticLimit * f1 * largest_diameter);
  for (int k = 0; lengths_free && k < 2; ++k)
    out.pressure =
        larger_or_nan(out.pressure, std::abs(imposed[k] - measured[k]) * largest_diameter / (kPowderForceLimit * f1));
  return out;
}

std::vector<PowderPhase> powder_phases(const PowderSpec& spec, const PowderProtocol& p) {
  const double kappa = spec.stiffness;
  const double cap = p.edge_speed_cap;
  const std::vector<double> pressures = p.pressures.empty() ? std::vector<double>{spec.stress()} : p.pressures;
  const auto load = [&](std::vector<PowderPhase>& phases, std::size_t first) {
    for (std::size_t k = first; k < pressures.size(); ++k)
      if (pressures[k] > 0.0)
        phases.push_back({k == 0 || pressures[k] > pressures[k - 1] ? "load" : "unload", false, false, pressures[k],
                          kappa, 0.0, cap});
  };
  if (p.method == 1) {
    std::vector<PowderPhase> phases{{"compaction", false, false, pressures.front(), kappa, 0.0, cap}};
    load(phases, 1);
    return phases;
  }
  const bool soft = p.aggregation_kappa > 0.0;
  const double first = soft ? p.aggregation_kappa : kappa;
  std::vector<PowderPhase> phases{{"aggregation", true, true, 0.0, first, 0.0, 0.0}};
  // Soft rolling springs would let the freed cell ring by percents: it is freed as they stiffen.
  phases.push_back({soft ? "stiffening" : "free", false, false, 0.0, kappa, soft ? p.stiffening_time : 0.0, cap});
  load(phases, 0);
  return phases;
}

void set_stiffness(PowderState& state, const PowderSpec& spec, double kappa) {
  const double share = state.stiffness / kappa;
  for (auto& spring : state.system.contacts.spring) spring *= share;
  for (auto& angle : state.system.contacts.memory) angle *= share;
  install_law(state, spec, kappa);
}

PowderState start_powder(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  PowderState state;
  state.system = make_powder(spec, seed, sample);
  state.stiffness = state.phase_stiffness = spec.stiffness;
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
                        const PowderOptions& options, const RunControl<PowderState>& control) {
  const RunKeeper keeper(control);
  PowderResult result;
  install_law(state, spec, state.stiffness);  // a saved state knows its stiffness, not the law
  while (result.reason.empty() && state.phase < static_cast<std::int64_t>(phases.size())) {
    const PowderPhase& now = phases[static_cast<std::size_t>(state.phase)];
    if (now.stiffening == 0.0 && state.stiffness != now.stiffness) set_stiffness(state, spec, now.stiffness);
    result.reason = Phase(state, spec, now, options).run(keeper, phases.size());
    if (!result.reason.empty()) break;
    if (now.pressure > 0.0) state.stages.push_back(stage_of(state, spec, now));
    ++state.phase;
    state.phase_start = state.still_since = state.system.time;
    state.phase_stiffness = state.stiffness;
    state.settling = false;
    state.phase_edge = {{state.system.cell.edges[0][0], state.system.cell.edges[1][1]}};
  }
  Phase last(state, spec, phases[std::min(static_cast<std::size_t>(state.phase), phases.size() - 1)], options);
  last.examine();
  result.usable = result.reason.empty();
  result.residual = last.residual();
  result.stress = last.stress();
  result.fraction = powder_fraction(state.system);
  return result;
}

}  // namespace softgrain

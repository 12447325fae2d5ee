#include "microsim/grain_box/grain_box_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/io/interrupt.h"
#include "common/state/checkpoint.h"
#include "microsim/grain_box/box_measure.h"

namespace softgrain {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int32_t kEnoughContacts = 4;
/// Isotropic strain per step on the way to the pressure of (a), and the growth of sigma^(2/3) per step.
constexpr double kPressureStep = 2e-3;
constexpr double kPressureGrowth = 8.0;
constexpr std::int64_t kPressureSteps = 300;
/// Growth of sigma_c with strain, for the estimate of progress: strain ~ sigma^(2/3).
constexpr double kStrainPower = 2.0 / 3.0;

class GrainBoxRun {
 public:
  GrainBoxRun(const GrainBoxSpec& spec, std::uint64_t seed, GrainBoxState&& state,
              const RunControl<GrainBoxState>& control)
      : spec_(spec),
        seed_(seed),
        state_(std::move(state)),
        control_(control),
        due_(control.seconds),
        started_(Clock::now()) {}

  GrainBoxResult run();

 private:
  void compact();
  void reach_pressure(double target);
  [[nodiscard]] double pressure_slope() const;
  bool grow();
  void add_friction();
  void load();
  [[nodiscard]] BoxMove next_move(const BoxPoint& now, double increment) const;
  [[nodiscard]] bool loading_over(const BoxPoint& now, double strain) const;
  [[nodiscard]] const BoxPoint& load_start() const;

  /// What an equilibrium that is being looked for changes; the rest of the state only grows when it is found.
  struct SafePoint {
    GrainPack pack;
    std::int64_t growth_passes = 0;
    BoxPhase phase = BoxPhase::start;
  };
  void note_safe_point() { safe_ = {state_.pack, state_.growth_passes, state_.phase}; }
  void go_back_and_save();

  void step(const BoxMove& move);
  void record(bool probe);
  void enter(BoxPhase phase);
  void pause_if_asked();
  void count_time();
  [[nodiscard]] BoxStepper stepper() const;
  [[nodiscard]] double share_done() const;

  const GrainBoxSpec& spec_;
  std::uint64_t seed_;
  GrainBoxState state_;
  SafePoint safe_;
  const RunControl<GrainBoxState>& control_;
  CheckpointClock due_;
  Clock::time_point started_;
};

BoxStepper GrainBoxRun::stepper() const {
  return {spec_.solver, state_.stress_free_lengths, spec_.loading.max_halvings, spec_.loading.stress_tolerance};
}

void GrainBoxRun::count_time() {
  const auto now = Clock::now();
  state_.seconds += std::chrono::duration<double>(now - started_).count();
  started_ = now;
}

double GrainBoxRun::share_done() const {
  if (state_.phase == BoxPhase::done) return 1.0;
  if (state_.points.empty()) return 0.0;
  const BoxPoint& p = state_.points.back();
  const double by_stress = std::pow(p.pressure / spec_.loading.end_stress, kStrainPower);
  if (state_.phase != BoxPhase::loading || !std::isfinite(spec_.loading.end_strain)) return std::min(by_stress, 1.0);
  return std::min(1.0, std::max(by_stress, largest(p.strain - load_start().strain) / spec_.loading.end_strain));
}

/// Called after every equilibrium: reports the progress, saves a checkpoint when due, and ends the run after a signal.
void GrainBoxRun::pause_if_asked() {
  count_time();
  note_safe_point();
  if (control_.progress) control_.progress(state_, share_done());
  const bool stop = interrupt_requested();
  if (control_.save && (stop || due_.due())) control_.save(state_);
  if (stop)
    throw Interrupted(
        fmt::format("interrupted in the {} of {}; go on with --resume", to_string(state_.phase), spec_.name));
}

/// A signal came while an equilibrium was looked for: the run goes on from the one before.
void GrainBoxRun::go_back_and_save() {
  if (safe_.pack.radius.empty()) return;  // there was none yet
  count_time();
  state_.pack = std::move(safe_.pack);
  state_.growth_passes = safe_.growth_passes;
  state_.phase = safe_.phase;
  if (control_.save) control_.save(state_);
}

void GrainBoxRun::enter(BoxPhase phase) {
  state_.phase = phase;
  if (!control_.say || state_.points.empty()) return;
  const BoxPoint& p = state_.points.back();
  control_.say(fmt::format("{}: {}: sigma_c {:.4g} MPa, solid fraction {:.4f}, {:.3f} contacts per grain, {} states",
                           spec_.name, to_string(phase), p.pressure * 1e-6, p.solid_fraction, p.coordination,
                           state_.points.size()));
}

void measure_medium(BoxPoint& p, const GrainPack& pack) {
  MediumState medium{p.pressure, p.solid_fraction, p.coordination, 0.0, 0.0};
  const auto grains = static_cast<double>(pack.grains());
  for (std::size_t n = 0; n < pack.radius.size(); ++n) {
    medium.shear_modulus += pack.youngs_modulus[n] / (2.0 * (1.0 + pack.poisson_ratio[n])) / grains;
    medium.poisson_ratio += pack.poisson_ratio[n] / grains;
  }
  const Moduli m = effective_medium(medium);
  p.bulk_medium = m.bulk;
  // The formula has contacts that never slide; without friction there is no such shear stiffness.
  p.shear_medium = pack.friction > 0.0 ? m.shear : kNaN;
}

BoxPoint measure(const GrainPack& pack, const Vec3& stress_free) {
  BoxPoint p;
  p.lengths = box_lengths(pack);
  for (int k = 0; k < 3; ++k) p.strain[k] = 1.0 - p.lengths[k] / stress_free[k];
  const BoxStress stress = box_stress(pack);
  p.stress = stress.normal;
  p.shear = stress.shear;
  p.moment = stress.moment;
  p.imbalance = stress.imbalance;
  p.pressure = stress.mean();
  p.deviator = stress.deviator();
  const ContactCounts counts = count_contacts(pack);
  p.sliding_share = counts.contacts > 0 && pack.friction > 0.0
                        ? static_cast<double>(counts.sliding) / static_cast<double>(counts.contacts)
                        : kNaN;
  p.coordination = counts.coordination;
  p.coordination_without = counts.coordination_without;
  p.rattlers = counts.rattlers;
  p.fewest_contacts = counts.fewest;
  p.mean_force = counts.mean_force;
  p.solid_fraction = solid_fraction(pack);
  measure_medium(p, pack);
  return p;
}

/// Moduli of the interval since the last point; the first point of phase (a) has none.
void add_interval(BoxPoint& p, const std::vector<BoxPoint>& points) {
  const Moduli m = points.empty() ? Moduli{kNaN, kNaN}
                                  : hooke_moduli(p.stress - points.back().stress, p.strain - points.back().strain);
  p.bulk = m.bulk;
  p.shear_modulus = m.shear;
}

void GrainBoxRun::record(bool probe) {
  BoxPoint p = measure(state_.pack, state_.stress_free_lengths);
  p.phase = state_.phase;
  add_interval(p, state_.points);
  const ElasticResponse elastic = probe ? elastic_probe(state_.pack, spec_.solver) : ElasticResponse{};
  p.bulk_probe = elastic.solved ? elastic.bulk_modulus() : kNaN;
  p.shear_probe = elastic.solved ? elastic.shear_modulus() : kNaN;
  p.effort.factorisations += elastic.factorisations;
  state_.points.push_back(p);
}

void GrainBoxRun::step(const BoxMove& move) {
  BoxStepper stepper = this->stepper();
  const std::vector<PackContact> before = state_.pack.contacts;
  const auto note_failures = [&] {
    for (FailedTry& f : stepper.take_failures())
      state_.failures.push_back({static_cast<std::int64_t>(state_.points.size()), std::move(f)});
  };
  try {
    (void)stepper.apply(state_.pack, move);
  } catch (const UnusableResult&) {
    note_failures();
    throw;
  }
  note_failures();
  const auto n = static_cast<std::int64_t>(state_.points.size());
  record(spec_.loading.probe_every > 0 && state_.phase != BoxPhase::compaction && n % spec_.loading.probe_every == 0);
  state_.points.back().at_start_limit = share_at_start_limit(before, state_.pack);
  StepEffort effort = stepper.take_effort();
  effort.factorisations += state_.points.back().effort.factorisations;
  state_.points.back().effort = effort;
  pause_if_asked();
}

BoxMove isotropic(double strain) { return {{}, {{strain, strain, strain}}, {}}; }

double height(double pressure) { return std::cbrt(pressure * std::abs(pressure)); }

/// d sigma^(2/3) / d strain: from the last two states when the box was strained between them, else from the elastic
/// probe, d sigma_c = 3 K de. Depends on the saved state alone, so that a resumed run takes the same steps.
double GrainBoxRun::pressure_slope() const {
  const auto& points = state_.points;
  const double now = points.back().pressure;
  if (points.size() > 1) {
    const BoxPoint& before = points[points.size() - 2];
    const double strain = points.back().strain[0] - before.strain[0];
    const double slope = (height(now) - height(before.pressure)) / strain;
    if (std::abs(strain) > 1e-12 && slope > 0.0) return slope;
  }
  const ElasticResponse elastic = elastic_probe(state_.pack, spec_.solver);
  return elastic.solved && now > 0.0 ? 2.0 * elastic.bulk_modulus() / std::cbrt(now) : 0.0;
}

/// Secant on sigma^(2/3), which grows linearly with strain for Hertz contacts. Without friction no path matters, so
/// every step goes on from the last.
void GrainBoxRun::reach_pressure(double target) {
  for (std::int64_t n = 0; n < kPressureSteps; ++n) {
    const double now = state_.points.back().pressure;
    if (std::abs(now / target - 1.0) <= spec_.generation.pressure_tolerance) return;
    const double slope = pressure_slope();
    const double rise = std::min(height(target), kPressureGrowth * height(now)) - height(now);
    const double wanted = slope > 0.0 ? rise / slope : kPressureStep;
    step(isotropic(std::clamp(wanted, -kPressureStep, kPressureStep)));
  }
  throw UnusableResult(
      fmt::format("{}: the pressure of {:.4g} Pa was not met in {} steps", spec_.name, target, kPressureSteps));
}

/// Grows grains that have too few contacts and finds equilibrium. False when all have enough.
bool GrainBoxRun::grow() {
  const std::vector<std::int32_t> count = contacts_per_grain(state_.pack);
  bool any = false;
  for (std::size_t n = 0; n < count.size(); ++n) {
    if (count[n] >= kEnoughContacts) continue;
    state_.pack.radius[n] *= 1.0 + spec_.generation.growth;
    any = true;
  }
  if (!any) return false;
  ++state_.growth_passes;
  refresh_contacts(state_.pack);
  step(isotropic(0.0));
  return true;
}

/// Phase (a), one pressure after the other. Growing raises the pressure and meeting the pressure may open contacts:
/// both until both hold.
void GrainBoxRun::compact() {
  if (state_.phase == BoxPhase::start) {
    CompactedPack compacted = compact_until_stress(spec_, make_loose_pack(spec_, seed_));
    state_.pack = std::move(compacted.pack);
    state_.stress_free_lengths = compacted.stress_free_lengths;
    state_.loose_passes = compacted.loop_passes;
    state_.phase = BoxPhase::compaction;
    step(isotropic(0.0));
  }
  const std::vector<double> pressures = spec_.generation.pressures();
  while (state_.pressures_met < static_cast<std::int64_t>(pressures.size())) {
    reach_pressure(pressures[static_cast<std::size_t>(state_.pressures_met)]);
    if (!grow())
      ++state_.pressures_met;
    else if (state_.growth_passes > spec_.generation.growth_passes)
      throw UnusableResult(fmt::format("{}: after {} passes of growth some grains still have fewer than {} contacts",
                                       spec_.name, spec_.generation.growth_passes, kEnoughContacts));
  }
}

double finite_friction(double friction) { return std::isinf(friction) ? kStickingFriction : friction; }

/// Phase (b), and the friction that stays on.
void GrainBoxRun::add_friction() {
  state_.pack.friction = finite_friction(spec_.friction);
  for (PackWall& wall : state_.pack.walls) wall.friction = finite_friction(spec_.walls.friction);
  if (!(spec_.friction > 0.0)) return;
  BoxMove move;
  if (spec_.generation.isotropic)
    move = isotropic(spec_.generation.increment);
  else
    move.strain[spec_.generation.axis] = spec_.generation.increment;
  while (!friction_phase_over(state_.points, spec_.generation)) {
    if (static_cast<std::int64_t>(std::count_if(state_.points.begin(), state_.points.end(), [](const BoxPoint& p) {
          return p.phase == BoxPhase::friction;
        })) >= spec_.generation.max_increments)
      throw UnusableResult(
          fmt::format("{}: after {} increments with friction sliding has not saturated, or G does not grow", spec_.name,
                      spec_.generation.max_increments));
    step(move);
  }
}

const BoxPoint& GrainBoxRun::load_start() const {
  const auto first = std::find_if(state_.points.begin(), state_.points.end(),
                                  [](const BoxPoint& p) { return p.phase == BoxPhase::loading; });
  return first == state_.points.begin() ? *first : *(first - 1);
}

/// The stress of a servo axis is approached by what the elastic medium would give for one increment, so that the first
/// increments do not jump.
BoxMove GrainBoxRun::next_move(const BoxPoint& now, double increment) const {
  const GrainBoxLoading& loading = spec_.loading;
  BoxMove move;
  move.control = loading.control;
  double fastest = 0.0;
  for (int k = 0; k < 3; ++k)
    if (loading.control[static_cast<std::size_t>(k)] == AxisControl::strain)
      fastest = std::max(fastest, std::abs(loading.strain_rate[k]));
  for (int k = 0; k < 3; ++k) {
    if (loading.control[static_cast<std::size_t>(k)] == AxisControl::strain) {
      move.strain[k] = fastest > 0.0 ? loading.strain_rate[k] / fastest * increment : 0.0;
    } else {
      const double reach = 3.0 * now.bulk_medium * increment;
      move.stress[k] = std::clamp(loading.stress[k], now.stress[k] - reach, now.stress[k] + reach);
    }
  }
  return move;
}

bool GrainBoxRun::loading_over(const BoxPoint& now, double strain) const {
  constexpr double kRounding = 1e-9;
  return now.pressure >= spec_.loading.end_stress || strain >= spec_.loading.end_strain * (1.0 - kRounding);
}

void GrainBoxRun::load() {
  for (;;) {
    const BoxPoint& now = state_.points.back();
    const double strain = now.phase == BoxPhase::loading ? largest(now.strain - load_start().strain) : 0.0;
    if (loading_over(now, strain)) return;
    step(next_move(now, increment_at(spec_.loading, strain)));
  }
}

GrainBoxResult GrainBoxRun::run() {
  GrainBoxResult result;
  result.spec = spec_;
  if (!state_.points.empty()) note_safe_point();
  try {
    if (state_.phase <= BoxPhase::compaction) {
      compact();
      enter(BoxPhase::friction);
    }
    if (state_.phase == BoxPhase::friction) {
      add_friction();
      enter(BoxPhase::loading);
    }
    if (state_.phase == BoxPhase::loading) {
      load();
      enter(BoxPhase::done);
    }
    result.usable = true;
  } catch (const Interrupted&) {
    go_back_and_save();
    throw;
  } catch (const UnusableResult& e) {
    result.reason = e.what();
    if (control_.say) control_.say(spec_.name + ": " + result.reason);
  }
  count_time();
  result.state = std::move(state_);
  return result;
}

}  // namespace

bool friction_phase_over(const std::vector<BoxPoint>& points, const GrainBoxGeneration& generation) {
  const std::int64_t w = generation.window;
  const auto n = static_cast<std::int64_t>(points.size());
  if (n < 2 * w || points[static_cast<std::size_t>(n - 2 * w)].phase != BoxPhase::friction) return false;
  const auto mean = [&](double BoxPoint::*value, std::int64_t first) {
    double sum = 0.0;
    for (std::int64_t k = first; k < first + w; ++k) sum += points[static_cast<std::size_t>(k)].*value;
    return sum / static_cast<double>(w);
  };
  const double change = mean(&BoxPoint::sliding_share, n - w) - mean(&BoxPoint::sliding_share, n - 2 * w);
  if (generation.isotropic) return std::abs(change) <= generation.saturation;  // no G to be had
  return std::abs(change) <= generation.saturation &&
         mean(&BoxPoint::shear_modulus, n - w) > mean(&BoxPoint::shear_modulus, n - 2 * w);
}

double increment_at(const GrainBoxLoading& loading, double strain) {
  double end = 0.0;
  for (std::size_t k = 0; k < loading.stage_strains.size(); ++k) {
    end += loading.stage_strains[k];
    if (strain < end * (1.0 - 1e-9)) return loading.increments[k];
  }
  return loading.increments.back();
}

GrainBoxResult run_grain_box(const GrainBoxSpec& spec, std::uint64_t seed, GrainBoxState state,
                             const RunControl<GrainBoxState>& control) {
  return GrainBoxRun(spec, seed, std::move(state), control).run();
}

}  // namespace softgrain

// The ways into touch: relaxation under a falling pressure, motion at a rate, fines that grow between coarse bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/data/attributes.h"
#include "common/data/rows.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/neighbours/verlet_list.h"
#include "common/state/system_io.h"
#include "macrosim/grain_materials.h"
#include "macrosim/placed_spheres.h"
#include "macrosim/preparation.h"
#include "macrosim/pressed_box.h"

namespace softgrain {

namespace {

double mean_radius(const System3& s) {
  double sum = 0.0;
  for (std::size_t u = 0; u < at(s.particles.grains); ++u) sum += s.particles.sphere[u].r;
  return sum / s.particles.grains;
}

double load_under(double pressure, const HardBodies& hard) {
  const Vec3 size = hard.size();
  return pressure * size[0] * size[1];
}

DampedOptions options_under(double pressure, double load, const HardBodies& hard, const MacroSpec& spec, bool last) {
  DampedOptions options = pressing_options(spec, last, load, hard.system.particles.grains, mean_radius(hard.system));
  if (spec.balance == Balance::own_load) options.own_stress = pressure;
  return options;
}

[[noreturn]] void not_jammed(const MacroSpec& spec, HardBodies& hard, const RelaxationResult& rest) {
  throw UnusableResult(fmt::format(
      "{}: relaxation {} after {} passes; reached: walls at {:.3g} E, bodies fill {:.4f} of the box, largest net force "
      "(but for one body in 2000) {:.3g} of {}",
      not_jammed_text(spec), to_string(rest.end), rest.passes, hard.pressure() / spec.youngs_modulus, hard.fraction(),
      rest.residual,
      spec.balance == Balance::own_load ? "what it is compared with (balance = \"own-load\")"
                                        : "the mean contact force; where radii span a factor of 30 or more, balance = "
                                          "\"own-load\" takes fewer passes"));
}

/// How far pressing has come, 0 to 1. The first pressure closes the gaps and brings all roughly to rest, which takes
/// about two fifths of all passes; half go into the last pressure, whose residual falls like a power of them.
class PressingProgress {
 public:
  PressingProgress(const HardBodies& hard, double first) : first_(std::max(first, 1.0)), begin_(volume(hard)) {
    to_close_ = std::log(kPacked / std::min(hard.fraction(), 0.99 * kPacked));
  }

  [[nodiscard]] double at(const HardBodies& hard, double over, double residual, double tolerance) const {
    if (over <= 1.0) {
      const double before = first_ > 1.0 ? kLast : 0.0;
      return before + (1.0 - before) * reached(std::log(residual) / std::log(tolerance));
    }
    if (over < first_) return kFirst + (kLast - kFirst) * (1.0 - std::log(over) / std::log(first_));
    const double closed = reached(std::log(begin_ / volume(hard)) / to_close_);
    return kFirst * closed * (0.2 + 0.8 * reached(std::log(residual) / std::log(tolerance)));
  }

 private:
  static constexpr double kPacked = 0.55;
  static constexpr double kFirst = 0.4;
  static constexpr double kLast = 0.5;

  static double volume(const HardBodies& hard) {
    const Vec3 size = hard.size();
    return size[0] * size[1] * size[2];
  }
  static double reached(double way) { return way > 0.0 ? std::min(way, 1.0) : 0.0; }

  double first_;
  double begin_;
  double to_close_ = 0.0;
};

/// Where a preparation under way stands, beside its hard bodies.
struct PreparationState {
  bool coarse = false;           ///< the coarse bodies of "dense", which jam by themselves
  MacroPacking begun;            ///< what the step began with
  bool presses = false;          ///< the step: whether the box is pressed, or shrinks
  double over = 1.0;             ///< pressure over the one asked for
  double load = 0.0;             ///< on a face of the box as it was when this pressure began [N]
  double seconds = 0.0;          ///< of the step so far
  PressedBox::Motion box{};      ///< of a box that is pressed
  RelaxationState relaxation{};  ///< of the bodies in it
};

void state_fields(auto&& visit, auto& s) {
  visit("coarse", s.coarse);
  visit("presses", s.presses);
  visit("over", s.over);
  visit("load", s.load);
  visit("seconds", s.seconds);
  visit("resisted_at", s.box.resisted_at);
  visit("passes", s.relaxation.so_far.passes);
  visit("fire_step", s.relaxation.fire.step);
  visit("fire_mixing", s.relaxation.fire.mixing);
  visit("fire_downhill", s.relaxation.fire.downhill);
}

constexpr auto kBoxMotion = [](auto&& visit, auto& motion) {
  visit(motion.velocity);
  visit(motion.strained);
  visit(motion.resisted);
};

void write_state(const h5::Group& group, const PreparationState& state, const System3& system) {
  state_fields(AttributeWriter{group}, state);
  write_macro_packing(group.create("begun"), state.begun);
  write_system(group.create("system"), system);
  if (!state.presses) return;
  write_row(group, "box_motion", state.box, kBoxMotion);
  const BodyStiffness& stiffness = state.relaxation.stiffness;
  group.write("translation", stiffness.translation);
  group.write("rotation", stiffness.rotation);
  group.write("force", stiffness.force);
  group.write("contacts", std::vector<std::int64_t>(stiffness.contacts.begin(), stiffness.contacts.end()));
}

/// All but the system, which needs its laws first.
void read_state(const h5::Group& group, PreparationState& state) {
  state_fields(AttributeReader{group}, state);
  state.begun = read_macro_packing(group.open("begun"));
  if (!state.presses) return;
  read_row(group, "box_motion", state.box, kBoxMotion);
  BodyStiffness& stiffness = state.relaxation.stiffness;
  stiffness.translation = group.doubles("translation");
  stiffness.rotation = group.doubles("rotation");
  stiffness.force = group.doubles("force");
  for (const std::int64_t n : group.integers("contacts")) stiffness.contacts.push_back(static_cast<std::int32_t>(n));
}

std::optional<PreparationState> kept_state(const PreparationWatch& watch) {
  std::optional<PreparationState> kept;
  if (watch.keeper != nullptr)
    watch.keeper->load([&kept](const h5::Group& group) { read_state(group, kept.emplace()); });
  return kept;
}

/// The hard bodies of one step of a preparation, begun with a packing or taken up where they were kept.
class PreparationStep {
 public:
  PreparationStep(const MacroSpec& spec, PreparationState begins, bool taken_up, double friction, double restitution,
                  PreparationKeeper* keeper)
      : state(std::move(begins)),
        hard(spec, state.begun, friction, restitution),
        keeper_(keeper),
        taken_up_(taken_up) {}

  /// Whether it went on from a state that was kept; what comes from the beginning of the step has to be known before.
  bool take_up() {
    if (!taken_up_) return false;
    keeper_->load([this](const h5::Group& group) { read_system(group.open("system"), hard.system); });
    hard.seconds_before = state.seconds;
    return true;
  }
  /// Whether the state is to be kept now: it is time, or a signal came.
  [[nodiscard]] bool is_due() const { return keeper_ != nullptr && (interrupt_requested() || keeper_->due()); }
  void keep() {
    state.seconds = hard.seconds();
    keeper_->save([this](const h5::Group& group) { write_state(group, state, hard.system); });
  }

  PreparationState state;
  HardBodies hard;

 private:
  PreparationKeeper* keeper_;
  bool taken_up_;
};

/// Relaxes bodies and walls together under a pressure that falls to the one asked for.
void press(PreparationStep& step, const MacroSpec& spec, double first, const PreparationWatch& watch) {
  HardBodies& hard = step.hard;
  PreparationState& state = step.state;
  const double asked = spec.start_pressure * spec.youngs_modulus;
  const PressingProgress progress(hard, first);
  bool taken_up = step.take_up();
  if (!taken_up) state.over = std::max(first, 1.0);
  for (;; state.over = std::max(1.0, state.over * kPressureFall)) {
    const bool last = state.over <= 1.0;
    const double pressure = state.over * asked;
    BoxControl control{{true, true, true}, {{pressure, pressure, pressure}}, true};
    if (!taken_up) state.load = load_under(pressure, hard);
    const DampedOptions options = options_under(pressure, state.load, hard, spec, last);
    control.tolerance = pressing_stress_tolerance(spec, last);
    PressedBox walls(hard.box, control, [&](const RelaxationResult& so_far) {
      watch(progress.at(hard, state.over, so_far.residual, options.tolerance));
    });
    if (taken_up) walls.go_on_with(state.box);
    const RelaxationState from = taken_up ? std::move(state.relaxation) : RelaxationState{};
    const auto keep = [&](const RelaxationState& now) {
      if (!step.is_due()) return;
      state.box = walls.motion();
      state.relaxation = now;
      step.keep();
    };
    const RelaxationResult rest =
        DampedRelaxation<3>(options).relax(hard.system, walls, {taken_up ? &from : nullptr, keep});
    taken_up = false;
    if (last && rest.end != RelaxationEnd::converged) not_jammed(spec, hard, rest);
    if (last) return;
  }
}

/// Velocities of a box that shrinks at this rate [1/s]: of its walls or the cell, and of all bodies when it begins.
void set_velocities(HardBodies& hard, double rate, bool bodies) {
  auto& p = hard.system.particles;
  const Vec3 centre = box_centre(hard.system, hard.box);
  if (hard.box.periodic)
    for (int k = 0; k < 3; ++k) hard.system.cell.velocity_gradient[k][k] = -rate;
  for (std::size_t u = bodies ? 0 : at(p.first_plane()); u < at(p.size()); ++u)
    p.velocity[u] = (centre - p.sphere[u].x) * rate;
}

/// A stable step for bodies that touch under the pressure, and that meet as fast as walls move at first.
double step_at(const HardBodies& hard, double pressure, double rate, const MacroSpec& spec) {
  const double speed = rate * hard.size()[0];
  const double modulus = lowest_modulus(spec);
  const double pressed = 4.0 * std::pow(pressure / modulus, 2.0 / 3.0);
  const double met = 2.0 * std::pow(highest_density(spec) * speed * speed / modulus, 0.4);
  const double damped = 1.0 + tsuji_alpha(spec.protocol.restitution);
  return 0.2 / damped * step_limit(hard.system, std::max(pressed, met)).natural_time;
}

/// Shrinks the box at the rate of the inertial number until its walls bear the pressure, in the mean over a little
/// time.
void shrink(PreparationStep& step, const MacroSpec& spec, const PreparationWatch& watch) {
  constexpr int kWindow = 50;  ///< steps
  HardBodies& hard = step.hard;
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  const double diameter = 2.0 * mean_radius(hard.system);
  const double rate = spec.protocol.inertial_number / (diameter * std::sqrt(spec.density / pressure));
  const double start = hard.fraction();
  VelocityVerlet<3> motion(step_at(hard, pressure, rate, spec));
  if (!step.take_up()) {
    set_velocities(hard, rate, true);
    motion.initialise(hard.system);
  }
  for (double mean = 0.0; mean < pressure;) {
    if (step.is_due()) step.keep();
    stop_if_interrupted("compacting");
    set_velocities(hard, rate, false);
    mean = 0.0;
    for (int k = 0; k < kWindow; ++k) {
      motion.step(hard.system);
      mean += hard.pressure() / kWindow;
    }
    const double now = hard.fraction();
    if (!(now < 1.0))
      throw UnusableResult(fmt::format("{}: bodies fill {:.4f} of the box, whose walls bear {:.3g} E",
                                       not_jammed_text(spec), now, mean / spec.youngs_modulus));
    watch(std::min(0.8, 0.8 * std::log(now / start) / std::log(0.62 / std::min(start, 0.6))));
  }
}

/// Fines at random places between the coarse bodies, their radii times the share that is returned, which is as small
/// as it takes.
double place_fines(const std::vector<MacroBody>& coarse, std::vector<MacroBody>& fines, const Vec3& low, double edge,
                   bool periodic, RandomStream& random) {
  constexpr int kTrials = 20000;
  std::vector<double> radii;
  for (const MacroBody& b : coarse) radii.push_back(b.r);
  for (const MacroBody& b : fines) radii.push_back(b.r);
  for (double share = 0.5;; share *= 0.7) {
    PlacedSpheres placed(edge, radii, periodic);
    for (const MacroBody& b : coarse) placed.add(b.x - low, b.r);
    const bool all = std::all_of(fines.begin(), fines.end(), [&](MacroBody& b) {
      const double r = share * b.r;
      for (int trial = 0; trial < kTrials; ++trial) {
        b.x = placed.place_of(r, random);
        if (placed.collides(b.x, r)) continue;
        placed.add(b.x, r);
        b.x = b.x + low;
        return true;
      }
      return false;
    });
    if (all) return share;
  }
}

void scale_fines(HardBodies& hard, const MacroPacking& packing, std::size_t coarse, double share) {
  for (std::size_t u = coarse; u < packing.bodies.size(); ++u)
    hard.system.particles.sphere[u].r = share * packing.bodies[u].r;
}

/// The coarse bodies and the walls stand; the fines grow to their radii, or to the share of them at which they press as
/// a relaxation begins. Returns that share.
double grow_fines(MacroPacking& packing, const MacroSpec& spec, std::size_t coarse, double share,
                  const PreparationWatch& watch) {
  constexpr double kGrowth = 1.04;
  constexpr std::int64_t kPasses = 400;
  HardBodies hard(spec, packing);
  for (std::size_t u = 0; u < coarse; ++u) hard.system.particles.inverse_mass[u] = 0.0;
  const double most = spec.protocol.first_pressure * spec.start_pressure * spec.youngs_modulus;
  DampedOptions options = options_under(most, load_under(most, hard), hard, spec, false);
  options.max_passes = kPasses;
  const double first = share;
  for (;;) {
    const double next = std::min(1.0, share * kGrowth);
    scale_fines(hard, packing, coarse, next);
    rebuild_neighbours(hard.system);
    DampedRelaxation<3>(options).relax(hard.system);
    share = next;
    watch(0.3 * (1.0 - std::log(share) / std::log(first)));
    if (share >= 1.0 || contact_stress(hard.system, hard.box)[0] > most) break;
  }
  hard.take_over(packing);
  return share;
}

}  // namespace

void bring_into_touch(const MacroSpec& spec, MacroPacking& packing, const PreparationWatch& watch, bool coarse) {
  const bool moves = spec.protocol.inertial_number > 0.0;
  std::optional<PreparationState> kept = kept_state(watch);
  if (kept && kept->coarse != coarse) kept.reset();
  if (kept) packing = kept->begun;
  const auto take_step = [&](bool presses, double restitution, const auto& go) {
    const bool taken_up = kept && kept->presses == presses;
    PreparationState begins{coarse, packing, presses};
    PreparationStep step(spec, taken_up ? *std::exchange(kept, {}) : std::move(begins), taken_up,
                         spec.protocol.friction, restitution, watch.keeper);
    go(step);
    step.hard.take_over(packing);
  };
  if (moves && !(kept && kept->presses))
    take_step(false, spec.protocol.restitution, [&](PreparationStep& step) { shrink(step, spec, watch); });
  take_step(true, 1.0, [&](PreparationStep& step) {
    press(step, spec, spec.protocol.first_pressure, moves ? watch.part(0.8, 0.2) : watch);
  });
}

MacroPacking pack_densely(const MacroSpec& spec, std::vector<MacroBody> bodies, std::uint64_t seed,
                          std::uint64_t sample, const PreparationWatch& watch) {
  const PreparationWatch last = watch.part(0.5, 0.5);
  if (const auto kept = kept_state(watch); kept && !kept->coarse) {
    MacroPacking packing = kept->begun;
    bring_into_touch(spec, packing, last);
    return packing;
  }
  double all = 0.0;
  for (const MacroBody& b : bodies) all += cube(b.r);
  std::size_t coarse = 0;
  for (double sum = 0.0; coarse < bodies.size() && sum < spec.protocol.coarse_share * all; ++coarse)
    sum += cube(bodies[coarse].r);
  std::vector<MacroBody> fines(bodies.begin() + static_cast<std::ptrdiff_t>(coarse), bodies.end());
  bodies.resize(coarse);
  MacroPacking packing = place_loosely(std::move(bodies), seed, sample, spec.protocol.start_fraction, spec.boundary);
  bring_into_touch(spec, packing, watch.part(0.0, 0.2), true);
  if (fines.empty()) return packing;
  RandomStream random(seed, kMacroFines, sample);
  const double share =
      place_fines(packing.bodies, fines, packing.low, packing.size()[0], spec.boundary == Boundary::periodic, random);
  packing.bodies.insert(packing.bodies.end(), fines.begin(), fines.end());
  const double grown = grow_fines(packing, spec, coarse, share, watch.part(0.2, 0.3));
  // What did not find room has it in a box that is as much wider.
  packing.low = packing.low * (1.0 / grown);
  packing.high = packing.high * (1.0 / grown);
  for (MacroBody& b : packing.bodies) b.x = b.x * (1.0 / grown);
  bring_into_touch(spec, packing, last);
  return packing;
}

}  // namespace softgrain

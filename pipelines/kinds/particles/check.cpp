#include "pipelines/kinds/particles/scene.h"

#include <fmt/format.h>

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/core/text.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "microsim/particles/particles_run.h"
#include "microsim/particles/scene_memory.h"
#include "microsim/particles/trajectory.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

/// Steps timed to tell the rest, and wall time that they may take; few, as a check should take a moment.
constexpr std::int64_t kTrialSteps = 200;
constexpr double kTrialSeconds = 0.5;

/// Wall time per step, with one pass before it that makes the neighbour list. Moves the system. Not known, with a
/// warning, where the first steps end the run.
template <int D>
double step_seconds(System<D>& s, const SceneTime& time, Findings& out) {
  VelocityVerlet<D> integrator(time.step);
  try {
    integrator.initialise(s);
    return seconds_per_call([&] { integrator.step(s); }, kTrialSeconds, std::min(kTrialSteps, time.steps));
  } catch (const UnusableResult& e) {
    out.warn(fmt::format("the run will end in its first {} steps: {}; look at gravity, speeds and the time step",
                         kTrialSteps, e.what()));
    return kNaN;
  }
}

/// Says how long the run takes, where that is known.
void add_time(double seconds, Findings& out) {
  if (std::isnan(seconds)) return;
  constexpr double kDay = 86400.0;
  if (seconds > kDay) out.warn("it takes about " + time_text(seconds));
  const std::string busy = busy_text();  // threads of the trial may have waited for cores
  out.add("seconds", seconds,
          fmt::format("expected time: about {:.3g} s with {}{}", seconds, counted(omp_get_max_threads(), "thread"),
                      busy.empty() ? "" : "; " + busy + ": less once it is idle"));
}

/// Adds the solid fraction of a cell that is periodic along all axes.
template <int D>
void add_solid_fraction(const System<D>& s, Findings& out) {
  if (!std::all_of(s.cell.periodic.begin(), s.cell.periodic.end(), [](bool along) { return along; })) return;
  double volume = 0.0;
  for (Slot i = 0; i < s.particles.grains; ++i) {
    const double r = s.particles.sphere[static_cast<std::size_t>(i)].r;
    volume += D == 3 ? kSphereVolume * r * r * r : std::numbers::pi * r * r;
  }
  const double fraction = volume / s.cell.volume();
  out.add("solid_fraction", fraction, fmt::format("solid fraction of the cell: {:.3f}", fraction));
  constexpr double kDensest = D == 3 ? 0.74 : 0.907;
  if (fraction > kDensest)
    out.warn(fmt::format("the cell is filled to {:.2f}: more than equal {} can be without overlap", fraction,
                         D == 3 ? "spheres" : "disks"));
}

/// What the first frame shows of the contacts.
template <int D>
void add_overlap(const System<D>& s, Findings& out) {
  const ContactWatch<D> watch = watch_contacts(s);
  if (!(watch.overlap > 0.0)) return;
  out.add("overlap", watch.overlap,
          fmt::format("largest overlap at the start: {:.3g} of the smaller radius (bodies {} and {})", watch.overlap,
                      watch.i, watch.j));
  constexpr double kLarge = 0.3;
  if (watch.overlap > kLarge)
    out.warn(fmt::format("bodies {} and {} overlap by {:.2g} of the smaller radius at the start: they will fly apart",
                         watch.i, watch.j, watch.overlap));
  const std::string beyond = law_use_text(watch.laws);
  if (!beyond.empty()) out.warn("at the start: " + beyond);
}

/// Warns of a largest grain whose radius is hardly meant in metres; disks may have any unit of length.
template <int D>
void warn_of_radius(const System<D>& s, Findings& out) {
  double largest = 0.0;
  for (Slot i = 0; i < s.particles.grains; ++i)
    largest = std::max(largest, s.particles.sphere[static_cast<std::size_t>(i)].r);
  if (D == 3) out.warn_of_metres("the largest particle", largest);
}

/// Frames of the trajectory with place, velocity and spin of every body, and the contacts that some of them keep: as
/// many as at the start.
template <int D>
double recorded_bytes(const ParticlesSceneOf<D>& scene, std::int64_t contacts) {
  constexpr double kBytesPerBody = 9.0 * 8.0;
  constexpr double kBytesPerContact = 18.0 * 8.0;  // pair, ends, point, force, its normal part, shift
  if (!scene.record) return 0.0;
  const auto frames = static_cast<double>(scene.frames());
  const double with_contacts = std::min(frames, static_cast<double>(scene.snapshots));
  return frames * kBytesPerBody * static_cast<double>(scene.system.particles.size()) +
         with_contacts * kBytesPerContact * static_cast<double>(contacts);
}

/// A run looks for such particles before its first step and ends there.
template <int D>
void warn_of_fast(const System<D>& s, double step, Findings& out) {
  const Slot lost = lost_particle(s, step);
  if (lost < 0) return;
  const auto u = static_cast<std::size_t>(lost);
  const double move = norm(s.particles.velocity[u]) * step / s.particles.sphere[u].r;
  out.warn(
      fmt::format("particle {} moves {:.3g} of its radius in one step, from 1 on a particle counts as lost: the run "
                  "will end at once; take a step below {:.3g} s",
                  s.particles.id.empty() ? lost : s.particles.id[u], move, step / move));
}

void warn_of_step(const SceneTime& time, Findings& out) {
  constexpr double kBiased = 0.4;
  const double share = time.step / time.natural_time;
  if (share >= kBiased)
    out.warn(fmt::format(
        "the step is {:.2f} sqrt(m/k): stable, but forces are off by several percent; 0.2 is as good as 0.05", share));
  constexpr double kManySteps = 1e8;
  if (static_cast<double>(time.steps) > kManySteps)
    out.warn(fmt::format("{:.2g} steps: {}; where overlaps stay small, a lower E allows longer steps (as 1/sqrt(E))",
                         static_cast<double>(time.steps), time.limited_by));
  if (std::isfinite(time.contact_time) && time.step > time.contact_time / 20.0)
    out.warn(
        fmt::format("the shortest impact takes {:.2g} steps: its outcome will be off", time.contact_time / time.step));
  constexpr double kCoarse = 3.0;
  if (time.step > time.reach_time / kCoarse)
    out.warn(
        fmt::format("at the largest speed the attraction at a distance is crossed in {:.2g} steps: what it takes "
                    "from the motion will be off",
                    time.reach_time / time.step));
}

}  // namespace

template <int D>
void check_particles(const ParticlesSceneOf<D>& scene, Findings& out) {
  System<D> s = scene.system;
  const StepLimit limit = step_limit(s);
  out.add("bodies", s.particles.size(),
          fmt::format("{}, {}", counted(s.particles.grains, D == 3 ? "grain" : "disk"),
                      counted(scene.wall_name.size(), "wall")));
  out.add("time_step", scene.time.step,
          fmt::format("step {:.4g} s to {:.4g} s: {}", scene.time.step,
                      scene.time.step * static_cast<double>(scene.time.steps), counted(scene.time.steps, "step")));
  add_sizes(out, drawn_sizes(scene));
  warn_of_radius(s, out);
  if (limit.body >= 0)
    out.add("step_limit", limit.natural_time,
            fmt::format("sqrt(m/k) of the fastest contact: {:.4g} s (grain {})", limit.natural_time, limit.body));
  if (std::isfinite(scene.time.slide_step))
    out.add("slide_step", scene.time.slide_step,
            fmt::format("the stiffest tangential spring is stable to steps of {:.4g} s", scene.time.slide_step));
  if (std::isfinite(scene.time.stable_step))
    out.add("stable_step", scene.time.stable_step,
            fmt::format("the contacts of the start are stable to steps of at least {:.4g} s", scene.time.stable_step));
  if (!scene.time.limited_by.empty())
    out.add("limited_by", scene.time.limited_by, "the step is " + scene.time.limited_by);
  add_solid_fraction(s, out);
  force_pass(s, 0.0);
  const System<D> first = s;
  const double seconds = step_seconds(s, scene.time, out) * static_cast<double>(scene.time.steps);
  const ContactTotals<D> totals = contact_totals(first);
  out.add("contacts", totals.contacts,
          fmt::format("contacts at the start: {}, {:.2f} per grain; {} pairs listed", totals.contacts,
                      totals.coordination_number, first.contacts.size()));
  const double memory = estimated_memory(s.particles.grains, static_cast<double>(s.contacts.size()), D);
  out.add("bytes", memory, fmt::format("memory: about {:.1f} MB beside the program's own", memory / 1e6));
  const double recorded = recorded_bytes(scene, totals.contacts);
  if (recorded > 0.0) out.add_disk(recorded);
  add_overlap(first, out);
  for (const std::string& remark : scene.remarks) out.warn(remark);
  warn_of_step(scene.time, out);
  warn_of_fast(scene.system, scene.time.step, out);
  add_time(seconds, out);
}

template void check_particles<2>(const ParticlesSceneOf<2>&, Findings&);
template void check_particles<3>(const ParticlesSceneOf<3>&, Findings&);

}  // namespace softgrain

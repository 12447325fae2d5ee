// What measuring soft particles takes, and softgrain check of those that are to be measured.
#include "pipelines/kinds/soft_particle/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "common/core/text.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "microsim/particles/scene_memory.h"
#include "microsim/shell_packing.h"
#include "microsim/soft_experiment.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

namespace {

/// Loop passes of a relaxation: along the way to an overlap, at every recorded point, along a slow turn, at every
/// rotated point. Two scenes with the same way and different numbers of points give the first two (results/relaxation,
/// results/published).
struct Passes {
  double way = 0.0;  ///< per Delta
  double point = 0.0;
  double turn = 0.0;  ///< per degree, at the usual speed
  double rotated = 0.0;
};

/// Loop passes of one degree at the usual speed: with real masses in steps of the published protocol, and with raised
/// ones.
constexpr double kTurnPasses = 2.7e3;
constexpr double kRaisedTurnPasses = kTurnPasses / 4.0;

/// Degrees that the first body is turned by at one overlap: to the largest angle of each sign.
double turned_degrees(const MeasurementPlan& plan) {
  double least = 0.0;
  double most = 0.0;
  for (const double a : plan.angles_deg) {
    least = std::min(least, a);
    most = std::max(most, a);
  }
  return most - least;
}

Passes published_passes(PairKind kind, const PublishedOptions& options) {
  const PublishedOptions usual;
  const Passes p = kind == PairKind::soft_solid ? Passes{5.7e5, 2.7e4, kTurnPasses, 4.1e4}
                                                : Passes{2.0e5, 3.9e4, kTurnPasses, 3.6e4};
  const double shorter = usual.step_fraction / options.step_fraction;
  const double rests = static_cast<double>(options.stops + 1) / static_cast<double>(usual.stops + 1);
  return {p.way * shorter, p.point * shorter * rests, p.turn * shorter, p.rotated * shorter * rests};
}

Passes least_work_passes(PairKind kind, const LeastWorkProtocolOptions& options) {
  constexpr double kStep = 2.0;  // at which slow dynamics was counted
  const bool slow = options.increment_passes == 0;
  if (slow) return {6.2e4 * kStep / options.step_factor, 1.8e3, kRaisedTurnPasses, 260.0};
  return kind == PairKind::soft_solid ? Passes{1.0e4, 1.0e3, kRaisedTurnPasses, 260.0}
                                      : Passes{1.8e4, 1.5e3, kRaisedTurnPasses, 260.0};
}

Passes damped_passes(PairKind kind, const DampedProtocolOptions& options) {
  const DampedProtocolOptions usual;
  const Passes p = kind == PairKind::soft_solid ? Passes{2.6e3, 1.6e3, kRaisedTurnPasses, 700.0}
                                                : Passes{3.0e4, 1.5e3, kRaisedTurnPasses, 900.0};
  return {p.way * usual.increment / options.increment, p.point, p.turn, p.rotated};
}

Passes passes_of(const MeasureSetup& setup, Relaxation relaxation, PairKind kind) {
  if (relaxation == Relaxation::published) return published_passes(kind, setup.published);
  if (relaxation == Relaxation::damped) return damped_passes(kind, setup.damped);
  return least_work_passes(kind, least_work_options(setup, relaxation));
}

}  // namespace

MeasureTrial try_soft_particle(const SoftParticleSpec& spec, std::uint64_t seed, double budget) {
  constexpr std::int64_t kPasses = 2000;
  constexpr double kHalfway = 0.15;  // h/Rs
  constexpr double kStep = 0.2;      // of the published protocol
  constexpr double kRestitution = 0.5;
  MeasureTrial t;
  t.packing_seconds = core_seconds_of([&] { t.packing = generate_shell_packing(spec, seed, 0); });
  SoftParticleSpec timed = spec;  // stronger damping would need shorter steps, which take the same time
  timed.restitution = std::max(spec.restitution, kRestitution);
  SoftExperiment e = make_soft_solid(timed, t.packing, false);
  e.push(kHalfway * spec.shell_radius);
  e.set_damping(true);
  VelocityVerlet<3> integrator(kStep * step_limit(e.system).natural_time);
  integrator.initialise(e.system);
  t.pass_seconds = core_seconds_per_call([&] { integrator.step(e.system); }, budget, kPasses);
  return t;
}

double measuring_seconds(const MeasureSetup& setup, Relaxation relaxation, const MeasurementPlan& plan, PairKind kind,
                         double pass_seconds) {
  constexpr double kTwoParticles = 2.0;
  if (plan.deltas.empty()) return 0.0;
  const Passes p = passes_of(setup, relaxation, kind);
  const double turn = p.turn * turned_degrees(plan) * usual_turn_speed(setup.spec) / turn_speed(plan, setup.spec);
  const double passes = p.way * plan.deltas.back() + p.point * static_cast<double>(plan.deltas.size()) +
                        static_cast<double>(plan.tangential_deltas.size()) *
                            (turn + p.rotated * static_cast<double>(plan.angles_deg.size()));
  return passes * pass_seconds * (kind == PairKind::soft_soft ? kTwoParticles : 1.0);
}

namespace {

using nlohmann::json;

struct PointCounts {
  std::int64_t normal = 0;
  std::int64_t rotated = 0;
};

PointCounts count_points(const MeasureSeries& series, PairKind kind) {
  const MeasurementPlan& plan = series.plan(kind);
  return {series.packings * static_cast<std::int64_t>(plan.deltas.size()),
          series.packings * static_cast<std::int64_t>(plan.tangential_deltas.size() * plan.angles_deg.size())};
}

/// Thresholds that the published soft particle has; others lie near, unless they are much looser.
double expected_threshold(PairKind kind) { return kind == PairKind::soft_solid ? 0.1 : 0.21; }

void warn_of_series(const MeasureSeries& series, PairKind kind, Findings& out) {
  constexpr std::int64_t kPackings = 5;  // below it a fit is marked, unless [calibrate] min_packings says otherwise
  constexpr std::int64_t kCrossed = 4;   // three parameters and something to judge them by
  const MeasurementPlan& plan = series.plan(kind);
  const std::string name = to_string(kind);
  if (series.packings < kPackings)
    out.warn(
        fmt::format("{}: only {}; laws differ by 10 % and more between packings, and below {} the fit is "
                    "marked as underdetermined",
                    name, counted(series.packings, "packing"), kPackings));
  const double threshold = expected_threshold(kind);
  const auto above = std::count_if(plan.deltas.begin(), plan.deltas.end(), [=](double d) { return d > threshold; });
  if (above < kCrossed)
    out.warn(
        fmt::format("{}: only {} above Delta = {}, where the published soft particle begins to resist: the "
                    "law will be underdetermined; record more, or deeper",
                    name, counted(above, "overlap"), threshold));
  if (plan.tangential_deltas.empty() || plan.angles_deg.empty())
    out.warn(name + ": nothing is rotated: the law will have no tangential spring");
}

void add_overlaps(const MeasureSeries& series, PairKind kind, Findings& out) {
  constexpr double kLarge = 0.5;
  const std::vector<double>& deltas = series.plan(kind).deltas;
  if (deltas.empty()) return;
  const double overlap = expected_grain_overlap(kind, deltas.back());
  out.add("overlap " + to_string(kind), overlap,
          fmt::format("{}: grains overlap by about {:.2g} of the smaller radius at Delta = {}", to_string(kind),
                      overlap, deltas.back()));
  if (overlap > kLarge)
    out.warn(
        fmt::format("{}: at Delta = {} grains overlap by about {:.2g} of the smaller radius: Hertz' law is one of "
                    "small overlaps",
                    to_string(kind), deltas.back(), overlap));
}

void describe_packing(const MeasureSetup& setup, const ShellPacking& packing, Findings& out) {
  const SoftExperiment e = make_soft_solid(setup.spec, packing, true);
  const StepLimit limit = step_limit(e.system);
  out.add("grains", packing.radius.size(),
          fmt::format("grains in the first packing: {}, solid fraction {:.3f}", packing.radius.size(),
                      packing.solid_fraction()));
  out.facts["solid_fraction"] = packing.solid_fraction();
  out.add("time_step", setup.published.step_fraction * limit.natural_time,
          fmt::format("time step of the published protocol: {:.3g} s, set by grain {} (radius {:.3g} m) at a stiffness "
                      "of {:.3g} N/m",
                      setup.published.step_fraction * limit.natural_time, limit.body,
                      e.system.particles.sphere[static_cast<std::size_t>(limit.body)].r, limit.stiffness));
  const double memory = estimated_memory(static_cast<std::int64_t>(packing.radius.size()),
                                         kPairsPerGrain * static_cast<double>(packing.radius.size()));
  out.add("bytes", memory, "memory: about " + bytes_text(memory) + " for each measurement under way");
  constexpr double kLoose = 0.6;
  if (packing.solid_fraction() < kLoose)
    out.warn(
        fmt::format("the packing is loose (solid fraction {:.3f}; published: 0.70): raise packing.beta or "
                    "packing.trials",
                    packing.solid_fraction()));
  constexpr std::size_t kFew = 50;
  if (packing.radius.size() < kFew)
    out.warn(fmt::format("{} grains in the shell are few: single grains make the law, and packings will differ widely",
                         packing.radius.size()));
}

/// Core seconds of a series; says what it records.
double series_seconds(const MeasureSetup& setup, const MeasureSeries& series, double pass_seconds, Findings& out) {
  double seconds = 0.0;
  for (const PairKind kind : series.kinds) {
    const PointCounts points = count_points(series, kind);
    seconds += static_cast<double>(series.packings) *
               measuring_seconds(setup, series.relaxation, series.plan(kind), kind, pass_seconds);
    out.add(to_string(series.relaxation) + " " + to_string(kind),
            json{{"normal", points.normal}, {"rotated", points.rotated}},
            fmt::format("{} {}: {}, {} normal and {} rotated states", to_string(series.relaxation), to_string(kind),
                        counted(series.packings, "packing"), points.normal, points.rotated));
  }
  return seconds;
}

}  // namespace

double expected_grain_overlap(PairKind kind, double delta) {
  return kind == PairKind::soft_solid ? 0.81 * delta / 0.3 : 0.26 * delta / 0.4;
}

void warn_of_soft_particle(const SoftParticleSpec& spec, Findings& out) {
  out.warn_of_metres("shell_radius", spec.shell_radius);
  out.warn_of_grains(spec.youngs_modulus, spec.density);
  constexpr double kSolid = 0.5;
  if (spec.rmax_over_shell > kSolid)
    out.warn(
        fmt::format("the largest grain has {} of the shell's radius: such packings hold one big grain and little "
                    "else; the published ratio is 0.5",
                    spec.rmax_over_shell));
  constexpr double kStiff = 1e12;
  if (spec.youngs_modulus > kStiff)
    out.warn(
        fmt::format("E = {:.3g} Pa is more than any solid has; results scale with E, so that a softer one costs less "
                    "and says the same",
                    spec.youngs_modulus));
}

MeasureTrial check_measurements(const MeasureSetup& setup, Findings& out) {
  constexpr double kBudget = 0.3;
  const MeasureTrial trial = try_soft_particle(setup.spec, setup.seed, kBudget);
  describe_packing(setup, trial.packing, out);
  double pairs = 0.0;  // packings for second bodies
  for (const MeasureSeries& series : setup.series) {
    out.spend(&series == &setup.series.front() ? "measuring" : "reference",
              series_seconds(setup, series, trial.pass_seconds, out));
    if (std::count(series.kinds.begin(), series.kinds.end(), PairKind::soft_soft) > 0)
      pairs = std::max(pairs, static_cast<double>(series.packings));
  }
  out.spend("packings", trial.packing_seconds * (static_cast<double>(setup.packings()) + pairs));
  if (!setup.series.empty())
    for (const PairKind kind : setup.series.front().kinds) {
      add_overlaps(setup.series.front(), kind, out);
      warn_of_series(setup.series.front(), kind, out);
    }
  warn_of_soft_particle(setup.spec, out);
  for (const std::string& warning : speed_warnings(setup)) out.warn(warning);
  add_sizes(out, shell_sizes(setup.spec, {describe(trial.packing, setup.spec)}));
  return trial;
}

}  // namespace softgrain

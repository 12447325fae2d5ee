#include "pipelines/kinds/soft_particle/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/text.h"
#include "common/data/soft_particle_schema.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/packing/grading_scene.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"

namespace softgrain {

namespace {

/// A number of the soft particle that packings can be made with; what the scene does not give stays as it is.
void read_number(const SceneTable& t, double SoftParticleSpec::*value, SoftParticleSpec& spec) {
  const SoftParticleNumber& number = soft_particle_number(value);
  spec.*value = t.number({number.scene_key, number.asked}, number.unit, number.drawn, spec.*value);
}

void read_material(const SceneTable& t, SoftParticleSpec& spec) {
  for (double SoftParticleSpec::*value :
       {&SoftParticleSpec::youngs_modulus, &SoftParticleSpec::poisson_ratio, &SoftParticleSpec::friction,
        &SoftParticleSpec::density, &SoftParticleSpec::restitution})
    read_number(t, value, spec);
}

void read_largest(const SceneTable& t, SoftParticleSpec& spec) {
  if (t.has("rmax")) {
    const double rmax = t.number({"rmax", "radius of the largest grain, instead of `rmax_over_shell`"}, Unit::length,
                                 Range::positive());
    const std::vector<std::string> keys = t.keys();
    if (std::find(keys.begin(), keys.end(), "rmax_over_shell") != keys.end())
      t.add_error("rmax_over_shell",
                  "contradicts rmax: give the radius of the largest grain, or that over shell_radius, not both");
    if (rmax >= spec.shell_radius)
      t.add_error("rmax", "the shell (shell_radius = " + rounded_text(spec.shell_radius, {6}) +
                              " m) must be larger than the largest grain");
    spec.rmax_over_shell = rmax / spec.shell_radius;
  } else {
    read_number(t, &SoftParticleSpec::rmax_over_shell, spec);
  }
}

/// What else depends on the smallest and largest grain of a distribution.
void set_size_limits(const SceneTable& t, SoftParticleSpec& spec) {
  spec.exponent = std::numeric_limits<double>::quiet_NaN();
  spec.polydispersity = spec.sizes->largest() / spec.sizes->smallest();
  spec.rmax_over_shell = spec.sizes->largest() / spec.shell_radius;
  if (!t.has_errors() && spec.rmax_over_shell >= 1.0)
    t.add_error("sizes",
                fmt::format("the largest grain, of radius {:g} m, must be smaller than the shell (shell_radius = "
                            "{:g} m)",
                            spec.sizes->largest(), spec.shell_radius));
}

void read_packing(const SceneTable& t, SoftParticleSpec& spec) {
  read_number(t, &SoftParticleSpec::shell_radius, spec);
  spec.sizes = read_sizes(
      t, {"sizes", "another distribution of radii, instead of `exponent`, `polydispersity` and the largest radius"},
      {"exponent", "polydispersity", "rmax", "rmax_over_shell"});
  if (spec.sizes) {
    set_size_limits(t, spec);
  } else {
    read_number(t, &SoftParticleSpec::exponent, spec);
    read_number(t, &SoftParticleSpec::polydispersity, spec);
    read_largest(t, spec);
  }
  read_number(t, &SoftParticleSpec::beta, spec);
  spec.trials = t.count({"trials", "random positions tried per grain"}, 1, 1000000000, spec.trials);
  spec.placement = t.choice({"placement",
                             "`trials`: random positions anywhere, as published; `voids`: only positions that may have "
                             "room (17 times faster, statistically equal packings)"},
                            {"trials", "voids"}, "trials") == "voids"
                       ? Placement::voids
                       : Placement::trials;
  if (!t.has_errors()) require_drawable(t, spec);
}

void read_damped(const SceneTable& t, DampedProtocolOptions& o) {
  o.increment = t.number({"increment", "largest step in Delta"}, Unit::none, Range::closed(1e-7, 0.1), o.increment);
  o.tolerance =
      t.number({"tolerance", "tolerance at recorded points: largest net force on a grain over the mean contact force"},
               Unit::none, Range{0.0, 1.0, true, false}, o.tolerance);
  o.tolerance_between = t.number({"tolerance_between", "tolerance at increments between recorded points"}, Unit::none,
                                 Range{0.0, 10.0, true, false}, o.tolerance_between);
  o.tolerance_rotated = t.number({"tolerance_rotated", "tolerance at recorded points after a rotation"}, Unit::none,
                                 Range{0.0, 1.0, true, false}, o.tolerance_rotated);
  o.max_passes = t.count({"max_passes", "largest number of loop passes per relaxation"}, 10, 100000000, o.max_passes);
}

constexpr double kFastestPlane = 10.0;         ///< over sqrt(E/rho)
constexpr std::int64_t kMostPasses = 1000000;  ///< largest number of passes of one increment by least work

void read_least_work(const SceneTable& t, const SoftParticleSpec& spec, LeastWorkProtocolOptions& o) {
  o.increment = t.number({"increment", "step in Delta between two equilibria"}, Unit::none, Range::closed(1e-7, 0.1),
                         o.increment);
  o.tolerance_between = t.number({"tolerance_between", "tolerance at increments between recorded points"}, Unit::none,
                                 Range{0.0, 10.0, true, false}, o.tolerance_between);
  o.tolerance =
      t.number({"tolerance", "tolerance at recorded points: largest net force on a grain over the mean contact force"},
               Unit::none, Range{0.0, 1.0, true, false}, o.tolerance);
  o.increment_passes = t.count({"increment_passes",
                                "`least-work`: if an increment is not in equilibrium after this number of loop passes, "
                                "dynamics takes it over; 0: `slow-dynamics`"},
                               0, kMostPasses, o.increment_passes);
  if (t.has("approach_speed"))
    o.approach_speed = t.number(
        {"approach_speed", "speed of the plane in dynamics, 1e-7 to 10 of sqrt(E/rho); above 0.1 with a warning",
         "0.002 m/s at the published parameters, scaled with sqrt(E/rho)"},
        Unit::velocity, approach_speeds(spec, kFastestPlane));
  o.step_factor = t.number(
      {"step_factor",
       "time step of dynamics over that of the published protocol; the quickest grains are made heavier accordingly"},
      Unit::none, Range::closed(kShortestStep, 20.0), o.step_factor);
  o.settle_time = t.number({"settle_time", "time of dynamics before a point is recorded, over Rs sqrt(rho/E)"},
                           Unit::none, Range::closed(0.0, kLongestSettling), o.settle_time);
  o.path_settle_time = t.number({"path_settle_time",
                                 "time of dynamics, at most `settle_time`, after which the next increment or rotation "
                                 "starts, over Rs sqrt(rho/E)"},
                                Unit::none, Range::closed(0.0, kLongestSettling), o.path_settle_time);
  o.settle_time_rotated = t.number({"settle_time_rotated", "time of dynamics after a rotation, over Rs sqrt(rho/E)"},
                                   Unit::none, Range::closed(0.0, kLongestSettling), o.settle_time_rotated);
  o.step_factor_rotated =
      t.number({"step_factor_rotated", "as `step_factor`, but after a rotation; during a rotation the factor is 4"},
               Unit::none, Range::closed(kShortestStep, 20.0), o.step_factor_rotated);
  o.max_passes = t.count({"max_passes", "largest number of loop passes of the last relaxation of a recorded point"}, 10,
                         100000000, o.max_passes);
}

void read_published(const SceneTable& t, const SoftParticleSpec& spec, PublishedOptions& o) {
  if (t.has("approach_speed"))
    o.approach_speed =
        t.number({"approach_speed", "speed of the plane, 1e-7 to 10 of sqrt(E/rho); above 0.1 with a warning",
                  "0.002 m/s at the published parameters, scaled with sqrt(E/rho)"},
                 Unit::velocity, approach_speeds(spec, kFastestPlane));
  if (t.has("stop_interval"))
    o.stop_interval = t.number({"stop_interval", "time between two stops of all motion, at most 1e6 Rs sqrt(rho/E)",
                                "0.3 s at the published parameters, scaled with Rs sqrt(rho/E)"},
                               Unit::time, Range{0.0, kLongestSettling * natural_time(spec), true, false});
  o.stops = static_cast<int>(
      t.count({"stops", "number of stops; one more interval follows the last stop"}, 0, 1000, o.stops));
  o.step_fraction = t.number(
      {"step_fraction",
       "time step over sqrt(m_min/k): m_min is the mass of the smallest grain, k its stiffness at 5 % overlap"},
      Unit::none, Range::closed(kShortestStep * kPublishedStep, 0.6), o.step_fraction);
  o.crowded_fraction =
      t.number({"crowded_fraction",
                "largest time step over sqrt(m/K): m is the mass of a grain, K the sum of its contact stiffnesses"},
               Unit::none, Range::closed(kShortestStep, 1.0), o.crowded_fraction);
  o.tolerance = t.number(
      {"tolerance",
       "below this tolerance (largest net force on a grain over the mean contact force) a point counts as converged"},
      Unit::none, Range{0.0, 1.0, true, false}, o.tolerance);
}

/// Neither so slow that no run comes to an end, nor as fast as sound in the grains.
void read_turn(const SceneTable& measure, const SoftParticleSpec& spec, MeasurementPlan& plan) {
  constexpr double kSlowest = 1e-7;  // over sqrt(E/rho)
  constexpr double kFastest = 1e-2;
  plan.rotation_step_deg = measure.number(
      {"rotation_step_deg", "largest rotation between two updates of the velocity directions; needs `angles_deg`"},
      Unit::angle_degree, Range::closed(1e-4, 5.0), plan.rotation_step_deg);
  if (!measure.has("turn_speed") || measure.has_errors()) return;
  const double wave_speed = std::sqrt(spec.youngs_modulus / spec.density);
  plan.turn_speed = measure.number(
      {"turn_speed", "speed of the shell surface in a rotation, 1e-7 to 1e-2 of sqrt(E/rho); needs `angles_deg`",
       "0.002 m/s at the published parameters, scaled with sqrt(E/rho)"},
      Unit::velocity, Range::closed(kSlowest * wave_speed, kFastest * wave_speed), plan.turn_speed);
}

void require_ascending(const SceneTable& t, const std::string& key, const std::vector<double>& values) {
  if (values.empty()) t.add_error(key, "at least one value is needed");
  for (std::size_t k = 1; k < values.size(); ++k)
    if (values[k] <= values[k - 1]) t.add_error(key, "values must ascend");
}

void require_subset(const SceneTable& t, const std::vector<double>& some, const std::vector<double>& all) {
  for (const double x : some)
    if (std::none_of(all.begin(), all.end(), [x](double y) { return std::abs(x - y) < 1e-9; }))
      t.add_error("tangential_deltas", fmt::format("{:g} is not among deltas", x));
}

/// Largest overlap that makes sense: at 1 the plane would have reached the centre of the shell.
const Range kDeltaRange{0.0, 0.9, true, false};

MeasurementPlan read_plan(const SceneTable& t, const MeasurementPlan& common) {
  MeasurementPlan plan = common;
  plan.deltas = t.numbers({"deltas", "recorded overlaps Delta = hn/Rs, ascending"}, Unit::none, kDeltaRange);
  require_ascending(t, "deltas", plan.deltas);
  plan.angles_deg =
      t.numbers({"angles_deg", "rotation angles of the first particle, of one or both signs, without 0", "none"},
                Unit::angle_degree, Range::closed(-90.0, 90.0), {});
  for (const double a : plan.angles_deg)
    if (a == 0.0) t.add_error("angles_deg", "0 is recorded anyway; leave it out");
  plan.tangential_deltas =
      t.numbers({"tangential_deltas", "those of `deltas` at which the particle is rotated", "all, if there are angles"},
                Unit::none, kDeltaRange, plan.angles_deg.empty() ? std::vector<double>{} : plan.deltas);
  if (plan.angles_deg.empty() && !plan.tangential_deltas.empty())
    t.add_error("tangential_deltas", "goes with angles_deg: nothing is rotated without angles");
  if (!t.has_errors()) require_subset(t, plan.tangential_deltas, plan.deltas);
  return plan;
}

/// Least work that leaves every increment to dynamics is called by what it does.
Relaxation read_relaxation(const SceneTable& t, const Key& key, Relaxation fallback,
                           const LeastWorkProtocolOptions& least_work) {
  const auto said = t.choice<Relaxation>(key, fallback);
  const bool slow = said == Relaxation::least_work && least_work.increment_passes == 0;
  return slow ? Relaxation::slow_dynamics : said;
}

/// Slow dynamics makes no increment by least work, and must not be asked for some.
void require_increments_used(const SceneTable& measure, Relaxation relaxation, bool least_work_too) {
  if (relaxation != Relaxation::slow_dynamics || least_work_too) return;
  const SceneTable t = measure.table_or_empty("least_work");
  if (t.has("increment_passes") && t.count("increment_passes", 0, kMostPasses) > 0)
    t.add_error("increment_passes",
                "relaxation = \"slow-dynamics\" makes no increment by least work: 0, or relaxation = \"least-work\"");
}

MeasureSeries read_series(const SceneTable& t, Relaxation relaxation, std::int64_t packings,
                          const MeasurementPlan& common) {
  MeasureSeries series;
  series.relaxation = relaxation;
  series.packings = packings;
  if (t.has("soft_solid")) {
    series.kinds.push_back(PairKind::soft_solid);
    series.soft_solid = read_plan(
        t.table({"soft_solid",
                 "recorded states of a soft particle against a plane; this table, `soft_soft` or both are needed"}),
        common);
  }
  if (t.has("soft_soft")) {
    series.kinds.push_back(PairKind::soft_soft);
    series.soft_soft = read_plan(t.table({"soft_soft",
                                          "recorded states of a soft particle against another one of the same size "
                                          "with other grains; as `soft_solid`"}),
                                 common);
  }
  if (series.kinds.empty())
    t.add_error("soft_solid", "neither soft_solid nor soft_soft is measured; give at least one");
  return series;
}

}  // namespace

void refuse_idle_protocols(const SceneTable& measure, const std::vector<Relaxation>& relaxations, bool rotates) {
  const auto one_of = [&](std::initializer_list<Relaxation> some) {
    return std::any_of(relaxations.begin(), relaxations.end(),
                       [&](Relaxation r) { return std::find(some.begin(), some.end(), r) != some.end(); });
  };
  const auto goes_with = [&](const char* table, bool used, const char* relaxation) {
    if (used || !measure.has(table)) return;
    if (measure.table_or_empty(table).keys().empty()) return;
    measure.add_error(
        table, fmt::format("nothing is relaxed this way: goes with relaxation = {}; leave the table out", relaxation));
  };
  goes_with("damped", one_of({Relaxation::damped}), "\"damped\"");
  goes_with("published", one_of({Relaxation::published}), "\"published\"");
  goes_with("least_work", one_of({Relaxation::least_work, Relaxation::slow_dynamics}),
            "\"least-work\" or \"slow-dynamics\"");
  if (rotates) return;
  measure.refuse({"turn_speed", "rotation_step_deg", "shell_turns", "rotation"},
                 "goes with angles_deg: nothing is rotated in this scene");
  if (measure.has("damped"))
    measure.table("damped").refuse({"tolerance_rotated"}, "goes with angles_deg: nothing is rotated in this scene");
}

void require_drawable(const SceneTable& t, const SoftParticleSpec& spec) {
  constexpr double kMost = 1e7;
  if (spec.sizes) {
    const double all = spec.beta * cube(spec.shell_radius) / spec.sizes->mean_volume();
    if (all > kMost)
      t.add_error("sizes",
                  fmt::format("{:.3g} grains of these sizes have the volume of beta = {:g} shells, allowed are "
                              "at most 1e7",
                              all, spec.beta));
    return;
  }
  const double b = spec.exponent;
  const double p = spec.polydispersity;
  const double third_moment = b == 4.0
                                  ? 3.0 * std::log(p) / (std::pow(p, 3.0) - 1.0)
                                  : (b - 1.0) / (b - 4.0) * (std::pow(p, b - 4.0) - 1.0) / (std::pow(p, b - 1.0) - 1.0);
  const double grains = spec.beta / (third_moment * std::pow(spec.rmax_over_shell, 3.0));
  if (grains <= kMost) return;
  std::ostringstream problem;
  problem << "beta = " << spec.beta << " with rmax_over_shell = " << spec.rmax_over_shell << ", polydispersity = " << p
          << " and exponent = " << b << " draws about " << grains << " grains per packing, allowed are at most 1e7";
  t.add_error(t.has("polydispersity") ? "polydispersity" : "beta", problem.str());
}

std::int64_t MeasureSetup::packings() const {
  std::int64_t most = 0;
  for (const MeasureSeries& s : series) most = std::max(most, s.packings);
  return most;
}

bool MeasureSetup::rotates() const {
  return std::any_of(series.begin(), series.end(), [](const MeasureSeries& s) {
    return std::any_of(s.kinds.begin(), s.kinds.end(), [&](PairKind k) { return !s.plan(k).angles_deg.empty(); });
  });
}

bool MeasureSetup::turns_on() const {
  const auto several = [](const std::vector<double>& angles) {
    const auto positive = std::count_if(angles.begin(), angles.end(), [](double a) { return a > 0.0; });
    const auto negative = std::count_if(angles.begin(), angles.end(), [](double a) { return a < 0.0; });
    return std::max(positive, negative) > 1;
  };
  return std::any_of(series.begin(), series.end(), [&](const MeasureSeries& s) {
    return std::any_of(s.kinds.begin(), s.kinds.end(), [&](PairKind k) { return several(s.plan(k).angles_deg); });
  });
}

Range approach_speeds(const SoftParticleSpec& spec, double fastest) {
  const double wave_speed = std::sqrt(spec.youngs_modulus / spec.density);
  return Range::closed(kSlowestApproach * wave_speed, fastest * wave_speed);
}

std::vector<std::string> speed_warnings(const MeasureSetup& setup) {
  const double wave_speed = std::sqrt(setup.spec.youngs_modulus / setup.spec.density);
  std::vector<std::string> out;
  const auto add = [&](const char* table, double speed) {
    if (speed > kFastestApproach * wave_speed)
      out.push_back(fmt::format(
          "[measure.{}] approach_speed = {:.3g} m/s is {:.2g} of sqrt(E/rho): above {:g} waves rearrange the grains, "
          "and forces need not be those of slow loading",
          table, speed, speed / wave_speed, kFastestApproach));
  };
  add("least_work", setup.least_work.approach_speed);
  add("published", setup.published.approach_speed);
  return out;
}

std::vector<std::string> warnings_of(const MeasureSetup& setup, const MeasureResult& result) {
  std::vector<std::string> out = speed_warnings(setup);
  out.insert(out.end(), result.left_out.begin(), result.left_out.end());
  return out;
}

SoftParticleSpec read_soft_particle(const SceneTable& root) {
  SoftParticleSpec spec;
  read_material(root.table_or_empty({"material", "material of the grains"}), spec);
  read_packing(root.table_or_empty({"packing", "packings of grains in soft particles"}), spec);
  return spec;
}

MeasureSetup read_measure_protocols(const SceneTable& root, Relaxation& relaxation, MeasurementPlan& plan) {
  MeasureSetup setup;
  setup.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
  setup.spec = read_soft_particle(root);
  const SceneTable measure = root.table_or_empty({"measure", "measurements of soft particles"});
  read_damped(measure.table_or_empty({"damped", "settings of the relaxation `damped`"}), setup.damped);
  read_published(measure.table_or_empty({"published", "settings of the relaxation `published`"}), setup.spec,
                 setup.published);
  read_least_work(
      measure.table_or_empty({"least_work", "settings of the relaxations `least-work` and `slow-dynamics`"}),
      setup.spec, setup.least_work);
  read_turn(measure, setup.spec, plan);
  plan.shell_turns = measure.flag(
      {"shell_turns",
       "true: the shell rotates with its grains; false: it stands still, and the grains do not reach the angle"},
      plan.shell_turns);
  plan.cumulative = measure.choice({"rotation",
                                    "`fresh`: each angle starts from the relaxed state without rotation; `cumulative`: "
                                    "from the relaxed state of the previous angle"},
                                   {"fresh", "cumulative"}, "fresh") == "cumulative";
  relaxation = read_relaxation(measure, {"relaxation", "method that brings grains to equilibrium"},
                               Relaxation::least_work, setup.least_work);
  return setup;
}

MeasureSetup read_measure_setup(const SceneTable& root) {
  Relaxation relaxation{};
  MeasurementPlan common;
  MeasureSetup setup = read_measure_protocols(root, relaxation, common);
  const SceneTable measure = root.table("measure");
  const std::int64_t count = root.table_or_empty("packing").count({"count", "number of packings"}, 1, 100000, 7);
  setup.series.push_back(read_series(measure, relaxation, count, common));
  if (root.has("reference")) {
    const SceneTable reference =
        root.table({"reference", "second series of measurements, which is compared with the first"});
    const Relaxation other =
        read_relaxation(reference, {"relaxation", "method of the second series; another one than that of `measure`"},
                        Relaxation::published, setup.least_work);
    if (!measure.has_errors() && other == setup.series[0].relaxation)
      reference.add_error("relaxation", "the reference must differ from measure.relaxation");
    setup.series.push_back(read_series(
        reference, other,
        reference.count({"count", "number of packings of the second series", "as `packing.count`"}, 1, 100000, count),
        common));
  }
  if (!root.has_errors()) {
    std::vector<Relaxation> relaxations;
    for (const MeasureSeries& s : setup.series) relaxations.push_back(s.relaxation);
    refuse_idle_protocols(measure, relaxations, setup.rotates());
    if (measure.has("rotation") && setup.rotates() && !setup.turns_on())
      measure.add_error("rotation", "goes with two angles of one sign: there is nothing that a turn could go on from");
  }
  if (!root.has_errors())
    require_increments_used(measure, setup.series.front().relaxation,
                            setup.series.back().relaxation == Relaxation::least_work);
  setup.kept_states = read_kept_states(root);
  return setup;
}

SoftParticleScene read_soft_particle_scene(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.choice(kKindKey, {"soft-particle"});
    return SoftParticleScene{root.title(), read_measure_setup(root)};
  });
}

LeastWorkProtocolOptions least_work_options(const MeasureSetup& setup, Relaxation relaxation) {
  LeastWorkProtocolOptions options = setup.least_work;
  if (relaxation == Relaxation::slow_dynamics) options.increment_passes = 0;
  return options;
}

std::unique_ptr<Protocol> make_protocol(const MeasureSetup& setup, Relaxation relaxation) {
  if (relaxation == Relaxation::published) return make_published_protocol(setup.published);
  if (relaxation == Relaxation::damped) return make_damped_protocol(setup.damped);
  return make_least_work_protocol(least_work_options(setup, relaxation));
}

std::string settings_text(const MeasureSetup& setup, Relaxation relaxation) {
  const auto speed = [&](double given) { return given > 0.0 ? given : published_speed(setup.spec); };
  if (relaxation == Relaxation::published) {
    const PublishedOptions& o = setup.published;
    return fmt::format(
        "approach_speed = {} m/s, stop_interval = {} s, stops = {}, step_fraction = {}, crowded_fraction = {}, "
        "tolerance = {}",
        speed(o.approach_speed), o.stop_interval > 0.0 ? o.stop_interval : published_interval(setup.spec), o.stops,
        o.step_fraction, o.crowded_fraction, o.tolerance);
  }
  if (relaxation == Relaxation::damped) {
    const DampedProtocolOptions& o = setup.damped;
    return fmt::format("increment = {}, tolerance = {}, tolerance_between = {}, tolerance_rotated = {}", o.increment,
                       o.tolerance, o.tolerance_between, o.tolerance_rotated);
  }
  const LeastWorkProtocolOptions o = least_work_options(setup, relaxation);
  return fmt::format(
      "increment = {}, increment_passes = {}, approach_speed = {} m/s, step_factor = {}, settle_time = {}, "
      "path_settle_time = {}, settle_time_rotated = {}, step_factor_rotated = {}, tolerance = {}, tolerance_between = "
      "{}",
      o.increment, o.increment_passes, speed(o.approach_speed), o.step_factor, o.settle_time, o.path_settle_time,
      o.settle_time_rotated, o.step_factor_rotated, o.tolerance, o.tolerance_between);
}

}  // namespace softgrain

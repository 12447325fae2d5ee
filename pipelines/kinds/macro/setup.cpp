// Reads [macro]: its bodies, how they are brought together, their test. Parts of it are of materials and recipes too.
#include "pipelines/kinds/macro/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/contact/rolling_scene.h"
#include "common/core/text.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/io/text_file.h"
#include "common/packing/grading_scene.h"
#include "macrosim/preparation.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/law/law_draws.h"

namespace softgrain {

void refuse_protocol_keys(const SceneTable& t) {
  t.refuse({"inertial_number", "compaction_mu", "compaction_restitution", "coarse_share", "first_pressure",
            "preparation_tolerance", "preparation_passes", "balance"},
           "LAMMPS has a protocol of its own: goes without preparation = \"lammps\"");
}

namespace {

/// Over E as a number, as a pressure with its unit: that stays what it is where a later table changes E.
void read_start_pressure(const SceneTable& t, MacroSetup& setup) {
  // Below, overlaps are lost in the rounding of the places, and a box that shrinks so slowly comes to no end.
  constexpr Range kOverModulus{1e-15, 1e-2, false, false};
  const Key key{"start_pressure",
                "pressure at the end of the preparation: a number is over E, a text with a unit is a pressure "
                "(`\"50 kPa\"`), from 1e-15 to 0.01 E"};
  MacroSpec& spec = setup.spec;
  if (t.is_text(key.name)) {
    setup.start_stress = t.number(key, Unit::pressure, Range::positive());
  } else {
    if (t.has(key.name)) setup.start_stress = 0.0;
    spec.start_pressure = t.number(key, Unit::none, kOverModulus, spec.start_pressure);
  }
  if (!(setup.start_stress > 0.0)) return;
  spec.start_pressure = setup.start_stress / spec.youngs_modulus;
  if (spec.start_pressure >= kOverModulus.low && spec.start_pressure <= kOverModulus.high) return;
  t.add_error(key.name, fmt::format("is {:.3g} E with E = {}; allowed: from {:g} to {:g} E", spec.start_pressure,
                                    pressure_text(spec.youngs_modulus), kOverModulus.low, kOverModulus.high));
  spec.start_pressure = std::clamp(spec.start_pressure, kOverModulus.low, kOverModulus.high);
}

}  // namespace

/// A name stands for all that defines a preparation; keys beside it replace single parts, whichever table gave them.
void read_preparation(const SceneTable& t, MacroSetup& setup) {
  MacroSpec& spec = setup.spec;
  spec.preparation = t.choice<Preparation>(
      {"preparation",
       "how particles are compacted; sets those of the keys from `start_fraction` to `preparation_passes` that are not "
       "given. `\"softgrain\"`: as `\"frictionless\"`; `\"lammps\"` goes with `--engine lammps`"},
      spec.preparation);
  const bool renewed = t.has("preparation") || t.has("mu");
  const PreparationProtocol named = protocol_of(spec.preparation, spec.friction);
  read_start_pressure(t, setup);
  PreparationProtocol& p = spec.protocol;
  const auto follows = [&](const std::string& key) {  // from the name and mu, as nobody said it
    if (t.has(key)) setup.said.insert(key);
    return renewed && !setup.said.contains(key);
  };
  using Protocol = PreparationProtocol;
  const auto read = [&](const SceneTable& from, const Key& key, double Protocol::*part, const Range& range) {
    if (follows(key.name)) p.*part = named.*part;
    p.*part = from.number(key, Unit::none, range, p.*part);
  };
  read(t, {"start_fraction", "solid fraction at placement (`construction = \"mixed\"` only)"},
       &Protocol::start_fraction, Range::closed(0.05, 0.4));
  read(t,
       {"inertial_number",
        "strain rate of the box times d sqrt(density/pressure), with the mean diameter d; 0: no motion",
        "0; `\"fast\"`, `\"poured\"`, `\"rodded\"`: 0.1, `\"slow\"`: 1e-3"},
       &Protocol::inertial_number, Range::closed(0.0, 1.0));
  read(t,
       {"compaction_mu", "friction between particles during the preparation; above 0, walls have `wall_mu`",
        "0; `\"fast\"`, `\"slow\"`, `\"poured\"`: `mu`; `\"rodded\"`: `mu`, at most 0.1"},
       &Protocol::friction, Range::friction());
  read(t, {"compaction_restitution", "coefficient of restitution during motion"}, &Protocol::restitution,
       Range::closed(0.05, 1.0));
  read(t, {"coarse_share", "volume share of the largest particles, which jam first", "1; `\"dense\"`: 0.75"},
       &Protocol::coarse_share, Range{0.0, 1.0, true, false});
  read(t,
       {"first_pressure", "first pressure over `start_pressure`",
        "128; `\"fast\"`, `\"slow\"`, `\"poured\"`, `\"rodded\"`: 1"},
       &Protocol::first_pressure, Range::closed(1.0, 1e6));
  read(t,
       {"preparation_tolerance",
        "largest net force over mean contact force at the end; with more than 2000 particles one in 2000 may exceed "
        "it. The pressure is met to a third of this value",
        "0.03; scenes of materials: 3e-3"},
       &Protocol::tolerance, Range{0.0, 0.1, true, false});
  if (follows("preparation_passes")) p.max_passes = named.max_passes;
  p.max_passes =
      t.count({"preparation_passes", "largest number of loop passes of a relaxation"}, 10, 100000000, p.max_passes);
  spec.balance = t.choice<Balance>(
      {"balance",
       "what net forces are compared with: `\"mean-force\"`: the mean contact force. `\"own-load\"`: where that is "
       "more, a sixth of what a particle of its radius r bears under the mean stress p, 4 pi r^2 p. Takes fewer passes "
       "where radii span a factor of 30 or more. In preparation and test"},
      spec.balance);
  if (spec.preparation == Preparation::lammps) refuse_protocol_keys(t);
  if (!(p.inertial_number > 0.0))
    t.refuse({"compaction_restitution"}, "nothing moves at inertial_number = 0: give one, or preparation = \"fast\"");
  if (spec.construction != Construction::voids) return;
  if (spec.preparation == Preparation::lammps)
    t.add_error("preparation",
                "\"lammps\" goes with construction \"mixed\": holes are filled in a packing that is compacted");
  if (p.coarse_share < 1.0)
    t.add_error(t.has("coarse_share") ? "coarse_share" : "preparation",
                "fines grow between coarse bodies of construction \"mixed\" alone");
  t.refuse({"start_fraction"}, "construction \"voids\" begins at solid_fill");
}

void read_density(const SceneTable& t, MacroSetup& setup) {
  const Key fraction{
      "solid_fraction",
      "target: solid fraction of all particles (soft ones by their shells) at `start_pressure`; each "
      "sample is prepared again and again, with `compaction_mu` between 0 and its value, until it is met",
      "no target"};
  const Key ratio{"void_ratio", "the target as a void ratio", "no target"};
  const Key dry{"dry_density", "the target as mass of the grains per volume", "no target"};
  std::vector<std::string> given;
  const auto take = [&](DensityMeasure measure, const Key& key, Unit unit, const Range& range) {
    const double value = t.number(key, unit, range, 0.0);
    if (!t.has(key.name)) return;
    given.push_back(key.name);
    if (given.size() > 1) t.add_error(key.name, "the target is given as " + given.front() + ": give one of the two");
    if (!setup.density) setup.density.emplace();
    setup.density->measure = measure;
    setup.density->value = value;
  };
  take(DensityMeasure::solid_fraction, fraction, Unit::none, Range{0.0, 1.0, true, true});
  take(DensityMeasure::void_ratio, ratio, Unit::none, Range::positive());
  take(DensityMeasure::dry_density, dry, Unit::density, Range::positive());
  const Key key{"solid_fraction_tolerance", "largest difference from the target, in solid fraction"};
  const double fallback = setup.density ? setup.density->tolerance : DensityTarget{}.tolerance;
  const double tolerance = t.number(key, Unit::none, Range::closed(1e-5, 0.05), fallback);
  if (setup.density)
    setup.density->tolerance = tolerance;
  else if (t.has(key.name))
    t.add_error(key.name, "goes with a target: solid_fraction, void_ratio or dry_density");
}

void require_density(const SceneTable& t, const MacroSetup& setup) {
  if (!setup.density) return;
  const std::string key = to_string(setup.density->measure);
  if (setup.spec.preparation == Preparation::lammps)
    return t.add_error(key, "goes with a preparation by this program, which searches the friction that meets it");
  if (!(setup.spec.protocol.friction > 0.0))
    return t.add_error(key,
                       "is met by the friction during the preparation, which has none: give preparation = "
                       "\"fast\", \"slow\", \"poured\" or \"rodded\" and mu above 0, or compaction_mu above 0");
  if (setup.density->measure == DensityMeasure::dry_density && !(setup.density->value < setup.spec.density))
    t.add_error(key, fmt::format("must be below the density of the grains, {:g} kg/m^3", setup.spec.density));
}

namespace {

/// Keys of a power law take the place of a distribution that a common [macro] gave.
void read_power_laws(const SceneTable& t, MacroSpec& spec) {
  if (t.has("solid_radius_max") || t.has("solid_polydispersity")) spec.solid_sizes.reset();
  if (t.has("soft_radius_max") || t.has("soft_polydispersity")) spec.soft_sizes.reset();
  spec.solid_radius_max = t.number({"solid_radius_max", "largest radius of the solid grains", "shell radius Rs"},
                                   Unit::length, Range::positive(), spec.solid_radius_max);
  spec.solid_polydispersity = t.number({"solid_polydispersity", "largest over smallest radius of the solid grains"},
                                       Unit::none, kSizeRatios, spec.solid_polydispersity);
  spec.soft_radius_max = t.number({"soft_radius_max", "largest radius of the soft particles", "shell radius Rs"},
                                  Unit::length, Range::positive(), spec.soft_radius_max);
  spec.soft_polydispersity = t.number(
      {"soft_polydispersity",
       "largest over smallest radius of the soft particles; `construction = \"voids\"`: smaller voids stay empty"},
      Unit::none, kSizeRatios, spec.soft_polydispersity);
}

/// What else depends on the largest and the smallest body.
void set_size_limits(const std::optional<Grading>& sizes, double& radius_max, double& polydispersity) {
  if (!sizes) return;
  radius_max = sizes->largest();
  polydispersity = sizes->largest() / sizes->smallest();
}

void read_bodies(const SceneTable& t, MacroSetup& setup) {
  MacroSpec& spec = setup.spec;
  spec.boundary =
      t.choice<Boundary>({"boundary",
                          "`\"walls\"`: box of six planes; `\"periodic\"`: periodic along all axes; the edges must "
                          "exceed two diameters of the largest particle, and the stress is that of the contacts"},
                         spec.boundary);
  spec.construction =
      t.choice<Construction>({"construction",
                              "`\"mixed\"`: all particles are placed and compacted together; `\"voids\"`: solid grains "
                              "come first, then soft particles fill their voids up to `soft_share`, largest first"},
                             spec.construction);
  spec.bodies = t.count(
      {"bodies",
       "number of solid grains and soft particles together; with `construction = \"voids\"` of solid grains only"},
      1, 10000000, spec.bodies);
  spec.soft_share =
      t.number({"soft_share", "volume share of the soft particles", "0.45; with a card of the cell law 0"}, Unit::none,
               Range::closed(0.0, 1.0), spec.soft_share);
  spec.exponent =
      t.number({"exponent", "b of the power laws P(r) ~ r^-b of the radii of solid grains and soft particles",
                "that of the grains in the soft particles; 3.5 if these have `sizes` or are not known"},
               Unit::none, kSizeExponents, spec.exponent);
  read_power_laws(t, spec);
  if (t.has("solid_sizes"))
    spec.solid_sizes =
        read_sizes(t, {"solid_sizes", "another distribution of radii of the solid grains instead of the power law"},
                   {"solid_radius_max", "solid_polydispersity"});
  if (t.has("soft_sizes"))
    spec.soft_sizes = read_sizes(
        t, {"soft_sizes", "another distribution of radii of the soft particles; not with `construction = \"voids\"`"},
        {"soft_radius_max", "soft_polydispersity"});
  if (spec.solid_sizes && spec.soft_sizes)
    t.refuse({"exponent"}, "goes without solid_sizes and soft_sizes, which say all sizes");
  set_size_limits(spec.solid_sizes, spec.solid_radius_max, spec.solid_polydispersity);
  set_size_limits(spec.soft_sizes, spec.soft_radius_max, spec.soft_polydispersity);
  if (spec.construction == Construction::voids && spec.soft_sizes)
    t.add_error("soft_sizes",
                "construction \"voids\" makes soft particles as large as the holes between solid grains: "
                "give soft_radius_max and soft_polydispersity, or construction \"mixed\"");
  spec.solid_fill = t.number({"solid_fill",
                              "`construction = \"voids\"`: share of the box that solid grains fill when soft particles "
                              "are inserted; then all are brought into contact",
                              "0.44 (1 - `soft_share`)"},
                             Unit::none, Range{0.0, 0.74, false, true}, spec.solid_fill);
  if (spec.construction == Construction::mixed)
    t.refuse({"solid_fill"}, "goes with construction = \"voids\", which fills solid grains first");
  if (spec.construction == Construction::voids && spec.soft_share >= 1.0)
    t.add_error("soft_share", "construction \"voids\" needs solid grains: must be below 1");
  spec.friction = t.number({"mu", "friction of particles", "as `[material]`, or as the law"}, Unit::none,
                           Range::friction(), spec.friction);
  spec.wall_friction = t.number({"wall_mu", "friction of walls"}, Unit::none, Range::friction(), spec.wall_friction);
  if (spec.boundary == Boundary::periodic) t.refuse({"wall_mu"}, "a periodic cell has no walls");
  read_rolling_resistance(t, spec.friction, spec.rolling);
  read_preparation(t, setup);
  read_density(t, setup);
}

}  // namespace

void read_test(const SceneTable& t, MacroSpec& spec) {
  if (t.has("test"))
    spec.test = t.choice<MacroTest>(
        {"test",
         "`\"oedometric\"` or `\"isotropic\"` compression; `\"shear\"` at constant volume: z shortens and x lengthens "
         "by the same logarithmic strain; `\"undrained\"`: triaxial at constant volume; `\"simple-shear\"` at constant "
         "volume; `\"direct-shear\"`: simple shear at constant stress along z. `[[stage]]` tables replace it by a "
         "sequence of loadings",
         "\"oedometric\""},
        {MacroTest::oedometric, MacroTest::isotropic, MacroTest::shear, MacroTest::undrained, MacroTest::simple_shear,
         MacroTest::direct_shear});
  if (spec.test == MacroTest::simple_shear || spec.test == MacroTest::direct_shear) require_sliding(t, "test", spec);
  spec.strain_end =
      t.number({"strain", "strain at the end"}, Unit::none, Range::closed(kLeastStrain, 0.5), spec.strain_end);
  spec.preload =
      t.number({"preload",
                "`\"shear\"`, `\"undrained\"`, `\"simple-shear\"`, `\"direct-shear\"`: isotropic strain before the "
                "shear, recorded as strains -`preload` to 0"},
               Unit::none, Range{0.0, 0.5, false, false}, spec.preload);
  spec.preload_steps = t.count({"preload_steps", "recorded points of the preload"}, 1, 100000, spec.preload_steps);
  spec.steps = t.count({"steps", "recorded points"}, 1, 100000, spec.steps);
  spec.increments_per_step = t.count({"increments_per_step", "relaxed strain increments per recorded point"}, 1, 10000,
                                     spec.increments_per_step);
  spec.tolerance = t.number({"tolerance", "equilibrium: largest net force over the mean contact force"}, Unit::none,
                            Range{0.0, 1.0, true, false}, spec.tolerance);
  spec.force_floor =
      t.number({"force_floor",
                "least value of the mean contact force in `tolerance`, over E R^2; R is the largest radius. A tenth of "
                "the default changed the end stress of a small twin by 1 % at 2.3 times the cost"},
               Unit::none, Range{0.0, 1e-2, true, false}, spec.force_floor);
  spec.max_passes =
      t.count({"max_passes", "largest number of loop passes per increment"}, 10, 100000000, spec.max_passes);
  read_modulus_stress(t, spec.modulus_stress);
}

namespace {

/// What a file of a packing says, or what would make another one.
constexpr std::array kMakingBodies{"bodies",
                                   "soft_share",
                                   "construction",
                                   "exponent",
                                   "solid_radius_max",
                                   "solid_polydispersity",
                                   "soft_radius_max",
                                   "soft_polydispersity",
                                   "solid_sizes",
                                   "soft_sizes",
                                   "solid_fill",
                                   "preparation",
                                   "start_pressure",
                                   "start_fraction",
                                   "inertial_number",
                                   "compaction_mu",
                                   "compaction_restitution",
                                   "coarse_share",
                                   "first_pressure",
                                   "preparation_tolerance",
                                   "preparation_passes"};

/// `packing`: places, radii and kinds of all bodies from a file; what would make them otherwise has no place beside it,
/// nor below a common one. The file is read for the boundary of the table that names it.
void read_given(const SceneTable& t, MacroSetup& setup) {
  const bool own = t.has("packing");
  if (!own && !setup.given) return;
  const auto refuse = [&](const auto& keys) {
    for (const char* key : keys)
      if (t.has(key))
        t.add_error(key, own ? "goes without packing, which says where all bodies are"
                             : "goes without the common packing, which says where all bodies are");
  };
  refuse(kMakingBodies);
  refuse(kDensityKeys);
  if (!own) t.refuse({"boundary"}, "is that of the common packing: give it beside that, or packing here too");
  if (setup.samples > 1) t.add_error("samples", "a packing is one sample: must be 1");
  if (!own) return;
  t.section([&] {
    const std::string file =
        t.resolve(t.filled_text({"packing",
                                 "file with positions, radii and kinds of all particles, which then are "
                                 "not drawn; path relative to the scene"}));
    setup.given = read_packing_file(file, setup.spec.boundary);
    const MacroPacking& p = *setup.given;
    MacroSpec& spec = setup.spec;
    spec.packing_text = read_text(file);
    spec.construction = Construction::mixed;
    spec.preparation = Preparation::frictionless;
    setup.density.reset();
    spec.bodies = static_cast<std::int64_t>(p.bodies.size());
    spec.soft_share = p.soft_volume_share();
    spec.solid_sizes.reset();
    spec.soft_sizes.reset();
    const auto take_radii = [&](bool soft, double& largest, double& ratio) {
      double low = HUGE_VAL;
      double high = 0.0;
      for (const MacroBody& b : p.bodies) {
        if (b.soft != soft) continue;
        low = std::min(low, b.r);
        high = std::max(high, b.r);
      }
      if (!(high > 0.0)) return;
      largest = high;
      ratio = high / low;
    };
    take_radii(false, spec.solid_radius_max, spec.solid_polydispersity);
    take_radii(true, spec.soft_radius_max, spec.soft_polydispersity);
  });
}

/// `resolved`: true for the shelled twin, or a list of twins.
std::vector<Twin> read_twins(const SceneTable& t, const std::vector<Twin>& fallback) {
  const Key key{"resolved",
                "resolved twins that run: a list of `\"shelled\"` (grains in moving shells) and `\"free\"` (these "
                "grains without shells); true: the shelled twin; false: none",
                "true; kind `macro-comparison`: both twins"};
  if (!t.has(key.name)) return fallback;
  if (!t.is_list(key.name)) return t.flag(key, true) ? std::vector<Twin>{Twin::shelled} : std::vector<Twin>{};
  std::vector<Twin> twins;
  for (const std::string& word : t.texts(key)) {
    const auto twin = parse_enum<Twin>(word);
    if (!twin) {
      t.add_error(key.name, "unknown twin '" + word + "'; known are \"shelled\" and \"free\"");
      continue;
    }
    if (std::count(twins.begin(), twins.end(), *twin) > 0) t.add_error(key.name, "'" + word + "' twice");
    twins.push_back(*twin);
  }
  return twins;
}

void read_twin_motion(const SceneTable& t, TwinMotion& m) {
  m.relaxation = t.choice<TwinRelaxation>(
      {"twin_relaxation",
       "`\"slow-dynamics\"`: twins are strained in motion and then settle, as in the measurement of soft particles; "
       "`\"damped\"`: they are strained at once and relaxed without inertia, five to seven times cheaper, 5 to 30 % "
       "too stiff at low stress. In both, stress-controlled axes relax without inertia"},
      m.relaxation);
  if (m.relaxation == TwinRelaxation::damped)
    t.refuse({"twin_speed", "twin_step_factor", "twin_settle_time"},
             "goes without motion: twin_relaxation = \"damped\"");
  m.speed = t.number({"twin_speed",
                      "speed at which neighbours of the largest radius approach each other, over sqrt(E/rho); the "
                      "default is as published"},
                     Unit::none, Range::closed(kSlowestApproach, kFastestApproach), m.speed);
  m.step_factor = t.number({"twin_step_factor", "time step over that of the published protocol"}, Unit::none,
                           Range::closed(0.01, 10.0), m.step_factor);
  m.settle_time = t.number(
      {"twin_settle_time",
       "time of motion after each increment, over R sqrt(rho/E); R is `soft_radius_max`, even if no radius reaches it"},
      Unit::none, Range::closed(0.0, kLongestSettling), m.settle_time);
}

}  // namespace

void require_own_preparation(const SceneTable& macro, const MacroSetup& setup) {
  if (setup.spec.preparation == Preparation::lammps)
    macro.add_error("preparation",
                    "\"lammps\" goes with scenes of kind \"macro\" and \"material\", and "
                    "--engine lammps");
}

MacroSetup read_macro_setup(const SceneTable& macro, const SoftParticleSpec& defaults) {
  MacroSetup setup;
  MacroSpec& spec = setup.spec;
  spec.solid_radius_max = spec.soft_radius_max = defaults.shell_radius;
  if (is_known(defaults.exponent)) spec.exponent = defaults.exponent;
  if (is_known(defaults.restitution)) spec.twin.restitution = defaults.restitution;
  const auto take = [&](const char* name, double known, double& value, const char* unit) {
    if (is_known(known))
      value = known;
    else
      setup.assumed.push_back(fmt::format("{} = {}{}", name, value, unit));
  };
  take("E", defaults.youngs_modulus, spec.youngs_modulus, " Pa");
  take("nu", defaults.poisson_ratio, spec.poisson_ratio, "");
  take("density", defaults.density, spec.density, " kg/m^3");
  if (is_known(defaults.friction) || !macro.has("mu")) take("mu", defaults.friction, spec.friction, "");
  return read_macro_setup(macro, setup);
}

void require_known_contents(const SceneTable& macro, const MacroSetup& setup, const SoftParticleSpec& spec,
                            const std::string& law_file) {
  if (setup.twins.empty() || packing_known(spec)) return;
  macro.add_error(
      "resolved",
      "a resolved twin is filled with grains, and " + law_file +
          " does not say what is inside the soft particle that was measured: give resolved = false, or, in a "
          "law card, add exponent, polydispersity, rmax_over_shell, beta and trials to [measurement]");
}

std::string assumed_text(const MacroSetup& setup) {
  if (setup.assumed.empty()) return "";
  return "the law does not state every property of the grains; taken for solid grains: " + join_text(setup.assumed);
}

MacroSetup read_macro_setup(const SceneTable& macro, const MacroSetup& base) {
  MacroSetup setup = base;
  read_bodies(macro, setup);
  read_test(macro, setup.spec);
  MacroSpec& spec = setup.spec;
  spec.kt_secant = macro.choice<TangentialSlope>({"kt",
                                                  "law card: tangential stiffness; `\"secant\"`: as published; "
                                                  "`\"initial\"`: initial slope, 2 to 3 times as stiff"},
                                                 spec.kt_secant ? TangentialSlope::secant : TangentialSlope::initial) ==
                   TangentialSlope::secant;
  setup.samples = macro.count({"samples", "independent random boxes"}, 1, 10000, setup.samples);
  read_given(macro, setup);
  require_density(macro, setup);
  setup.bands = read_draw_count(
      macro,
      {"bands",
       "number of draws (laws with parameters drawn from their scatter) for the error bars, 8 or more; 0: no bars"},
      100000, setup.bands);
  setup.band_estimator = macro.choice<BandEstimator>(
      {"band_estimator",
       "`\"draws\"`: one run per draw; `\"components\"`: at most twelve runs per sample, with the combinations of "
       "parameters that change the law, from which the curves of all draws are computed"},
      setup.band_estimator);
  setup.law_increments = macro.count({"law_increments",
                                      "number of increments of a law run for each increment of a twin; coarse "
                                      "increments change the loading path of law runs, which relax quickly"},
                                     1, 1000, setup.law_increments);
  setup.noise_samples = macro.count(
      {"noise_samples",
       "number of samples that run twice, the second time with strains and target stresses changed in the twelfth "
       "digit; the difference is the noise of one run (`noise` in results). No law can be more accurate"},
      0, 10000, setup.noise_samples);
  setup.twins = read_twins(macro, setup.twins);
  read_twin_motion(macro, spec.twin);
  return setup;
}

void refuse_idle_keys(const SceneTable& macro, bool twins, bool bands) {
  // bands = 0 switches them off, by --set of a scene that has some, say.
  if (!bands && !macro.has("bands"))
    macro.refuse({"band_estimator"}, "goes with bands, the number of draws of the law");
  if (!twins)
    macro.refuse({"twin_relaxation", "twin_speed", "twin_step_factor", "twin_settle_time"},
                 "goes with a resolved twin: resolved = true");
}

void refuse_idle_sizes(const SceneTable& macro, const std::vector<const MacroSetup*>& scenes) {
  // Beside a file of bodies these keys are refused where it is read.
  const auto none = [&](auto&& has) {
    return std::ranges::none_of(scenes, [&](const MacroSetup* s) { return s->given || has(s->spec.soft_share); });
  };
  if (none([](double soft_share) { return soft_share > 0.0; }))
    macro.refuse({"soft_radius_max", "soft_polydispersity", "soft_sizes"},
                 "goes with soft_share above 0: there are no soft particles");
  if (none([](double soft_share) { return soft_share < 1.0; }))
    macro.refuse({"solid_radius_max", "solid_polydispersity", "solid_sizes", "mu_r", "kr_ratio"},
                 "goes with soft_share below 1: there are no solid grains");
}

}  // namespace softgrain

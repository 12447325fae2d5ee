#include "pipelines/kinds/grain_box/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/contact/rolling_scene.h"
#include "common/core/error.h"
#include "common/io/scene.h"
#include "common/packing/grading_scene.h"
#include "microsim/grain_box/analysis.h"
#include "microsim/grain_box/grain_box_run.h"
#include "microsim/particles/scene_memory.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

namespace {

const Range kScatter{0.0, 0.3, false, false};
const Range kIncrement = Range::closed(1e-9, 0.1);

/// What holds without a key of a variant.
constexpr const char* kAsScene = "as the scene";

/// A coefficient of friction, or "infinite".
double read_friction(const SceneTable& t, const Key& key, double fallback) {
  if (!t.is_text(key.name)) return t.number(key, Unit::none, Range::friction(), fallback);
  (void)t.choice(key, {"infinite"});
  return std::numeric_limits<double>::infinity();
}

int read_axis(const SceneTable& t, const Key& key, int fallback) {
  const std::string axis = t.choice(key, {"x", "y", "z"}, std::string(1, "xyz"[fallback]));
  return axis[0] - 'x';
}

void read_material(const SceneTable& t, GrainBoxMaterial& m) {
  m.sizes = read_sizes(
      t,
      {"sizes",
       "another distribution of radii, instead of `radius_min` and `radius_max`; largest over smallest at most 20",
       "none"},
      {"radius_min", "radius_max"});
  m.radius_min = t.number({"radius_min", "smallest radius; radii are uniform between both"}, Unit::length,
                          Range::positive(), m.radius_min);
  m.radius_max = t.number({"radius_max", "largest radius, from `radius_min` to 20 times that"}, Unit::length,
                          Range::positive(), m.radius_max);
  if (m.radius_max < m.radius_min) t.add_error("radius_max", "must not be below radius_min");
  if (m.sizes) {
    m.radius_min = m.sizes->smallest();
    m.radius_max = m.sizes->largest();
  }
  if (m.radius_max > 20.0 * m.radius_min)
    t.add_error(m.sizes ? "sizes" : "radius_max", m.sizes ? "the largest size must be at most 20 times the smallest"
                                                          : "must be at most 20 times radius_min");
  m.youngs_modulus = t.number({"E", "mean of Young's modulus, normally distributed"}, Unit::pressure, Range::positive(),
                              m.youngs_modulus);
  m.youngs_modulus_scatter = t.number({"E_sd", "standard deviation of Young's modulus over its mean"}, Unit::none,
                                      kScatter, m.youngs_modulus_scatter);
  m.poisson_ratio =
      t.number({"nu", "mean of Poisson's ratio, normally distributed"}, Unit::none, kPoissonRange, m.poisson_ratio);
  m.poisson_ratio_scatter = t.number({"nu_sd", "standard deviation of Poisson's ratio over its mean"}, Unit::none,
                                     kScatter, m.poisson_ratio_scatter);
  m.density = t.number({"density", "density of the grains"}, Unit::density, Range::positive(), m.density);
}

void read_walls(const SceneTable& t, GrainBoxSpec& spec) {
  spec.walls.youngs_modulus = t.number({"E", "Young's modulus of the six planes", "100 `E` of `[material]`"},
                                       Unit::pressure, Range::positive(), 100.0 * spec.material.youngs_modulus);
  spec.walls.poisson_ratio =
      t.number({"nu", "Poisson's ratio of the six planes"}, Unit::none, kPoissonRange, spec.walls.poisson_ratio);
  spec.walls.friction = read_friction(
      t, {"mu", "friction of the planes: a number, or `\"infinite\"`; 0: smooth", "as grains (as published)"},
      spec.friction);
}

void read_box(const SceneTable& t, GrainBoxSpec& spec) {
  spec.grains = t.count({"grains", "number of grains"}, 8, 10000000, spec.grains);
  spec.aspect =
      t.vector3({"aspect", "relative lengths of the sides, each above 0 and at most 1e6"}, Unit::none, spec.aspect);
  for (int k = 0; k < 3; ++k)
    if (!(spec.aspect[k] > 0.0 && spec.aspect[k] <= 1e6))
      t.add_error("aspect", "the box is not closed: all three sides must be above 0 (and at most 1e6)");
  spec.solid_fraction = t.number({"solid_fraction", "solid fraction of the loose arrangement"}, Unit::none,
                                 Range::closed(0.01, 0.36), spec.solid_fraction);
}

void read_friction_path(const SceneTable& t, GrainBoxGeneration& g, const std::string& usual = "") {
  g.isotropic = t.choice({"friction_path",
                          "phase 3: `\"uniaxial\"`, or `\"isotropic\"`, which ends when the sliding share is constant, "
                          "whatever G does",
                          usual},
                         {"uniaxial", "isotropic"}, g.isotropic ? "isotropic" : "uniaxial") == "isotropic";
}

void read_generation(const SceneTable& t, GrainBoxGeneration& g) {
  g.pressure = t.number({"pressure", "sigma_c at the end of phase 2"}, Unit::pressure, Range::positive(), g.pressure);
  g.pressure_tolerance = t.number({"tolerance", "relative tolerance of `pressure`"}, Unit::none,
                                  Range{0.0, 0.1, true, false}, g.pressure_tolerance);
  g.growth = t.number({"growth", "phase 2: relative growth of a radius per pass"}, Unit::none,
                      Range{0.0, 0.1, true, false}, g.growth);
  g.growth_passes = t.count({"growth_passes", "phase 2: largest number of passes"}, 1, 100000, g.growth_passes);
  g.increment = t.number({"increment", "phase 3: strain increment"}, Unit::none, kIncrement, g.increment);
  g.window = t.count({"window",
                      "phase 3 ends when the mean sliding share over `window` increments differs by at most "
                      "`saturation` from the previous `window`, and the mean G is larger"},
                     2, 10000, g.window);
  g.saturation = t.number(
      {"saturation", "largest difference of the mean sliding share between two `window`s at the end of phase 3"},
      Unit::none, Range{0.0, 1.0, true, false}, g.saturation);
  g.max_increments = t.count({"max_increments", "phase 3: largest number of increments; then the run fails"}, 1,
                             1000000, g.max_increments);
  g.axis = read_axis(t, {"axis", "phase 3: axis of the compression"}, g.axis);
  read_friction_path(t, g);
}

void read_coulomb(const SceneTable& t, LeastWorkOptions& o, const std::string& usual = "") {
  const std::string fallback = o.coulomb == CoulombRule::current ? "current" : "reference";
  o.coulomb = t.choice({"coulomb",
                        "friction limit: mu times the `\"current\"` normal force, or that of the `\"reference\"` "
                        "state, as published; with `\"reference\"` a contact that carries more keeps it, and jumps of "
                        "the published rule are made continuous",
                        usual},
                       {"current", "reference"}, fallback) == "current"
                  ? CoulombRule::current
                  : CoulombRule::reference;
}

void read_solver(const SceneTable& t, LeastWorkOptions& o) {
  const bool published = t.choice({"method", "how equilibrium is found: `\"fast\"` (Newton steps) or `\"published\"`"},
                                  {"fast", "published"}, "fast") == "published";
  o.method = published ? LeastWorkMethod::published : LeastWorkMethod::fast;
  read_coulomb(t, o);
  o.torsion = t.flag({"torsion", "contacts resist twisting about their normal"}, o.torsion);
  o.max_iterations =
      t.count({"max_iterations", "largest number of iterations per increment"}, 1, 100000000, o.max_iterations);
  if (!published) {
    o.residual_tolerance = t.number({"tolerance", "fast: net force on every grain over its largest contact force"},
                                    Unit::none, Range{0.0, 0.1, true, false}, o.residual_tolerance);
    return;
  }
  o.refresh = static_cast<int>(t.count({"refresh", "published: iterations between restarts"}, 1, 1000000, o.refresh));
  o.sub_increment_interval =
      static_cast<int>(t.count({"sub_increment_interval", "published: iterations between wall sub-increments"}, 1,
                               1000000, o.sub_increment_interval));
  o.sub_increments = static_cast<int>(
      t.count({"sub_increments", "published: number of wall sub-increments"}, 1, 1000, o.sub_increments));
  o.max_move = t.number({"max_move", "published: largest move per iteration, in radii"}, Unit::none,
                        Range{0.0, 1.0, true, false}, o.max_move);
  o.work_tolerance = t.number({"work_tolerance", "published: stop criterion for work"}, Unit::none,
                              Range{0.0, 1.0, true, false}, o.work_tolerance);
  o.force_tolerance = t.number({"force_tolerance", "published: stop criterion for force"}, Unit::none,
                               Range{0.0, 1.0, true, false}, o.force_tolerance);
}

/// `increment`, or `increments` with the strain that every stage but the last covers. `usual`: of a variant.
void read_increments(const SceneTable& t, GrainBoxLoading& l, const std::string& usual = "") {
  if (t.has("increment")) {
    t.refuse({"increments"}, "give increment or increments, not both");
    l.increments = {
        t.number({"increment", "strain per increment", usual.empty() ? "1e-4" : usual}, Unit::none, kIncrement)};
    l.stage_strains.clear();
  } else if (t.has("increments")) {
    l.increments =
        t.numbers({"increments", "instead of `increment`: one increment per stage", usual.empty() ? "none" : usual},
                  Unit::none, kIncrement);
    l.stage_strains =
        t.numbers({"stage_strains", "with `increments`: the strain of every stage except the last", "none"}, Unit::none,
                  Range{0.0, 0.5, true, false}, {});
    if (l.increments.empty()) t.add_error("increments", "at least one value is needed");
    if (l.stage_strains.size() + 1 != l.increments.size())
      t.add_error("increments", fmt::format("{} stages need {} stage_strains (the last stage goes on to the end)",
                                            l.increments.size(), l.increments.size() - 1));
  }
}

void read_end(const SceneTable& t, GrainBoxLoading& l, const std::string& usual = "none") {
  l.end_stress =
      t.number({"end_stress", "the loading ends at this sigma_c, or at `end_strain`; give at least one", usual},
               Unit::pressure, Range::positive(), l.end_stress);
  l.end_strain = t.number(
      {"end_strain",
       "the loading ends at this largest strain of an axis since its start, or at `end_stress`; give at least one",
       usual},
      Unit::none, Range{0.0, 0.4, true, false}, l.end_strain);
}

Vec3 along(int axis, double axial, double lateral) {
  Vec3 out{{lateral, lateral, lateral}};
  out[axis] = axial;
  return out;
}

int read_strained_axis(const SceneTable& t) {
  return read_axis(t, {"axis", "uniaxial, triaxial: the strained axis"}, 2);
}

void read_triaxial(const SceneTable& t, GrainBoxLoading& l) {
  const int axis = read_strained_axis(t);
  l.strain_rate = along(axis, 1.0, 0.0);
  if (t.has("lateral_stress") == t.has("lateral_strain_rate"))
    t.add_error("test", "a triaxial test needs either lateral_stress or lateral_strain_rate");
  if (t.has("lateral_strain_rate")) {
    l.strain_rate =
        along(axis, 1.0,
              t.number({"lateral_strain_rate",
                        "triaxial: strain rate of the other two axes over that of `axis`; instead of `lateral_stress`",
                        "none"},
                       Unit::none, Range::closed(-10.0, 10.0)));
    return;
  }
  l.control = {AxisControl::stress, AxisControl::stress, AxisControl::stress};
  l.control[static_cast<std::size_t>(axis)] = AxisControl::strain;
  l.stress = along(
      axis, 0.0,
      t.number({"lateral_stress", "triaxial: stress of the other two axes; instead of `lateral_strain_rate`", "none"},
               Unit::pressure, Range::positive()));
}

void read_polyaxial(const SceneTable& t, GrainBoxLoading& l) {
  l.strain_rate = t.vector3(
      {"strain_rates", "polyaxial: relative strain rates of the three axes, each from -1000 to 1000"}, Unit::none);
  double fastest = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(l.strain_rate[k]) > 1e3) t.add_error("strain_rates", "each must be from -1000 to 1000");
    fastest = std::max(fastest, std::abs(l.strain_rate[k]));
  }
  if (t.has("control")) {
    const std::vector<std::string> control =
        t.texts({"control", "polyaxial: `\"strain\"` or `\"stress\"` per axis", "all strain"});
    if (control.size() != 3) t.throw_error("control", "must have three words, \"strain\" or \"stress\"");
    l.stress =
        t.vector3({"stresses",
                   "polyaxial with `control`: constant stresses of the three axes, above 0 where stress is controlled"},
                  Unit::pressure);
    fastest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (control[k] != "strain" && control[k] != "stress")
        t.add_error("control", "'" + control[k] + "': must be \"strain\" or \"stress\"");
      l.control[k] = control[k] == "stress" ? AxisControl::stress : AxisControl::strain;
      if (l.control[k] == AxisControl::stress && !(l.stress.v[k] > 0.0))
        t.add_error("stresses", fmt::format("the stress of {} must be above 0: grains cannot be pulled", "xyz"[k]));
      if (l.control[k] == AxisControl::strain) fastest = std::max(fastest, std::abs(l.strain_rate.v[k]));
    }
  }
  if (!(fastest > 0.0)) t.add_error("strain_rates", "at least one axis must be strained");
}

void read_loading(const SceneTable& t, GrainBoxLoading& l) {
  l.test = t.choice({"test", "which test is run"}, {"uniaxial", "isotropic", "polyaxial", "triaxial"}, l.test);
  if (l.test == "uniaxial") l.strain_rate = along(read_strained_axis(t), 1.0, 0.0);
  if (l.test == "isotropic") l.strain_rate = {{1.0, 1.0, 1.0}};
  if (l.test == "polyaxial") read_polyaxial(t, l);
  if (l.test == "triaxial") read_triaxial(t, l);
  read_increments(t, l);
  read_end(t, l);
  l.probe_every = t.count({"probe_every", "increments between two elastic probes (K and G without sliding); 0: none"},
                          0, 1000000, l.probe_every);
  l.stress_tolerance = t.number({"stress_tolerance", "relative tolerance of stress-controlled axes"}, Unit::none,
                                Range{0.0, 0.1, true, false}, l.stress_tolerance);
  const bool by_stress = std::find(l.control.begin(), l.control.end(), AxisControl::stress) != l.control.end();
  if (!by_stress)
    t.refuse({"stress_tolerance"}, "goes with a side that goes by stress (lateral_stress, or control): none does");
  l.max_halvings = static_cast<int>(
      t.count({"max_halvings", "how often an increment without equilibrium is halved"}, 0, 12, l.max_halvings));
}

std::array<double, 2> read_range(const SceneTable& t, const Key& key, const std::array<double, 2>& fallback) {
  const std::vector<double> v =
      t.numbers(key, Unit::pressure, Range::positive(), std::vector<double>(fallback.begin(), fallback.end()));
  if (v.size() == 2 && v[0] < v[1]) return {v[0], v[1]};
  t.add_error(key.name, "must be two ascending stresses");
  return fallback;
}

void read_fit(const SceneTable& t, GrainBoxFit& fit) {
  fit.low = read_range(t, {"low", "lower range of sigma_c for the growth exponents: its two ends"}, fit.low);
  fit.high = read_range(t, {"high", "upper range of sigma_c for the growth exponents: its two ends"}, fit.high);
}

/// What no single key shows. `t` is the table to blame: [loading], or the variant.
void validate_combination(const SceneTable& t, const GrainBoxSpec& spec) {
  const GrainBoxLoading& l = spec.loading;
  if (!std::isfinite(l.end_stress) && !std::isfinite(l.end_strain))
    t.add_error("end_stress", "the loading has no end: give end_stress or end_strain");
  if (spec.generation.pressure >= l.end_stress)
    t.add_error("end_stress",
                fmt::format("must be above the generation pressure of {:.4g} Pa", spec.generation.pressure));
  const GrainBoxForecast f = forecast(spec);
  if (f.overlap_ratio > 0.5)
    t.add_error(
        "end_stress",
        fmt::format("grains would overlap by about {:.2f} of their radius at the largest stress: beyond what contacts "
                    "of small strain describe (0.5)",
                    f.overlap_ratio));
  const double largest =
      std::max(*std::max_element(l.increments.begin(), l.increments.end()), spec.generation.increment);
  const double most = spec.material.radius_min / f.box_length;
  if (largest >= most)
    t.add_error(
        t.has("increments") ? "increments" : "increment",
        fmt::format("a wall would move more than the smallest grain's radius at once; must be below {:.3g}", most));
}

/// One pack after another runs, so that each must fit by itself. `t`: [box], or the variant.
void require_memory(const SceneTable& t, const GrainBoxSpec& spec) {
  const double available = available_memory();
  const double needed = forecast(spec).bytes;
  if (!(available > 0.0) || needed <= available) return;
  t.add_error(
      "grains",
      fmt::format("a pack of {} grains needs about {:.3g} GB of memory, {:.3g} GB are free; allowed: up to {:.0f}",
                  spec.grains, needed / 1e9, available / 1e9,
                  std::floor(static_cast<double>(spec.grains) * available / needed)));
}

/// `valid`: the scene around it has no errors.
GrainBoxSpec read_variant(const SceneTable& t, GrainBoxSpec spec, bool walls_follow, bool valid) {
  spec.name = read_variant_name(t);
  spec.grains = t.count({"grains", "number of grains", kAsScene}, 8, 10000000, spec.grains);
  spec.friction = read_friction(t, {"mu", "friction between grains, as `mu` of `[material]`", kAsScene}, spec.friction);
  if (walls_follow) spec.walls.friction = spec.friction;
  spec.walls.friction = read_friction(
      t, {"wall_mu", "friction of the planes, as `mu` of `[walls]`", "`mu` of `[walls]`, else `mu` of the variant"},
      spec.walls.friction);
  spec.generation.pressure = t.number({"pressure", "sigma_c at the end of phase 2", kAsScene}, Unit::pressure,
                                      Range::positive(), spec.generation.pressure);
  read_friction_path(t, spec.generation, kAsScene);
  read_coulomb(t, spec.solver, kAsScene);
  spec.solver.torsion =
      t.flag({"torsion", "contacts resist twisting about their normal", kAsScene}, spec.solver.torsion);
  if (t.has("tolerance")) {
    spec.solver.residual_tolerance =
        t.number({"tolerance", "`tolerance` of `[solver]`, with its `method = \"fast\"`", kAsScene}, Unit::none,
                 Range{0.0, 0.1, true, false}, spec.solver.residual_tolerance);
    if (spec.solver.method == LeastWorkMethod::published)
      t.add_error("tolerance",
                  "solver.method = \"published\" stops by work_tolerance and force_tolerance; leave it out");
  }
  read_increments(t, spec.loading, kAsScene);
  read_end(t, spec.loading, kAsScene);
  if (!valid || t.has_errors()) return spec;
  validate_combination(t, spec);
  require_memory(t, spec);
  return spec;
}

}  // namespace

namespace {

/// Every pack in so many arrangements: "4MPa", "4MPa-2", "4MPa-3".
std::vector<GrainBoxSpec> repeated(const std::vector<GrainBoxSpec>& packs, std::int64_t arrangements) {
  std::vector<GrainBoxSpec> out;
  for (const GrainBoxSpec& pack : packs)
    for (std::int64_t k = 0; k < arrangements; ++k) {
      out.push_back(pack);
      out.back().of = pack.name;
      out.back().arrangement = static_cast<std::uint64_t>(k);
      if (k > 0) out.back().name += fmt::format("-{}", k + 1);
    }
  return out;
}

/// Packs of the same grains are one pack that is pressed on without friction: each goes through the lower pressures of
/// the others [QS 2.3]. Friction, walls, solver and loading play no part before friction sets in.
void press_on(std::vector<GrainBoxSpec>& packs) {
  for (GrainBoxSpec& pack : packs) {
    std::set<double> lower;
    for (const GrainBoxSpec& other : packs)
      if (other.grains == pack.grains && other.generation.pressure < pack.generation.pressure)
        lower.insert(other.generation.pressure);
    pack.generation.lower_pressures.assign(lower.begin(), lower.end());
  }
}

}  // namespace

std::vector<DrawnSizes> drawn_sizes(const GrainBoxSetup& setup, std::uint64_t seed) {
  std::vector<DrawnSizes> out;
  for (const GrainBoxSpec& spec : setup.packs)
    if (spec.material.sizes)
      out.push_back(
          {.of = "grains of " + spec.name, .asked = *spec.material.sizes, .samples = {drawn_radii(spec, seed)}});
  return out;
}

GrainBoxSetup read_grain_box(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    GrainBoxSetup setup;
    (void)root.choice(kKindKey, {"grain-box"});
    setup.title = root.title();
    setup.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
    GrainBoxSpec spec;
    const SceneTable material = root.table_or_empty({"material", "the grains: radii, elasticity, density, friction"});
    read_material(material, spec.material);
    spec.friction = read_friction(material,
                                  {"mu",
                                   "friction between grains: a number, or `\"infinite\"` (taken as 5, so that a "
                                   "contact that opens loses its tangential force)"},
                                  spec.friction);
    material.refuse(kRollingKeys, "the least-work solver knows no rolling resistance: kind = \"material\" does");
    const SceneTable walls = root.table_or_empty({"walls", "the six planes around the grains"});
    read_walls(walls, spec);
    read_box(root.table_or_empty({"box", "the loose arrangement of the grains between the planes"}), spec);
    const SceneTable generation =
        root.table_or_empty({"generation",
                             "phase 2, isotropic compaction without friction, and phase 3, compression with friction; "
                             "sigma_c is the mean of the three normal stresses"});
    read_generation(generation, spec.generation);
    read_solver(root.table_or_empty({"solver", "how the equilibrium of every increment is found"}), spec.solver);
    const SceneTable loading = root.table({"loading", "the test of the packing, phase 4"});
    loading.section([&] { read_loading(loading, spec.loading); });
    read_fit(root.table_or_empty({"fit", "fits of the growth of K and G with sigma_c"}), spec.fit);
    const bool valid = !root.has_errors();
    std::set<std::string> names;
    for (const SceneTable& variant :
         root.tables({"variant", "one of several packings of the scene; its keys replace those of the scene"})) {
      setup.packs.push_back(read_variant(variant, spec, !walls.has("mu"), valid));
      if (!names.insert(setup.packs.back().name).second) variant.add_error("name", "is used twice");
    }
    const std::int64_t arrangements = root.count({"arrangements",
                                                  "realisations of every packing, each with its own random grains and "
                                                  "positions; K, G and sliding then have errors"},
                                                 1, 1000, 1);
    if (setup.packs.empty()) {
      if (valid) validate_combination(loading, spec);
      if (!root.has_errors()) require_memory(root.table_or_empty("box"), spec);
      setup.packs.push_back(spec);
    }
    if (generation.has("axis") && std::all_of(setup.packs.begin(), setup.packs.end(),
                                              [](const GrainBoxSpec& pack) { return pack.generation.isotropic; }))
      generation.add_error("axis", "goes with friction_path = \"uniaxial\": all axes are strained alike");
    press_on(setup.packs);
    setup.packs = repeated(setup.packs, arrangements);
    std::set<std::string> all;
    for (const GrainBoxSpec& pack : setup.packs)
      if (!all.insert(pack.name).second)
        root.add_error("arrangements", "two packs would be called '" + pack.name + "'; rename a variant");
    return setup;
  });
}

}  // namespace softgrain

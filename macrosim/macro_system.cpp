#include "macrosim/macro_system.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/neighbours/verlet_list.h"
#include "common/state/system_io.h"
#include "macrosim/grain_materials.h"

namespace softgrain {

namespace {

/// What walls and what is inside soft particles are made of.
Material common_material(const MacroSpec& spec, const char* name) {
  return {name, spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
}

AnyLaw solid_law(const Material& material, double friction, double restitution = 1.0,
                 const RollingResistance& rolling = {}) {
  return hertz_law(HertzCoefficients::of(material, material, friction, restitution, rolling), false);
}

/// A rotation drawn uniformly (random unit quaternion), as the images of the three axes.
std::array<Vec3, 3> random_rotation(RandomStream& random) {
  const double u = random.uniform();
  const double a = 2.0 * std::numbers::pi * random.uniform();
  const double b = 2.0 * std::numbers::pi * random.uniform();
  const double w = std::sqrt(1.0 - u) * std::sin(a);
  const double x = std::sqrt(1.0 - u) * std::cos(a);
  const double y = std::sqrt(u) * std::sin(b);
  const double z = std::sqrt(u) * std::cos(b);
  return {Vec3{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)}},
          Vec3{{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)}},
          Vec3{{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

/// Adds the grains of a soft particle, turned; they belong to body `number` and to a shell (-1: none).
void add_content(MacroSystem& out, const MacroSpec& spec, const MacroBody& body, const ShellPacking& content,
                 Slot shell, std::int32_t number, RandomStream& random) {
  const auto axes = random_rotation(random);
  for (std::size_t k = 0; k < content.radius.size(); ++k) {
    const Vec3& y = content.position[k];
    const Vec3 turned = axes[0] * y[0] + axes[1] * y[1] + axes[2] * y[2];
    NewBody<3> grain = solid_sphere(body.x + turned * body.r, content.radius[k] * body.r, spec.density, 0);
    grain.shell = shell;
    add_grain(out.system.particles, grain);
    out.body.push_back(number);
  }
}

std::int64_t count_inner_grains(const MacroPacking& packing, const std::vector<ShellPacking>& contents) {
  std::int64_t inner = 0;
  std::size_t k = 0;
  for (const MacroBody& b : packing.bodies)
    if (b.soft) inner += static_cast<std::int64_t>(contents[k++ % contents.size()].radius.size());
  return inner;
}

/// Walls come last: they take the numbers after the bodies. A periodic cell begins at the origin.
void close_box(MacroSystem& out, const MacroSpec& spec, const MacroPacking& packing, std::int32_t material) {
  out.bodies = static_cast<std::int32_t>(packing.bodies.size());
  if (spec.boundary == Boundary::periodic) {
    for (Sphere<3>& sphere : out.system.particles.sphere) sphere.x -= packing.low;
    out.box = add_periodic_cell(out.system, packing.size());
  } else {
    out.box = add_box(out.system, packing.low, packing.high, material);
    for (std::int32_t wall = 0; wall < 6; ++wall) out.body.push_back(out.bodies + wall);
  }
  for (const MacroBody& b : packing.bodies) out.largest_radius = std::max(out.largest_radius, b.r);
}

/// springs_of_test() by the slots of their grains and walls in a system. Slots of solid grains lie in the order of
/// their bodies in law runs and in twins, walls after all.
std::vector<BodySpring> springs_by_slot(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro) {
  std::vector<Slot> slot(packing.bodies.size() + macro.box.plane.size(), -1);
  for (std::size_t u = 0; u < macro.body.size(); ++u)
    if (const std::int32_t b = macro.body[u]; b >= macro.bodies || !packing.bodies[at(b)].soft)
      slot[at(b)] = static_cast<Slot>(u);
  std::vector<BodySpring> out = springs_of_test(spec, packing);
  for (BodySpring& s : out) {
    s.i = slot[at(s.i)];
    s.j = slot[at(s.j)];
  }
  return out;
}

/// Solid grains go on bearing what they bore along their contacts when the preparation ended, in a run by laws and in
/// its twin.
void load_springs(const MacroSpec& spec, const MacroPacking& packing, MacroSystem& macro) {
  const std::vector<BodySpring> springs = springs_by_slot(spec, packing, macro);
  if (springs.empty()) return;
  System3& s = macro.system;
  rebuild_neighbours(s);
  auto& list = s.contacts;
  for (const ContactSection& section : list.sections) {
    if (section.geometry == Geometry::sphere_shell) continue;
    auto c = at(section.begin);
    for (const BodySpring& b : springs) {
      const auto before = [&](std::size_t k) { return list.i[k] != b.i ? list.i[k] < b.i : list.j[k] < b.j; };
      while (c < at(section.end) && before(c)) ++c;
      if (c == at(section.end)) break;
      if (list.i[c] != b.i || list.j[c] != b.j) continue;
      list.spring[c] = b.spring;
      if (list.has_roll) list.roll[c] = b.roll;
    }
  }
}

void add_shells(MacroSystem& out, const MacroSpec& spec, const MacroPacking& packing,
                const std::vector<ShellPacking>& contents) {
  std::size_t k = 0;
  for (std::size_t n = 0; n < packing.bodies.size(); ++n) {
    const MacroBody& b = packing.bodies[n];
    if (!b.soft) continue;
    const double density = spec.density * contents[k++ % contents.size()].solid_fraction();
    add_shell(out.system.particles, solid_sphere(b.x, b.r, density, 0));
    out.body.push_back(static_cast<std::int32_t>(n));
  }
}

/// Materials of twins: grains, walls, and solid grains where they resist rolling, which the grains of soft particles
/// do not.
constexpr std::int32_t kRollingSolid = 2;

bool solids_resist_rolling(const MacroSpec& spec) { return spec.rolling.friction > 0.0; }

LawSet twin_laws(const Material& grain, const MacroSpec& spec, double restitution) {
  LawSet laws(solids_resist_rolling(spec) ? 3 : 2);
  laws.set(0, 0, solid_law(grain, spec.friction, restitution));
  laws.set(0, 1, solid_law(grain, spec.wall_friction, restitution));
  if (!solids_resist_rolling(spec)) return laws;
  laws.use(0, kRollingSolid, laws.index(0, 0));
  laws.set(kRollingSolid, kRollingSolid, solid_law(grain, spec.friction, restitution, spec.rolling));
  laws.set(kRollingSolid, 1, solid_law(grain, spec.wall_friction, restitution, spec.rolling));
  return laws;
}

/// Solid grains first, then the contents of the soft particles, then their shells (of the shelled twin).
MacroSystem make_twin(const MacroSpec& spec, const MacroPacking& packing, const std::vector<ShellPacking>& contents,
                      std::uint64_t seed, std::uint64_t sample, bool shelled) {
  if (contents.empty() && packing.soft_count() > 0)
    throw InputError("resolved twin: no packing to fill the soft particles with");
  if (!spec.grain_materials.empty()) throw InputError("resolved twin: its grains are of one material");
  MacroSystem out;
  System3& s = out.system;
  s.materials = {common_material(spec, "grain"), common_material(spec, "wall")};
  if (solids_resist_rolling(spec)) s.materials.push_back(common_material(spec, "solid"));
  out.dashpots = {twin_laws(s.materials[0], spec, 1.0), twin_laws(s.materials[0], spec, spec.twin.restitution)};
  s.laws = out.dashpots->off;
  out.inner_grains = count_inner_grains(packing, contents);
  const auto bodies = static_cast<std::int32_t>(packing.bodies.size());
  for (std::int32_t n = 0; n < bodies; ++n) {
    const MacroBody& b = packing.bodies[static_cast<std::size_t>(n)];
    if (b.soft) continue;
    add_grain(s.particles, solid_sphere(b.x, b.r, spec.density, solids_resist_rolling(spec) ? kRollingSolid : 0));
    out.body.push_back(n);
  }
  const Slot first_shell = s.particles.grains + static_cast<Slot>(out.inner_grains);
  RandomStream random(seed, RandomPurpose::rotation, sample);
  std::size_t k = 0;
  for (std::int32_t n = 0; n < bodies; ++n) {
    const MacroBody& b = packing.bodies[static_cast<std::size_t>(n)];
    if (!b.soft) continue;
    const Slot shell = shelled ? first_shell + static_cast<Slot>(k) : -1;
    add_content(out, spec, b, contents[k % contents.size()], shell, n, random);
    ++k;
  }
  if (shelled) add_shells(out, spec, packing, contents);
  close_box(out, spec, packing, 1);
  load_springs(spec, packing, out);
  return out;
}

}  // namespace

SoftLaws pair_soft_laws(const CardLaw& soft_solid, const CardLaw& soft_soft, double wall_friction) {
  return std::visit(
      [&](auto soft_first) -> SoftLaws {
        soft_first.i_is_soft = true;
        auto solid_first = soft_first;
        solid_first.i_is_soft = false;
        auto wall = soft_first;
        wall.friction = wall_friction;
        return {soft_first, solid_first, wall, any_law(soft_soft)};
      },
      soft_solid);
}

MacroSystem make_law_system(const MacroSpec& spec, const MacroPacking& packing, const SoftLaws& laws,
                            double inner_solid_fraction) {
  MacroSystem out;
  System3& s = out.system;
  s.materials = {solid_material(spec, 0, "solid"), common_material(spec, "soft"), common_material(spec, "wall")};
  std::vector<std::int32_t> number{0};
  for (std::int32_t m = 1; m < count_of_materials(spec); ++m) {
    number.push_back(static_cast<std::int32_t>(s.materials.size()));
    s.materials.push_back(solid_material(spec, m, "solid"));
  }
  s.laws = LawSet(static_cast<std::int32_t>(s.materials.size()));
  set_solid_laws(spec, number, 2, {spec.friction, spec.wall_friction, 1.0, spec.rolling}, s.laws);
  const std::int32_t soft_solid = s.laws.add(laws.soft_solid);
  const std::int32_t solid_soft = s.laws.add(laws.solid_soft);
  for (const std::int32_t solid : number) {
    s.laws.use(1, solid, soft_solid, true);
    s.laws.use(solid, 1, solid_soft, true);
  }
  s.laws.set(1, 2, laws.soft_wall);
  s.laws.set(1, 1, laws.soft_soft);
  for (const MacroBody& b : packing.bodies) {
    out.body.push_back(static_cast<std::int32_t>(out.body.size()));
    add_grain(s.particles,
              solid_sphere(b.x, b.r, b.soft ? spec.density * inner_solid_fraction : grain_density(spec, b.material),
                           b.soft ? 1 : number.at(static_cast<std::size_t>(b.material))));
  }
  close_box(out, spec, packing, 2);
  load_springs(spec, packing, out);
  return out;
}

MacroSystem make_shelled_system(const MacroSpec& spec, const MacroPacking& packing,
                                const std::vector<ShellPacking>& contents, std::uint64_t seed, std::uint64_t sample) {
  return make_twin(spec, packing, contents, seed, sample, true);
}

MacroSystem make_free_system(const MacroSpec& spec, const MacroPacking& packing,
                             const std::vector<ShellPacking>& contents, std::uint64_t seed, std::uint64_t sample) {
  return make_twin(spec, packing, contents, seed, sample, false);
}

Snapshot macro_snapshot(const MacroSystem& macro, const MacroPacking& packing) {
  Snapshot s = snapshot_of(macro.system);
  const bool resolved = macro.inner_grains > 0;
  s.kind = resolved ? SnapshotKind::twin : SnapshotKind::macro;
  s.has_velocity = false;  // left over from relaxing
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    SnapshotParticle& p = s.particles[k];
    p.body = macro.body[k];
    p.velocity = p.spin = {};
    if (packing.bodies[static_cast<std::size_t>(p.body)].soft)
      p.role = resolved ? ParticleRole::inner : ParticleRole::soft;
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    if (s.walls[k].shape == WallShape::sphere_inside) s.walls[k].body = macro.body[s.particles.size() + k];
  return s;
}

}  // namespace softgrain

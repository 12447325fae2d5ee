#include "macrosim/macro_system.h"

#include <cmath>
#include <numbers>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/core/solid_sphere.h"

namespace softgrain {

namespace {

Material solid_material(const MacroSpec& spec, const char* name) {
  return {name, spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
}

AnyLaw solid_law(const Material& material, double friction) {
  return hertz_law(HertzCoefficients::of(material, material, friction, 1.0), false);
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

void add_content(System3& s, const MacroSpec& spec, const MacroBody& body, const ShellPacking& content, Slot shell,
                 RandomStream& random) {
  const auto axes = random_rotation(random);
  for (std::size_t k = 0; k < content.radius.size(); ++k) {
    const Vec3& y = content.position[k];
    const Vec3 turned = axes[0] * y[0] + axes[1] * y[1] + axes[2] * y[2];
    NewBody<3> grain = solid_sphere(body.x + turned * body.r, content.radius[k] * body.r, spec.density, 0);
    grain.shell = shell;
    add_grain(s.particles, grain);
  }
}

std::int64_t count_inner_grains(const MacroPacking& packing, const std::vector<ShellPacking>& contents) {
  std::int64_t inner = 0;
  std::size_t k = 0;
  for (const MacroBody& b : packing.bodies)
    if (b.soft) inner += static_cast<std::int64_t>(contents[k++ % contents.size()].radius.size());
  return inner;
}

}  // namespace

MacroSystem make_law_system(const MacroSpec& spec, const MacroPacking& packing, const SoftLaws& laws,
                            double inner_solid_fraction) {
  MacroSystem out;
  System3& s = out.system;
  s.materials = {solid_material(spec, "solid"), solid_material(spec, "soft"), solid_material(spec, "wall")};
  s.laws = LawSet(3);
  s.laws.set(0, 0, solid_law(s.materials[0], spec.friction));
  s.laws.set(0, 2, solid_law(s.materials[0], spec.wall_friction));
  SoftContact law = laws.soft_solid;
  law.i_is_soft = true;
  s.laws.set(1, 0, law, true);
  law.i_is_soft = false;
  s.laws.set(0, 1, law, true);
  law.i_is_soft = true;
  law.friction = spec.wall_friction;
  s.laws.set(1, 2, law);
  s.laws.set(1, 1, laws.soft_soft);
  for (const MacroBody& b : packing.bodies)
    add_grain(s.particles,
              solid_sphere(b.x, b.r, b.soft ? spec.density * inner_solid_fraction : spec.density, b.soft ? 1 : 0));
  out.box = add_box(s, packing.low, packing.high, 2);
  return out;
}

MacroSystem make_shelled_system(const MacroSpec& spec, const MacroPacking& packing,
                                const std::vector<ShellPacking>& contents, std::uint64_t seed, std::uint64_t sample) {
  if (contents.empty() && packing.soft_count() > 0)
    throw BadInput("resolved twin: no packing to fill the soft particles with");
  MacroSystem out;
  System3& s = out.system;
  s.materials = {solid_material(spec, "grain"), solid_material(spec, "wall")};
  s.laws = LawSet(2);
  s.laws.set(0, 0, solid_law(s.materials[0], spec.friction));
  s.laws.set(0, 1, solid_law(s.materials[0], spec.wall_friction));
  out.inner_grains = count_inner_grains(packing, contents);
  const auto solids = static_cast<Slot>(packing.bodies.size()) - static_cast<Slot>(packing.soft_count());
  const Slot first_shell = solids + static_cast<Slot>(out.inner_grains);
  RandomStream random(seed, RandomPurpose::rotation, sample);
  for (const MacroBody& b : packing.bodies)
    if (!b.soft) add_grain(s.particles, solid_sphere(b.x, b.r, spec.density, 0));
  std::size_t k = 0;
  for (const MacroBody& b : packing.bodies) {
    if (!b.soft) continue;
    add_content(s, spec, b, contents[k % contents.size()], first_shell + static_cast<Slot>(k), random);
    ++k;
  }
  k = 0;
  for (const MacroBody& b : packing.bodies)
    if (b.soft)
      add_shell(s.particles,
                solid_sphere(b.x, b.r, spec.density * contents[k++ % contents.size()].solid_fraction(), 0));
  out.box = add_box(s, packing.low, packing.high, 1);
  return out;
}

}  // namespace softgrain

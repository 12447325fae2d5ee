// Packings for the benchmarks of the contact loop, settled under the full law and then given the law that is asked for:
// all cases of a packing look at the same contacts, so that their times differ by the work alone.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/core/parallel_tasks.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "common/neighbours/spatial_order.h"
#include "common/neighbours/verlet_list.h"
#include "microsim/particles/scene_bodies.h"

namespace softgrain::bench {

/// What a case needs of the loop.
struct Needs {
  bool friction = true;
  bool damping = true;
  bool rescaled = false;
  bool periodic = true;
  bool sorted = false;  ///< grains numbered along a space-filling curve before they are read in
  const char* packing = "A";
  double smallest = 1.0;  ///< radius [m]; sets the step
};

inline constexpr double kStepPerRadius = 0.05;  // [s/m]
inline constexpr int kSettlingSteps = 300;
inline constexpr double kDensity = 2500.0;

inline Material grain_material() {
  Material m;
  m.density = kDensity;
  m.youngs_modulus = 5e5;
  m.poisson_ratio = 0.3;
  return m;
}

template <int D>
void set_law(System<D>& s, const AnyLaw& law) {
  s.materials = {grain_material()};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
}

inline AnyLaw law_of(const Needs& n) {
  const Material m = grain_material();
  return hertz_law(HertzCoefficients::of(m, m, n.friction ? 0.3 : 0.0, n.damping ? 0.5 : 1.0), n.rescaled);
}

template <int D>
void clear_forces(Particles<D>& p) {
  std::fill(p.force.begin(), p.force.end(), Stored<D>{});
  std::fill(p.torque.begin(), p.torque.end(), StoredRot<D>{});
}

template <int D>
void settle(System<D>& s, double dt) {
  VelocityVerlet<D> integrator(dt);
  integrator.initialise(s);
  integrator.advance(s, kSettlingSteps);
}

/// A new list with the margins as they are; histories stay where the law has any.
template <int D>
void list_again(System<D>& s) {
  s.neighbours.reference.clear();
  rebuild_neighbours(s);
}

/// Scene A or B under the full law, settled. Read and settled once per process.
inline const System<3>& settled_packing(const Needs& n) {
  struct Kept {
    std::string name;
    System<3> system;
  };
  static std::vector<Kept> kept;
  const std::string name = std::string(n.packing) + (n.sorted ? "" : " as read");
  for (const Kept& k : kept)
    if (k.name == name) return k.system;
  const XyzrFile file =
      read_xyzr(std::string(SOFTGRAIN_SOURCE_DIR) + "/tests/reference/bench/" + n.packing + ".xyzr.gz");
  System<3> s;
  set_law(s, law_of({}));
  s.cell = box_cell<3>(file.box, {true, true, true});
  for (std::size_t k = 0; k < file.radius.size(); ++k)
    add_grain(s.particles, solid_sphere(file.position[k], file.radius[k], kDensity, 0));
  settle(s, kStepPerRadius * n.smallest);
  if (n.sorted) reorder_grains(s, spatial_order(s));
  kept.push_back({name, std::move(s)});
  return kept.back().system;
}

inline System<3> packing(const Needs& n) {
  System<3> s = settled_packing(n);
  set_law(s, law_of(n));
  if (!n.periodic) s.cell = open_cell<3>();
  list_again(s);
  return s;
}

/// A triangular lattice of discs (thickness 1 m), radii spread by 5 %, squeezed by 2 %: about four contacts a disc.
inline System<2> disc_packing(const Needs& n) {
  constexpr int kColumns = 140;
  constexpr int kRows = 142;
  constexpr double kSpacing = 1.96;
  const double height = 0.5 * std::sqrt(3.0) * kSpacing;
  System<2> s;
  set_law(s, law_of({}));
  s.cell = box_cell<2>({{kColumns * kSpacing, kRows * height}}, {true, true});
  RandomStream random(11, RandomPurpose::test, 0);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      NewBody<2> body;
      body.r = 0.95 + 0.1 * random.uniform();
      body.x = {{(column + 0.5 * (row % 2)) * kSpacing, row * height}};
      body.mass = kDensity * std::numbers::pi * body.r * body.r;
      body.inertia = 0.5 * body.mass * body.r * body.r;
      add_grain(s.particles, body);
    }
  settle(s, kStepPerRadius);
  if (n.sorted) reorder_grains(s, spatial_order(s));
  set_law(s, law_of(n));
  list_again(s);
  return s;
}

/// One layer of grains that lie on a plane and nowhere near each other.
inline System<3> grains_on_plane(const Needs& n) {
  constexpr int kSide = 141;
  System<3> s;
  set_law(s, law_of(n));
  RandomStream random(12, RandomPurpose::test, 0);
  for (int a = 0; a < kSide; ++a)
    for (int b = 0; b < kSide; ++b) {
      NewBody<3> body = solid_sphere({{2.5 * a, 2.5 * b, 0.99}}, 1.0, kDensity, 0);
      for (int k = 0; k < 2; ++k) body.velocity[k] = 1e-3 * (random.uniform() - 0.5);
      add_grain(s.particles, body);
    }
  add_plane(s.particles, NewBody<3>{}, Vec3{{0.0, 0.0, 1.0}});
  update_neighbours(s);
  return s;
}

}  // namespace softgrain::bench

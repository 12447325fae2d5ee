#include "common/statics/least_work.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/statics/minimiser.h"

namespace softgrain {

namespace {

using statics::PackProblem;
using statics::Unknowns;

void require_walls_apart(const GrainPack& pack, const std::vector<Vec3>& moves) {
  for (std::size_t a = 0; a < pack.walls.size(); ++a)
    for (std::size_t b = a + 1; b < pack.walls.size(); ++b) {
      const Vec3 n = pack.walls[a].normal;
      if (dot(n, pack.walls[b].normal) > -1.0 + 1e-9) continue;
      const Vec3 across = pack.walls[b].point + moves[b] - pack.walls[a].point - moves[a];
      if (!(dot(across, n) > 0.0))
        throw UnusableResult("least work: walls " + std::to_string(a) + " and " + std::to_string(b) +
                             " pass each other");
    }
}

void require_inside(const std::vector<Vec3>& positions, const std::vector<Vec3>& wall_points, const GrainPack& pack) {
  for (std::size_t g = 0; g < positions.size(); ++g)
    for (std::size_t w = 0; w < wall_points.size(); ++w)
      if (dot(positions[g] - wall_points[w], pack.walls[w].normal) <= 0.0 && !statics::centred_on(pack, g, w))
        throw UnusableResult("least work: grain " + std::to_string(g) + " is beyond wall " + std::to_string(w));
}

/// What symmetry planes take from the grains that they hold: the normal part of all other forces on them.
void add_held_grains(const GrainPack& pack, std::vector<Vec3>& walls) {
  if (std::none_of(pack.walls.begin(), pack.walls.end(), [](const PackWall& w) { return w.symmetry; })) return;
  std::vector<Vec3> net(pack.position.size());
  for (std::size_t g = 0; g < pack.weight.size(); ++g) net[g] = pack.gravity * pack.weight[g];
  for (const PackContact& c : pack.contacts) {
    const Vec3 force = c.normal * c.normal_force + c.tangential_force;
    net[static_cast<std::size_t>(c.i)] += force;
    if (c.j < pack.grains()) net[static_cast<std::size_t>(c.j)] -= force;
  }
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (std::size_t g = 0; g < net.size(); ++g)
      if (statics::centred_on(pack, g, w)) walls[w] += pack.walls[w].normal * dot(pack.walls[w].normal, net[g]);
}

/// Grains with fewer contacts than hold them: two with friction, four without.
std::int64_t floppy_grains(const GrainPack& pack) {
  std::vector<int> contacts(pack.position.size(), 0);
  for (const PackContact& c : pack.contacts) {
    ++contacts[static_cast<std::size_t>(c.i)];
    if (c.j < pack.grains()) ++contacts[static_cast<std::size_t>(c.j)];
  }
  const int needed = pack.friction > 0.0 ? 2 : 4;
  std::int64_t count = 0;
  for (const int z : contacts) count += z < needed ? 1 : 0;
  return count;
}

void check(const LeastWorkOptions& o) {
  if (o.refresh < 1 || o.sub_increment_interval < 1 || o.sub_increments < 1 || o.max_iterations < 0)
    throw InputError("least work: refresh, sub-increments and their interval are 1 or more, the cap 0 or more");
  if (!(o.max_move > 0.0 && o.work_tolerance >= 0.0 && o.force_tolerance >= 0.0 && o.residual_tolerance > 0.0 &&
        o.force_floor >= 0.0))
    throw InputError("least work: the largest move and the residual tolerance are above 0, other tolerances 0 or more");
}

/// Makes theta the reference state.
void commit(GrainPack& pack, PackProblem& problem, const Unknowns& theta) {
  std::vector<PackContact> contacts = problem.contacts(theta);
  std::vector<Vec3> positions = problem.positions(theta);
  require_inside(positions, problem.wall_points(), pack);
  for (std::size_t w = 0; w < pack.walls.size(); ++w) pack.walls[w].point = problem.wall_points()[w];
  pack.position = std::move(positions);
  pack.contacts = std::move(contacts);
}

}  // namespace

LeastWorkResult advance(GrainPack& pack, const std::vector<Vec3>& wall_moves, const LeastWorkOptions& options) {
  check(options);
  if (wall_moves.size() != pack.walls.size()) throw InputError("least work: one move per wall");
  require_walls_apart(pack, wall_moves);
  PackProblem problem(pack, wall_moves, options.coulomb, options.torsion);
  require_inside(pack.position, problem.wall_points(), pack);
  Unknowns theta(problem.size(), 0.0);
  const bool published = options.method == LeastWorkMethod::published;
  LeastWorkResult result = published ? statics::minimise_published(problem, theta, options)
                                     : statics::minimise_fast(problem, theta, options);
  result.loop_passes = problem.cost().loop_passes;
  result.contact_evaluations = problem.cost().contact_evaluations;
  result.work -= problem.reference_work();
  if (result.converged) commit(pack, problem, theta);
  result.floppy = floppy_grains(pack);
  return result;
}

void refresh_contacts(GrainPack& pack) {
  PackProblem problem(pack, std::vector<Vec3>(pack.walls.size()), CoulombRule::current, true);
  pack.contacts = problem.contacts(Unknowns(problem.size(), 0.0));
}

std::vector<Vec3> wall_forces(const GrainPack& pack) {
  std::vector<Vec3> out(pack.walls.size());
  for (const PackContact& c : pack.contacts)
    if (c.j >= pack.grains())
      out[static_cast<std::size_t>(c.j - pack.grains())] -= c.normal * c.normal_force + c.tangential_force;
  add_held_grains(pack, out);
  return out;
}

}  // namespace softgrain

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/statics/least_work.h"
#include "common/statics/stiffness.h"
#include "common/statics/unknowns.h"

namespace softgrain {

namespace {

using statics::LinkTangent;
using statics::PackProblem;
using statics::Unknowns;

constexpr double kReduction = 1e-11;
constexpr std::int64_t kLinearIterations = 20000;

/// Widths of the box; throws when the walls are not six planes in the order -x +x -y +y -z +z.
Vec3 box_of(const GrainPack& pack) {
  if (pack.walls.size() != 6) throw InputError("elastic probe: needs a box of six walls");
  Vec3 width;
  for (int k = 0; k < 3; ++k) {
    const PackWall& low = pack.walls[static_cast<std::size_t>(2 * k)];
    const PackWall& high = pack.walls[static_cast<std::size_t>(2 * k + 1)];
    width[k] = high.point[k] - low.point[k];
    if (!(low.normal[k] > 0.999 && high.normal[k] < -0.999 && width[k] > 0.0))
      throw InputError("elastic probe: walls come in the order -x +x -y +y -z +z");
  }
  return width;
}

/// Contacts as they are, none sliding. Forces that turn with their contacts are left out: they are smaller than the
/// stiffness by the order of the overlap over the radius, and with them a pack with rattlers has no unique answer.
std::vector<LinkTangent> stuck_contacts(PackProblem& problem) {
  std::vector<LinkTangent> tangents;
  problem.linearise(Unknowns(problem.size(), 0.0), tangents);
  for (LinkTangent& t : tangents) t.tangential = t.stick;
  return tangents;
}

/// Moves of the six walls at unit compressive strain along `axis`.
std::vector<Vec3> unit_strain(const Vec3& width, int axis) {
  std::vector<Vec3> moves(6);
  moves[static_cast<std::size_t>(2 * axis)][axis] = 0.5 * width[axis];
  moves[static_cast<std::size_t>(2 * axis + 1)][axis] = -0.5 * width[axis];
  return moves;
}

/// Answer of a wall contact to the relative displacement of its grain.
Vec3 contact_force(const LinkTangent& t, const Vec3& delta) {
  const double along = dot(t.normal, delta);
  return t.normal * (t.normal_stiffness * along) + (delta - t.normal * along) * t.tangential;
}

/// Calls body(link, grain, wall) for every closed contact with a wall.
template <class F>
void for_wall_contacts(const PackProblem& problem, const std::vector<LinkTangent>& tangents, const F& body) {
  const auto& links = problem.links();
  const std::int32_t n = problem.pack().grains();
  for (std::size_t c = 0; c < tangents.size(); ++c)
    if (tangents[c].closed && links.j[c] >= n)
      body(tangents[c], static_cast<std::size_t>(links.i[c]), static_cast<std::size_t>(links.j[c] - n));
}

/// Forces on the grains when the walls move and the grains stay.
Unknowns push_of_walls(const PackProblem& problem, const std::vector<LinkTangent>& tangents,
                       const std::vector<Vec3>& moves) {
  Unknowns out(problem.size(), 0.0);
  const auto stride = static_cast<std::size_t>(problem.stride());
  for_wall_contacts(problem, tangents, [&](const LinkTangent& t, std::size_t g, std::size_t w) {
    const Vec3 f = contact_force(t, moves[w]);
    const Vec3 roll = cross(t.normal, f) * -t.arm_i;
    for (std::size_t k = 0; k < 3; ++k) {
      out[g * stride + k] += f[static_cast<int>(k)];
      if (stride == 6) out[g * stride + 3 + k] += roll[static_cast<int>(k)];
    }
  });
  return out;
}

/// Change of the three wall stresses, each the mean of two opposite walls.
Vec3 stress_change(const PackProblem& problem, const std::vector<LinkTangent>& tangents, const std::vector<Vec3>& moves,
                   const Unknowns& x, const Vec3& width) {
  Vec3 stress;
  const auto stride = static_cast<std::size_t>(problem.stride());
  for_wall_contacts(problem, tangents, [&](const LinkTangent& t, std::size_t g, std::size_t w) {
    // The arm to a wall is along its normal: rolling does not change the normal force.
    const double closing = -dot(t.normal, statics::triple(x, g * stride) - moves[w]);
    const int axis = static_cast<int>(w / 2);
    const double area = width[(axis + 1) % 3] * width[(axis + 2) % 3];
    stress[axis] += 0.5 * t.normal_stiffness * closing / area;
  });
  return stress;
}

}  // namespace

ElasticResponse elastic_probe(const GrainPack& pack, const LeastWorkOptions& options) {
  ElasticResponse out;
  const Vec3 width = box_of(pack);
  if (std::any_of(pack.walls.begin(), pack.walls.end(), [](const PackWall& w) { return w.symmetry; }))
    throw InputError("elastic probe: not between symmetry planes");
  PackProblem problem(pack, std::vector<Vec3>(6), options.coulomb, options.torsion);
  const std::vector<LinkTangent> tangents = stuck_contacts(problem);
  statics::BlockJacobi inverse;
  inverse.build(problem, tangents, 1e-2);
  out.factorisations = 1;
  const statics::Stiffness stiffness(problem, tangents);
  out.solved = true;
  for (int b = 0; b < 3; ++b) {
    const std::vector<Vec3> moves = unit_strain(width, b);
    Unknowns x;
    const auto solved =
        statics::conjugate_gradient([&](const Unknowns& in, Unknowns& to) { stiffness.apply(in, to); },
                                    [&](const Unknowns& in, Unknowns& to) { inverse.apply(in, to); },
                                    push_of_walls(problem, tangents, moves), kReduction, kLinearIterations, x);
    out.linear_iterations += solved.iterations;
    out.solved = out.solved && (solved.reduction <= kReduction || solved.iterations == 0);
    const Vec3 stress = stress_change(problem, tangents, moves, x, width);
    for (int a = 0; a < 3; ++a) out.stiffness[a][b] = stress[a];
  }
  return out;
}

double ElasticResponse::bulk_modulus() const {
  double sum = 0.0;
  for (const auto& row : stiffness)
    for (const double c : row) sum += c;
  return sum / 9.0;
}

double ElasticResponse::shear_modulus() const {
  double along = 0.0;
  double across = 0.0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) (a == b ? along : across) += stiffness[a][b];
  return 0.5 * (along / 3.0 - across / 6.0);
}

}  // namespace softgrain

#include "common/statics/pack_problem.h"

#include <omp.h>

#include <algorithm>

#include "common/core/error.h"
#include "common/statics/contact_law.h"

namespace softgrain::statics {

namespace {

/// Number of links below which one thread is faster than two.
constexpr std::int32_t kParallelLinks = 16000;
constexpr std::int32_t kChunk = 1024;

std::size_t slot(std::int32_t k) { return static_cast<std::size_t>(k); }

/// What a link does to its grains.
struct LinkForce {
  Vec3 force{};        ///< force on i
  Vec3 roll{};         ///< n x Q
  Vec3 twist{};        ///< M n [N m]
  double arm_i = 0.0;  ///< arm over R_i
  double arm_j = 0.0;
  double size2 = 0.0;  ///< square of the contact force; 0: apart
  double normal = 0.0;
  double work = 0.0;
};

/// Positions and rotations that a link sees.
struct View {
  const GrainPack& pack;
  const Links& links;
  const std::vector<Vec3>& place;
  const std::vector<Vec3>& wall_points;
  const std::vector<Vec3>& wall_moves;
  double wall_part;
  const Unknowns& theta;
  std::int32_t grains;
};

/// Geometry of link c; false when apart.
bool place_of(const View& v, std::size_t c, ContactPlace& out) {
  const std::size_t i = slot(v.links.i[c]);
  const std::int32_t j = v.links.j[c];
  if (j >= v.grains) {
    const std::size_t w = slot(j - v.grains);
    out = place_at_wall(v.pack.walls[w].normal, softgrain::dot(v.place[i] - v.wall_points[w], v.pack.walls[w].normal),
                        v.pack.radius[i]);
    return out.overlap > 0.0;
  }
  const Vec3 r = v.place[i] - v.place[slot(j)];
  const double reach = v.pack.radius[i] + v.pack.radius[slot(j)];
  const double d2 = norm2(r);
  if (d2 >= reach * reach || d2 == 0.0) return false;
  out = place_of_spheres(r, std::sqrt(d2), v.pack.radius[i], v.pack.radius[slot(j)]);
  return out.overlap > 0.0;
}

/// Response of link c, which is closed at `place`.
template <class Law>
ContactResponse response_of(const View& v, std::size_t c, const ContactPlace& place) {
  if constexpr (!Law::friction) {
    return respond<Law>(v.links.normal[c], nullptr, place, {}, {}, {});
  } else {
    const std::size_t i = slot(v.links.i[c]);
    Vec3 moved = triple(v.theta, 6 * i);
    const Vec3 turn_i = triple(v.theta, 6 * i + 3) * (1.0 / v.pack.radius[i]);
    Vec3 turn_j{};
    if (v.links.j[c] >= v.grains) {
      moved -= v.wall_moves[slot(v.links.j[c] - v.grains)] * v.wall_part;
    } else {
      const std::size_t j = slot(v.links.j[c]);
      moved -= triple(v.theta, 6 * j);
      turn_j = triple(v.theta, 6 * j + 3) * (1.0 / v.pack.radius[j]);
    }
    return respond<Law>(v.links.normal[c], &v.links.friction[c], place, moved, turn_i, turn_j);
  }
}

template <class Law>
LinkForce force_from(const View& v, std::size_t c, const ContactPlace& place, const ContactResponse& r) {
  LinkForce out;
  out.force = place.normal * r.normal.force;
  out.normal = r.normal.force;
  out.work = r.normal.work;
  if constexpr (Law::friction) {
    out.force += r.tangential.force;
    out.roll = cross(place.normal, r.tangential.force);
    out.arm_i = place.arm_i / v.pack.radius[slot(v.links.i[c])];
    if (v.links.j[c] < v.grains) out.arm_j = place.arm_j / v.pack.radius[slot(v.links.j[c])];
    out.work += r.tangential.work;
    if constexpr (Law::torsion) {
      out.twist = place.normal * r.torsion.moment;
      out.work += r.torsion.work;
    }
  }
  out.size2 = norm2(out.force);
  return out;
}

template <class Law>
LinkForce force_of(const View& v, std::size_t c) {
  ContactPlace place;
  if (!place_of(v, c, place)) return {};
  return force_from<Law>(v, c, place, response_of<Law>(v, c, place));
}

template <class Law>
LinkTangent tangent_from(const View& v, std::size_t c, const ContactPlace& place, const ContactResponse& r) {
  LinkTangent t;
  t.closed = true;
  t.normal = place.normal;
  t.normal_stiffness = r.normal.stiffness;
  if constexpr (Law::friction) {
    t.curvature_i = 1.0 / v.pack.radius[slot(v.links.i[c])];
    if (v.links.j[c] < v.grains) t.curvature_j = 1.0 / v.pack.radius[slot(v.links.j[c])];
    t.arm_i = place.arm_i * t.curvature_i;
    t.arm_j = place.arm_j * t.curvature_j;
    t.twist = r.torsion.stiffness;
    t.tangential = r.tangential.stiffness;
    t.stick = r.tangential.stick;
    if (r.tangential.follows && r.tangential.limit > 0.0) {
      t.slip = r.tangential.force * (1.0 / r.tangential.limit);
      t.drag = v.links.friction[c].friction * r.normal.stiffness;
    }
  }
  return t;
}

/// Adds what a link does to grain g, which is its i or its j.
template <class Law>
void add_push(const View& v, const LinkForce& f, std::size_t c, std::int32_t g, Unknowns& out, std::size_t at) {
  const bool first = v.links.i[c] == g;
  add_triple(out, at, first ? f.force : -f.force);
  if constexpr (Law::friction) {
    add_triple(out, at + 3, f.roll * -(first ? f.arm_i : f.arm_j));
    if constexpr (Law::torsion) add_triple(out, at + 3, f.twist * ((first ? 1.0 : -1.0) / v.pack.radius[slot(g)]));
  }
}

template <class Law>
void add_to_grain(const View& v, const LinkForce& f, std::size_t c, std::int32_t g, PackForces& out) {
  add_push<Law>(v, f, c, g, out.force, slot(g) * static_cast<std::size_t>(Law::stride));
  out.largest2[slot(g)] = std::max(out.largest2[slot(g)], f.size2);
}

struct Sums {
  double work = 0.0;
  double normal = 0.0;
  std::int64_t contacts = 0;
  void take(const LinkForce& f) {
    work += f.work;
    normal += f.normal;
    ++contacts;
  }
};

/// Links [begin, end) one after the other.
template <class Law>
Sums scatter(const View& v, std::size_t begin, std::size_t end, PackForces& out) {
  Sums sums;
  for (std::size_t c = begin; c < end; ++c) {
    const LinkForce f = force_of<Law>(v, c);
    if (f.size2 == 0.0) continue;
    sums.take(f);
    add_to_grain<Law>(v, f, c, v.links.i[c], out);
    if (v.links.j[c] < v.grains) add_to_grain<Law>(v, f, c, v.links.j[c], out);
  }
  return sums;
}

/// Computes the sums of scatter() in the same order: all links first, then every grain gathers its own.
template <class Law>
void gather_all(const View& v, std::vector<Sums>& sums, PackForces& out) {
  const auto links = static_cast<std::size_t>(v.links.size());
  std::vector<LinkForce> forces(links);
  const auto chunks = static_cast<std::int32_t>(sums.size());
#pragma omp parallel
  {
#pragma omp for schedule(static)
    for (std::int32_t k = 0; k < chunks; ++k) {
      const std::size_t begin = slot(k) * kChunk;
      for (std::size_t c = begin; c < std::min(begin + kChunk, links); ++c) {
        forces[c] = force_of<Law>(v, c);
        if (forces[c].size2 != 0.0) sums[slot(k)].take(forces[c]);
      }
    }
#pragma omp for schedule(static)
    for (std::int32_t g = 0; g < v.grains; ++g)
      for (std::int32_t k = v.links.start[slot(g)]; k < v.links.start[slot(g) + 1]; ++k) {
        const std::size_t c = slot(v.links.of_grain[slot(k)]);
        if (forces[c].size2 != 0.0) add_to_grain<Law>(v, forces[c], c, g, out);
      }
  }
}

/// Work of gravity, and its force: the start of the sums.
double start_sums(const GrainPack& pack, const Unknowns& theta, std::size_t stride, PackForces& out) {
  const auto n = static_cast<std::size_t>(pack.grains());
  out.force.assign(n * stride, 0.0);
  out.largest2.assign(n, 0.0);
  double work = 0.0;
  for (std::size_t g = 0; g < pack.weight.size(); ++g) {
    const Vec3 load = pack.gravity * pack.weight[g];
    add_triple(out.force, g * stride, load);
    work -= softgrain::dot(load, triple(theta, g * stride));
  }
  return work;
}

}  // namespace

PackProblem::PackProblem(const GrainPack& pack, std::vector<Vec3> wall_moves, CoulombRule rule, bool torsion)
    : pack_(pack),
      wall_moves_(std::move(wall_moves)),
      rule_(rule),
      torsion_(torsion),
      friction_(has_friction(pack)),
      symmetry_(pack) {
  if (wall_moves_.size() != pack.walls.size()) throw InputError("pack: one move per wall");
  set_walls(0.0);
  links_ = find_links(pack_, pack_.position, wall_points_);
}

void PackProblem::set_walls(double part) {
  wall_part_ = part;
  wall_points_.resize(pack_.walls.size());
  for (std::size_t w = 0; w < wall_points_.size(); ++w) wall_points_[w] = pack_.walls[w].point + wall_moves_[w] * part;
}

std::vector<Vec3> PackProblem::positions(const Unknowns& theta) const {
  std::vector<Vec3> x = pack_.position;
  for (std::size_t g = 0; g < x.size(); ++g) x[g] += triple(theta, g * static_cast<std::size_t>(stride()));
  return x;
}

void PackProblem::place(const Unknowns& theta) {
  place_ = positions(theta);
  for (const Vec3& x : place_)
    if (!std::isfinite(norm2(x))) return;  // the forces will say so
  if (!links_hold(links_, pack_, place_, wall_points_)) links_ = find_links(pack_, place_, wall_points_);
}

template <class F>
void PackProblem::dispatch(const F& body) const {
  if (!friction_) return body(FrictionlessLaw{});
  if (rule_ == CoulombRule::reference) {
    if (torsion_) return body(FrictionLaw<CoulombRule::reference, true>{});
    return body(FrictionLaw<CoulombRule::reference, false>{});
  }
  if (torsion_) return body(FrictionLaw<CoulombRule::current, true>{});
  return body(FrictionLaw<CoulombRule::current, false>{});
}

template <class Law>
void PackProblem::evaluate_as(const Unknowns& theta, PackForces& out) const {
  const View view{pack_, links_, place_, wall_points_, wall_moves_, wall_part_, theta, pack_.grains()};
  out.work = start_sums(pack_, theta, static_cast<std::size_t>(Law::stride), out);
  const auto links = static_cast<std::size_t>(links_.size());
  std::vector<Sums> sums((links + kChunk - 1) / kChunk);
  if (links_.size() >= kParallelLinks && omp_get_max_threads() > 1 && omp_in_parallel() == 0) {
    gather_all<Law>(view, sums, out);
  } else {
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k] = scatter<Law>(view, k * kChunk, std::min((k + 1) * kChunk, links), out);
  }
  out.contact_force = 0.0;
  out.contacts = 0;
  for (const Sums& s : sums) {
    out.work += s.work;
    out.contact_force += s.normal;
    out.contacts += s.contacts;
  }
}

template <class Law>
void PackProblem::linearise_as(const Unknowns& theta, std::vector<LinkTangent>& out) const {
  const View view{pack_, links_, place_, wall_points_, wall_moves_, wall_part_, theta, pack_.grains()};
  out.resize(static_cast<std::size_t>(links_.size()));
  for (std::size_t c = 0; c < out.size(); ++c) {
    ContactPlace place;
    out[c] =
        place_of(view, c, place) ? tangent_from<Law>(view, c, place, response_of<Law>(view, c, place)) : LinkTangent{};
  }
}

template <class Law>
void PackProblem::evaluate_grain_as(const Unknowns& theta, std::size_t g, GrainForces& out) const {
  const View view{pack_, links_, place_, wall_points_, wall_moves_, wall_part_, theta, pack_.grains()};
  const auto grain = static_cast<std::int32_t>(g);
  for (std::int32_t k = links_.start[g]; k < links_.start[g + 1]; ++k) {
    const std::size_t c = slot(links_.of_grain[slot(k)]);
    ContactPlace place;
    if (!place_of(view, c, place)) continue;
    const ContactResponse r = response_of<Law>(view, c, place);
    const LinkForce f = force_from<Law>(view, c, place, r);
    add_push<Law>(view, f, c, grain, out.force, 0);
    out.largest2 = std::max(out.largest2, f.size2);
    out.links.push_back(c);
    out.tangents.push_back(tangent_from<Law>(view, c, place, r));
  }
}

template <class Law>
void PackProblem::contacts_as(const Unknowns& theta, std::vector<PackContact>& out) const {
  const View view{pack_, links_, place_, wall_points_, wall_moves_, wall_part_, theta, pack_.grains()};
  for (std::size_t c = 0; c < static_cast<std::size_t>(links_.size()); ++c) {
    ContactPlace place;
    if (!place_of(view, c, place)) continue;
    const ContactResponse r = response_of<Law>(view, c, place);
    bool sliding = false;
    if constexpr (Law::friction) {
      const double limit = links_.friction[c].friction * r.normal.force;
      sliding = limit > 0.0 && norm(r.tangential.force) >= (1.0 - 1e-6) * limit;
    }
    out.push_back({links_.i[c], links_.j[c], place.normal, place.overlap, r.normal.force,
                   links_.normal[c].root_radius * std::sqrt(place.overlap), r.tangential.force, r.torsion.moment,
                   sliding});
  }
}

double PackProblem::reference_work() const {
  double sum = 0.0;
  for (const PackContact& c : pack_.contacts) sum += 0.4 * c.normal_force * c.overlap;
  return sum;
}

void PackProblem::evaluate(const Unknowns& theta, PackForces& out) {
  place(theta);
  ++cost_.loop_passes;
  cost_.contact_evaluations += links_.size();
  dispatch([&](auto law) { evaluate_as<decltype(law)>(theta, out); });
  symmetry_.project(out.force, stride());
}

void PackProblem::linearise(const Unknowns& theta, std::vector<LinkTangent>& out) {
  place(theta);
  ++cost_.loop_passes;
  cost_.contact_evaluations += links_.size();
  dispatch([&](auto law) { linearise_as<decltype(law)>(theta, out); });
}

void PackProblem::evaluate_grain(const Unknowns& theta, std::size_t g, GrainForces& out) {
  const auto width = static_cast<std::size_t>(stride());
  place_[g] = pack_.position[g] + triple(theta, g * width);
  out.force.assign(width, 0.0);
  out.largest2 = 0.0;
  out.links.clear();
  out.tangents.clear();
  if (!pack_.weight.empty()) add_triple(out.force, 0, pack_.gravity * pack_.weight[g]);
  cost_.contact_evaluations += links_.start[g + 1] - links_.start[g];
  dispatch([&](auto law) { evaluate_grain_as<decltype(law)>(theta, g, out); });
}

std::vector<PackContact> PackProblem::contacts(const Unknowns& theta) {
  place(theta);
  std::vector<PackContact> out;
  dispatch([&](auto law) { contacts_as<decltype(law)>(theta, out); });
  return out;
}

}  // namespace softgrain::statics

// Grains on symmetry planes, and the search for pairs that may touch.
#include "common/statics/links.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/material.h"
#include "common/neighbours/hierarchical_grid.h"

namespace softgrain::statics {

namespace {

constexpr double kOnPlane = 1e-9;  // of the radius

void set_triple(Unknowns& v, std::size_t at, const Vec3& a) {
  for (int k = 0; k < 3; ++k) v[at + static_cast<std::size_t>(k)] = a[k];
}

}  // namespace

bool centred_on(const GrainPack& pack, std::size_t g, std::size_t w) {
  const PackWall& wall = pack.walls[w];
  return wall.symmetry &&
         std::abs(softgrain::dot(pack.position[g] - wall.point, wall.normal)) < kOnPlane * pack.radius[g];
}

SymmetryPlanes::SymmetryPlanes(const GrainPack& pack) {
  for (const PackWall& w : pack.walls) normal_.push_back(w.normal);
  for (std::size_t g = 0; g < pack.position.size(); ++g) {
    HeldGrain held{g, {}};
    for (std::size_t w = 0; w < pack.walls.size(); ++w) {
      if (!centred_on(pack, g, w)) continue;
      for (const std::size_t other : held.walls)
        if (std::abs(softgrain::dot(normal_[other], normal_[w])) > 1e-9)
          throw InputError("pack: symmetry planes that share a grain are at right angles");
      held.walls.push_back(w);
    }
    if (!held.walls.empty()) held_.push_back(std::move(held));
  }
}

void SymmetryPlanes::project(Unknowns& v, int stride) const {
  for (const HeldGrain& held : held_) {
    const std::size_t at = held.grain * static_cast<std::size_t>(stride);
    Vec3 move = triple(v, at);
    for (const std::size_t w : held.walls) move -= normal_[w] * softgrain::dot(normal_[w], move);
    set_triple(v, at, move);
    if (stride != 6) continue;
    const Vec3 n = normal_[held.walls.front()];
    set_triple(v, at + 3, held.walls.size() == 1 ? n * softgrain::dot(n, triple(v, at + 3)) : Vec3{});
  }
}

void SymmetryPlanes::carry(Unknowns& displacement, int stride, const std::vector<Vec3>& wall_moves, double part) const {
  for (const HeldGrain& held : held_) {
    const std::size_t at = held.grain * static_cast<std::size_t>(stride);
    Vec3 move = triple(displacement, at);
    for (const std::size_t w : held.walls) move += normal_[w] * softgrain::dot(normal_[w], wall_moves[w] * part - move);
    set_triple(displacement, at, move);
  }
}

namespace {

/// How far a grain may move, in its radius, before the search is repeated.
constexpr double kSkin = 0.04;

Material material_of(double youngs_modulus, double nu) { return {"", 0.0, youngs_modulus, nu}; }

/// 1/G [1/Pa]
double shear_compliance(const Material& m) { return 2.0 * (1.0 + m.poisson_ratio) / m.youngs_modulus; }

NormalConstants normal_constants(const Material& a, const Material& b, const PairBodies& bodies) {
  const double root = std::sqrt(bodies.effective_radius());
  return {4.0 / 3.0 / (a.normal_compliance() + b.normal_compliance()) * root, root};
}

FrictionConstants friction_constants(const Material& a, const Material& b, double friction) {
  FrictionConstants f;
  f.friction = friction;
  f.fresh = true;
  if (friction == 0.0) return f;
  f.shear = 8.0 / ((2.0 - a.poisson_ratio) * shear_compliance(a) + (2.0 - b.poisson_ratio) * shear_compliance(b));
  f.twist = 16.0 / 3.0 / (shear_compliance(a) + shear_compliance(b));
  return f;
}

/// Reference state of a contact. Its forces are those of the equilibrium: one whose normal force fell may carry more
/// than mu P, and what becomes of that is up to the rule of friction.
void remember(FrictionConstants& f, const PackContact& c) {
  f.fresh = false;
  f.overlap0 = c.overlap;
  f.contact_radius0 = c.contact_radius;
  if (f.friction == 0.0) return;
  f.limit0 = f.friction * c.normal_force;
  f.tangential0 = c.tangential_force;
  f.torsion0 = c.torsion;
}

bool before(const PackContact& c, std::int32_t i, std::int32_t j) { return c.i < i || (c.i == i && c.j < j); }

struct Pair {
  std::int32_t i, j;
};

std::vector<Pair> pairs_in_reach(const GrainPack& pack, const std::vector<Vec3>& x, const std::vector<Vec3>& walls) {
  Particles<3> p;
  const std::int32_t n = pack.grains();
  p.grains = n;
  std::vector<double> skin(x.size());
  for (std::size_t g = 0; g < x.size(); ++g) {
    p.sphere.push_back({x[g], pack.radius[g]});
    skin[g] = kSkin * pack.radius[g];
  }
  std::vector<Pair> out;
  for (const CandidatePair& c : candidate_pairs(p, open_cell<3>(), skin)) out.push_back({c.i, c.j});
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (std::size_t g = 0; g < x.size(); ++g)
      if (dot(x[g] - walls[w], pack.walls[w].normal) < pack.radius[g] + skin[g] && !centred_on(pack, g, w))
        out.push_back({static_cast<std::int32_t>(g), n + static_cast<std::int32_t>(w)});
  std::sort(out.begin(), out.end(), [](const Pair& a, const Pair& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; });
  return out;
}

void index_by_grain(Links& links, std::size_t grains) {
  const auto n = static_cast<std::int32_t>(grains);
  links.start.assign(grains + 1, 0);
  const auto slot = [](std::int32_t k) { return static_cast<std::size_t>(k); };
  for (std::size_t c = 0; c < links.i.size(); ++c) {
    ++links.start[slot(links.i[c]) + 1];
    if (links.j[c] < n) ++links.start[slot(links.j[c]) + 1];
  }
  for (std::size_t g = 1; g <= grains; ++g) links.start[g] += links.start[g - 1];
  links.of_grain.resize(slot(links.start[grains]));
  std::vector<std::int32_t> next(links.start.begin(), links.start.end() - 1);
  for (std::size_t c = 0; c < links.i.size(); ++c) {
    links.of_grain[slot(next[slot(links.i[c])]++)] = static_cast<std::int32_t>(c);
    if (links.j[c] < n) links.of_grain[slot(next[slot(links.j[c])]++)] = static_cast<std::int32_t>(c);
  }
}

void require(bool good, const char* what) {
  if (!good) throw InputError(what);
}

bool in_range(double youngs_modulus, double nu) { return youngs_modulus > 0.0 && is_poisson_ratio(nu); }

void check(const GrainPack& pack) {
  const std::size_t n = pack.position.size();
  require(pack.radius.size() == n && pack.youngs_modulus.size() == n && pack.poisson_ratio.size() == n &&
              (pack.weight.empty() || pack.weight.size() == n),
          "pack: one radius, modulus, Poisson ratio (and weight) per grain");
  require(pack.friction >= 0.0, "pack: friction is 0 or more");
  for (std::size_t g = 0; g < n; ++g)
    require(pack.radius[g] > 0.0 && std::isfinite(pack.radius[g]) &&
                in_range(pack.youngs_modulus[g], pack.poisson_ratio[g]),
            "pack: radii and moduli are above 0, Poisson ratios in (-1, 0.5]");
  for (const PackWall& w : pack.walls)
    require(!w.symmetry || w.friction == 0.0, "pack: a symmetry plane has no friction");
  for (const PackWall& w : pack.walls)
    require(w.friction >= 0.0 && in_range(w.youngs_modulus, w.poisson_ratio) && std::abs(norm2(w.normal) - 1.0) < 1e-9,
            "pack: walls need unit normals, moduli above 0, Poisson ratios in (-1, 0.5], friction 0 or more");
}

/// Constants and reference state of every pair; contacts and pairs are both sorted.
void fill_constants(Links& links, const GrainPack& pack) {
  const std::int32_t n = pack.grains();
  const bool friction = has_friction(pack);
  auto contact = pack.contacts.begin();
  for (std::size_t c = 0; c < links.i.size(); ++c) {
    const auto i = static_cast<std::size_t>(links.i[c]);
    const bool wall = links.j[c] >= n;
    const auto j = static_cast<std::size_t>(wall ? links.j[c] - n : links.j[c]);
    const Material a = material_of(pack.youngs_modulus[i], pack.poisson_ratio[i]);
    const Material b = wall ? material_of(pack.walls[j].youngs_modulus, pack.walls[j].poisson_ratio)
                            : material_of(pack.youngs_modulus[j], pack.poisson_ratio[j]);
    const double ri = pack.radius[i];
    links.normal[c] = normal_constants(a, b, {ri, wall ? 0.0 : pack.radius[j]});
    require(std::isfinite(links.normal[c].hertz), "pack: a contact of two rigid bodies has no finite stiffness");
    if (!friction) continue;
    links.friction[c] = friction_constants(a, b, wall ? pack.walls[j].friction : pack.friction);
    while (contact != pack.contacts.end() && before(*contact, links.i[c], links.j[c])) ++contact;
    const bool known = contact != pack.contacts.end() && contact->i == links.i[c] && contact->j == links.j[c];
    if (known && contact->overlap > 0.0) {
      remember(links.friction[c], *contact);
    } else {
      const double distance = wall ? dot(pack.position[i] - pack.walls[j].point, pack.walls[j].normal)
                                   : norm(pack.position[i] - pack.position[j]) - pack.radius[j];
      links.friction[c].overlap0 = std::min(0.0, ri - distance);
    }
  }
}

}  // namespace

bool has_friction(const GrainPack& pack) {
  return pack.friction > 0.0 ||
         std::any_of(pack.walls.begin(), pack.walls.end(), [](const PackWall& w) { return w.friction > 0.0; });
}

Links find_links(const GrainPack& pack, const std::vector<Vec3>& positions, const std::vector<Vec3>& wall_points) {
  check(pack);
  Links links;
  for (const Pair& p : pairs_in_reach(pack, positions, wall_points)) {
    links.i.push_back(p.i);
    links.j.push_back(p.j);
  }
  links.normal.resize(links.i.size());
  if (has_friction(pack)) links.friction.resize(links.i.size());
  fill_constants(links, pack);
  index_by_grain(links, positions.size());
  links.searched_at = positions;
  links.walls_at = wall_points;
  return links;
}

bool links_hold(const Links& links, const GrainPack& pack, const std::vector<Vec3>& positions,
                const std::vector<Vec3>& wall_points) {
  double walls_moved = 0.0;
  for (std::size_t w = 0; w < wall_points.size(); ++w)
    walls_moved = std::max(walls_moved, norm(wall_points[w] - links.walls_at[w]));
  for (std::size_t g = 0; g < positions.size(); ++g) {
    const double left = kSkin * pack.radius[g] - walls_moved;
    // The negation also catches a position that is not a number.
    if (!(left > 0.0 && norm2(positions[g] - links.searched_at[g]) < left * left)) return false;
  }
  return true;
}

}  // namespace softgrain::statics

#include "microsim/grain_box/box_measure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/statics/least_work.h"

namespace softgrain {

Vec3 box_lengths(const GrainPack& pack) {
  Vec3 lengths;
  for (int k = 0; k < 3; ++k) {
    const auto low = static_cast<std::size_t>(2 * k);
    lengths[k] = pack.walls[low + 1].point[k] - pack.walls[low].point[k];
  }
  return lengths;
}

double solid_volume(const GrainPack& pack) {
  double volume = 0.0;
  for (const double r : pack.radius) volume += kSphereVolume * r * r * r;
  return volume;
}

double solid_fraction(const GrainPack& pack) {
  const Vec3 lengths = box_lengths(pack);
  return solid_volume(pack) / (lengths[0] * lengths[1] * lengths[2]);
}

double BoxStress::deviator() const {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += (normal[k] - mean()) * (normal[k] - mean());
  return std::sqrt(1.5 * sum);
}

namespace {

/// -(1/V) sum over the wall contacts of f_a (x - centre)_b; f: force on the grain, x: where it meets the wall.
std::array<Vec3, 3> first_moment(const GrainPack& pack, const Vec3& lengths) {
  Vec3 centre;
  for (int k = 0; k < 3; ++k) centre[k] = pack.walls[static_cast<std::size_t>(2 * k)].point[k] + 0.5 * lengths[k];
  const double volume = lengths[0] * lengths[1] * lengths[2];
  std::array<Vec3, 3> out{};
  for (const PackContact& c : pack.contacts) {
    if (c.j < pack.grains()) continue;
    const auto i = static_cast<std::size_t>(c.i);
    const Vec3 arm = pack.position[i] - c.normal * (pack.radius[i] - c.overlap) - centre;
    const Vec3 force = c.normal * c.normal_force + c.tangential_force;
    for (int a = 0; a < 3; ++a) out[static_cast<std::size_t>(a)] -= arm * (force[a] / volume);
  }
  return out;
}

}  // namespace

BoxStress box_stress(const GrainPack& pack) {
  const Vec3 lengths = box_lengths(pack);
  const std::vector<Vec3> forces = wall_forces(pack);
  BoxStress out;
  for (int k = 0; k < 3; ++k) {
    const double area = lengths[(k + 1) % 3] * lengths[(k + 2) % 3];
    const auto low = static_cast<std::size_t>(2 * k);
    const double pushed_low = -forces[low][k] / area;
    const double pushed_high = forces[low + 1][k] / area;
    out.normal[k] = 0.5 * (pushed_low + pushed_high);
    if (out.normal[k] > 0.0)
      out.imbalance = larger_or_nan(out.imbalance, std::abs(pushed_high - pushed_low) / out.normal[k]);
  }
  const std::array<Vec3, 3> stress = first_moment(pack, lengths);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const double ab = stress[static_cast<std::size_t>(a)][b];
    const double ba = stress[static_cast<std::size_t>(b)][a];
    out.shear = larger_or_nan(out.shear, 0.5 * std::abs(ab + ba));
    out.moment = larger_or_nan(out.moment, std::abs(ab - ba));
  }
  return out;
}

std::vector<std::int32_t> contacts_per_grain(const GrainPack& pack) {
  std::vector<std::int32_t> count(pack.position.size(), 0);
  for (const PackContact& c : pack.contacts) {
    if (!(c.normal_force > 0.0)) continue;
    ++count[static_cast<std::size_t>(c.i)];
    if (c.j < pack.grains()) ++count[static_cast<std::size_t>(c.j)];
  }
  return count;
}

namespace {

/// Takes grains with fewer than `least` contacts out, and again those that this leaves with too few.
std::vector<char> find_rattlers(const GrainPack& pack, std::vector<std::int32_t> count, std::int32_t least) {
  std::vector<char> out(count.size(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> now = out;
    for (std::size_t n = 0; n < out.size(); ++n)
      if (out[n] == 0 && count[n] < least) {
        now[n] = 1;
        changed = true;
      }
    for (const PackContact& c : pack.contacts) {
      if (!(c.normal_force > 0.0) || c.j >= pack.grains()) continue;
      const auto i = static_cast<std::size_t>(c.i);
      const auto j = static_cast<std::size_t>(c.j);
      if (now[i] != 0 && out[i] == 0 && now[j] == 0) --count[j];
      if (now[j] != 0 && out[j] == 0 && now[i] == 0) --count[i];
    }
    out = std::move(now);
  }
  return out;
}

}  // namespace

ContactCounts count_contacts(const GrainPack& pack) {
  ContactCounts out;
  const std::vector<std::int32_t> count = contacts_per_grain(pack);
  const std::vector<char> rattler = find_rattlers(pack, count, pack.friction > 0.0 ? 2 : 4);
  std::int64_t ends = 0;
  std::int64_t held_ends = 0;
  for (const PackContact& c : pack.contacts) {
    if (!(c.normal_force > 0.0)) continue;
    const bool wall = c.j >= pack.grains();
    ++out.contacts;
    out.sliding += c.sliding ? 1 : 0;
    out.mean_force += c.normal_force;
    ends += wall ? 1 : 2;
    const bool held =
        rattler[static_cast<std::size_t>(c.i)] == 0 && (wall || rattler[static_cast<std::size_t>(c.j)] == 0);
    if (held) held_ends += wall ? 1 : 2;
  }
  const auto grains = static_cast<std::int64_t>(count.size());
  out.rattlers = std::count(rattler.begin(), rattler.end(), 1);
  out.fewest = count.empty() ? 0 : *std::min_element(count.begin(), count.end());
  if (out.contacts > 0) out.mean_force /= static_cast<double>(out.contacts);
  if (grains > 0) out.coordination = static_cast<double>(ends) / static_cast<double>(grains);
  if (grains > out.rattlers)
    out.coordination_without = static_cast<double>(held_ends) / static_cast<double>(grains - out.rattlers);
  return out;
}

namespace {

double friction_of(const GrainPack& pack, const PackContact& c) {
  return c.j < pack.grains() ? pack.friction : pack.walls[static_cast<std::size_t>(c.j - pack.grains())].friction;
}

bool reaches(const GrainPack& pack, const PackContact& c, double normal_force) {
  const double friction = friction_of(pack, c);
  return friction > 0.0 && normal_force > 0.0 && norm(c.tangential_force) >= (1.0 - 1e-6) * friction * normal_force;
}

}  // namespace

double share_at_start_limit(const std::vector<PackContact>& before, const GrainPack& after) {
  if (!(after.friction > 0.0)) return kNaN;
  const auto start_force = [&](const PackContact& c) {
    const auto found =
        std::lower_bound(before.begin(), before.end(), c,
                         [](const PackContact& x, const PackContact& y) { return x.i != y.i ? x.i < y.i : x.j < y.j; });
    return found != before.end() && found->i == c.i && found->j == c.j ? found->normal_force : 0.0;
  };
  std::int64_t all = 0;
  std::int64_t at_limit = 0;
  for (const PackContact& c : after.contacts) {
    if (!(c.normal_force > 0.0)) continue;
    ++all;
    at_limit += reaches(after, c, start_force(c)) ? 1 : 0;
  }
  return all > 0 ? static_cast<double>(at_limit) / static_cast<double>(all) : kNaN;
}

std::vector<Vec3> wall_moves(const Vec3& strain, const Vec3& reference) {
  std::vector<Vec3> moves(kBoxWalls);
  for (int k = 0; k < 3; ++k) {
    const double half = 0.5 * strain[k] * reference[k];
    moves[static_cast<std::size_t>(2 * k)][k] = half;
    moves[static_cast<std::size_t>(2 * k + 1)][k] = -half;
  }
  return moves;
}

}  // namespace softgrain

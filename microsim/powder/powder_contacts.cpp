#include "microsim/powder/powder_contacts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/dynamics/force_pass.h"
#include "microsim/powder/powder_start.h"

namespace softgrain {

namespace {

/// Disks with fewer than two contacts, taken away until every one left has two.
std::vector<bool> find_rattlers(std::size_t disks, const std::vector<ContactRecord<2>>& records) {
  std::vector<int> degree(disks, 0);
  std::vector<bool> gone(disks, false);
  for (const auto& c : records) {
    ++degree[static_cast<std::size_t>(c.i)];
    ++degree[static_cast<std::size_t>(c.j)];
  }
  std::vector<bool> cut(records.size(), false);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t k = 0; k < disks; ++k)
      if (!gone[k] && degree[k] < 2) {
        gone[k] = again = true;
      }
    for (std::size_t c = 0; c < records.size(); ++c) {
      const auto i = static_cast<std::size_t>(records[c].i);
      const auto j = static_cast<std::size_t>(records[c].j);
      if (cut[c] || (!gone[i] && !gone[j])) continue;
      cut[c] = true;
      --degree[i];
      --degree[j];
    }
  }
  return gone;
}

std::vector<double> shares_of(std::size_t disks, const std::vector<ContactRecord<2>>& records) {
  std::vector<std::size_t> neighbours(disks, 0);
  for (const auto& c : records) {
    ++neighbours[static_cast<std::size_t>(c.i)];
    ++neighbours[static_cast<std::size_t>(c.j)];
  }
  std::vector<double> shares;
  for (const std::size_t k : neighbours) {
    if (k >= shares.size()) shares.resize(k + 1, 0.0);
    shares[k] += 1.0 / static_cast<double>(disks);
  }
  return shares;
}

double rumpf(const System<2>& s, const PowderContacts& c) {
  double d = 0.0;
  double d2 = 0.0;
  for (const auto& b : s.particles.sphere) {
    d += 2.0 * b.r;
    d2 += 4.0 * b.r * b.r;
  }
  return c.coordination * powder_fraction(s) * c.mean_normal * d / (std::numbers::pi * d2);
}

}  // namespace

PowderContacts powder_contacts(const System<2>& s, double zero, bool cohesive) {
  PowderContacts out;
  const std::vector<ContactRecord<2>> records = contact_records(s);
  const auto disks = static_cast<std::size_t>(s.particles.grains);
  double sum = 0.0;
  double square = 0.0;
  double repulsive = 0.0;
  double tensile = 0.0;
  double work = 0.0;
  for (const auto& c : records) {
    work += c.normal_force * norm(c.branch);
    ++(c.overlap > 0.0 ? out.contacts : out.distant);
    sum += c.normal_force;
    square += c.normal_force * c.normal_force;
    if (std::abs(c.normal_force) < zero) {
      ++out.unstressed;
    } else if (c.normal_force > 0.0) {
      ++out.repulsive;
      repulsive += c.normal_force;
    } else {
      ++out.tensile;
      tensile += c.normal_force;
    }
  }
  const auto n = static_cast<double>(records.size());
  out.coordination = 2.0 * n / static_cast<double>(disks);
  out.shares = shares_of(disks, records);
  if (!cohesive) {
    const std::vector<bool> rattlers = find_rattlers(disks, records);
    out.rattlers = std::count(rattlers.begin(), rattlers.end(), true);
  }
  const double idle = cohesive ? (out.shares.empty() ? 0.0 : out.shares[0])
                               : static_cast<double>(out.rattlers) / static_cast<double>(disks);
  out.coordination_backbone = idle < 1.0 ? out.coordination / (1.0 - idle) : 0.0;
  if (records.empty()) return out;
  out.mean_normal = sum / n;
  out.square_mean_normal = std::sqrt(square / n);
  if (out.repulsive > 0) out.mean_repulsive = repulsive / static_cast<double>(out.repulsive);
  if (out.tensile > 0) out.mean_tensile = tensile / static_cast<double>(out.tensile);
  out.rumpf_pressure = rumpf(s, out);
  out.branch_pressure = 0.5 * work / s.cell.volume();
  return out;
}

std::vector<bool> powder_rattlers(const System<2>& system) {
  return find_rattlers(static_cast<std::size_t>(system.particles.grains), contact_records(system));
}

namespace {

/// A straight pull is 180 degrees exactly, and belongs to the last bin.
double angle_of(const PowderInteraction& pair) {
  const double angle = std::atan2(std::abs(pair.tangential_force), pair.normal_force) * 180.0 / std::numbers::pi;
  return std::min(angle, std::nextafter(180.0, 0.0));
}

void add_normals(const std::vector<PowderInteraction>& pairs, double zero, PowderForces& out) {
  double mean = 0.0;
  for (const auto& pair : pairs) {
    out.normal.add(pair.normal_force);
    mean += pair.normal_force / static_cast<double>(pairs.size());
  }
  if (mean < zero) return;
  for (const auto& pair : pairs) out.normal_over_mean.add(pair.normal_force / mean);
}

}  // namespace

PowderForces powder_forces(const std::vector<PowderInteraction>& pairs, double zero) {
  PowderForces out;
  add_normals(pairs, zero, out);
  std::int64_t contacts = 0;
  std::int64_t idle = 0;
  for (const auto& pair : pairs) {
    if (pair.distant) continue;
    ++contacts;
    if (pair.force() < zero) {
      ++idle;
      continue;
    }
    out.ratio.add(std::abs(pair.tangential_force / pair.normal_force));
    out.angle.add(angle_of(pair));
  }
  if (contacts > 0) out.zero_share = static_cast<double>(idle) / static_cast<double>(contacts);
  return out;
}

}  // namespace softgrain

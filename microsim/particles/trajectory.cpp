#include "microsim/particles/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/vec.h"
#include "common/dynamics/contact_tensors.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/spatial_order.h"
#include "common/state/system_io.h"

namespace softgrain {

namespace {

void append(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), v.v.begin(), v.v.end()); }

Vec3 axis_in_space(const Vec3& spin) { return spin; }
Vec3 axis_in_space(const Vec<1>& spin) { return {{0.0, 0.0, spin[0]}}; }

/// Row-major; an axis that a plane cell does not have is open, of length 1.
template <int D>
void append_edges(std::vector<double>& to, const Matrix<D>& edges) {
  for (int k = 0; k < 3; ++k) append(to, k < D ? in_space<D>(edges[k]) : Vec3{{0.0, 0.0, 1.0}});
}

constexpr std::int64_t kMostSnapshots = 100;
constexpr std::int64_t kGrainFrames = 200'000;

}  // namespace

template <int D>
void record_frame(Trajectory& t, const System<D>& s) {
  const auto& p = s.particles;
  double translational = 0.0;
  double rotational = 0.0;
  double gravitational = 0.0;
  for (const Slot slot : slots_by_id(p)) {
    const auto u = static_cast<std::size_t>(slot);
    append(t.position, in_space<D>(p.sphere[u].x));
    append(t.velocity, in_space<D>(p.velocity[u]));
    append(t.spin, axis_in_space(p.spin[u]));
    translational += 0.5 * norm2(p.velocity[u]) / p.inverse_mass[u];
    rotational += 0.5 * norm2(p.spin[u]) / p.inverse_inertia[u];
    gravitational -= dot(s.gravity, p.sphere[u].x) / p.inverse_mass[u];
  }
  for (auto u = static_cast<std::size_t>(p.grains); u < p.sphere.size(); ++u)
    append(t.wall_position, in_space<D>(p.sphere[u].x));
  append_edges<D>(t.cell_edges, s.cell.edges);
  t.time.push_back(s.time);
  t.translational_energy.push_back(translational);
  t.rotational_energy.push_back(rotational);
  t.gravitational_energy.push_back(gravitational);
}

template void record_frame<2>(Trajectory&, const System<2>&);
template void record_frame<3>(Trajectory&, const System<3>&);

template <int D>
void record_contacts(FrameContacts& to, std::int64_t frame, const System<D>& system) {
  const std::vector<SnapshotContact> now = snapshot_contacts(system);
  const auto valid = [](const SnapshotContact& c) {
    return std::isfinite(norm2(c.force)) && std::isfinite(norm2(c.from)) && std::isfinite(norm2(c.to));
  };
  if (!std::all_of(now.begin(), now.end(), valid)) return;  // the run is about to be found lost
  to.frame.push_back(frame);
  to.count.push_back(static_cast<std::int64_t>(now.size()));
  to.contacts.insert(to.contacts.end(), now.begin(), now.end());
}

template void record_contacts<2>(FrameContacts&, std::int64_t, const System<2>&);
template void record_contacts<3>(FrameContacts&, std::int64_t, const System<3>&);

std::int64_t default_snapshots(std::int64_t grains) {
  return std::clamp<std::int64_t>(kGrainFrames / std::max<std::int64_t>(grains, 1), 1, kMostSnapshots);
}

namespace {

/// Diameter: mean over grains by number; density: mass of all over their volume (of disks their area).
template <int D>
double inertial_number_of(const System<D>& s, const ContactTotals<D>& totals) {
  const auto& p = s.particles;
  double mass = 0.0;
  double volume = 0.0;
  double diameter = 0.0;
  for (std::size_t u = 0; u < static_cast<std::size_t>(p.grains); ++u) {
    const double r = p.sphere[u].r;
    mass += 1.0 / p.inverse_mass[u];
    volume += D == 3 ? kSphereVolume * cube(r) : std::numbers::pi * r * r;
    diameter += 2.0 * r;
  }
  return inertial_number(totals.rate, diameter / p.grains, mass / volume, totals.pressure);
}

}  // namespace

template <int D>
ContactTotals<D> contact_totals(const System<D>& s) {
  ContactTotals<D> out;
  std::int64_t ends_at_grains = 0;
  const std::vector<ContactRecord<D>> contacts = contact_records(s);
  std::vector<Vec<D>> directions;
  for (const ContactRecord<D>& c : contacts) {
    ++out.contacts;
    ends_at_grains += c.j < s.particles.grains ? 2 : 1;
    if (c.j < s.particles.grains) directions.push_back(c.normal);
  }
  out.fabric = fabric_tensor(directions);
  if (s.particles.grains > 0)
    out.coordination_number = static_cast<double>(ends_at_grains) / static_cast<double>(s.particles.grains);
  out.has_stress = std::all_of(s.cell.periodic.begin(), s.cell.periodic.end(), [](bool along) { return along; });
  if (!out.has_stress) return out;
  const double volume = s.cell.volume();
  const Matrix<D> sum = branch_force_sum(contacts, s.particles.first_plane());
  for (int k = 0; k < D; ++k) {
    out.stress[k] = sum[k] * (-1.0 / volume);
    out.pressure -= out.stress[k][k] / static_cast<double>(D);
  }
  out.asymmetry = asymmetry(out.stress);
  out.rate = shear_rate(s.cell.velocity_gradient);
  if (out.rate > 0.0) out.inertial_number = inertial_number_of(s, out);
  return out;
}

namespace {

/// Row-major in three dimensions; zeros along an axis that a plane does not have.
template <int D>
void append_tensor(std::vector<double>& to, const Matrix<D>& tensor) {
  for (int k = 0; k < 3; ++k) append(to, k < D ? in_space<D>(tensor[k]) : Vec3{});
}

}  // namespace

template <int D>
void record_tensors(Trajectory& t, const System<D>& s, bool contacts) {
  const auto& periodic = s.cell.periodic;
  if (!std::all_of(periodic.begin(), periodic.end(), [](bool along) { return along; })) return;
  const std::size_t before = t.time.size() - 1;  // frames of a checkpoint of an earlier version have none
  t.stress.resize(9 * before, kNaN);
  t.fabric.resize(9 * before, kNaN);
  t.inertial_number.resize(before, kNaN);
  if (!contacts) {
    t.stress.resize(9 * (before + 1), kNaN);
    t.fabric.resize(9 * (before + 1), kNaN);
    t.inertial_number.push_back(kNaN);
    return;
  }
  const ContactTotals<D> totals = contact_totals(s);
  append_tensor<D>(t.stress, totals.stress);
  append_tensor<D>(t.fabric, totals.fabric);
  t.inertial_number.push_back(totals.inertial_number);
}

template void record_tensors<2>(Trajectory&, const System<2>&, bool);
template void record_tensors<3>(Trajectory&, const System<3>&, bool);

template ContactTotals<2> contact_totals<2>(const System<2>&);
template ContactTotals<3> contact_totals<3>(const System<3>&);

}  // namespace softgrain

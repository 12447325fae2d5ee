#include "microsim/particles/frame_contacts.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/core/error.h"
#include "common/data/columns.h"
#include "common/data/snapshot_io.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/system_snapshot.h"

namespace softgrain {

namespace {

constexpr std::int64_t kMostSnapshots = 100;
constexpr std::int64_t kGrainFrames = 200'000;

}  // namespace

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

void write_frame_contacts(const h5::Group& group, const FrameContacts& c) {
  group.write("frame", std::span<const std::int64_t>(c.frame));
  group.write("count", std::span<const std::int64_t>(c.count));
  const std::int64_t most = c.count.empty() ? 0 : *std::max_element(c.count.begin(), c.count.end());
  write_snapshot_contacts(group, c.contacts, Snapshot{}, static_cast<std::size_t>(most));
}

FrameContacts read_frame_contacts(const h5::Group& group, std::size_t particles, std::size_t bodies) {
  FrameContacts c;
  c.frame = group.integers("frame");
  c.count = group.integers("count");
  c.contacts = read_snapshot_contacts(group, {particles, bodies}, Snapshot{});
  std::int64_t total = 0;
  for (const std::int64_t n : c.count) {
    if (n < 0 || n > static_cast<std::int64_t>(c.contacts.size())) throw IoError("contacts of frames do not fit");
    total += n;
  }
  if (c.frame.size() != c.count.size() || total != static_cast<std::int64_t>(c.contacts.size()) ||
      !std::is_sorted(c.frame.begin(), c.frame.end()))
    throw IoError("contacts of frames do not fit");
  const std::int64_t most = c.count.empty() ? 0 : *std::max_element(c.count.begin(), c.count.end());
  require_shape(group, "segment", {static_cast<std::size_t>(most), 2});
  return c;
}

std::int64_t default_snapshots(std::int64_t grains) {
  return std::clamp<std::int64_t>(kGrainFrames / std::max<std::int64_t>(grains, 1), 1, kMostSnapshots);
}

template <int D>
ContactTotals<D> contact_totals(const System<D>& s) {
  ContactTotals<D> out;
  std::int64_t ends_at_grains = 0;
  Matrix<D> sum;
  for (const ContactRecord<D>& c : contact_records(s)) {
    ++out.contacts;
    ends_at_grains += c.j < s.particles.grains ? 2 : 1;
    const Vec<D> force = c.normal * c.normal_force + c.tangential_force;
    for (int k = 0; k < D; ++k) sum[k] += force * c.branch[k];
  }
  if (s.particles.grains > 0)
    out.coordination_number = static_cast<double>(ends_at_grains) / static_cast<double>(s.particles.grains);
  out.has_stress = std::all_of(s.cell.periodic.begin(), s.cell.periodic.end(), [](bool along) { return along; });
  if (!out.has_stress) return out;
  const double volume = s.cell.volume();
  for (int k = 0; k < D; ++k) {
    out.stress[k] = sum[k] * (-1.0 / volume);
    out.pressure -= out.stress[k][k] / static_cast<double>(D);
  }
  return out;
}

template ContactTotals<2> contact_totals<2>(const System<2>&);
template ContactTotals<3> contact_totals<3>(const System<3>&);

}  // namespace softgrain

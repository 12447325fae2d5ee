#include "microsim/powder/powder_snapshots.h"

#include "common/core/error.h"

namespace softgrain {

PowderSnapshot powder_snapshot(const System<2>& s) {
  return {s.time,
          {{s.cell.edges[0][0], s.cell.edges[1][1]}},
          {s.particles.sphere.begin(), s.particles.sphere.begin() + s.particles.grains}};
}

void write_snapshots(const h5::Group& group, const std::vector<PowderSnapshot>& snapshots) {
  if (snapshots.empty()) return;
  const h5::Group all = group.create("snapshots");
  for (std::size_t k = 0; k < snapshots.size(); ++k) {
    const PowderSnapshot& s = snapshots[k];
    std::vector<double> positions;
    std::vector<double> radii;
    for (const auto& d : s.disks) {
      positions.insert(positions.end(), {d.x[0], d.x[1]});
      radii.push_back(d.r);
    }
    const h5::Group one = all.create(std::to_string(k));
    one.attribute("time", s.time);
    one.write("positions", positions, {radii.size(), 2});
    one.write("radii", radii);
    one.write("cell", std::vector<double>{s.lengths[0], s.lengths[1]});
  }
}

std::vector<PowderSnapshot> read_snapshots(const h5::Group& group) {
  std::vector<PowderSnapshot> out;
  if (!group.has("snapshots")) return out;
  const h5::Group all = group.open("snapshots");
  for (std::size_t k = 0; all.has(std::to_string(k)); ++k) {
    const h5::Group one = all.open(std::to_string(k));
    const auto positions = one.doubles("positions");
    const auto radii = one.doubles("radii");
    const auto cell = one.doubles("cell");
    if (positions.size() != 2 * radii.size() || cell.size() != 2)
      throw FileTrouble("powder: snapshot " + std::to_string(k) + " has arrays that do not fit together");
    PowderSnapshot s{one.number("time"), {{cell[0], cell[1]}}, {}};
    for (std::size_t n = 0; n < radii.size(); ++n)
      s.disks.push_back({{{positions[2 * n], positions[2 * n + 1]}}, radii[n]});
    out.push_back(std::move(s));
  }
  return out;
}

}  // namespace softgrain

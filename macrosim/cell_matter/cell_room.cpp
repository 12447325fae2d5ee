#include "macrosim/cell_matter/cell_room.h"

#include <fmt/format.h>

#include <cmath>

#include "common/core/error.h"

namespace softgrain {

double CellRoom::volume() const {
  return std::visit([](const auto& w) { return w.volume(); }, where_);
}

Vec3 CellRoom::low() const { return periodic() ? Vec3{} : planes().low; }

Vec3 CellRoom::high() const { return periodic() ? cell().edges * Vec3{{1.0, 1.0, 1.0}} : planes().high; }

Vec3 CellRoom::centre() const { return periodic() ? Vec3{} : (planes().low + planes().high) * 0.5; }

void CellRoom::stretch(const Vec3& factor) {
  if (auto* cell = std::get_if<Cell<3>>(&where_)) {
    cell->stretch(factor);
    return;
  }
  auto& box = std::get<PlaneBox>(where_);
  const Vec3 c = centre();
  for (int k = 0; k < 3; ++k) {
    box.low[k] = c[k] + (box.low[k] - c[k]) * factor[k];
    box.high[k] = c[k] + (box.high[k] - c[k]) * factor[k];
  }
}

void CellRoom::bring_home(std::vector<Sphere<3>>& sites, std::vector<std::array<std::int32_t, 3>>& periods) const {
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(sites[i].x[k])) throw InputError(fmt::format("cells: site {} has no place", i));
    if (!periodic()) continue;
    const Vec3 s = cell().fractional(sites[i].x);
    Vec3 back;
    for (int k = 0; k < 3; ++k) {
      back[k] = std::floor(s[k]);
      periods[i][static_cast<std::size_t>(k)] += static_cast<std::int32_t>(back[k]);
    }
    if (back != Vec3{}) sites[i].x -= cell().edges * back;
  }
}

bool CellRoom::holds(const std::vector<Sphere<3>>& sites) const {
  if (periodic()) return true;
  const Vec3 from = low();
  const Vec3 to = high();
  for (const auto& s : sites)
    for (int k = 0; k < 3; ++k)
      if (!(s.x[k] > from[k] && s.x[k] < to[k])) return false;
  return true;
}

RadicalCells CellRoom::cells_of(const std::vector<Sphere<3>>& sites) const {
  return std::visit([&](const auto& w) { return radical_cells(sites, w); }, where_);
}

}  // namespace softgrain

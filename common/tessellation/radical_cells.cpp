#include "common/tessellation/radical_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <voro++/voro++.hh>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// Shares of the spacing (V/N)^(1/3).
constexpr double kCoincident = 1e-9;
constexpr double kSmallestFace = 1e-10;  ///< squared spacings
constexpr double kSideMismatch = 1e-7;   ///< squared spacings: areas of the two sides of a face, faces seen once
/// Tolerances of fractional coordinates, and of the sum of volumes.
constexpr double kOutside = 1e-9;
constexpr double kVolumeMismatch = 1e-9;

/// Squared distances of planes over those that can cut, times 4, with room for rounding.
constexpr double kBeyond = 4.0 * (1.0 + 1e-9);

/// Stands for the plane of two sites at one place; sorts before all others.
constexpr double kTogether = -std::numeric_limits<double>::infinity();

using Steps = std::array<int, 3>;  // periods along the edges

/// The room in which sites lie: origin, edges, and whether it repeats (all axes or none).
struct Room {
  Vec3 origin;
  Cell<3> cell;
  bool periodic = false;

  [[nodiscard]] Vec3 shift(const Steps& n) const {
    return cell.edges * Vec3{{static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}};
  }
  /// Distance of the two faces of the room along axis k: V over the area of the other two edges.
  [[nodiscard]] double width(int k) const {
    const auto edge = [&](int l) { return Vec3{{cell.edges[0][l], cell.edges[1][l], cell.edges[2][l]}}; };
    return cell.volume() / norm(cross(edge((k + 1) % 3), edge((k + 2) % 3)));
  }
};

/// A sphere that may cut a cell.
struct Candidate {
  std::int32_t j = 0;
  Steps steps{};
  Vec3 separation;     ///< vector from the site
  double plane = 0.0;  ///< distance of the radical plane from the site along `separation`
};

/// Sites sorted into bins of the room, at most about two each.
class Bins {
 public:
  Bins(const std::vector<Sphere<3>>& sites, const Room& room, double spacing)
      : sites_(sites), room_(room), coincident2_(kCoincident * kCoincident * spacing * spacing) {
    narrowest_ = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double width = room.width(k);
      count_[k] = std::clamp(static_cast<int>(width / spacing), 1, 1024);
      narrowest_ = std::min(narrowest_, width / count_[k]);
    }
    start_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]) + 1, 0);
    bin_.resize(sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const Vec3 s = room.cell.fractional(sites[i].x - room.origin);
      for (int k = 0; k < 3; ++k) bin_[i][k] = std::clamp(static_cast<int>(s[k] * count_[k]), 0, count_[k] - 1);
      ++start_[index(bin_[i]) + 1];
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    sorted_.resize(sites.size());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < sites.size(); ++i) sorted_[next[index(bin_[i])]++] = static_cast<std::int32_t>(i);
  }

  /// No site of ring r is nearer than this: the site lies anywhere in its own bin.
  [[nodiscard]] double nearest(int ring) const { return (ring - 1) * narrowest_ * (1.0 - 1e-6); }

  /// Spheres of the bins that are `ring` bins away, with the distance of their planes where that is up to `radius`.
  /// False: no bin is.
  bool gather(std::int32_t i, int ring, double radius, std::vector<Candidate>& out) const {
    bool any = false;
    for (int a = -ring; a <= ring; ++a)
      for (int b = -ring; b <= ring; ++b) {
        const bool side = std::abs(a) == ring || std::abs(b) == ring;
        for (int c = -ring; c <= ring; c += side || ring == 0 ? 1 : 2 * ring)
          any = visit(i, {a, b, c}, radius * radius, out) || any;
      }
    return any;
  }

 private:
  [[nodiscard]] std::size_t index(const Steps& at) const {
    return static_cast<std::size_t>((at[0] * count_[1] + at[1]) * count_[2] + at[2]);
  }

  bool visit(std::int32_t i, const Steps& offset, double radius2, std::vector<Candidate>& out) const {
    const auto u = static_cast<std::size_t>(i);
    Steps at{};
    Steps steps{};
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = bin_[u][k] + offset[k];
      if (at[k] >= 0 && at[k] < count_[k]) continue;
      steps[k] = at[k] >= 0 ? at[k] / count_[k] : -((count_[k] - 1 - at[k]) / count_[k]);
      if (!room_.periodic && steps[k] != 0) return false;
      at[k] -= steps[k] * count_[k];
    }
    const Sphere<3>& own = sites_[u];
    const Vec3 shift = room_.shift(steps);
    for (std::size_t n = start_[index(at)]; n < start_[index(at) + 1]; ++n) {
      const std::int32_t j = sorted_[n];
      if (j == i && steps == Steps{}) continue;
      const Sphere<3>& other = sites_[static_cast<std::size_t>(j)];
      const Vec3 d = other.x + shift - own.x;
      const double d2 = norm2(d);
      const bool apart = d2 > coincident2_;
      const double twice = d2 + own.r * own.r - other.r * other.r;  // the distance of the plane, times 2 |d|
      if (apart && twice > 0.0 && twice * twice > kBeyond * radius2 * d2) continue;
      const double plane = 0.5 * twice / std::sqrt(d2);
      out.push_back({j, steps, d, apart ? plane : kTogether});
    }
    return true;
  }

  const std::vector<Sphere<3>>& sites_;
  const Room& room_;
  double coincident2_;
  std::array<int, 3> count_{};
  double narrowest_ = 0.0;
  std::vector<std::size_t> start_;
  std::vector<std::int32_t> sorted_;
  std::vector<Steps> bin_;
};

/// One side of a face, or (j < 0) a face at plane -1 - j.
struct HalfFace {
  std::int32_t j = 0;
  int image = 0;
  double area = 0.0;
  Vec3 centroid;  ///< centroid relative to the site
  Vec3 separation;
};

enum class CellFault { none, coincident, far_image, open };

struct OneCell {
  double volume = 0.0;
  std::vector<HalfFace> halves;
  CellFault fault = CellFault::none;
  std::int32_t with = 0;
};

/// Cuts cells in units of a length near the spacing, because the tolerances of voro++ are absolute.
class Cutter {
 public:
  Cutter(const std::vector<Sphere<3>>& sites, const Room& room, const Bins& bins, double spacing)
      : sites_(sites), room_(room), bins_(bins), spacing_(spacing), unit_(std::exp2(std::round(std::log2(spacing)))) {
    for (const auto& s : sites) largest_ = std::max(largest_, s.r);
    for (int k = 0; k < 3; ++k)
      reach_ += std::abs(room.cell.edges[k][0]) + std::abs(room.cell.edges[k][1]) + std::abs(room.cell.edges[k][2]);
  }

  OneCell cut(std::int32_t i) {
    OneCell out;
    begin(i);
    tried_.clear();
    double radius = std::numeric_limits<double>::infinity();
    const double r = sites_[static_cast<std::size_t>(i)].r;
    const double lead = largest_ * largest_ - r * r;
    for (int ring = 0;; ++ring) {
      if (bins_.nearest(ring) > radius + std::sqrt(std::max(0.0, radius * radius + lead))) break;
      found_.clear();
      if (!bins_.gather(i, ring, radius, found_)) break;
      std::sort(found_.begin(), found_.end(), [](const Candidate& a, const Candidate& b) {
        return a.plane != b.plane ? a.plane < b.plane : (a.j != b.j ? a.j < b.j : a.steps < b.steps);
      });
      for (const Candidate& c : found_) {
        if (c.plane == kTogether) return {0.0, {}, CellFault::coincident, c.j};
        if (c.plane > radius) break;
        if (!cut(c)) return out;
      }
      radius = 0.5 * std::sqrt(cell_.max_radius_squared()) * unit_;  // voro++ keeps vertices at twice their place
    }
    measure(out);
    return out;
  }

 private:
  void begin(std::int32_t i) {
    if (room_.periodic) {
      const double far = 2.0 * reach_ / unit_;  // images of the site itself cut all of this away
      cell_.init(-far, far, -far, far, -far, far);
      return;
    }
    const Vec3 low = (room_.origin - sites_[static_cast<std::size_t>(i)].x) * (1.0 / unit_);
    const Vec3 high =
        low + Vec3{{room_.cell.edges[0][0], room_.cell.edges[1][1], room_.cell.edges[2][2]}} * (1.0 / unit_);
    cell_.init(low[0], high[0], low[1], high[1], low[2], high[2]);
  }

  /// False: nothing is left.
  bool cut(const Candidate& c) {
    tried_.push_back(c);
    const Vec3 d = c.separation * (1.0 / unit_);
    const double twice = 2.0 * c.plane * norm(c.separation) / (unit_ * unit_);
    return cell_.nplane(d[0], d[1], d[2], twice, static_cast<int>(tried_.size()));
  }

  void measure(OneCell& out) {
    out.volume = cell_.volume() * unit_ * unit_ * unit_;
    cell_.vertices(vertices_);
    cell_.neighbors(ids_);
    cell_.face_vertices(loops_);
    std::size_t at = 0;
    for (const int id : ids_) {
      const auto n = static_cast<std::size_t>(loops_[at]);
      HalfFace half = polygon(loops_.data() + at + 1, n);
      at += n + 1;
      if (half.area < kSmallestFace * spacing_ * spacing_) continue;
      if (id <= 0) {  // voro++ names the faces that it began with -1 to -6
        if (room_.periodic) out.fault = CellFault::open;
        half.j = id;
      } else {
        const Candidate& c = tried_[static_cast<std::size_t>(id) - 1];
        half.j = c.j;
        half.separation = c.separation;
        for (int k = 2; k >= 0; --k) {
          if (std::abs(c.steps[static_cast<std::size_t>(k)]) > 1) {
            out.fault = CellFault::far_image;
            out.with = c.j;
          }
          half.image = 3 * half.image + c.steps[static_cast<std::size_t>(k)] + 1;
        }
      }
      out.halves.push_back(half);
    }
    std::sort(out.halves.begin(), out.halves.end(),
              [](const HalfFace& a, const HalfFace& b) { return a.j != b.j ? a.j < b.j : a.image < b.image; });
  }

  /// Area and centroid of a polygon by triangles about the mean of its corners.
  [[nodiscard]] HalfFace polygon(const int* corner, std::size_t n) const {
    const auto point = [&](std::size_t k) {
      const auto u = 3 * static_cast<std::size_t>(corner[k % n]);
      return Vec3{{vertices_[u], vertices_[u + 1], vertices_[u + 2]}};
    };
    Vec3 middle;
    for (std::size_t k = 0; k < n; ++k) middle += point(k) * (1.0 / static_cast<double>(n));
    HalfFace half;
    Vec3 moment;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 a = point(k) - middle;
      const Vec3 b = point(k + 1) - middle;
      const double area = 0.5 * norm(cross(a, b));
      half.area += area;
      moment += (a + b) * (area / 3.0);
    }
    half.centroid = (half.area > 0.0 ? middle + moment * (1.0 / half.area) : middle) * unit_;
    half.area *= unit_ * unit_;
    return half;
  }

  const std::vector<Sphere<3>>& sites_;
  const Room& room_;
  const Bins& bins_;
  double spacing_;
  double unit_;
  double largest_ = 0.0;
  double reach_ = 0.0;
  voro::voronoicell_neighbor cell_;
  std::vector<Candidate> found_;
  std::vector<Candidate> tried_;
  std::vector<double> vertices_;
  std::vector<int> ids_;
  std::vector<int> loops_;
};

void require_sites(const std::vector<Sphere<3>>& sites, const Room& room) {
  if (sites.empty()) throw InputError("cells: no sites");
  const double volume = room.cell.volume();
  if (!(volume > 0.0) || !std::isfinite(volume))
    throw InputError(fmt::format("cells: a room of volume {} m^3; it must be above 0", volume));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const auto& [x, r] = sites[i];
    if (!std::isfinite(r) || r < 0.0 || !std::isfinite(norm2(x)))
      throw InputError(
          fmt::format("cells: site {} at ({}, {}, {}) with radius {}: numbers, and radii from 0 on, are needed", i,
                      x[0], x[1], x[2], r));
    const Vec3 s = room.cell.fractional(x - room.origin);
    for (int k = 0; k < 3; ++k)
      if (s[k] < -kOutside || s[k] > 1.0 + kOutside)
        throw InputError(fmt::format("cells: site {} lies outside the {} along axis {} (at {} of its length)", i,
                                     room.periodic ? "periodic cell" : "box", k, s[k]));
  }
}

void require_valid(const OneCell& cell, std::size_t i) {
  if (cell.fault == CellFault::coincident)
    throw InputError(fmt::format("cells: sites {} and {} are at the same place", i, cell.with));
  if (cell.fault == CellFault::far_image)
    throw UnusableResult(
        fmt::format("cells: site {} meets an image of site {} beyond the neighbouring ones: too few sites for a cell "
                    "of this shape",
                    i, cell.with));
  if (cell.fault == CellFault::open) throw UnusableResult(fmt::format("cells: the cell of site {} does not close", i));
}

const HalfFace* find(const OneCell& cell, std::int32_t j, int image) {
  const auto at = std::lower_bound(
      cell.halves.begin(), cell.halves.end(), std::pair{j, image},
      [](const HalfFace& a, const auto& key) { return a.j != key.first ? a.j < key.first : a.image < key.second; });
  return at != cell.halves.end() && at->j == j && at->image == image ? &*at : nullptr;
}

/// Cells from which several threads join them: one costs about a microsecond.
constexpr std::int64_t kManyCells = 500;
/// Cells that a thread cuts in a row. A small site among large ones costs several times the 30 us of others.
constexpr int kCutInRow = 8;

/// Whether cell u is the one that tells of a face. Faces at planes are told apart from others (j below 0).
bool tells(std::size_t u, const HalfFace& half) {
  const auto i = static_cast<std::int32_t>(u);
  return half.j >= 0 && (i != half.j ? i < half.j : half.image > home_image<3>());
}

/// The first face of cell u that its neighbour knows otherwise; null: none.
const HalfFace* find_mismatch(const std::vector<OneCell>& cells, std::size_t u, double allowed) {
  for (const HalfFace& half : cells[u].halves) {
    if (half.j < 0) continue;
    const HalfFace* other =
        find(cells[static_cast<std::size_t>(half.j)], static_cast<std::int32_t>(u), image_count<3>() - 1 - half.image);
    if (std::abs(half.area - (other != nullptr ? other->area : 0.0)) > allowed) return &half;
  }
  return nullptr;
}

/// Throws for the first cell with a fault; where there is none, for the first that does not agree with a neighbour.
/// (The neighbours of a cell with a fault do not agree with it.)
[[noreturn]] void throw_fault(const std::vector<OneCell>& cells, double allowed) {
  for (std::size_t u = 0; u < cells.size(); ++u) require_valid(cells[u], u);
  for (std::size_t u = 0; u < cells.size(); ++u)
    if (const HalfFace* half = find_mismatch(cells, u, allowed))
      throw UnusableResult(fmt::format("cells: sites {} and {} do not agree about their face", u, half->j));
  throw UnusableResult("cells: they do not fit together");
}

/// Fills in what cell u tells, from these places on.
void fill_faces(const Sphere<3>& site, const OneCell& cell, std::size_t u, CellFace* face, WallFace* wall) {
  const auto i = static_cast<std::int32_t>(u);
  for (const HalfFace& half : cell.halves) {
    const Vec3 centroid = site.x + half.centroid;
    if (half.j < 0)  // faces at planes come first, with the highest plane in front
      *wall++ = {i, -1 - half.j, half.area, centroid};
    else if (tells(u, half))
      *face++ = {i, half.j, half.image, half.area, norm(half.separation), centroid, half.separation};
  }
}

/// The faces of all cells, each once, and whether both sides tell the same.
RadicalCells join(const std::vector<Sphere<3>>& sites, const std::vector<OneCell>& cells, const Room& room,
                  double spacing) {
  RadicalCells out;
  const double allowed = kSideMismatch * spacing * spacing;
  const auto n = static_cast<std::int64_t>(cells.size());
  std::vector<std::size_t> first_face(cells.size() + 1, 0);
  std::vector<std::size_t> first_wall(cells.size() + 1, 0);
  bool good = true;
#pragma omp parallel for schedule(static) reduction(&& : good) if (n >= kManyCells)
  for (std::int64_t k = 0; k < n; ++k) {
    const auto u = static_cast<std::size_t>(k);
    good = good && cells[u].fault == CellFault::none && find_mismatch(cells, u, allowed) == nullptr;
    for (const HalfFace& half : cells[u].halves) {
      first_wall[u + 1] += half.j < 0 ? 1 : 0;
      first_face[u + 1] += tells(u, half) ? 1 : 0;
    }
  }
  if (!good) throw_fault(cells, allowed);
  double total = 0.0;
  out.volume.reserve(cells.size());
  for (const OneCell& cell : cells) {
    total += cell.volume;
    out.volume.push_back(cell.volume);
  }
  std::partial_sum(first_face.begin(), first_face.end(), first_face.begin());
  std::partial_sum(first_wall.begin(), first_wall.end(), first_wall.begin());
  out.faces.resize(first_face.back());
  out.at_walls.resize(first_wall.back());
#pragma omp parallel for schedule(static) if (n >= kManyCells)
  for (std::int64_t k = 0; k < n; ++k) {
    const auto u = static_cast<std::size_t>(k);
    fill_faces(sites[u], cells[u], u, out.faces.data() + first_face[u], out.at_walls.data() + first_wall[u]);
  }
  std::sort(out.at_walls.begin(), out.at_walls.end(), [](const WallFace& a, const WallFace& b) {
    return a.site != b.site ? a.site < b.site : a.plane < b.plane;
  });
  const double volume = room.cell.volume();
  if (!(std::abs(total - volume) <= kVolumeMismatch * volume))
    throw UnusableResult(fmt::format("cells: their volumes add up to {} of the room", total / volume));
  return out;
}

RadicalCells radical_cells_in(const std::vector<Sphere<3>>& sites, const Room& room) {
  require_sites(sites, room);
  const double spacing = std::cbrt(room.cell.volume() / static_cast<double>(sites.size()));
  const Bins bins(sites, room, spacing);
  std::vector<OneCell> cells(sites.size());
  const auto n = static_cast<std::int32_t>(sites.size());
#pragma omp parallel
  {
    Cutter cutter(sites, room, bins, spacing);
#pragma omp for schedule(dynamic, kCutInRow)
    for (std::int32_t i = 0; i < n; ++i) cells[static_cast<std::size_t>(i)] = cutter.cut(i);
  }
  return join(sites, cells, room, spacing);
}

}  // namespace

RadicalCells radical_cells(const std::vector<Sphere<3>>& sites, const Cell<3>& cell) {
  if (!(cell.periodic[0] && cell.periodic[1] && cell.periodic[2]))
    throw InputError("cells: the cell must be periodic along every axis (or else be given as a box of planes)");
  return radical_cells_in(sites, {Vec3{}, cell, true});
}

RadicalCells radical_cells(const std::vector<Sphere<3>>& sites, const PlaneBox& box) {
  return radical_cells_in(sites, {box.low, box_cell<3>(box.high - box.low, {false, false, false}), false});
}

}  // namespace softgrain

#include "common/neighbours/hierarchical_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// One size class: grains sorted by cell (counting sort).
template <int D>
struct Level {
  using Index = std::array<std::int64_t, static_cast<std::size_t>(D)>;
  double reach = 0.0;               ///< largest r + skin of the class
  Index cells{};                    ///< per axis
  std::vector<Slot> members;        ///< ascending
  std::vector<std::int32_t> start;  ///< per cell, into sorted
  std::vector<Slot> sorted;
};

/// Maps positions to cell coordinates: fractional on periodic axes, bounding box on open ones.
template <int D>
struct Frame {
  const Cell<D>* cell = nullptr;
  Vec<D> low{};     ///< lower corner of the bounding box, fractional units
  Vec<D> extent{};  ///< its size; 1 along periodic axes
  Vec<D> width{};   ///< the same in metres, perpendicular distance between faces

  [[nodiscard]] Vec<D> unit(const Vec<D>& x) const {
    Vec<D> s = cell->fractional(x);
    for (int k = 0; k < D; ++k) {
      s[k] = (s[k] - low[k]) / extent[k];
    }
    return s;
  }
};

/// Perpendicular distance between opposite faces of the cell, per axis (upper triangular edges).
template <int D>
Vec<D> face_distances(const Cell<D>& cell) {
  Vec<D> out;
  for (int k = 0; k < D; ++k) {
    // Row k of the inverse of the edges is the gradient of the fractional coordinate k; its norm is 1/distance.
    Vec<D> gradient;
    for (int c = 0; c < D; ++c) {
      Vec<D> e;
      e[c] = 1.0;
      gradient[c] = cell.fractional(e)[k];
    }
    out[k] = 1.0 / norm(gradient);
  }
  return out;
}

template <int D>
Frame<D> make_frame(const Particles<D>& p, const Cell<D>& cell) {
  Frame<D> frame;
  frame.cell = &cell;
  const Vec<D> faces = face_distances(cell);
  Vec<D> low = cell.fractional(p.sphere[0].x);
  Vec<D> high = low;
  for (Slot i = 1; i < p.grains; ++i) {
    const Vec<D> s = cell.fractional(p.sphere[static_cast<std::size_t>(i)].x);
    for (int k = 0; k < D; ++k) {
      low[k] = std::min(low[k], s[k]);
      high[k] = std::max(high[k], s[k]);
    }
  }
  for (int k = 0; k < D; ++k) {
    if (cell.periodic[static_cast<std::size_t>(k)]) {
      low[k] = 0.0;
      high[k] = 1.0;
    }
    frame.low[k] = low[k];
    frame.extent[k] = std::max(high[k] - low[k], 1e-300);
    frame.width[k] = frame.extent[k] * faces[k];
  }
  return frame;
}

/// Cells at least `edge` wide; no more than a few per grain, so that sparse fine classes cost no memory.
template <int D>
void choose_cells(Level<D>& level, const Frame<D>& frame, double edge) {
  const double budget = 4.0 * static_cast<double>(level.members.size()) + 64.0;
  for (int round = 0; round < 64; ++round) {
    double total = 1.0;
    for (int k = 0; k < D; ++k) {
      const double n = std::clamp(std::floor(frame.width[k] / edge), 1.0, 1e6);
      level.cells[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(n);
      total *= n;
    }
    if (total <= budget) return;
    edge *= 1.26;
  }
  level.cells.fill(1);
}

template <int D>
std::int64_t cell_index(const Level<D>& level, const typename Level<D>::Index& c) {
  std::int64_t index = c[D - 1];
  for (int k = D - 2; k >= 0; --k)
    index = index * level.cells[static_cast<std::size_t>(k)] + c[static_cast<std::size_t>(k)];
  return index;
}

template <int D>
typename Level<D>::Index cell_of(const Level<D>& level, const Vec<D>& unit) {
  typename Level<D>::Index c;
  for (int k = 0; k < D; ++k) {
    const auto n = level.cells[static_cast<std::size_t>(k)];
    c[static_cast<std::size_t>(k)] =
        std::clamp(static_cast<std::int64_t>(std::floor(unit[k] * static_cast<double>(n))), std::int64_t{0}, n - 1);
  }
  return c;
}

template <int D>
void sort_members(Level<D>& level, const Frame<D>& frame, const Particles<D>& p) {
  std::int64_t total = 1;
  for (const auto n : level.cells) total *= n;
  std::vector<std::int32_t> where(level.members.size());
  level.start.assign(static_cast<std::size_t>(total) + 1, 0);
  for (std::size_t m = 0; m < level.members.size(); ++m) {
    const Vec<D> unit = frame.unit(p.sphere[static_cast<std::size_t>(level.members[m])].x);
    where[m] = static_cast<std::int32_t>(cell_index(level, cell_of(level, unit)));
    ++level.start[static_cast<std::size_t>(where[m]) + 1];
  }
  for (std::size_t c = 1; c < level.start.size(); ++c) level.start[c] += level.start[c - 1];
  std::vector<std::int32_t> next(level.start.begin(), level.start.end() - 1);
  level.sorted.resize(level.members.size());
  for (std::size_t m = 0; m < level.members.size(); ++m)
    level.sorted[static_cast<std::size_t>(next[static_cast<std::size_t>(where[m])]++)] = level.members[m];
}

/// Classes by halving of r + skin, largest first; empty ones are left out.
template <int D>
std::vector<Level<D>> make_levels(const Particles<D>& p, const std::vector<double>& skin, const Frame<D>& frame,
                                  std::vector<std::int32_t>& level_of) {
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i)
    largest = std::max(largest, p.sphere[static_cast<std::size_t>(i)].r + skin[static_cast<std::size_t>(i)]);
  std::vector<Level<D>> all(64);
  std::vector<int> raw(static_cast<std::size_t>(p.grains));
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const double reach = p.sphere[u].r + skin[u];
    const int l = std::clamp(static_cast<int>(std::floor(std::log2(largest / reach))), 0, 63);
    raw[u] = l;
    auto& level = all[static_cast<std::size_t>(l)];
    level.members.push_back(i);
    level.reach = std::max(level.reach, reach);
  }
  std::vector<Level<D>> levels;
  std::vector<std::int32_t> renumbered(64, 0);
  for (std::size_t l = 0; l < all.size(); ++l) {
    if (all[l].members.empty()) continue;
    renumbered[l] = static_cast<std::int32_t>(levels.size());
    levels.push_back(std::move(all[l]));
    choose_cells(levels.back(), frame, 2.0 * levels.back().reach);
    sort_members(levels.back(), frame, p);
  }
  level_of.resize(raw.size());
  for (std::size_t u = 0; u < raw.size(); ++u) level_of[u] = renumbered[static_cast<std::size_t>(raw[u])];
  return levels;
}

template <int D>
void require_wide_cell(const Cell<D>& cell, const Frame<D>& frame, double largest_reach) {
  for (int k = 0; k < D; ++k)
    if (cell.periodic[static_cast<std::size_t>(k)] && frame.width[k] < 4.0 * largest_reach)
      throw BadInput("cell: the periodic axis " + std::to_string(k) + " is " + std::to_string(frame.width[k]) +
                     " m wide, narrower than two diameters of its largest grain with skin (" +
                     std::to_string(4.0 * largest_reach) + " m)");
}

/// Calls visit(cell index, image) for the cells of `level` around `centre`.
template <int D, class Visit>
void around(const Level<D>& level, const Cell<D>& cell, const typename Level<D>::Index& centre, Visit&& visit) {
  for (int code = 0; code < image_count<D>(); ++code) {
    typename Level<D>::Index c = centre;
    int rest = code;
    int image = 0;
    int weight = 1;
    bool inside = true;
    for (int k = 0; k < D; ++k, rest /= 3, weight *= 3) {
      const auto u = static_cast<std::size_t>(k);
      c[u] += rest % 3 - 1;
      int wrap = 0;
      if (c[u] < 0) wrap = -1;
      if (c[u] >= level.cells[u]) wrap = 1;
      if (wrap != 0 && !cell.periodic[u]) inside = false;
      c[u] -= wrap * level.cells[u];
      image += (wrap + 1) * weight;
    }
    if (inside) visit(cell_index(level, c), image);
  }
}

/// An open axis with one cell is searched once: the cells beside it do not exist. A periodic axis with one or two cells
/// is visited under every image, which is right: each image is a different neighbour.
template <int D>
void search(const Particles<D>& p, const Cell<D>& cell, const std::vector<double>& skin, const Frame<D>& frame,
            const Level<D>& level, bool same_level, Slot i, std::vector<CandidatePair>& out) {
  const Sphere<D>& a = p.sphere[static_cast<std::size_t>(i)];
  const double reach_i = a.r + skin[static_cast<std::size_t>(i)];
  around(level, cell, cell_of(level, frame.unit(a.x)), [&](std::int64_t index, int image) {
    const auto c = static_cast<std::size_t>(index);
    const Vec<D> shifted = a.x - cell.image_shift(image);
    for (std::int32_t m = level.start[c]; m < level.start[c + 1]; ++m) {
      const Slot j = level.sorted[static_cast<std::size_t>(m)];
      if (same_level && j <= i) continue;
      const Sphere<D>& b = p.sphere[static_cast<std::size_t>(j)];
      const double reach = reach_i + b.r + skin[static_cast<std::size_t>(j)];
      if (norm2(shifted - b.x) >= reach * reach) continue;
      // The image belongs to the body with the larger slot.
      if (i < j)
        out.push_back({i, j, image});
      else
        out.push_back({j, i, image_count<D>() - 1 - image});
    }
  });
}

}  // namespace

template <int D>
std::vector<CandidatePair> candidate_pairs(const Particles<D>& particles, const Cell<D>& cell,
                                           const std::vector<double>& skin) {
  std::vector<CandidatePair> out;
  if (particles.grains < 2) return out;
  const Frame<D> frame = make_frame(particles, cell);
  std::vector<std::int32_t> level_of;
  const auto levels = make_levels(particles, skin, frame, level_of);
  require_wide_cell(cell, frame, levels.front().reach);
  for (Slot i = 0; i < particles.grains; ++i) {
    const std::int32_t own = level_of[static_cast<std::size_t>(i)];
    for (std::int32_t l = 0; l <= own; ++l)
      search(particles, cell, skin, frame, levels[static_cast<std::size_t>(l)], l == own, i, out);
  }
  return out;
}

template <int D>
std::vector<CandidatePair> candidate_pairs_brute_force(const Particles<D>& p, const Cell<D>& cell,
                                                       const std::vector<double>& skin) {
  std::vector<CandidatePair> out;
  const bool periodic = cell.any_periodic();
  for (Slot i = 0; i < p.grains; ++i) {
    for (Slot j = i + 1; j < p.grains; ++j) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      const double reach = p.sphere[a].r + p.sphere[b].r + skin[a] + skin[b];
      for (int image = 0; image < image_count<D>(); ++image) {
        if (!periodic && image != home_image<D>()) continue;
        const Vec<D> shift = cell.image_shift(image);
        bool allowed = true;
        int rest = image;
        for (int k = 0; k < D; ++k, rest /= 3)
          allowed = allowed && (rest % 3 == 1 || cell.periodic[static_cast<std::size_t>(k)]);
        if (allowed && norm2(p.sphere[a].x - p.sphere[b].x - shift) < reach * reach) out.push_back({i, j, image});
      }
    }
  }
  return out;
}

template std::vector<CandidatePair> candidate_pairs<2>(const Particles<2>&, const Cell<2>&, const std::vector<double>&);
template std::vector<CandidatePair> candidate_pairs<3>(const Particles<3>&, const Cell<3>&, const std::vector<double>&);
template std::vector<CandidatePair> candidate_pairs_brute_force<2>(const Particles<2>&, const Cell<2>&,
                                                                   const std::vector<double>&);
template std::vector<CandidatePair> candidate_pairs_brute_force<3>(const Particles<3>&, const Cell<3>&,
                                                                   const std::vector<double>&);

}  // namespace softgrain

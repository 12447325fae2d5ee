#include "common/neighbours/hierarchical_grid.h"

#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/core/quad.h"
#include "common/neighbours/pair_search.h"

namespace softgrain {

namespace {

/// Grains looked at together.
constexpr std::size_t kLanes = 4;

/// One size class: grains sorted by cell, in a cell by slot (counting sort).
template <int D>
struct Level {
  using Index = std::array<std::int64_t, static_cast<std::size_t>(D)>;
  double reach = 0.0;               ///< largest r + skin of the class
  Index cells{};                    ///< per axis
  std::vector<Slot> members;        ///< ascending
  std::vector<std::int32_t> start;  ///< per cell, into what follows
  // What the search asks of the sorted grains, in rows that end with room for a full look.
  std::array<std::vector<double>, static_cast<std::size_t>(D)> x;
  std::vector<double> reaches;  ///< r + skin
  std::vector<Slot> slot;
};

/// Cells at least `edge` wide; no more than a few per grain, so that sparse fine classes cost no memory.
template <int D>
void choose_cells(Level<D>& level, const SearchFrame<D>& frame, double edge) {
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

/// Clamped before the conversion: a place may be a number that no integer holds, or none.
std::int64_t cell_at(double place, std::int64_t cells) {
  const auto n = static_cast<double>(cells);
  return static_cast<std::int64_t>(std::min(std::max(0.0, std::floor(place * n)), n - 1.0));
}

template <int D>
typename Level<D>::Index cell_of(const Level<D>& level, const Vec<D>& unit) {
  typename Level<D>::Index c;
  for (int k = 0; k < D; ++k)
    c[static_cast<std::size_t>(k)] = cell_at(unit[k], level.cells[static_cast<std::size_t>(k)]);
  return c;
}

/// The search looks no farther than one image: who lies beyond has diverged.
template <int D>
void require_at_home(const Particles<D>& p, const Cell<D>& cell, const Vec<D>& unit, Slot slot) {
  constexpr double kRounding = 0.125;
  for (int k = 0; k < D; ++k)
    if (cell.periodic[static_cast<std::size_t>(k)] && !(std::abs(unit[k] - 0.5) <= 0.5 + kRounding))
      throw UnusableResult(grain_name(p, slot) + " is lost: it is outside of its periodic cell");
}

template <int D>
void sort_members(Level<D>& level, const SearchFrame<D>& frame, const Particles<D>& p,
                  const std::vector<double>& skin) {
  std::int64_t total = 1;
  for (const auto n : level.cells) total *= n;
  std::vector<std::int32_t> where(level.members.size());
  level.start.assign(static_cast<std::size_t>(total) + 1, 0);
  in_pieces(where.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const Vec<D> unit = frame.unit(p.sphere[static_cast<std::size_t>(level.members[m])].x);
      require_at_home(p, *frame.cell, unit, level.members[m]);
      where[m] = static_cast<std::int32_t>(cell_index(level, cell_of(level, unit)));
    }
  });
  for (const std::int32_t cell : where) ++level.start[static_cast<std::size_t>(cell) + 1];
  for (std::size_t c = 1; c < level.start.size(); ++c) level.start[c] += level.start[c - 1];
  std::vector<std::int32_t> next(level.start.begin(), level.start.end() - 1);
  const std::size_t room = level.members.size() + kLanes;
  for (auto& row : level.x) row.resize(room);
  level.reaches.resize(room);
  level.slot.resize(room);
  for (std::size_t m = 0; m < level.members.size(); ++m) {
    const auto to = static_cast<std::size_t>(next[static_cast<std::size_t>(where[m])]++);
    const std::size_t u = at(level.members[m]);
    for (int k = 0; k < D; ++k) level.x[static_cast<std::size_t>(k)][to] = p.sphere[u].x[k];
    level.reaches[to] = p.sphere[u].r + skin[u];
    level.slot[to] = level.members[m];
  }
}

/// Classes by halving of r + skin, largest first; empty ones are left out.
template <int D>
std::vector<Level<D>> make_levels(const Particles<D>& p, const std::vector<double>& skin, const SearchFrame<D>& frame,
                                  std::vector<std::int32_t>& level_of) {
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i)
    largest = std::max(largest, p.sphere[static_cast<std::size_t>(i)].r + skin[static_cast<std::size_t>(i)]);
  std::vector<Level<D>> all(64);
  std::vector<int> raw(static_cast<std::size_t>(p.grains));
  in_pieces(raw.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u)
      raw[u] = std::clamp(static_cast<int>(std::floor(std::log2(largest / (p.sphere[u].r + skin[u])))), 0, 63);
  });
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    auto& level = all[static_cast<std::size_t>(raw[u])];
    level.members.push_back(i);
    level.reach = std::max(level.reach, p.sphere[u].r + skin[u]);
  }
  std::vector<Level<D>> levels;
  std::vector<std::int32_t> renumbered(64, 0);
  for (std::size_t l = 0; l < all.size(); ++l) {
    if (all[l].members.empty()) continue;
    renumbered[l] = static_cast<std::int32_t>(levels.size());
    levels.push_back(std::move(all[l]));
    choose_cells(levels.back(), frame, 2.0 * levels.back().reach);
    sort_members(levels.back(), frame, p, skin);
  }
  level_of.resize(raw.size());
  for (std::size_t u = 0; u < raw.size(); ++u) level_of[u] = renumbered[static_cast<std::size_t>(raw[u])];
  return levels;
}

template <int D>
void require_wide_cell(const Cell<D>& cell, double largest_reach) {
  const double period = shortest_period(cell);
  if (!(period >= 4.0 * largest_reach))
    throw InputError("cell: images of a body are " + std::to_string(period) +
                     " m apart, less than two diameters of the largest grain with skin (" +
                     std::to_string(4.0 * largest_reach) + " m)");
}

/// The cells along one axis that a sphere reaches; beyond a periodic boundary they count on (-1, cells, ...).
struct Range {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

/// A row of cells along the first axis that lies in one image, ends included.
struct Run {
  std::int64_t low = 0;
  std::int64_t high = 0;
  int wrap = 0;
};

/// Number of whole periods below `cell`.
int wrap_of(std::int64_t cell, std::int64_t cells) { return cell < 0 ? -1 : (cell >= cells ? 1 : 0); }

template <int D>
class Search {
 public:
  Search(const Particles<D>& p, const Cell<D>& cell, const std::vector<double>& skin, const SearchFrame<D>& frame)
      : p_(p), cell_(cell), skin_(skin), frame_(frame) {
    for (int image = 0; image < image_count<D>(); ++image)
      shift_[static_cast<std::size_t>(image)] = cell.image_shift(image);
  }

  /// Appends the partners of grain i in one class. Of its own class only those in cells that come later, or in its own
  /// cell with a larger slot: the others find it.
  void run(const Level<D>& level, bool same_level, Slot i, std::vector<CandidatePair>& out) const {
    const std::size_t u = at(i);
    const Sphere<D>& a = p_.sphere[u];
    const Vec<D> unit = frame_.unit(a.x);
    Look look{level, i, a.x, a.r + skin_[u], {}, {}, out};
    for (int k = 0; k < D; ++k)
      look.ranges[static_cast<std::size_t>(k)] = range(level, unit[k], look.reach + level.reach, k);
    if (same_level) look.own = cell_of(level, unit);
    rows<D - 1>(look, same_level, 0, 0);
  }

 private:
  using Axes = std::array<Range, static_cast<std::size_t>(D)>;

  /// One grain in one class.
  struct Look {
    const Level<D>& level;
    Slot i;
    Vec<D> x;
    double reach;
    Axes ranges;
    typename Level<D>::Index own;  ///< its cell, when it is of this class
    std::vector<CandidatePair>& out;
  };

  [[nodiscard]] Range range(const Level<D>& level, double unit, double reach, int axis) const {
    const auto k = static_cast<std::size_t>(axis);
    const double half = reach / frame_.width[axis] * (1.0 + 1e-12);  // rounding must not cut off a partner
    const auto place = [&](double at) {
      return cell_.periodic[k] ? static_cast<std::int64_t>(std::floor(at * static_cast<double>(level.cells[k])))
                               : cell_at(at, level.cells[k]);
    };
    return {place(unit - half), place(unit + half)};
  }

  /// All rows along the first axis. `level_with_own`: so far in the own cell along all axes, so that no cell before
  /// counts. `index`: of the first cell, `image` without the first axis.
  template <int kAxis>
  void rows(const Look& look, bool level_with_own, std::int64_t index, int image) const {
    const std::int64_t n = look.level.cells[kAxis];
    Range range = look.ranges[kAxis];
    if (level_with_own) range.low = look.own[kAxis];
    if constexpr (kAxis == 0) {
      along_row(range, n, [&](const Run& r) { scan(look, level_with_own, index * n, r, image + (r.wrap + 1)); });
    } else {
      int weight = 1;
      for (int k = 0; k < kAxis; ++k) weight *= 3;
      for (std::int64_t c = range.low; c <= range.high; ++c) {
        const int wrap = wrap_of(c, n);
        rows<kAxis - 1>(look, level_with_own && c == look.own[kAxis], index * n + c - wrap * n,
                        image + (wrap + 1) * weight);
      }
    }
  }

  template <class Visit>
  static void along_row(const Range& range, std::int64_t n, Visit&& visit) {
    for (std::int64_t c = range.low; c <= range.high;) {
      const int wrap = wrap_of(c, n);
      const std::int64_t last = std::min(range.high, (wrap + 1) * n - 1);
      visit(Run{c - wrap * n, last - wrap * n, wrap});
      c = last + 1;
    }
  }

  /// A run of cells, in the own row from the own cell on.
  void scan(const Look& look, bool own_row, std::int64_t row, const Run& run, int image) const {
    const auto& start = look.level.start;
    const auto first = static_cast<std::size_t>(row + run.low);
    auto begin = static_cast<std::size_t>(start[first]);
    const auto end = static_cast<std::size_t>(start[static_cast<std::size_t>(row + run.high) + 1]);
    if (own_row && run.wrap == 0)
      while (begin < static_cast<std::size_t>(start[first + 1]) && look.level.slot[begin] <= look.i) ++begin;
    const Vec<D> x = look.x - shift_[static_cast<std::size_t>(image)];
    for (std::size_t m = begin; m < end; m += kLanes) {
      unsigned near = within_reach(look.level, m, x, look.reach) & ((1U << std::min(end - m, kLanes)) - 1U);
      for (; near != 0; near &= near - 1) note(look, look.level.slot[m + std::countr_zero(near)], image);
    }
  }

  /// One bit for each of the grains from m on that is within reach.
  static unsigned within_reach(const Level<D>& level, std::size_t m, const Vec<D>& x, double reach) {
    Quad distance2{};
    for (int k = 0; k < D; ++k) {
      const Quad d = x[k] - load_unaligned(level.x[static_cast<std::size_t>(k)].data() + m);
      distance2 += d * d;
    }
    const Quad both = reach + load_unaligned(level.reaches.data() + m);
    return static_cast<unsigned>(sign_bits(distance2 < both * both));
  }

  /// The image belongs to the body with the larger slot.
  static void note(const Look& look, Slot other, int image) {
    if (look.i < other)
      look.out.push_back({look.i, other, image});
    else
      look.out.push_back({other, look.i, image_count<D>() - 1 - image});
  }

  const Particles<D>& p_;
  const Cell<D>& cell_;
  const std::vector<double>& skin_;
  const SearchFrame<D>& frame_;
  std::array<Vec<D>, static_cast<std::size_t>(image_count<D>())> shift_;
};

/// Cells rows that a grain of one class looks at in another, about.
template <int D>
double rows_seen(const Level<D>& from, const Level<D>& in, const SearchFrame<D>& frame) {
  double rows = 1.0;
  for (int k = 1; k < D; ++k) {
    const auto cells = static_cast<double>(in.cells[static_cast<std::size_t>(k)]);
    rows *= std::min(cells, 1.0 + 2.0 * (from.reach + in.reach) / frame.width[k] * cells);
  }
  return rows;
}

/// Decides which of two classes looks for partners in the other: the one that looks at fewer rows in all. A large grain
/// sees many small cells, but there are few large grains. looks[a][b]: grains of class a look into b.
template <int D>
std::vector<std::vector<bool>> search_directions(const std::vector<Level<D>>& levels, const SearchFrame<D>& frame) {
  std::vector<std::vector<bool>> looks(levels.size(), std::vector<bool>(levels.size(), false));
  for (std::size_t a = 0; a < levels.size(); ++a) {
    looks[a][a] = true;
    for (std::size_t b = a + 1; b < levels.size(); ++b) {
      const double coarse = static_cast<double>(levels[a].members.size()) * rows_seen(levels[a], levels[b], frame);
      const double fine = static_cast<double>(levels[b].members.size()) * rows_seen(levels[b], levels[a], frame);
      looks[a][b] = coarse < fine;
      looks[b][a] = !looks[a][b];
    }
  }
  return looks;
}

/// Grains per piece of work; pieces are joined in order, so the result does not depend on the threads.
constexpr Slot kPiece = 1024;
constexpr Slot kParallelGrains = 4000;

}  // namespace

template <int D>
std::string grain_name(const Particles<D>& p, Slot slot) {
  return "grain " + std::to_string(p.id.empty() ? slot : p.id[static_cast<std::size_t>(slot)]);
}

template <int D>
double shortest_period(const Cell<D>& cell) {
  double shortest2 = std::numeric_limits<double>::infinity();
  for (int image = 0; image < image_count<D>(); ++image) {
    bool periodic = image != home_image<D>();
    int rest = image;
    for (std::size_t k = 0; k < D; ++k, rest /= 3) periodic = periodic && (rest % 3 == 1 || cell.periodic[k]);
    if (periodic) shortest2 = std::min(shortest2, norm2(cell.image_shift(image)));
  }
  return std::sqrt(shortest2);
}

template <int D>
std::vector<CandidatePair> candidate_pairs(const Particles<D>& particles, const Cell<D>& cell,
                                           const std::vector<double>& skin) {
  if (particles.grains < 2) return {};
  const SearchFrame<D> frame = search_frame(particles, cell);
  std::vector<std::int32_t> level_of;
  const auto levels = make_levels(particles, skin, frame, level_of);
  require_wide_cell(cell, levels.front().reach);
  const Search<D> search(particles, cell, skin, frame);
  const auto looks = search_directions(levels, frame);
  const Slot pieces = (particles.grains + kPiece - 1) / kPiece;
  std::vector<std::vector<CandidatePair>> found(static_cast<std::size_t>(pieces));
#pragma omp parallel for schedule(dynamic) if (particles.grains >= kParallelGrains && omp_in_parallel() == 0)
  for (Slot piece = 0; piece < pieces; ++piece) {
    auto& to = found[static_cast<std::size_t>(piece)];
    for (Slot i = piece * kPiece; i < std::min((piece + 1) * kPiece, particles.grains); ++i) {
      const std::int32_t own = level_of[static_cast<std::size_t>(i)];
      for (std::size_t l = 0; l < levels.size(); ++l)
        if (looks[static_cast<std::size_t>(own)][l]) search.run(levels[l], l == static_cast<std::size_t>(own), i, to);
    }
  }
  return sorted_pairs(found, static_cast<std::size_t>(particles.grains));
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

template std::string grain_name<2>(const Particles<2>&, Slot);
template std::string grain_name<3>(const Particles<3>&, Slot);
template double shortest_period<2>(const Cell<2>&);
template double shortest_period<3>(const Cell<3>&);
template std::vector<CandidatePair> candidate_pairs<2>(const Particles<2>&, const Cell<2>&, const std::vector<double>&);
template std::vector<CandidatePair> candidate_pairs<3>(const Particles<3>&, const Cell<3>&, const std::vector<double>&);
template std::vector<CandidatePair> candidate_pairs_brute_force<2>(const Particles<2>&, const Cell<2>&,
                                                                   const std::vector<double>&);
template std::vector<CandidatePair> candidate_pairs_brute_force<3>(const Particles<3>&, const Cell<3>&,
                                                                   const std::vector<double>&);

}  // namespace softgrain

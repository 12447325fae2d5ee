#include "common/neighbours/skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/core/parallel_tasks.h"
#include "common/neighbours/hierarchical_grid.h"

namespace softgrain {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

template <int D>
double frobenius(const Matrix<D>& m) {
  double sum = 0.0;
  for (int k = 0; k < D; ++k) sum += norm2(m[k]);
  return std::sqrt(sum);
}

/// Whether bodies are followed relative to the cell. Planes do not flow with it.
template <int D>
bool follows_cell(const System<D>& s) {
  return s.cell.any_periodic() && s.particles.planes == 0;
}

/// F of the cell since the list was made.
template <int D>
Matrix<D> deformation(const Cell<D>& cell, const Matrix<D>& reference) {
  Cell<D> old;
  old.edges = reference;
  Matrix<D> f;
  for (int c = 0; c < D; ++c) {
    Vec<D> unit;
    unit[c] = 1.0;
    const Vec<D> column = cell.edges * old.fractional(unit);
    for (int r = 0; r < D; ++r) f[r][c] = column[r];
  }
  return f;
}

template <int D>
Matrix<D> without_unit(Matrix<D> f) {
  for (int k = 0; k < D; ++k) f[k][k] -= 1.0;
  return f;
}

/// How far an image of a neighbour has moved because the cell deformed.
template <int D>
double image_drift(const System<D>& s) {
  if (!s.cell.any_periodic()) return 0.0;
  double sum = 0.0;
  for (int r = 0; r < D; ++r)
    for (int c = 0; c < D; ++c) sum += std::abs(s.cell.edges[r][c] - s.neighbours.reference_edges[r][c]);
  return sum;
}

/// Where places of the last list would be had all moved alike: F x + shift.
template <int D>
struct ReferenceMotion {
  Matrix<D> f;
  Vec<D> shift;
  bool moves = false;

  ReferenceMotion() {
    for (int k = 0; k < D; ++k) f[k][k] = 1.0;
  }
};

/// The only plane with this normal, or none.
template <int D>
Slot plane_facing(const Particles<D>& p, int axis, double sign) {
  Vec<D> normal{};
  normal[axis] = sign;
  Slot found = -1;
  for (Slot plane = p.first_plane(); plane < p.size(); ++plane) {
    if (!(p.normal_of(plane) == normal)) continue;
    if (found >= 0) return -1;
    found = plane;
  }
  return found;
}

/// Motion of the box along axes where two planes face each other. A packing that is pressed between walls moves like
/// this, but for its fluctuations. No motion in a periodic scene.
template <int D>
ReferenceMotion<D> motion_of_walls(const System<D>& s) {
  ReferenceMotion<D> out;
  if (s.cell.any_periodic() || s.particles.planes < 2) return out;
  for (int k = 0; k < D; ++k) {
    const Slot low = plane_facing(s.particles, k, 1.0);
    const Slot high = plane_facing(s.particles, k, -1.0);
    if (low < 0 || high < 0) continue;
    const double from[2] = {s.neighbours.reference[at(low)][k], s.neighbours.reference[at(high)][k]};
    const double to[2] = {s.particles.sphere[at(low)].x[k], s.particles.sphere[at(high)].x[k]};
    const double f = (to[1] - to[0]) / (from[1] - from[0]);
    if (!std::isfinite(f) || !(f > 0.0)) continue;
    out.f[k][k] = f;
    out.shift[k] = to[0] - f * from[0];
    out.moves = out.moves || to[0] != from[0] || to[1] != from[1];
  }
  return out;
}

/// Motion of a periodic cell that deforms, where bodies are followed relative to it.
template <int D>
ReferenceMotion<D> motion_of_cell(const System<D>& s) {
  ReferenceMotion<D> out;
  out.moves = follows_cell(s) && !(s.cell.edges == s.neighbours.reference_edges);
  if (out.moves) out.f = deformation(s.cell, s.neighbours.reference_edges);
  return out;
}

/// Share of its margin that each body has used up, relative to a motion that all share.
template <int D>
class Uses {
 public:
  Uses(const System<D>& s, const ReferenceMotion<D>& motion)
      : s_(s),
        half_reach_(half_reach(s.laws)),
        motion_(motion),
        strain_(frobenius(without_unit(motion.f))),
        drift_(follows_cell(s) ? 0.0 : 0.5 * image_drift(s)) {}

  [[nodiscard]] double of(std::size_t u) const {
    const auto& n = s_.neighbours;
    const Sphere<D>& sphere = s_.particles.sphere[u];
    const Vec<D> from = motion_.moves ? motion_.f * n.reference[u] + motion_.shift : n.reference[u];
    const double used = (norm(sphere.x - from) + drift_ + strain_ * (sphere.r + half_reach_ + n.skin[u])) / n.skin[u];
    return std::isfinite(used) ? used : kNever;
  }

 private:
  const System<D>& s_;
  double half_reach_;
  ReferenceMotion<D> motion_;
  double strain_;
  double drift_;
};

template <int D>
double largest_use(const System<D>& s, const ReferenceMotion<D>& motion) {
  const Uses<D> uses(s, motion);
  return joined_in_pieces<double>(
      at(s.particles.size()),
      [&](std::size_t begin, std::size_t end) {
        double most = 0.0;
        for (std::size_t u = begin; u < end; ++u) most = std::max(most, uses.of(u));
        return most;
      },
      [](double& most, double piece) { most = std::max(most, piece); });
}

/// The motion relative to which bodies are followed, any that all share will do, and the largest share of a margin that
/// is used up. With the walls only where a new list would be made else.
template <int D>
struct BestReference {
  ReferenceMotion<D> with;
  double largest = 0.0;

  explicit BestReference(const System<D>& s) : with(motion_of_cell(s)), largest(largest_use(s, with)) {
    if (largest <= 1.0) return;
    const ReferenceMotion<D> walls = motion_of_walls(s);
    const double rest = walls.moves ? largest_use(s, walls) : kNever;
    if (!(rest < largest)) return;
    largest = rest;
    with = walls;
  }
};

/// Size classes by halving of the radius, the smallest grain in class 0.
constexpr std::size_t kClasses = 40;

std::size_t class_of(double r, double smallest) {
  return std::min(static_cast<std::size_t>(std::max(std::ilogb(r / smallest), 0)), kClasses - 1);
}

template <int D>
double smallest_radius(const Particles<D>& p) {
  double smallest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const double r = p.sphere[static_cast<std::size_t>(i)].r;
    smallest = i == 0 ? r : std::min(smallest, r);
  }
  return smallest;
}

template <int D>
double touching_pairs(const System<D>& s) {
  const auto& list = s.contacts;
  std::int64_t count = 0;
  for (const ContactSection& section : list.sections) {
    if (section.geometry != Geometry::sphere_sphere) continue;
    const std::size_t first = at(section.begin);
    count += sum_in_pieces<std::int64_t>(at(section.end) - first, [&](std::size_t begin, std::size_t end) {
      std::int64_t here = 0;
      for (std::size_t c = first + begin; c < first + end; ++c) {
        const Sphere<D>& a = s.particles.sphere[at(list.i[c])];
        const Sphere<D>& b = s.particles.sphere[at(list.j[c])];
        const double reach = a.r + b.r;
        here += static_cast<std::int64_t>(norm2(a.x - b.x - s.cell.image_shift(list.image[c])) < reach * reach);
      }
      return here;
    });
  }
  return static_cast<double>(count);
}

/// What bodies have used up of their margins [m]: of grains the largest of their size class, but for the few that fly,
/// far ahead of the others: those go by themselves, as do walls.
template <int D>
class SkinConsumption {
 public:
  explicit SkinConsumption(const System<D>& s) : smallest_(smallest_radius(s.particles)), grains_(s.particles.grains) {
    const Uses<D> uses(s, BestReference<D>(s).with);
    used_.resize(s.particles.sphere.size());
    in_pieces(used_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t u = begin; u < end; ++u) used_[u] = uses.of(u) * s.neighbours.skin[u];
    });
    std::array<std::vector<double>, kClasses> of_class;
    for (std::size_t u = 0; u < used_.size(); ++u) {
      known_ = known_ && std::isfinite(used_[u]);
      if (static_cast<Slot>(u) < grains_) of_class[class_of(s.particles.sphere[u].r, smallest_)].push_back(used_[u]);
    }
    if (!known_) return;
    for (std::size_t c = 0; c < kClasses; ++c) most_[c] = most_of_the_others(of_class[c]);
  }

  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] double smallest() const { return smallest_; }
  [[nodiscard]] bool is_outlier(std::size_t u, double r) const {
    return static_cast<Slot>(u) < grains_ && used_[u] > most_[class_of(r, smallest_)];
  }
  [[nodiscard]] double of(std::size_t u, double r) const {
    return static_cast<Slot>(u) < grains_ && !is_outlier(u, r) ? most_[class_of(r, smallest_)] : used_[u];
  }

 private:
  static constexpr double kShareOfOthers = 0.99;  // of a class that does not fly, at least: none flies of less than 100
  static constexpr double kAhead = 2.0;           // of those, from which on one flies

  /// The largest number that does not stand out.
  static double most_of_the_others(std::vector<double>& used) {
    if (used.empty()) return 0.0;
    const auto flying = static_cast<std::size_t>((1.0 - kShareOfOthers) * static_cast<double>(used.size()) + 1e-9);
    const auto place = static_cast<std::ptrdiff_t>(used.size() - 1 - flying);
    std::nth_element(used.begin(), used.begin() + place, used.end());
    const double limit = kAhead * used[static_cast<std::size_t>(place)];
    double most = 0.0;
    for (const double x : used)
      if (x <= limit) most = std::max(most, x);
    return most;
  }

  double smallest_;
  Slot grains_;
  bool known_ = true;
  std::array<double, kClasses> most_{};
  std::vector<double> used_;
};

// What making a list costs, in looks at a pair that does not touch: measured on scenes A, B and C
// (results/performance).
constexpr double kPerGrain = 120.0;
constexpr double kPerPair = 15.0;

/// The number of passes between two lists that costs least: per pass extra pairs cost `near` N/n, lists `build`/N.
double best_interval(double near, double build, double passes) {
  return std::sqrt(build * passes / std::max(near, 1.0));
}

/// No margin changes faster than this from one list to the next: one wild list should not decide.
constexpr double kFastestChange = 2.0;
constexpr double kWidest = 0.5;            // of the radius ...
constexpr double kWidestInSmallest = 1.0;  // ... and of the smallest one
// A grain that flies has few neighbours, and few grains fly: wide margins cost little there.
constexpr double kWidestOfOutliers = 8.0;  // of the smallest radius
constexpr double kFastestOfOutliers = 16.0;
constexpr double kNarrowest = 0.01;  // of the radius of the smallest

/// Margins that last `stretch` times as long as the last ones.
template <int D>
void set_margins(System<D>& s, const SkinConsumption<D>& used, double stretch) {
  NeighbourState<D>& n = s.neighbours;
  const auto& p = s.particles;
  in_pieces(n.skin.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      const double r = p.sphere[u].r;
      const bool is_outlier = used.is_outlier(u, r);
      const double up = is_outlier ? kFastestOfOutliers : kFastestChange;
      const double limited = std::clamp(used.of(u, r) * stretch, n.skin[u] / kFastestChange, n.skin[u] * up);
      const double widest = is_outlier ? kWidestOfOutliers * used.smallest()
                                       : std::min(r > 0.0 ? kWidest * r : kNever, kWidestInSmallest * used.smallest());
      n.skin[u] = std::max(std::min(limited, widest), kNarrowest * used.smallest());
    }
  });
}

}  // namespace

double half_reach(const LawSet& laws) {
  double reach = 0.0;
  for (std::int32_t l = 0; l < laws.size(); ++l)
    reach = std::max(reach, std::visit([](const auto& law) { return reach_of(law); }, laws.law(l)));
  return 0.5 * reach;
}

template <int D>
std::vector<double> default_skin(const Particles<D>& p) {
  const double smallest = smallest_radius(p);
  std::vector<double> skin(static_cast<std::size_t>(p.size()), 0.0);
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    skin[u] = std::min(0.125 * p.sphere[u].r, 0.5 * smallest);
    largest = std::max(largest, skin[u]);
  }
  for (auto u = static_cast<std::size_t>(p.grains); u < skin.size(); ++u) skin[u] = largest;
  return skin;
}

template <int D>
double skin_used(const System<D>& s) {
  const auto bodies = static_cast<std::size_t>(s.particles.size());
  if (s.neighbours.reference.size() != bodies) return kNever;
  return BestReference<D>(s).largest;
}

template <int D>
void note_skin(System<D>& s) {
  NeighbourState<D>& n = s.neighbours;
  n.inverse_skin2.resize(n.skin.size());
  n.slimmest = 0.0;
  const double half = half_reach(s.laws);
  for (std::size_t u = 0; u < n.skin.size(); ++u) {
    n.inverse_skin2[u] = 1.0 / (n.skin[u] * n.skin[u]);
    n.slimmest = std::max(n.slimmest, (s.particles.sphere[u].r + half) / n.skin[u]);
  }
}

template <int D>
void fit_skin_to_cell(System<D>& s) {
  const double room = kShareOfPeriod * shortest_period(s.cell) - half_reach(s.laws);
  for (Slot i = 0; i < s.particles.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const double r = s.particles.sphere[u].r;
    if (room > r) s.neighbours.skin[u] = std::min(s.neighbours.skin[u], room - r);
  }
}

template <int D>
void adapt_skin(System<D>& s) {
  NeighbourState<D>& n = s.neighbours;
  const auto& p = s.particles;
  const auto passes = static_cast<double>(s.cost.loop_passes - n.passes_at_build);
  if (n.reference.size() != p.sphere.size() || !(passes >= 2.0) || p.grains < 2) return;
  const SkinConsumption<D> used(s);
  if (!used.known()) return;
  const auto listed = static_cast<double>(s.contacts.size());
  const double build = kPerGrain * static_cast<double>(p.grains) + kPerPair * listed;
  const double target = best_interval(listed - touching_pairs(s), build, passes);
  const double stretch = std::clamp(target / passes, 1.0 / kFastestChange, kFastestChange);
  set_margins(s, used, stretch);
}

template <int D>
SkinUse<D>::SkinUse(const System<D>& s) : flows_(follows_cell(s) && !(s.cell.velocity_gradient == Matrix<D>{})) {
  if (s.cell.velocity_gradient == Matrix<D>{}) return;
  // |u| grows by |v - L x| + |L| s at most, e by 2 |L|; walls beside a deforming cell: no bound, look every time.
  strain_rate_ = flows_ ? frobenius(s.cell.velocity_gradient) * (1.0 + 2.0 * (1.0 + s.neighbours.slimmest)) : kNever;
}

template std::vector<double> default_skin<2>(const Particles<2>&);
template std::vector<double> default_skin<3>(const Particles<3>&);
template double skin_used<2>(const System<2>&);
template double skin_used<3>(const System<3>&);
template void note_skin<2>(System<2>&);
template void note_skin<3>(System<3>&);
template void fit_skin_to_cell<2>(System<2>&);
template void fit_skin_to_cell<3>(System<3>&);
template void adapt_skin<2>(System<2>&);
template void adapt_skin<3>(System<3>&);
template class SkinUse<2>;
template class SkinUse<3>;

}  // namespace softgrain

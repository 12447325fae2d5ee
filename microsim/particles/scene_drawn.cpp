#include "microsim/particles/scene_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"
#include "common/io/scene.h"
#include "common/neighbours/skin.h"
#include "common/packing/grading_scene.h"
#include "microsim/particles/scene_memory.h"
#include "microsim/particles/scene_walls.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kParticleRadii{40};
constexpr RandomPurpose kParticlePlaces{41};
// For all together: so many each, and some for the last ones.
constexpr std::int64_t kTrialsEach = 1000;
constexpr std::int64_t kTrialsBeside = 1000000;

/// Where centres may lie, and which axes are closed.
template <int D>
struct Region {
  Vec<D> low{};
  Vec<D> high{};
  std::array<bool, D> periodic{};  ///< the region is the cell along this axis
  Vec<D> period{};                 ///< of the cell, where the region is another; 0: none
};

/// Periodic edges of the cell; `in_file`: those of size = "file". 0 along other axes.
template <int D>
Vec<D> periods_of(const SceneTable& root, const Vec3& in_file) {
  Vec<D> out;
  if (!root.has("cell")) return out;
  const SceneTable cell = root.table("cell");
  if (!cell.has("size") || !cell.has("periodic")) return out;  // said where the cell is read
  const bool of_file = cell.is_text("size");
  const Vec<D> size = of_file ? Vec<D>{} : read_vector<D>(cell, "size", Unit::length);
  const std::vector<bool> flags = cell.flags("periodic");
  for (int k = 0; k < D && k < std::ssize(flags); ++k)
    if (flags[static_cast<std::size_t>(k)]) out[k] = of_file ? in_file[k] : size[k];
  return out;
}

template <int D>
Region<D> read_region(const SceneTable& root, const SceneTable& t, const Vec3& in_file) {
  Region<D> region;
  if (t.has("low") || t.has("high") || !root.has("cell") || root.table("cell").is_text("size")) {
    region.low = read_vector<D>(t,
                                {"low",
                                 "lower corner of the box for random places instead of the cell; its faces are then "
                                 "closed",
                                 "the cell"},
                                Unit::length);
    region.high = read_vector<D>(
        t, {"high", "upper corner of the box for random places instead of the cell", "the cell"}, Unit::length);
    region.period = periods_of<D>(root, in_file);
  } else {
    const SceneTable cell = root.table("cell");
    region.high = read_vector<D>(cell, "size", Unit::length);
    const std::vector<bool> flags = cell.flags("periodic");
    for (std::size_t k = 0; k < std::min<std::size_t>(flags.size(), D); ++k) region.periodic[k] = flags[k];
  }
  for (int k = 0; k < D; ++k)
    if (!t.has_errors() && !(region.high[k] > region.low[k]))
      t.throw_error("high", "must be above low along every axis");
  return region;
}

/// Particles that have a place, by cells as wide as the largest diameter.
template <int D>
class PlacedParticles {
 public:
  PlacedParticles(const Region<D>& region, double largest) : region_(region), largest_(largest) {
    std::size_t all = 1;
    for (int k = 0; k < D; ++k) {
      const double length = region.high[k] - region.low[k];
      const auto u = static_cast<std::size_t>(k);
      count_[u] = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::min(length / (2.0 * largest), 200.0)));
      all *= static_cast<std::size_t>(count_[u]);
    }
    cells_.resize(all);
  }

  [[nodiscard]] bool has_room(const Vec<D>& x, double r) const {
    bool room = true;
    around(x, [&](std::size_t cell) {
      for (const std::size_t j : cells_[cell]) room = room && !touches(x, r, j);
    });
    return room;
  }
  /// With all images that something in the region may touch; cells too narrow for neighbour lists are refused
  /// elsewhere.
  void add(const Vec<D>& x, double r) { add_images(x, r, 0); }

 private:
  void add_images(const Vec<D>& x, double r, int axis) {
    if (axis == D) return add_one(x, r);
    const double period = region_.period[axis];
    if (!(period * kShareOfPeriod >= largest_)) return add_images(x, r, axis + 1);
    const double reach = r + largest_;
    const double last = std::floor((region_.high[axis] + reach - x[axis]) / period);
    for (double n = std::ceil((region_.low[axis] - reach - x[axis]) / period); n <= last; ++n) {
      Vec<D> image = x;
      image[axis] += n * period;
      add_images(image, r, axis + 1);
    }
  }
  void add_one(const Vec<D>& x, double r) {
    std::size_t cell = 0;
    for (std::size_t k = 0; k < D; ++k)
      cell = cell * static_cast<std::size_t>(count_[k]) + static_cast<std::size_t>(index(x, k));
    cells_[cell].push_back(x_.size());
    x_.push_back(x);
    r_.push_back(r);
  }
  [[nodiscard]] std::int64_t index(const Vec<D>& x, std::size_t k) const {
    const auto a = static_cast<int>(k);
    double share = (x[a] - region_.low[a]) / (region_.high[a] - region_.low[a]);
    if (region_.periodic[k]) share -= std::floor(share);
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(share * static_cast<double>(count_[k])), 0,
                                    count_[k] - 1);
  }
  /// Every cell once that may hold a neighbour.
  template <class Visit>
  void around(const Vec<D>& x, const Visit& visit) const {
    std::vector<std::size_t> cells{0};
    for (std::size_t k = 0; k < D; ++k) {
      std::vector<std::int64_t> along;
      for (std::int64_t step = -1; step <= 1; ++step) {
        std::int64_t c = index(x, k) + step;
        if (region_.periodic[k]) c = (c + count_[k]) % count_[k];
        if (c >= 0 && c < count_[k] && std::find(along.begin(), along.end(), c) == along.end()) along.push_back(c);
      }
      std::vector<std::size_t> next;
      for (const std::size_t before : cells)
        for (const std::int64_t c : along)
          next.push_back(before * static_cast<std::size_t>(count_[k]) + static_cast<std::size_t>(c));
      cells = std::move(next);
    }
    for (const std::size_t cell : cells) visit(cell);
  }
  [[nodiscard]] bool touches(const Vec<D>& x, double r, std::size_t j) const {
    Vec<D> apart = x - x_[j];
    for (int k = 0; k < D; ++k) {
      const double length = region_.high[k] - region_.low[k];
      if (region_.periodic[static_cast<std::size_t>(k)]) apart[k] -= length * std::round(apart[k] / length);
    }
    return norm2(apart) < (r + r_[j]) * (r + r_[j]);
  }

  Region<D> region_;
  double largest_;
  std::array<std::int64_t, D> count_{};
  std::vector<std::vector<std::size_t>> cells_;
  std::vector<Vec<D>> x_;
  std::vector<double> r_;
};

/// Of several sphere-insides the particle has to be within the one that will hold it.
template <int D>
bool clear_of_walls(const std::vector<SceneWall<D>>& walls, const Vec<D>& x, double r) {
  const bool spheres = std::any_of(walls.begin(), walls.end(), [](const auto& w) { return !w.plane; });
  const std::ptrdiff_t around = wall_around(walls, x);
  if (spheres && around < 0) return false;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const SceneWall<D>& w = walls[k];
    if (w.plane ? dot(x - w.body.x, w.normal) < r
                : static_cast<std::ptrdiff_t>(k) == around && norm(x - w.body.x) + r > w.body.r)
      return false;
  }
  return true;
}

template <int D>
Vec<D> random_place(const Region<D>& region, double r, RandomStream& random) {
  Vec<D> x;
  for (int k = 0; k < D; ++k) {
    const double margin = region.periodic[static_cast<std::size_t>(k)] ? 0.0 : r;
    x[k] = region.low[k] + margin + (region.high[k] - region.low[k] - 2.0 * margin) * random.uniform();
  }
  return x;
}

template <int D>
void require_room(const SceneTable& t, const Region<D>& region, const std::vector<double>& radii) {
  constexpr double kDensest = D == 3 ? 0.74 : 0.907;  // of equal spheres and disks; places at random hold half of it
  const double largest = radii.front();
  double box = 1.0;
  for (int k = 0; k < D; ++k) box *= region.high[k] - region.low[k];
  double volume = 0.0;
  for (const double r : radii) volume += D == 3 ? kSphereVolume * cube(r) : std::numbers::pi * r * r;
  if (volume > kDensest * box)
    t.throw_error("count", fmt::format("the particles would fill {:.3g} of the box; at most {:g} is possible",
                                       volume / box, kDensest));
  for (int k = 0; k < D; ++k)
    if (region.high[k] - region.low[k] < 2.0 * largest)
      t.throw_error("sizes", fmt::format("the largest particle, of radius {:g} m, is wider than the box", largest));
  for (int k = 0; k < D; ++k)
    if (region.period[k] > 0.0 && region.high[k] - region.low[k] > region.period[k] * (1.0 + 1e-9))
      t.throw_error("high",
                    fmt::format("the box from low to high is wider than the cell, which is periodic along {}; allowed: "
                                "at most {:g} m above low",
                                "xyz"[k], region.period[k]));
}

template <int D>
void place(const SceneTable& t, const Region<D>& region, const std::vector<SceneWall<D>>& walls,
           const std::vector<NewBody<D>>& others, RandomStream& random, DrawnParticles<D>& out) {
  double largest = out.radius.front();
  for (const NewBody<D>& body : others) largest = std::max(largest, body.r);
  PlacedParticles<D> placed(region, largest);
  for (const NewBody<D>& body : others) placed.add(body.x, body.r);
  std::int64_t left = kTrialsBeside + kTrialsEach * static_cast<std::int64_t>(out.radius.size());
  for (std::size_t k = 0; k < out.radius.size(); ++k) {
    stop_if_interrupted("placing particles");
    const double r = out.radius[k];
    Vec<D> x;
    do {
      x = random_place(region, r, random);
    } while ((!clear_of_walls(walls, x, r) || !placed.has_room(x, r)) && --left > 0);
    if (left <= 0)
      t.throw_error("count",
                    fmt::format("particle {} of {} finds no place: fewer, or a larger box", k + 1, out.radius.size()));
    placed.add(x, r);
    out.position.push_back(x);
  }
}

/// Reads the seed at the top level, as in scenes of all kinds, or in the table.
std::uint64_t read_seed(const SceneTable& root, const SceneTable& t) {
  constexpr std::int64_t kMost = 1'000'000'000'000;
  if (root.has("seed")) t.refuse({"seed"}, "is given at the top level too: leave one of them out");
  return static_cast<std::uint64_t>(root.count(kSeedKey, 0, kMost,
                                               t.count({"seed",
                                                        "seed of the random places, better given at the top level as "
                                                        "in other scenes; `--seed` has priority; refused where "
                                                        "nothing is random"},
                                                       0, kMost, 1)));
}

}  // namespace

template <int D>
DrawnParticles<D> read_drawn(const SceneTable& root, const SceneTable& t, const std::vector<SceneWall<D>>& walls,
                             const std::vector<NewBody<D>>& others, const Vec3& in_file,
                             const std::optional<std::uint64_t>& seed) {
  DrawnParticles<D> out;
  const std::int64_t count = t.count(
      {"count", "instead of a file: this many particles of `sizes`, placed at random without overlap, largest first"},
      1, 10000000);
  out.seed = seed.value_or(read_seed(root, t));
  if (!t.has("sizes")) (void)t.table("sizes");  // says that it is missing
  out.sizes = read_sizes(t, {"sizes", "size distribution of the particles of `count`"}, {}, D);
  const Region<D> region = read_region<D>(root, t, in_file);
  if (!out.sizes || t.has_errors() || root.has_errors()) return out;
  if (const std::string problem = memory_problem(count, available_memory()); !problem.empty())
    t.throw_error("count", problem);
  RandomStream radii(out.seed, kParticleRadii, 0);
  out.radius = out.sizes->draw(static_cast<std::size_t>(count), radii);
  std::reverse(out.radius.begin(), out.radius.end());
  require_room<D>(t, region, out.radius);
  RandomStream places(out.seed, kParticlePlaces, 0);
  place(t, region, walls, others, places, out);
  return out;
}

template DrawnParticles<2> read_drawn<2>(const SceneTable&, const SceneTable&, const std::vector<SceneWall<2>>&,
                                         const std::vector<NewBody<2>>&, const Vec3&,
                                         const std::optional<std::uint64_t>&);
template DrawnParticles<3> read_drawn<3>(const SceneTable&, const SceneTable&, const std::vector<SceneWall<3>>&,
                                         const std::vector<NewBody<3>>&, const Vec3&,
                                         const std::optional<std::uint64_t>&);

}  // namespace softgrain

#include "microsim/powder/powder_holes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace softgrain {

namespace {

/// Void cells [from, to) of one row.
struct Run {
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::int64_t row = 0;
};

/// Number of periods, along x and y.
struct Image {
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend Image operator+(Image a, Image b) { return {a.x + b.x, a.y + b.y}; }
  friend Image operator-(Image a, Image b) { return {a.x - b.x, a.y - b.y}; }
  friend bool operator==(Image a, Image b) { return a.x == b.x && a.y == b.y; }
};

/// Union-find that also knows by which image each member is shifted against the root of its set.
class ImageSets {
 public:
  explicit ImageSets(std::size_t size) : parent_(size), shift_(size), size_(size, 1), percolates_(size, 0) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  struct Place {
    std::size_t root = 0;
    Image shift;
  };
  Place find(std::size_t member) {
    Place place{member, {}};
    while (parent_[place.root] != place.root) {
      place.shift = place.shift + shift_[place.root];
      place.root = parent_[place.root];
    }
    for (Image left = place.shift; parent_[member] != place.root && member != place.root;) {
      const std::size_t next = parent_[member];
      const Image step = shift_[member];
      parent_[member] = place.root;
      shift_[member] = left;
      left = left - step;
      member = next;
    }
    return place;
  }

  /// b, shifted by `image`, touches a. A set that meets itself under another shift percolates.
  void join(std::size_t a, std::size_t b, Image image) {
    Place pa = find(a);
    Place pb = find(b);
    Image between = pa.shift - pb.shift + image;  // of the root of b against that of a
    if (pa.root == pb.root) {
      if (!(between == Image{})) percolates_[pa.root] = 1;
      return;
    }
    if (size_[pa.root] < size_[pb.root]) {
      std::swap(pa, pb);
      between = Image{} - between;
    }
    parent_[pb.root] = pa.root;
    shift_[pb.root] = between;
    size_[pa.root] += size_[pb.root];
    percolates_[pa.root] = percolates_[pa.root] | percolates_[pb.root];
  }

  [[nodiscard]] bool percolates(std::size_t root) const { return percolates_[root] != 0; }

 private:
  std::vector<std::size_t> parent_;
  std::vector<Image> shift_;  ///< against the parent
  std::vector<std::size_t> size_;
  std::vector<std::uint8_t> percolates_;
};

/// Runs of all rows, and where each row's begin.
struct Runs {
  std::vector<Run> list;
  std::vector<std::size_t> first;  ///< ny + 1 entries
};

Runs void_runs(const PowderMesh& mesh) {
  Runs runs;
  for (std::int64_t j = 0; j < mesh.ny; ++j) {
    runs.first.push_back(runs.list.size());
    const std::uint8_t* row = mesh.solid.data() + j * mesh.nx;
    const std::uint8_t* end = row + mesh.nx;
    for (const std::uint8_t* at = std::find(row, end, 0); at != end; at = std::find(at, end, 0)) {
      const std::uint8_t* stop = std::find(at, end, 1);
      runs.list.push_back({at - row, stop - row, j});
      at = stop;
    }
  }
  runs.first.push_back(runs.list.size());
  return runs;
}

/// Joins runs of two rows that share a column; the upper row is shifted by `image`.
void join_rows(const Runs& runs, std::size_t lower, std::size_t upper, Image image, ImageSets& sets) {
  std::size_t a = runs.first[lower];
  std::size_t b = runs.first[upper];
  while (a < runs.first[lower + 1] && b < runs.first[upper + 1]) {
    const Run& low = runs.list[a];
    const Run& high = runs.list[b];
    if (low.from < high.to && high.from < low.to) sets.join(a, b, image);
    ++(low.to < high.to ? a : b);
  }
}

ImageSets join_runs(const PowderMesh& mesh, const Runs& runs) {
  ImageSets sets(runs.list.size());
  const auto rows = static_cast<std::size_t>(mesh.ny);
  for (std::size_t j = 0; j < rows; ++j) {
    const std::size_t begin = runs.first[j];
    const std::size_t end = runs.first[j + 1];
    if (begin == end) continue;
    if (runs.list[begin].from == 0 && runs.list[end - 1].to == mesh.nx) sets.join(end - 1, begin, {1, 0});
    join_rows(runs, j, (j + 1) % rows, {0, j + 1 == rows ? 1 : 0}, sets);
  }
  return sets;
}

/// Area and moments of a hole, unwrapped across the period.
struct Moments {
  double area = 0.0;
  Vec<2> first{};
  double second = 0.0;
  bool percolates = false;

  /// A rectangle from (x0, y0) of edges (w, h).
  void add(double x0, double y0, double w, double h) {
    const double x = x0 + 0.5 * w;
    const double y = y0 + 0.5 * h;
    area += w * h;
    first += Vec<2>{{x, y}} * (w * h);
    second += w * h * (x * x + y * y + (w * w + h * h) / 12.0);
  }

  [[nodiscard]] Hole hole(const Vec<2>& lengths) const {
    Hole out;
    out.area = area;
    out.percolates = percolates;
    out.centre = first * (1.0 / area);
    out.radius = percolates ? std::numeric_limits<double>::quiet_NaN()
                            : std::sqrt(std::max(2.0 * (second / area - norm2(out.centre)), 0.0));
    for (int k = 0; k < 2; ++k) out.centre[k] -= lengths[k] * std::floor(out.centre[k] / lengths[k]);
    return out;
  }
};

std::vector<Hole> measure(const PowderMesh& mesh, const Runs& runs, ImageSets& sets) {
  const Vec<2> d = mesh.spacing();
  std::vector<Moments> moments(runs.list.size());
  for (std::size_t r = 0; r < runs.list.size(); ++r) {
    const Run& run = runs.list[r];
    const ImageSets::Place place = sets.find(r);
    Moments& m = moments[place.root];
    m.percolates = sets.percolates(place.root);
    m.add(static_cast<double>(run.from + place.shift.x * mesh.nx) * d[0],
          static_cast<double>(run.row + place.shift.y * mesh.ny) * d[1], static_cast<double>(run.to - run.from) * d[0],
          d[1]);
  }
  std::vector<Hole> holes;
  for (const Moments& m : moments)
    if (m.area > 0.0) holes.push_back(m.hole(mesh.lengths));
  std::stable_sort(holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.area > b.area; });
  return holes;
}

}  // namespace

double smallest_hole_area(double r) { return (std::sqrt(3.0) - 0.5 * std::numbers::pi) * r * r; }

PowderHoles powder_holes(const PowderMesh& mesh, double smallest_area) {
  const Runs runs = void_runs(mesh);
  ImageSets sets = join_runs(mesh, runs);
  PowderHoles out;
  out.holes = measure(mesh, runs, sets);
  double area = 0.0;
  double weighted = 0.0;
  for (const Hole& hole : out.holes) {
    area += hole.area;
    weighted += hole.area * hole.radius;
    ++(hole.area >= smallest_area ? out.count : out.fragments);
    if (hole.percolates) ++out.percolating;
    // Not std::max alone: a NaN must stay.
    out.largest_radius = std::isnan(hole.radius) ? hole.radius : std::max(hole.radius, out.largest_radius);
  }
  if (out.percolating > 0) out.largest_radius = std::numeric_limits<double>::quiet_NaN();
  out.void_fraction = area / (mesh.lengths[0] * mesh.lengths[1]);
  if (area > 0.0) {
    out.mean_radius = weighted / area;
    out.largest_share = out.holes.front().area / area;
  }
  return out;
}

}  // namespace softgrain

#include "common/packing/void_filling.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/core/error.h"
#include "common/io/interrupt.h"
#include "common/packing/clearance_field.h"

namespace softgrain {

namespace {

/// Part of the domain; no sphere larger than `key` has its centre in it.
struct Part {
  double key = 0.0;
  std::int64_t number = 0;  ///< breaks ties
  Vec3 centre{};
  int level = 0;
};

bool later(const Part& a, const Part& b) { return a.key != b.key ? a.key < b.key : a.number > b.number; }

/// A sphere that fits, or did when it was found.
struct Hole {
  PackedSphere sphere;
  std::int64_t number = 0;
};

bool smaller(const Hole& a, const Hole& b) {
  return a.sphere.r != b.sphere.r ? a.sphere.r < b.sphere.r : a.number > b.number;
}

/// Branch and bound over the clearance: parts of the domain with upper bounds, holes with lower ones. Both only become
/// smaller as spheres are added, so bounds are renewed when they come up, never before.
class HoleSearch {
 public:
  HoleSearch(const std::vector<PackedSphere>& placed, const VoidDomain& domain, double r_min, double r_max,
             double tolerance)
      : field_(placed, domain, kReach * r_max), r_min_(r_min), tolerance_(tolerance) {
    const Vec3 size = domain.high - domain.low;
    std::array<int, 3> n{};
    for (int k = 0; k < 3; ++k) {
      n[static_cast<std::size_t>(k)] = std::clamp(static_cast<int>(std::ceil(2.0 * size[k] / r_max)), 1, kMostParts);
      half_[k] = 0.5 * size[k] / n[static_cast<std::size_t>(k)];
    }
    for (int a = 0; a < n[0]; ++a)
      for (int b = 0; b < n[1]; ++b)
        for (int c = 0; c < n[2]; ++c)
          offer(domain.low + Vec3{{(2 * a + 1) * half_[0], (2 * b + 1) * half_[1], (2 * c + 1) * half_[2]}}, 0,
                std::numeric_limits<double>::infinity());
  }

  /// The largest hole, or the first found that holds a sphere of `cap`; nothing when none of r_min is left.
  std::optional<PackedSphere> find(double cap) {
    if (kReach * cap < 0.5 * field_.reach()) field_.set_reach(kReach * cap);
    for (;;) {
      renew_holes();
      const double bound = parts_.empty() ? 0.0 : parts_.front().key;
      const double found = holes_.empty() ? 0.0 : holes_.front().sphere.r;
      if (found > 0.0 && found * (1.0 + tolerance_) >= std::min(bound, cap)) return holes_.front().sphere;
      if (bound < r_min_) return std::nullopt;
      search(pop_part());
    }
  }

  void add(const PackedSphere& sphere) { field_.add(sphere); }
  [[nodiscard]] const ClearanceField& field() const { return field_; }
  [[nodiscard]] double bound() const {
    return std::max(parts_.empty() ? 0.0 : parts_.front().key, holes_.empty() ? 0.0 : holes_.front().sphere.r);
  }

 private:
  static constexpr double kReach = 1.5;  ///< reach over the largest radius of interest, which settling needs
  static constexpr int kMostParts = 48;  ///< per axis, at the start
  static constexpr int kMostLevels = 24;

  [[nodiscard]] double radius(int level) const { return std::ldexp(norm(half_), -level); }

  /// The clearance changes by no more than the distance moved: that of the centre bounds the part.
  void offer(const Vec3& centre, int level, double key) {
    key = std::min(key, field_.clearance(centre) + radius(level));
    if (key < r_min_ || level == kMostLevels) return;
    parts_.push_back({key, numbers_++, centre, level});
    std::push_heap(parts_.begin(), parts_.end(), later);
  }

  Part pop_part() {
    std::pop_heap(parts_.begin(), parts_.end(), later);
    const Part part = parts_.back();
    parts_.pop_back();
    return part;
  }

  void search(const Part& part) {
    const double room = field_.clearance(part.centre);
    const double reach = radius(part.level);
    if (room + reach < part.key * (1.0 - 1e-12)) return offer(part.centre, part.level, part.key);
    if (!knows_hole_near(part.centre, std::max(reach, 0.5 * room))) add_hole(climb(field_, part.centre));
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 centre = part.centre;
      for (int k = 0; k < 3; ++k)
        centre[k] += std::ldexp((corner >> k & 1) != 0 ? half_[k] : -half_[k], -part.level - 1);
      offer(centre, part.level + 1, part.key);
    }
  }

  [[nodiscard]] bool knows_hole_near(const Vec3& x, double distance) const {
    return std::any_of(holes_.begin(), holes_.end(),
                       [&](const Hole& h) { return norm2(h.sphere.x - x) < distance * distance; });
  }

  void add_hole(const PackedSphere& sphere) {
    if (sphere.r < r_min_) return;
    holes_.push_back({sphere, numbers_++});
    std::push_heap(holes_.begin(), holes_.end(), smaller);
  }

  /// Holes that a sphere has been put into are looked at again from where they were.
  void renew_holes() {
    while (!holes_.empty()) {
      const PackedSphere top = holes_.front().sphere;
      if (field_.clearance(top.x) >= top.r * (1.0 - 1e-12)) return;
      std::pop_heap(holes_.begin(), holes_.end(), smaller);
      holes_.pop_back();
      if (field_.clearance(top.x) > 0.0) add_hole(climb(field_, top.x));
    }
  }

  ClearanceField field_;
  double r_min_;
  double tolerance_;
  Vec3 half_{};
  std::vector<Part> parts_;
  std::vector<Hole> holes_;
  std::int64_t numbers_ = 0;
};

double half_extent(const VoidDomain& domain) {
  const Vec3 size = domain.high - domain.low;
  return 0.5 * std::min({size[0], size[1], size[2]});
}

void require_valid(const VoidDomain& domain, double r_min, double r_max) {
  if (!(half_extent(domain) > 0.0)) throw InputError("filling of voids: the domain is empty");
  if (!(r_min > 0.0)) throw InputError("filling of voids: the smallest radius must be positive");
  if (!(r_max >= r_min)) throw InputError("filling of voids: the largest radius must not be below the smallest");
}

}  // namespace

VoidFilling fill_voids(const std::vector<PackedSphere>& placed, const VoidDomain& domain,
                       const VoidFillingOptions& options) {
  require_valid(domain, options.r_min, options.r_max);
  VoidFilling out;
  double cap = std::min(options.r_max, half_extent(domain));
  if (cap < options.r_min) return out;
  HoleSearch search(placed, domain, options.r_min, cap, options.tolerance);
  while (static_cast<std::int64_t>(out.added.size()) < options.count && out.volume < options.volume) {
    stop_if_interrupted("filling voids");
    const auto hole = search.find(cap);
    if (!hole) break;
    PackedSphere sphere = *hole;
    if (sphere.r >= cap) sphere.x = settle(search.field(), hole->x, cap);
    sphere.r = std::min(cap, search.field().clearance(sphere.x));
    if (sphere.r < options.r_min) break;
    sphere.x = search.field().home(sphere.x);
    search.add(sphere);
    out.added.push_back(sphere);
    out.volume += 4.0 / 3.0 * std::numbers::pi * sphere.r * sphere.r * sphere.r;
    cap = sphere.r;
  }
  out.next_hole = std::min(search.bound(), cap);
  return out;
}

PackedSphere largest_void(const std::vector<PackedSphere>& placed, const VoidDomain& domain, double r_min,
                          double tolerance) {
  require_valid(domain, r_min, std::numeric_limits<double>::infinity());
  HoleSearch search(placed, domain, r_min, half_extent(domain), tolerance);
  return search.find(std::numeric_limits<double>::infinity()).value_or(PackedSphere{});
}

}  // namespace softgrain

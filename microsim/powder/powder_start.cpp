#include "microsim/powder/powder_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kDiameters{30};
constexpr RandomPurpose kPositions{31};
constexpr RandomPurpose kVelocities{32};

template <bool kFriction, bool kRolling>
AnyLaw law_of(const PowderSpec& spec) {
  CohesiveDisk<kFriction, kRolling> law;
  law.normal = spec.stiffness;
  law.tangential = spec.stiffness_ratio * spec.stiffness;
  law.friction = spec.friction;
  law.damping = spec.damping;
  law.adhesion = spec.cohesive ? 1.0 : 0.0;
  law.range = spec.range;
  law.rolling = spec.rolling_stiffness * spec.stiffness;
  law.rolling_limit = spec.rolling_friction * spec.friction;
  return law;
}

/// Disks placed so far, by cells as wide as the largest disk and its reach.
class PlacedDisks {
 public:
  PlacedDisks(double edge, double reach)
      : edge_(edge), reach_(reach), cells_(std::max(1, static_cast<int>(edge / (1.0 + reach)))) {
    log_lists_.resize(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_));
  }

  [[nodiscard]] bool has_room(const Vec<2>& x, double d) const {
    const int a = cell(x[0]);
    const int b = cell(x[1]);
    for (int da = -1; da <= 1; ++da)
      for (int db = -1; db <= 1; ++db)
        for (const std::size_t j : log_lists_[index(a + da, b + db)])
          if (near(x, d, j)) return false;
    return true;
  }
  void add(const Vec<2>& x, double d) {
    log_lists_[index(cell(x[0]), cell(x[1]))].push_back(x_.size());
    x_.push_back(x);
    d_.push_back(d);
  }

 private:
  [[nodiscard]] int cell(double x) const { return std::min(static_cast<int>(x / edge_ * cells_), cells_ - 1); }
  [[nodiscard]] std::size_t index(int a, int b) const {
    const auto wrap = [this](int k) { return static_cast<std::size_t>((k + 2 * cells_) % cells_); };
    return wrap(a) * static_cast<std::size_t>(cells_) + wrap(b);
  }
  [[nodiscard]] bool near(const Vec<2>& x, double d, std::size_t j) const {
    Vec<2> apart = x - x_[j];
    for (int k = 0; k < 2; ++k) apart[k] -= edge_ * std::round(apart[k] / edge_);
    const double touch = 0.5 * (d + d_[j]) + reach_;
    return norm2(apart) <= touch * touch;
  }

  double edge_;
  double reach_;
  int cells_;
  std::vector<std::vector<std::size_t>> log_lists_;
  std::vector<Vec<2>> x_;
  std::vector<double> d_;
};

/// Two independent numbers of a normal distribution (Box and Muller).
Vec<2> normal_pair(RandomStream& random) {
  const double radius = std::sqrt(-2.0 * std::log(random.uniform()));
  const double angle = 2.0 * std::numbers::pi * random.uniform();
  return {{radius * std::cos(angle), radius * std::sin(angle)}};
}

void set_velocities(System<2>& s, const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  RandomStream random(seed, kVelocities, sample);
  auto& p = s.particles;
  Vec<2> momentum{};
  double mass = 0.0;
  for (std::size_t u = 0; u < p.velocity.size(); ++u) {  // equal mean energy: v ~ 1/sqrt(m)
    p.velocity[u] = normal_pair(random) * std::sqrt(p.inverse_mass[u]);
    momentum += p.velocity[u] * (1.0 / p.inverse_mass[u]);
    mass += 1.0 / p.inverse_mass[u];
  }
  double square = 0.0;
  for (auto& v : p.velocity) {
    v -= momentum * (1.0 / mass);
    square += norm2(v);
  }
  const double wanted = spec.start_speed * std::sqrt(spec.range);  // of one component, two of them in `square`
  const double scale = wanted / std::sqrt(0.5 * square / static_cast<double>(p.velocity.size()));
  for (auto& v : p.velocity) v *= scale;
}

}  // namespace

AnyLaw powder_law(const PowderSpec& spec) {
  if (spec.friction == 0.0) return law_of<false, false>(spec);  // mu_r = c mu a vanishes with mu
  return spec.rolling ? law_of<true, true>(spec) : law_of<true, false>(spec);
}

std::vector<double> drawn_diameters(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  RandomStream random(seed, kDiameters, sample);
  std::vector<double> d;
  if (spec.sizes)
    for (const double r : spec.sizes->draw(static_cast<std::size_t>(spec.disks), random))
      d.push_back(r / spec.sizes->largest());
  while (d.size() < static_cast<std::size_t>(spec.disks))
    d.push_back(spec.diameter_min + (1.0 - spec.diameter_min) * random.uniform());
  std::sort(d.begin(), d.end(), std::greater<>());
  return d;
}

System<2> make_powder(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  constexpr int kTrials = 1000000;
  const std::vector<double> diameters = drawn_diameters(spec, seed, sample);
  double area = 0.0;
  for (const double d : diameters) area += 0.25 * std::numbers::pi * d * d;
  const double edge = std::sqrt(area / spec.solid_fraction);
  System<2> s;
  s.materials = {{"disk", 1.0, 1.0, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, powder_law(spec));
  s.cell = box_cell<2>({{edge, edge}}, {true, true});
  RandomStream random(seed, kPositions, sample);
  PlacedDisks placed(edge, spec.cohesive ? spec.range : 0.0);
  for (const double d : diameters) {
    NewBody<2> disk;
    int trial = 0;
    do {
      disk.x = {{edge * random.uniform(), edge * random.uniform()}};
    } while (!placed.has_room(disk.x, d) && ++trial < kTrials);
    if (trial == kTrials)
      throw InputError("powder: disks find no place at a solid fraction of " + std::to_string(spec.solid_fraction) +
                       "; start looser");
    placed.add(disk.x, d);
    disk.r = 0.5 * d;
    disk.mass = d * d;
    disk.inertia = disk.mass * d * d / 8.0;
    add_grain(s.particles, disk);
  }
  if (spec.start_speed > 0.0) set_velocities(s, spec, seed, sample);
  return s;
}

double powder_fraction(const System<2>& system) {
  double area = 0.0;
  for (Slot i = 0; i < system.particles.grains; ++i) {
    const double r = system.particles.sphere[static_cast<std::size_t>(i)].r;
    area += std::numbers::pi * r * r;
  }
  return area / system.cell.volume();
}

}  // namespace softgrain

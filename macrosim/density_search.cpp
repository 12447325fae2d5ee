#include "macrosim/density_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/core/text.h"

namespace softgrain {

namespace {

/// A preparation that was tried.
struct DensityTry {
  double friction = 0.0;
  double off = 0.0;  ///< solid fraction minus the target
};

/// Two neighbours in friction.
struct DensityBracket {
  DensityTry low, high;

  [[nodiscard]] double width() const { return high.friction - low.friction; }
  [[nodiscard]] double inside(double share) const { return low.friction + share * width(); }
  [[nodiscard]] bool crosses() const { return (low.off > 0.0) != (high.off > 0.0); }
};

/// A jump: the solid fraction falls so many times faster with friction than from end to end. Packings of many particles
/// are three times as steep at most.
constexpr double kJump = 10.0;
/// Neighbours that differ by less than this share of the largest friction are not parted further.
constexpr double kNarrowest = 1e-6;
/// Tries of a search between neighbours, at most: enough for the smallest tolerance where nothing jumps.
constexpr std::size_t kMostBracketed = 16;
/// Frictions around which the target is looked for where packings jump, over the largest friction.
constexpr double kLeastSpread = 0.01;

class DensitySearcher {
 public:
  DensitySearcher(double target, double tolerance, double largest_friction,
                  const std::function<MacroPacking(double)>& prepare)
      : target_(target), tolerance_(tolerance), largest_(largest_friction), prepare_(prepare) {}

  /// Whether the target is met with this friction.
  bool attempt(double friction) {
    MacroPacking packing = prepare_(friction);
    cost_ += packing.cost;
    const DensityTry one{friction, packing.solid_fraction() - target_};
    tries_.insert(std::ranges::upper_bound(tries_, friction, {}, &DensityTry::friction), one);
    if (!best_ || std::abs(one.off) < std::abs(nearest_.off)) {
      best_ = std::move(packing);
      nearest_ = one;
    }
    return std::abs(one.off) <= tolerance_;
  }

  /// Between the widest neighbours on both sides of the target that are no jump, by regula falsi and in the middle in
  /// turn. Where packings jump, in turn within the widest jump, and at frictions around the one where a line through
  /// the nearest tries meets the target: beside a jump there may be packings of any density between.
  [[nodiscard]] double next() const {
    const double slope = kJump * (densest().off - loosest().off) / largest_;
    const auto widest = [&](bool jumps) {
      std::optional<DensityBracket> out;
      for (std::size_t k = 0; k + 1 < tries_.size(); ++k) {
        const DensityBracket b{tries_[k], tries_[k + 1]};
        if (!b.crosses() || b.width() < kNarrowest * largest_) continue;
        if (jumps != (b.low.off - b.high.off > slope * b.width())) continue;
        if (!out || b.width() > out->width()) out = b;
      }
      return out;
    };
    const bool even = tries_.size() % 2 == 0;
    if (const auto smooth = widest(false); smooth && tries_.size() < kMostBracketed) {
      constexpr double kEdge = 0.1;
      const double falsi = smooth->low.off / (smooth->low.off - smooth->high.off);
      return smooth->inside(even ? std::clamp(falsi, kEdge, 1.0 - kEdge) : 0.5);
    }
    if (const auto jump = widest(true); jump && even) return jump->inside(0.5);
    return scattered();
  }

  [[nodiscard]] bool can_go_on() const {
    return tries_.size() < kMostDensityTries && tries_.front().off > 0.0 && tries_.back().off < 0.0;
  }

  [[nodiscard]] MacroPacking take() {
    best_->cost = cost_;
    best_->density = {target_, tolerance_, nearest_.friction, static_cast<std::int64_t>(tries_.size())};
    return std::move(*best_);
  }

  [[nodiscard]] const DensityTry& loosest() const { return tries_.back(); }
  [[nodiscard]] const DensityTry& densest() const { return tries_.front(); }
  [[nodiscard]] const DensityTry& nearest() const { return nearest_; }
  [[nodiscard]] std::size_t tries() const { return tries_.size(); }
  [[nodiscard]] double fraction(const DensityTry& one) const { return target_ + one.off; }

 private:
  /// Each try anew within the frictions over which the solid fraction changes by a few tolerances, none twice.
  [[nodiscard]] double scattered() const {
    constexpr std::size_t kNear = 6;
    constexpr double kGolden = 0.6180339887498949;
    std::vector<DensityTry> near = tries_;
    std::ranges::stable_sort(near, {}, [](const DensityTry& t) { return std::abs(t.off); });
    near.resize(std::min(near.size(), kNear));
    double friction = 0.0;
    double off = 0.0;
    for (const DensityTry& t : near) {
      friction += t.friction / static_cast<double>(near.size());
      off += t.off / static_cast<double>(near.size());
    }
    const double slope = (densest().off - loosest().off) / largest_;
    const double place = static_cast<double>(tries_.size()) * kGolden;
    const double spread = std::max(4.0 * tolerance_ / slope, kLeastSpread * largest_);
    const double at = friction + off / slope + spread * (2.0 * (place - std::floor(place)) - 1.0);
    return std::clamp(at, 1e-6 * place * largest_, (1.0 - 1e-6 * place) * largest_);
  }

  double target_, tolerance_, largest_;
  const std::function<MacroPacking(double)>& prepare_;
  std::vector<DensityTry> tries_;  ///< by friction
  std::optional<MacroPacking> best_;
  DensityTry nearest_;
  Cost cost_{};
};

std::string fraction_text(double fraction) { return rounded_text(fraction, {4, true}); }

/// What the ends of the search reach, in the measure of the target too.
[[noreturn]] void out_of_reach(const DensityTarget& target, double grain_density, std::int64_t sample,
                               const DensitySearcher& search) {
  const double loose = search.fraction(search.loosest());
  const double dense = search.fraction(search.densest());
  std::string other;
  if (target.measure != DensityMeasure::solid_fraction)
    other = fmt::format(" ({} from {:.4g} to {:.4g})", to_string(target.measure), target.measured(loose, grain_density),
                        target.measured(dense, grain_density));
  const bool denser = search.loosest().off < 0.0;
  throw DensityNotReached(fmt::format(
      "{} cannot be reached: sample {} packs to solid fractions from {} with friction {:g} while packed to {} "
      "without{}; {}",
      target.text(grain_density), sample, fraction_text(loose), search.loosest().friction, fraction_text(dense), other,
      denser ? "a wider span of sizes, or preparation = \"dense\" without a target, packs more densely"
             : "a larger compaction_mu, or rolling resistance (mu_r), packs more loosely"));
}

[[noreturn]] void not_met(const DensityTarget& target, double grain_density, std::int64_t sample,
                          const DensitySearcher& search) {
  const double nearest = search.fraction(search.nearest());
  throw DensityNotReached(fmt::format(
      "{} was not met in {} preparations of sample {}: the nearest was {} with compaction_mu = {:.6g}. Packings of few "
      "particles jump with friction: more particles, or solid_fraction_tolerance = {:.1g}",
      target.text(grain_density), search.tries(), sample, fraction_text(nearest), search.nearest().friction,
      1.5 * std::abs(search.nearest().off)));
}

}  // namespace

double DensityTarget::solid_fraction(double density) const {
  if (measure == DensityMeasure::void_ratio) return 1.0 / (1.0 + value);
  return measure == DensityMeasure::dry_density ? value / density : value;
}

double DensityTarget::measured(double solid_fraction, double density) const {
  if (measure == DensityMeasure::void_ratio) return 1.0 / solid_fraction - 1.0;
  return measure == DensityMeasure::dry_density ? solid_fraction * density : solid_fraction;
}

std::string DensityTarget::text(double density) const {
  if (measure == DensityMeasure::solid_fraction) return fmt::format("solid_fraction = {:g} +- {:g}", value, tolerance);
  return fmt::format("{} = {:g}{} (solid fraction {} +- {:g})", to_string(measure), value,
                     measure == DensityMeasure::dry_density ? " kg/m^3" : "", fraction_text(solid_fraction(density)),
                     tolerance);
}

MacroPacking pack_to_density(const DensityTarget& target, double grain_density, double largest_friction,
                             std::int64_t sample, const std::function<MacroPacking(double friction)>& prepare) {
  DensitySearcher search(target.solid_fraction(grain_density), target.tolerance, largest_friction, prepare);
  if (search.attempt(largest_friction) || search.attempt(0.0)) return search.take();
  if (!search.can_go_on()) out_of_reach(target, grain_density, sample, search);
  while (search.can_go_on())
    if (search.attempt(search.next())) return search.take();
  not_met(target, grain_density, sample, search);
}

}  // namespace softgrain

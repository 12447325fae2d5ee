#include "microsim/powder/powder_analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace softgrain {

namespace {

/// Clusters (union-find) whose members know how many periods their place in the unwrapped cluster is from their own.
class PeriodicClusters {
 public:
  explicit PeriodicClusters(std::size_t disks) : parent_(disks), size_(disks, 1), offset_(disks), wraps_(disks) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  using Wraps = std::array<bool, 2>;

  /// i meets the image of j that is `steps` periods away. Answers along which axes the cluster meets itself now.
  Wraps join(std::size_t i, std::size_t j, const Vec<2>& steps) {
    const Place a = place(i);
    const Place b = place(j);
    const Vec<2> between = a.offset + steps - b.offset;  // of the root of j against the root of i
    if (a.root == b.root) return note(a.root, {between[0] != 0.0, between[1] != 0.0});
    const bool below = size_[a.root] < size_[b.root];
    const std::size_t root = below ? b.root : a.root;
    const std::size_t child = below ? a.root : b.root;
    parent_[child] = root;
    offset_[child] = below ? -between : between;
    size_[root] += size_[child];
    return note(root, wraps_[child]);
  }

 private:
  struct Place {
    std::size_t root;
    Vec<2> offset;
  };
  [[nodiscard]] Place place(std::size_t k) const {
    Vec<2> offset{};
    for (; parent_[k] != k; k = parent_[k]) offset += offset_[k];
    return {k, offset};
  }
  Wraps note(std::size_t root, const Wraps& more) {
    for (std::size_t k = 0; k < 2; ++k) wraps_[root][k] = wraps_[root][k] || more[k];
    return wraps_[root];
  }

  std::vector<std::size_t> parent_;
  std::vector<std::size_t> size_;
  std::vector<Vec<2>> offset_;  ///< against the parent, in periods
  std::vector<Wraps> wraps_;    ///< per root, the axes along which its cluster wraps
};

}  // namespace

PowderAnalysis analyse_powder(const System<2>& system, const PowderSpec& spec, double pressure, bool rigidity) {
  PowderAnalysis out;
  out.zero = kPowderZeroForce;
  out.contacts = powder_contacts(system, out.zero, spec.cohesive);
  out.pairs = powder_interactions(system, out.zero);
  out.forces = powder_forces(out.pairs, out.zero);
  out.percolation = powder_percolation(system, out.pairs);
  if (rigidity) out.rigidity = powder_rigidity(system, out.pairs, spec.cohesive);
  out.moduli = powder_moduli(system, out.pairs);
  out.solid_fraction_3d = 4.0 / (3.0 * std::sqrt(std::numbers::pi)) * std::pow(powder_fraction(system), 1.5);
  if (pressure > 0.0 && !out.pairs.empty()) out.rumpf_ratio = out.contacts.rumpf_pressure / pressure;
  return out;
}

PowderPercolation powder_percolation(const System<2>& system, const std::vector<PowderInteraction>& pairs) {
  std::vector<const PowderInteraction*> falling;
  for (const auto& pair : pairs) falling.push_back(&pair);
  std::stable_sort(falling.begin(), falling.end(),
                   [](const auto* a, const auto* b) { return a->force() > b->force(); });
  PeriodicClusters clusters(static_cast<std::size_t>(system.particles.grains));
  PowderPercolation out;
  const auto first = [](std::optional<double>& threshold, bool reached, double force) {
    if (reached && !threshold) threshold = force;
  };
  for (const auto* pair : falling) {
    const auto wraps =
        clusters.join(static_cast<std::size_t>(pair->i), static_cast<std::size_t>(pair->j), winding(system, *pair));
    first(out.x, wraps[0], pair->force());
    first(out.y, wraps[1], pair->force());
    first(out.either, wraps[0] || wraps[1], pair->force());
    first(out.both, wraps[0] && wraps[1], pair->force());
  }
  return out;
}

}  // namespace softgrain

#include "microsim/powder/rigidity_matrix.h"

#include <stdexcept>

namespace softgrain {

namespace {

template <bool kFriction, bool kRolling>
PairStiffness stiffness_of(const CohesiveDisk<kFriction, kRolling>& law) {
  PairStiffness k;
  k.normal = law.normal;
  if (kFriction && law.friction > 0.0) k.tangential = law.tangential;
  if (kRolling && law.rolling_limit > 0.0) k.rolling = law.rolling;
  if (law.adhesion > 0.0) k.distant = -law.adhesion / law.range;
  return k;
}

template <class Law>
PairStiffness stiffness_of(const Law&) {
  throw std::logic_error("rigidity: not a law of cohesive disks");
}

class Builder {
 public:
  Builder(const System<2>& system, const std::vector<bool>& keep, CellMotions cell)
      : system_(system), k_(pair_stiffness(system)), strains_(static_cast<int>(cell)) {
    out_.per_disk = k_.tangential > 0.0 ? 3 : 2;
    for (const bool kept : keep) {
      first_.push_back(kept ? columns_ : -1);
      if (kept) columns_ += out_.per_disk;
    }
    out_.disk_columns = columns_;
    out_.entries.columns = columns_ + strains_;
  }

  void add(const PowderInteraction& pair) {
    if (first(pair.i) < 0 || first(pair.j) < 0) return;
    ++(pair.distant ? out_.distant : out_.contacts);
    displacement(pair, pair.normal, 0.0, 0.0, pair.distant ? k_.distant : k_.normal);
    if (pair.distant) return;
    if (k_.tangential > 0.0)
      displacement(pair, {{-pair.normal[1], pair.normal[0]}}, -pair.arm_i, -pair.arm_j, k_.tangential);
    if (k_.rolling > 0.0) rolling(pair);
  }

  RigidityMatrix take() { return std::move(out_); }

 private:
  [[nodiscard]] std::int64_t first(Slot disk) const { return first_[static_cast<std::size_t>(disk)]; }
  [[nodiscard]] double radius(Slot disk) const { return system_.particles.sphere[static_cast<std::size_t>(disk)].r; }
  void put(std::int64_t column, double value) {
    if (value != 0.0) out_.entries.entries.push_back({out_.entries.rows, column, value});
  }
  void close_row(double stiffness) {
    out_.stiffness.push_back(stiffness);
    ++out_.entries.rows;
  }

  /// Displacement of i against j along `axis`, where turning by theta moves the contact point by `turn` theta.
  void displacement(const PowderInteraction& pair, const Vec<2>& axis, double turn_i, double turn_j, double stiffness) {
    Vec<2> periods = winding(system_, pair);
    for (int k = 0; k < 2; ++k) {
      periods[k] *= system_.cell.edges[k][k];
      put(first(pair.i) + k, axis[k]);
      put(first(pair.j) + k, -axis[k]);
      if (strains_ > 0) put(columns_ + k, axis[k] * periods[k]);
    }
    if (strains_ > 2) put(columns_ + 2, 0.5 * (axis[0] * periods[1] + axis[1] * periods[0]));
    if (turn_i != 0.0) put(first(pair.i) + 2, turn_i / radius(pair.i));
    if (turn_j != 0.0) put(first(pair.j) + 2, turn_j / radius(pair.j));
    close_row(stiffness);
  }
  void rolling(const PowderInteraction& pair) {
    put(first(pair.i) + 2, 1.0 / radius(pair.i));
    put(first(pair.j) + 2, -1.0 / radius(pair.j));
    close_row(k_.rolling);
  }

  const System<2>& system_;
  PairStiffness k_;
  int strains_;
  std::int64_t columns_ = 0;  ///< columns of all disks
  std::vector<std::int64_t> first_;
  RigidityMatrix out_;
};

}  // namespace

PairStiffness pair_stiffness(const System<2>& system) {
  return std::visit([](const auto& law) { return stiffness_of(law); }, system.laws.law(system.laws.index(0, 0)));
}

RigidityMatrix rigidity_matrix(const std::vector<PowderInteraction>& pairs, const System<2>& system,
                               const std::vector<bool>& keep, CellMotions cell) {
  Builder builder(system, keep, cell);
  for (const PowderInteraction& pair : pairs) builder.add(pair);
  return builder.take();
}

}  // namespace softgrain

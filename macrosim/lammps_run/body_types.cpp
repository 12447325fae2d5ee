#include "macrosim/lammps_run/body_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace softgrain::lammps {

namespace {

/// 0 for radii in (largest/2, largest], 1 for the next octave below...
int size_class(double r, double largest) { return static_cast<int>(std::floor(std::log2(largest / r))); }

std::string range(std::int32_t first, std::int32_t count) {
  if (count == 0) return "";
  return count == 1 ? fmt::format("{}", first) : fmt::format("{}*{}", first, first + count - 1);
}

/// Types of one kind of bodies, from `first` on; returns how many.
std::int32_t add_kind(const MacroPacking& packing, bool soft, std::int32_t first, BodyTypes& types) {
  double largest = 0.0;
  for (const MacroBody& b : packing.bodies)
    if (b.soft == soft) largest = std::max(largest, b.r);
  std::map<int, double> classes;  // largest radius of each
  for (const MacroBody& b : packing.bodies) {
    if (b.soft != soft) continue;
    double& of_class = classes[size_class(b.r, largest)];
    of_class = std::max(of_class, b.r);
  }
  std::map<int, std::int32_t> type;
  for (const auto& [size, radius] : classes) {
    type[size] = first + static_cast<std::int32_t>(type.size());
    types.largest.push_back(radius);
  }
  for (std::size_t k = 0; k < packing.bodies.size(); ++k)
    if (packing.bodies[k].soft == soft) types.of[k] = type.at(size_class(packing.bodies[k].r, largest));
  return static_cast<std::int32_t>(type.size());
}

}  // namespace

std::string BodyTypes::solid_range() const { return range(1, solid); }
std::string BodyTypes::soft_range() const { return range(solid + 1, soft); }

BodyTypes body_types(const MacroPacking& packing) {
  BodyTypes types;
  types.of.assign(packing.bodies.size(), 0);
  types.solid = add_kind(packing, false, 1, types);
  types.soft = add_kind(packing, true, types.solid + 1, types);
  return types;
}

}  // namespace softgrain::lammps

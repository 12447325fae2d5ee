// Grains that meet lie near each other in memory: small ones first, each size class along a space-filling curve.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/system.h"

namespace softgrain {

/// Size class of a grain: classes double the radius, from the smallest one on.
inline int size_class(double radius, double smallest) { return std::ilogb(radius / smallest); }

/// The order that a system of many grains runs best in: order[k] is the slot of the grain that should come k-th. Size
/// classes halve the radius, the finest first (a grain looks for partners in its own class and coarser ones, so pairs
/// come out sorted); within a class along the Morton curve of the cell.
template <int D>
std::vector<Slot> spatial_order(const System<D>& system);

/// Equal stretches of that curve.
inline constexpr std::size_t kCurveParts = 4096;

/// The stretch of the curve that each grain and shell lies in.
template <int D>
std::vector<std::uint16_t> curve_parts(const System<D>& system);

/// Puts the grains into that order, with everything that goes by slot: state, margins, pairs and their histories. Which
/// grain is which stays in Particles::id. Forces are sums in list order, so that their last bits may change at the next
/// pass.
template <int D>
void reorder_grains(System<D>& system, const std::vector<Slot>& order);

/// Back to the order in which the grains were added.
template <int D>
void restore_order(System<D>& system);

/// Slot of every grain by its number, as it was added.
template <int D>
std::vector<Slot> slots_by_id(const Particles<D>& particles);

}  // namespace softgrain

// Who bears the load in a packing of grains: coarse ones, fine ones, or none.
#pragma once

#include <string>

#include "macrosim/macro_system.h"

namespace softgrain {

/// Names of the columns of MacroCurve::more, of a split at `split` of the largest radius.
enum class Bearers { coarse_coarse, coarse_fine, fine_fine };

template <>
inline constexpr auto enum_names<Bearers> = enum_name_list<Bearers>({{Bearers::coarse_coarse, "coarse-coarse"},
                                                                     {Bearers::coarse_fine, "coarse-fine"},
                                                                     {Bearers::fine_fine, "fine-fine"}});

inline constexpr const char* kSolidFraction = "solid_fraction";
inline constexpr const char* kRattlers = "rattlers";
std::string share_name(Bearers bearers, double split);

/// Contacts that a grain needs, to grains that do not rattle, so that it does not: four, with friction two.
inline int contacts_that_hold(const MacroSpec& spec) { return spec.friction > 0.0 ? 2 : 4; }

/// Appends a point to curve.more: the solid fraction (full volume of every grain, overlaps twice, over that of the
/// cell), the share of the grains that rattle, and of the mean stress the shares that contacts between coarse and fine
/// grains carry (their virials over that of all; walls count with neither). A grain rattles with fewer than
/// contacts_that_hold().
void record_grains(const MacroSystem& macro, const MacroSpec& spec, MacroCurve& curve);

}  // namespace softgrain

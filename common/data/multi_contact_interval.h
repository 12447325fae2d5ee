// How sure a law of a table is, and up to where it was measured.
#pragma once

#include <optional>
#include <vector>

#include "common/data/law_band.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// Fewer replicates than this say nothing of an interval.
inline constexpr std::size_t kEnoughReplicates = 10;

/// Largest overlap over Rs that was measured with neighbours of this kind and radius (over Rs; not of planes), from the
/// row of the nearest ratio.
double measured_overlap(const LawTableEntry& entry, LawForm form, PartnerKind partner, double ratio);

/// 95 % interval of a number of a law above 0, from what the refits to drawn packings give in its place; widened for
/// few packings. Empty with fewer than ten refits.
std::optional<LawInterval> refit_interval(double value, const std::vector<double>& refits, int packings);

}  // namespace softgrain

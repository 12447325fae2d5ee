// What a reader of fitted laws should know, in words that program, report and checks share.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// "friction limit and kt/kn: 0.22, 0.21 against planes; not measured against solid spheres (0.22, 0.21 stand in);
/// ...".
std::string slides_text(const LawTableEntry& entry);

/// What to know of the tangential stiffnesses of a card: that they come from a frozen turn, and what runs take where
/// none was measured; empty: all were, by a slow turn or in an experiment.
std::string kt_remark(const LawCard& card);

/// "unloading is 1.16 times as steep as loading", or that it was not measured.
std::string unloading_text(const LawTableEntry& entry);

/// What a pair law misses: force of a soft particle with several neighbours over that of its pair law, from two
/// opposite planes to twelve small spheres, and among soft particles, as measured for results/law_table.
inline constexpr double kPairLawMissesLeast = 2.2;
inline constexpr double kPairLawMissesMost = 12.0;
inline constexpr double kPairLawMissesAmongSoft = 43.0;
std::string pair_law_remark();

/// Whether curves were made with a law of single contacts.
bool use_pair_law(const std::vector<MacroCurve>& curves);

}  // namespace softgrain

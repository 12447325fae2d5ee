// Error bars through levels: how the law of a level follows that of the level below, and what the uncertainty of that
// one adds to its own.
#pragma once

#include <vector>

#include "common/data/multi_contact_law.h"

namespace softgrain {

/// One plane from each side, along the axes.
std::vector<MultiContactPartner> six_planes();

/// How strong a law is: geometric mean of the forces of one plane at `overlap` and of six planes at two thirds of it.
double law_strength(const MultiContactLaw& law, double overlap);

/// Overlap over Rs from which a soft particle bears between six planes; `most` when it bears nothing up to there.
double law_onset(const MultiContactLaw& law, double most);

/// The table with all forces times `factor`.
LawTableEntry scaled_law(LawTableEntry entry, double factor);

/// How much a draw of the law below makes of this one: strength over that of the fit, to the power of `sensitivity`.
std::vector<double> strength_draws(const LawTableEntry& below, LawForm form, double sensitivity);

/// Every replicate of every law times one draw, turn by turn; standard error and interval of `a` follow.
void spread(LawTableEntry& entry, const std::vector<double>& draws);

/// Relative standard deviation of the strength over the replicates; NaN with fewer than two.
double strength_error(const LawTableEntry& entry, LawForm form);

}  // namespace softgrain

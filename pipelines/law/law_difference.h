// Two laws side by side over the range that both were measured in.
#pragma once

#include <string>
#include <vector>

#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_values.h"

namespace softgrain::law {

struct DifferenceRow {
  double delta = 0.0;
  Quantity a;
  Quantity b;
  double relative = 0.0;  ///< b/a - 1; NaN where a is zero
  bool known = false;     ///< whether at least one of both has an interval
  bool within = false;    ///< |b - a| below the root of the squares of both half intervals
};

/// One quantity of one kind of pair.
struct LawDifference {
  std::string pair;      ///< "soft-solid" or "soft-soft"
  std::string quantity;  ///< "F/(E Rs^2)", "kt/(E Rs) initial", "kt/(E Rs) secant"
  double low = 0.0;      ///< common range of Delta
  double high = 0.0;
  std::vector<DifferenceRow> rows;  ///< overlaps at which at least one of both is not zero
  double root_mean_square = 0.0;    ///< root mean square of (b - a) over that of a
  double largest = 0.0;             ///< largest |b - a| over the largest a
};

/// Every quantity that both files have, at `points` overlaps over the common range. A table stands for one plane
/// (soft-solid) and one equal soft neighbour (soft-soft), by its best law at compared_fraction(). Empty when nothing is
/// common.
std::vector<LawDifference> law_differences(const FittedLaw& a, const FittedLaw& b, std::size_t points = 9);

/// The solid fraction at which a table is compared with another law: that of the entry whose packings were drawn like
/// those of the other card (same beta, trials), or lies nearest to the other table's first entry; else the first. 0 for
/// a card.
double compared_fraction(const FittedLaw& file, const FittedLaw& other);

/// Tables and a plot for a terminal.
std::string differences_text(const FittedLaw& a, const FittedLaw& b, const std::vector<LawDifference>& differences,
                             bool utf8);

}  // namespace softgrain::law

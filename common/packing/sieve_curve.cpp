// The grading through the points of a curve of what passes, and what is wrong with points that are none.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/packing/sieve_table.h"

namespace softgrain {

namespace {

std::string percent_of_curve(double share) { return percent_text(share, {6}); }

/// What passing that falls may be instead, from the smallest sieve to the largest.
std::string guess(const std::vector<SieveRow>& rows) {
  if (std::is_sorted(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.passing > b.passing; }))
    return ": this looks like what is retained in all; passing is 100 % less that";
  double sum = 0.0;
  for (const SieveRow& row : rows) sum += row.passing;
  if (std::abs(sum - 1.0) > 0.02) return "";
  return ": all add up to 100 %, which looks like what each sieve retains; passing is the sum of what finer sieves "
         "retain";
}

}  // namespace

Grading sieve_grading(std::vector<SieveRow> rows, int dimension, const std::string& what_to_do) {
  std::stable_sort(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.opening < b.opening; });
  std::vector<double> radius;
  std::vector<double> passing;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const SieveRow& before = rows[k == 0 ? 0 : k - 1];
    const SieveRow& row = rows[k];
    if (k > 0 && row.opening == before.opening)
      throw InputError(
          fmt::format("{}: the sieve of {:g} mm is there twice ({})", row.where, 1e3 * row.opening, before.where));
    if (row.passing < before.passing - kSieveRounding)
      throw InputError(fmt::format("{}: passing falls to {} on a wider sieve ({}: {}){}", row.where,
                                   percent_of_curve(row.passing), before.where, percent_of_curve(before.passing),
                                   guess(rows)));
    radius.push_back(0.5 * row.opening);
    passing.push_back(std::max(row.passing, before.passing));
  }
  if (rows.empty() || (rows.size() < 2 && what_to_do.empty()))
    throw InputError("a sieve curve needs at least two sieves");
  for (const auto& [row, wanted] : {std::pair{rows.front(), 0.0}, std::pair{rows.back(), 1.0}})
    if (row.passing != wanted)
      throw InputError(fmt::format("{}: the curve goes from {} to {}; it must go from 0 to 100 %: add the {} grains{}",
                                   row.where, percent_of_curve(rows.front().passing),
                                   percent_of_curve(rows.back().passing),
                                   wanted == 0.0 ? "size that is below all" : "size that is above all", what_to_do));
  if (rows.size() < 2) throw InputError("a sieve curve needs at least two sieves");
  return Grading::sieve_curve(radius, passing, dimension);
}

}  // namespace softgrain

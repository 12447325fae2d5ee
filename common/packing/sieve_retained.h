// What passes, from what sieves retain: on each of them, or in all down to each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/packing/sieve_columns.h"

namespace softgrain {

struct RetainedRow {
  double opening = 0.0;  ///< [m]
  double upper = 0.0;    ///< the other end of a class [m]; 0: none
  double value = 0.0;    ///< a mass in any unit, or a share
  std::string where{};   ///< "file:line"
  std::string cell{};    ///< the value as written
};

struct RetainedTable {
  std::string where_header{};  ///< "file:line: "
  std::string title{};         ///< of the column
  SieveMeasure measure = SieveMeasure::unknown;
  std::vector<RetainedRow> rows{};  ///< from the coarsest sieve to the finest
  std::optional<RetainedRow> pan{};
  std::optional<double> total{};  ///< of a line below the table, in the unit of the values
};

struct RetainedCurve {
  SieveColumn meaning = SieveColumn::other;  ///< passing, retained or cumulative
  std::vector<double> passing{};             ///< of every row
  std::vector<std::string> remarks{};
};

/// `meaning` may be unclear or running; then the numbers decide:
/// - what falls from a sieve to a finer one is retained on each sieve;
/// - what adds up to 100 % (within 1 %; masses: to the total below the table, within 2 %) is retained on each sieve;
/// - what rises to 100 % on the finest sieve or the pan (or to that total) is cumulative;
/// - where both hold, the nearer one.
/// Throws InputError where neither holds, with the key that decides, and where sums contradict a total.
RetainedCurve passing_of_retained(const RetainedTable& table, SieveColumn meaning);

}  // namespace softgrain

// Sieve analyses as files of laboratories: what passes, what is retained on each sieve or in all, by mass or in
// percent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/packing/grading.h"

namespace softgrain {

/// What a scene says beside the file.
struct SieveOptions {
  std::string column{};              ///< see choose_sieve_columns(); empty: as the titles say
  std::string unit{};                ///< of sizes, as sieve_unit() gives it; empty: as the file says
  std::optional<double> smallest{};  ///< diameter below all grains [m], where the finest sieve lets some pass
  std::optional<double> largest{};   ///< diameter above all grains [m], where the coarsest sieve retains some
};

/// A point of a curve of what passes.
struct SieveRow {
  double opening = 0.0;  ///< [m]
  double passing = 0.0;  ///< 0 to 1
  std::string where{};   ///< "file:line"
};

struct SieveCurve {
  Grading grading;
  std::string columns{};               ///< what was read of the file, in words
  std::vector<SieveRow> rows{};        ///< from the finest sieve to the coarsest
  std::vector<std::string> remarks{};  ///< what was taken for granted
};

/// Shares that differ by less are the same: sums of percents that a spreadsheet rounded.
inline constexpr double kSieveRounding = 1e-9;

/// The grading through rows in any order; `what_to_do` goes on with a complaint about an end that is missing. Throws
/// InputError.
Grading sieve_grading(std::vector<SieveRow> rows, int dimension, const std::string& what_to_do = "");

/// Reads a file of the forms that pipelines/guide/sizes.md lists. What the titles leave open is taken from the numbers
/// where they allow one reading only. Throws InputError, with the one key that decides; IoError.
SieveCurve read_sieve_file(const std::string& path, const SieveOptions& options = {}, int dimension = 3);

/// Whether a file has a header of a sieve analysis. Throws IoError.
bool is_sieve_file(const std::string& path);

}  // namespace softgrain

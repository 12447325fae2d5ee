// Sizes of sieves as laboratories write them: numbers with units, ASTM numbers and inches, phi, classes, the pan.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace softgrain {

/// What one cell says of the size of a sieve.
struct SieveSize {
  enum class Kind { none, sieve, pan };
  Kind kind = Kind::none;
  std::string number{};  ///< with a decimal point, or a fraction as "1 1/2"; empty for a pan without a size
  std::string upper{};   ///< the other end of a class "0.5 - 1"; empty: none
  std::string unit{};    ///< as sieve_unit() gives it; empty: that of the column
};

/// The unit of length of this word: "mm", "um", "in", "phi", "astm" (numbers of ASTM E11), "mesh", or any other that
/// scenes know, as they write it. Empty: it is none.
std::string sieve_unit(const std::string& word);
inline constexpr const char* kAstmNumbers = "astm";  ///< numbers of sieves of ASTM E11
inline constexpr const char* kMesh = "mesh";         ///< of ASTM E11 or of Tyler
inline constexpr const char* kInches = "in";
inline constexpr const char* kPhi = "phi";  ///< -log2 of millimetres

/// Reads a cell with plain numbers (csv::plain_numbers). Kind::none for what is no size: a line below the table.
SieveSize sieve_size(const std::string& cell);

/// Whether a cell as written is a size with its unit or a mass: "No. 4", "3/8 in.", "4,75 mm", "150 g"; not "Test No.
/// 3", a title, nor "12/2026" or "EN 933", which have no unit.
bool is_sieve_or_mass(std::string cell);

/// Diameter [m] of `number` in this unit. Inches that are a fraction, or `nominal`, are names of ASTM E11: 3/8 in. is
/// the sieve of 9.5 mm; phi is -log2 of mm. Throws InputError.
double sieve_diameter(const std::string& number, const std::string& unit, bool nominal = false);

/// The unit that numbers without one must have; none where they could be of several. In mm where all are openings of
/// ISO 565 in mm and one is below 0.1 mm, which no sieve has in inches; in um where all are openings of ISO 565 in um
/// and one is above 125, which no sieve has in mm; never where all may be numbers of ASTM E11 or mesh.
std::optional<std::string> unit_of_numbers(const std::vector<std::string>& numbers);

/// Whether these mesh numbers are those of ASTM E11 in every series that has them, or one is in no other series
/// (Tyler).
bool are_astm_numbers(const std::vector<std::string>& numbers);

}  // namespace softgrain

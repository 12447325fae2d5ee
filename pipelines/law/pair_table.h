// Laws as tables of energy and force over distance: what other programs read as a pair potential.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/law/fitted_law.h"

namespace softgrain::law {

struct PairTableChoice {
  std::vector<PairKind> kinds{};          ///< empty: every usable one
  std::vector<double> ratios{1.0};        ///< radius of the other body over that of the soft particle
  std::size_t rows = 1001;                ///< values per table, at least 2
  double modulus = 0.0;                   ///< E [Pa]
  double radius = 0.0;                    ///< R of the soft particle [m]
  std::optional<double> delta_max{};      ///< deepest overlap; empty: the end of the measured range
  std::optional<Extrapolation> beyond{};  ///< policy beyond the range, instead of that of the law
  WantedForm form{};                      ///< form of the law of a table
  std::optional<double> solid_fraction{};
  RangePolicy range = RangePolicy::reject;
};

/// Energy and force of one pair of bodies of fixed radii, r ascending from the deepest overlap to touch. SI units.
struct PairTable {
  std::string keyword;  ///< "SOFT_SOLID_1", "SOFT_SOFT_0.5": kind and ratio
  std::string meaning;  ///< one line
  double soft_radius = 0.0;
  double other_radius = 0.0;
  std::vector<double> r;       ///< distance of the centres [m], even steps
  std::vector<double> energy;  ///< [J], zero at touch
  std::vector<double> force;   ///< -dE/dr [N]
  double slope_low = 0.0;      ///< dF/dr at the first r [N/m]
};

/// Conservative normal forces of two bodies alone. Soft-solid pairs of a card: Delta = h/R; soft-soft pairs: h over the
/// smaller radius [SP 1.6]. Of a table: the single contact, whose lost volume knows the ratio of the radii. Throws
/// InputError: no usable law, `delta_max` beyond the range of a law that refuses that, an overlap that reaches a
/// centre.
std::vector<PairTable> pair_tables(const FittedLaw& file, const PairTableChoice& choice);

/// The file of LAMMPS' pair_style table, `units si`: one section per pair, keyword first. `head` goes into comments.
std::string lammps_text(const std::vector<PairTable>& tables, const std::vector<std::string>& head);

}  // namespace softgrain::law

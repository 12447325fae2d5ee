// A card of the cell law: what was measured of fines, and of coarse grains among them, with where it holds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/limits.h"
#include "common/core/material.h"
#include "common/data/law_card.h"

namespace softgrain {

/// porosity: p/E = K x^n, x = (phi - phi_J)/(1 - phi_J). pores: p/E = K (1 - Vp/Vp_J)^n, Vp/Vp_J = e/e_J of the void
/// ratios e = (1 - phi)/phi (the form that adds over volumes; K, n and onsets of its own).
enum class StateForm { porosity, pores };

template <>
inline constexpr auto enum_names<StateForm> = enum_name_list<StateForm>({{StateForm::porosity, "porosity"},
                                                                         {StateForm::pores, "pores"}});

/// What shear leaves behind in cells (ShearMemory of macrosim/cell_matter).
struct CellMemory {
  Estimate dilatancy;       ///< A: compaction by slip beyond what friction uses of the work
  Estimate critical_pores;  ///< r_c: pores at the critical state over those where the card's preparation jams
  Estimate strength_slope;  ///< m: growth of the strength of faces with density
  Estimate strength_range;  ///< c: strengths lie within mu_f (1 -+ c)
  Estimate density_slope;   ///< lambda: change of the critical state with phi - phi_J
  Estimate least_state;     ///< x_r: shear compacts no cell below this state
};

/// How the errors of numbers of a card go together, for draws of the whole law. Numbers that are not there have errors
/// of their own alone, or none that is known.
struct CellCorrelation {
  std::vector<std::string> numbers;  ///< keys of numbers_of()
  std::vector<double> matrix;        ///< row by row; of logarithms, where CellCardNumber::logarithm says so
};

/// Void ratios of the same grains where they jam in another preparation, over those in the preparation of the card.
/// Void ratios factorise into one of the grading and one of the preparation: the factor of the fines is that of their
/// mixtures with coarse grains too (within 0.003 in solid fraction for power laws of spans 3 to 12, 0.007 for dense
/// packings of other gradings: results/material_law/notes.md).
struct PreparationFactor {
  std::string preparation;
  Estimate factor;
};

/// Largest A of shear memory with this c, (1 + c)/c: beyond, slip of the strongest faces would give energy back.
constexpr double most_dilatancy(double strength_range) { return (1.0 + strength_range) / strength_range; }

/// Numbers of the cell law (macrosim/cell_matter), dimensionless, and what they were measured on.
struct CellCard {
  StateForm form = StateForm::porosity;
  Estimate modulus;        ///< K: p = E K x^n
  Estimate exponent;       ///< n
  Estimate void_ratio;     ///< e_J of the fines alone where they jam
  Estimate excess_alone;   ///< e_c: void ratio of the coarse grains alone where they jam
  Estimate excess_many;    ///< w_inf: pores beside coarse grains over their volume, many fines
  Estimate excess_decay;   ///< xi, of V_f/V_c
  Estimate friction;       ///< mu_f of faces
  Estimate stiffness;      ///< chi of faces
  Estimate lateral_ratio;  ///< K0 of the fines alone, mean over the oedometer
  /// With it mu_f is the strength at the critical state and chi the stiffness before any slip; none: as in earlier
  /// versions, one spring a face and cells that forget.
  std::optional<CellMemory> memory;
  CellCorrelation correlation;                  ///< empty: not known (cards of earlier versions)
  std::vector<PreparationFactor> preparations;  ///< other preparations, for starts from the density
  // Where it holds.
  double pressure_low = 0.0;  ///< p/E of the fit
  double pressure_high = 0.0;
  double mixture_high = 0.0;  ///< largest V_f/V_c measured; the smallest is 0
  // Measured on grains and a preparation of these; another one has other numbers.
  double youngs_modulus = kNaN;  ///< E [Pa]; NaN: the card does not say (older ones)
  double density = kNaN;         ///< density of the grains, mean over their solid volume [kg/m^3]; NaN: not said
  double poisson_ratio = 0.0;
  double grain_friction = 0.0;
  RollingResistance grain_rolling{};
  std::string preparation;      ///< its name
  double start_pressure = 0.0;  ///< p/E of its end
  double split = 0.0;           ///< largest radius of fines over largest of coarse grains
  double fines_ratio = 0.0;     ///< largest over smallest radius of the fines
  std::string fines_sizes;      ///< size distribution of the fines, in words
  std::int64_t samples = 0;     ///< number of samples of each measurement
};

/// A number of a card under its key there.
struct CellCardNumber {
  std::string key;
  Estimate estimate;
  std::string meaning;
  bool logarithm = false;  ///< whether its errors are of its logarithm
  bool is_drawn = true;    ///< whether runs take it and the material has it: x_r is of the solution, no run takes K0
};

/// All numbers of a card in the order of the file; those of the memory, if it has one, at the end.
std::vector<CellCardNumber> numbers_of(const CellCard& card);

/// Changes the number of this key, as near to `value` as the card allows. Throws InputError for another key.
void set_number(CellCard& card, const std::string& key, double value);

/// Factor on e_J, e_c and w_inf for grains of this preparation: 1 for that of the card and for an empty name; empty
/// where the card has none.
std::optional<double> void_ratio_factor(const CellCard& card, const std::string& preparation);

/// What to say where void_ratio_factor() is empty: what the card was measured on, and what measures the factor.
std::string missing_factor_text(const CellCard& card, const std::string& preparation);

/// What the number of this key means; empty for another key.
std::string meaning_of_cell_number(const std::string& key);

/// Writes the card as TOML, for people and for read_cell_card(), which gives the same bits. Atomic. Throws IoError.
void write_cell_card(const CellCard& card, const std::string& path, const Provenance& provenance = build_provenance());

/// Throws InputError with file and line for keys that are missing or unknown, numbers that are none of a law and
/// intervals whose ends are the wrong way round; IoError.
CellCard read_cell_card(const std::string& path);
CellCard read_cell_card(const Scene& file);

}  // namespace softgrain

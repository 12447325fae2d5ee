// A card of the cell law: what was measured of fines, and of coarse grains among them, with where it holds.
#pragma once

#include <cstdint>
#include <string>

#include "common/core/enum_names.h"
#include "common/core/limits.h"
#include "common/data/law_card.h"

namespace softgrain {

/// porosity: p/E = K x^n, x = (phi - phi_J)/(1 - phi_J). pores: p/E = K (1 - Vp/Vp_J)^n, Vp/Vp_J = e/e_J of the void
/// ratios e = (1 - phi)/phi (the form that adds over volumes; K, n and onsets of its own).
enum class StateForm { porosity, pores };

template <>
inline constexpr auto enum_names<StateForm> = enum_name_list<StateForm>({{StateForm::porosity, "porosity"},
                                                                         {StateForm::pores, "pores"}});

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
  // Where it holds.
  double pressure_low = 0.0;  ///< p/E of the fit
  double pressure_high = 0.0;
  double mixture_high = 0.0;  ///< largest V_f/V_c measured; the smallest is 0
  // Measured on grains and a preparation of these; another one has other numbers.
  double youngs_modulus = kNaN;  ///< E [Pa]; NaN: the card does not say (older ones)
  double density = kNaN;         ///< density of the grains, mean over their solid volume [kg/m^3]; NaN: not said
  double poisson_ratio = 0.0;
  double grain_friction = 0.0;
  std::string preparation;      ///< its name
  double start_pressure = 0.0;  ///< p/E of its end
  double split = 0.0;           ///< largest radius of fines over largest of coarse grains
  double fines_ratio = 0.0;     ///< largest over smallest radius of the fines
  std::string fines_sizes;      ///< size distribution of the fines, in words
  std::int64_t samples = 0;     ///< number of samples of each measurement
};

/// Writes the card as TOML, for people and for read_cell_card(), which gives the same bits. Atomic. Throws IoError.
void write_cell_card(const CellCard& card, const std::string& path, const Provenance& provenance = build_provenance());

/// Throws InputError with file and line for keys that are missing or unknown, numbers that are none of a law and
/// intervals whose ends are the wrong way round; IoError.
CellCard read_cell_card(const std::string& path);
CellCard read_cell_card(const Scene& file);

}  // namespace softgrain

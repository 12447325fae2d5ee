// How much each cell holds at the start: fines and excess pores, from a start pressure or from the density.
#pragma once

#include <vector>

#include "common/core/particles.h"
#include "macrosim/cell_matter/equation_of_state.h"

namespace softgrain {

/// Pores that fines leave beside coarse grains beyond their own, in a mixture of solid volumes V_f and V_c:
/// W = V_c [w_inf + (e_c - w_inf) exp(-(V_f/V_c)/xi)]. Without fines the pores of the coarse grains alone (e_c V_c),
/// with many a layer at every grain (w_inf V_c).
struct ExcessPores {
  double alone = 0.0;  ///< e_c: void ratio of the coarse grains alone where they jam
  double many = 0.0;   ///< w_inf
  double decay = 0.0;  ///< xi > 0

  [[nodiscard]] double volume(double fines, double coarse) const;
};

/// What is known of the fines and their mixtures; measured on fines that were prepared as the material is.
struct FinesLaw {
  EquationOfState equation;
  double void_ratio = 0.0;  ///< e_J of the fines alone where they jam
  ExcessPores excess;
  double critical_pores = 0.0;  ///< r_c of ShearMemory; 0: without
  /// Whether the material is known to be prepared as these void ratios are. What excess pores the start pressure then
  /// asks for beyond those above are of the grading, which the critical state follows too; else it may be of a looser
  /// or denser preparation, which has the same critical state.
  bool of_preparation = false;
};

/// The solid that each site represents. A grain has its own volume and surface. A soft body is fines alone (no solid,
/// no excess pores).
struct CoarseBodies {
  std::vector<double> radius;  ///< radii of the bodies [m]
  std::vector<bool> soft;      ///< whether a body is soft; empty: none is

  [[nodiscard]] bool is_soft(std::size_t i) const { return !soft.empty() && soft[i]; }
  [[nodiscard]] double grain(std::size_t i) const;    ///< solid volume [m^3]
  [[nodiscard]] double surface(std::size_t i) const;  ///< surface of the grain [m^2]
};

struct CellStart {
  std::vector<CellContent> content;
  std::vector<double> fines;  ///< v_i: solid volume of fines in each cell [m^3]
  int without_fines = 0;      ///< cells too small for any
  double excess_share = 0.0;  ///< s: excess pores over those of ExcessPores
  double state = 0.0;         ///< y0 or x0, the same in all cells
  double pressure = 0.0;      ///< [Pa]
};

/// All cells at the pressure p0: w_i = s W S_i/sum S, and s such that the fines are as many as given. In the pore form
/// closed: s = [V - sum Vs - V_f (1 + (1-y0) e_J)]/[(1-y0) W]; in the porosity form by bisection. Excess pores stay
/// as they are from there on.
/// A cell that is too small for its grain and the excess pores beside it (v_i < 0: coarse grains that touch) holds no
/// fines, and what pores it has; the others share them.
/// Throws InputError, with the cell and what would help, for s < 0 (the fines fit only denser than this pressure),
/// where more than a quarter of the cells would hold no fines, without coarse grains (s then means nothing), for a
/// pressure that is not above 0 or beyond the state 1, volumes that do not fit together.
CellStart start_at_pressure(const FinesLaw& law, const CoarseBodies& bodies, const std::vector<double>& volume,
                            double fines, double pressure);

/// Volume of the room in which a mixture bears the pressure, excess pores as ExcessPores says. Throws InputError for
/// pressures beyond the state 1 or not above 0, and a mixture that is empty.
double room_at_pressure(const FinesLaw& law, double fines, double coarse, double pressure);

/// Excess pores as ExcessPores says (s = 1), and the pressure that follows from the density: in the pore form
/// 1 - y0 = (V - sum Vs - V_f)/(W + V_f e_J). Throws InputError where the mixture does not jam (y0 <= 0), and as above.
CellStart start_at_density(const FinesLaw& law, const CoarseBodies& bodies, const std::vector<double>& volume,
                           double fines);

}  // namespace softgrain

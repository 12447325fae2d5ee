// Pressure of the matter in a cell as a function of the cell's volume, in two forms, with the energy it derives from.
#pragma once

#include <variant>

namespace softgrain {

/// What a cell holds; conserved while it is strained, but for `pores` of a law with ShearMemory.
struct CellContent {
  double solid = 0.0;     ///< m: volume of its grain and of its fines, overlaps counted twice [m^3]
  double pores = 0.0;     ///< VpJ: volume of its pores where pressure begins [m^3], above 0
  double critical = 0.0;  ///< pores at the critical state of shear [m^3]; of laws with ShearMemory only
};

/// Response of a cell at one volume V. The energy is that of compression from V = solid + pores, so dU/dV = -pressure.
struct CellResponse {
  double pressure = 0.0;   ///< [Pa]; 0 for volumes beyond solid + pores
  double stiffness = 0.0;  ///< -dp/dV [Pa/m^3], not negative
  double energy = 0.0;     ///< [J]; infinite for V <= solid (with guard)
  double hardening = 0.0;  ///< d(stiffness)/dV [Pa/m^6]; below 0 where the cell gets stiffer as it is compressed
};

/// Volume of pores over that where pressure begins: q = (V - m)/VpJ; 1 at the onset, 0 where pores are gone.
inline double relative_pores(const CellContent& c, double volume) { return (volume - c.solid) / c.pores; }

/// p = A y^alpha, y = 1 - Vp/VpJ: adds over volumes, so that cells with equal y are one large cell. U = A VpJ
/// y^(alpha+1)/(alpha+1).
struct PoreForm {
  double modulus = 0.0;   ///< A = E Kp [Pa]
  double exponent = 0.0;  ///< alpha > 1

  [[nodiscard]] CellResponse at(const CellContent& c, double volume) const;
  /// Solid volume of fines v with which a cell of volume V around a grain of volume Vs has the state y:
  /// [V - Vs - (1-y) w]/[1 + (1-y) e_J], for VpJ = e_J v + w.
  [[nodiscard]] double fines(double volume, double grain, double excess, double void_ratio, double y) const;
};

/// p = A x^n, x = (phi - phiJ)/(1 - phiJ), phi = m/V, phiJ = m/(m + VpJ): the form in which packings of any span fall
/// on one curve. (Equal frictionless Hertzian spheres just above their onset: n = 1.5 [O'Hern et al. 2003, PRE 68,
/// 011306]; power-law packings over a wider range: about 1.75.) With t = phi - phiJ: U = A m x^n t/[(n+1) phi^2]
/// 2F1(1, 2; n+2; t/phi), the integral of p over V after V = m/phi and Pfaff's transformation (all terms positive,
/// t/phi < 1).
struct PorosityForm {
  double modulus = 0.0;   ///< A = E K [Pa]
  double exponent = 0.0;  ///< n > 1

  [[nodiscard]] CellResponse at(const CellContent& c, double volume) const;
  /// Solid volume of fines v with which a cell of volume V around a grain of volume Vs has the state x, for VpJ = e_J v
  /// + w. It follows from m = Vs + v, the larger root of m (m + VpJ) = V (m + x VpJ), quadratic in v. Not a number
  /// where there is none.
  [[nodiscard]] double fines(double volume, double grain, double excess, double void_ratio, double x) const;
};

using EquationOfState = std::variant<PoreForm, PorosityForm>;

double modulus(const EquationOfState& equation);
double exponent(const EquationOfState& equation);
/// The state (y or x) where the pressure is p >= 0: (p/A)^(1/exponent).
double state_at(const EquationOfState& equation, double pressure);

/// Both forms stay finite where the pores of a cell vanish, so nothing would stop a cell from collapsing. Below
/// q = `from` another pressure A (from/q - 1)^2 is added, with the energy A VpJ from (u - 1/u - 2 ln u), u = from/q;
/// both grow without bound as q -> 0, and begin with slope 0, so forces have no kink. It is no measured law: a cell in
/// it is beyond what the law was fitted to, and is counted.
struct PoreGuard {
  double from = 0.25;  ///< relative pores below which the guard acts, in [0, 1); 0: no guard

  [[nodiscard]] CellResponse at(const CellContent& c, double volume, double modulus) const;
};

/// Equation and guard together. `volume` <= c.solid: energy and pressure are infinite. In the porosity form, beyond the
/// volume V_r of the state `tail` > 0 the pressure does not end at the onset but falls as p_r/(1 + z/2)^2, z = (V -
/// V_r) S_r/p_r with the pressure p_r and the stiffness S_r there: a cell that others make room for keeps some
/// stiffness and its place.
CellResponse respond(const EquationOfState& equation, const PoreGuard& guard, const CellContent& c, double volume,
                     double tail = 0.0);

/// Throws InputError for a modulus that is not above 0, an exponent not above 1 (the stiffness would jump at the
/// onset), a guard outside [0, 1), values that are not finite.
void require_valid(const EquationOfState& equation, const PoreGuard& guard);

}  // namespace softgrain

// What shear leaves behind in cells: where a cell jams moves with slip, the strength of a face follows,
// and each face yields gradually.
#pragma once

#include <array>
#include <cstddef>

#include "common/core/vec.h"
#include "macrosim/cell_matter/equation_of_state.h"

namespace softgrain {

/// Cells jam at a solid fraction phi_J that shear moves. Compaction of a step is what friction does not use of the work
/// (Taylor's work equation; Rowe 1962, Proc. R. Soc. A 269, 500 has another form of it):
///   d phi_J/phi_J = A (M dgamma_p - dW_p/p),  M = 1.5 mu_f,
/// gamma_p and W_p the slip and the frictional work of the faces of a cell, p the pressure at the face. Faces are the
/// stronger the denser their cells are than their critical state (the state parameter of Been and Jefferies 1985,
/// Geotechnique 35, 99):
///   mu = mu_f [1 + c tanh(-m psi/c)],  psi = [phi_c + lambda (phi - phi_J) - phi_J]/(1 - phi_c).
/// phi_c belongs to the grading, whatever the preparation: pores r_c (e_J v + w) of each cell.
struct ShearMemory {
  double dilatancy = 1.0;       ///< A: 0: phi_J stays
  double critical_pores = 1.0;  ///< r_c: pores at the critical state over those where the card's preparation jams
  double strength_slope = 0.0;  ///< m: 0: all faces are equally strong
  double strength_range = 0.5;  ///< c, below 1: strengths lie within mu_f (1 -+ c)
  double density_slope = 0.0;   ///< lambda
  /// x_r: a cell below this state counts as unloaded: shear compacts it no further, and pressures end slowly. Not of
  /// the material: loose grains sheared at constant volume lose all pressure that a solver resolves.
  double least_state = 0.0;

  /// mu of a cell at the solid fraction phi. Where the cell is nearly unjammed (x < 3 x_r), a strength below mu_f goes
  /// linearly to mu_f at x_r: there volume no longer changes.
  [[nodiscard]] double strength(double mu_f, const CellContent& content, double volume) const;

  /// Pores where the cell jams after slip gamma_p, of whose faces friction used the share `used`, the sum of W_p/p over
  /// them. A rise of phi_J ends at x = x_r.
  [[nodiscard]] double pores_after(double mu_f, const CellContent& content, double volume, double slip,
                                   double used) const;
};

/// A strain is applied in equal parts, none larger than this along any axis (logarithmic): what the slip of a part
/// leaves behind counts from the next one on.
inline constexpr double kMemoryStrain = 2.5e-3;
int memory_parts(double largest_strain);

/// Cells whose pressure is below this share of the start pressure count as unloaded: where x_r lies.
inline constexpr double kUnloadedPressure = 1e-2;

/// A face has six springs in parallel, each with a limit: Masing's rules for reversals, and the hyperbolic backbone
/// tau/(mu p) = g/sqrt(1 + g^2), g = k u/(mu p A), in pieces between g = 0.1, 0.3, 0.7, 1.5, 3.5 and 9. Shares of the
/// stiffness, and of displacements at which springs yield, in mu p A/k; both sums of shares and of their products are
/// 1, so k is the initial stiffness and mu p A the limit.
inline constexpr std::size_t kFaceSprings = 6;
using SpringForces = std::array<Vec3, kFaceSprings>;
struct Backbone {
  std::array<double, kFaceSprings> share{};
  std::array<double, kFaceSprings> yield{};
};
const Backbone& backbone();

/// The springs of a face after a motion in its plane.
struct PulledSprings {
  SpringForces force{};
  Vec3 sum;
  double energy = 0.0;  ///< sum of T_s^2/(2 k_s)
  double kept = 0.0;    ///< share of the stiffness that the limits leave across the force
  double yields = 0.0;  ///< share of that which yields along the force
  bool slides = false;  ///< every spring is at its limit
};

/// Springs that had the forces `before` at the stiffness k0, moved by `motion` at the stiffness k; forces are brought
/// into the plane of the face: T_s = P [T0_s k/k0 - k_s motion], cut to its share of `limit`. All zero for k = 0.
PulledSprings pull(const SpringForces& before, double k0, double k, const Vec3& motion, const Vec3& normal,
                   double limit);

/// Slip of a face between two kept states, and the frictional work: displacement less what the springs hold.
struct FaceSlip {
  double slip = 0.0;  ///< |delta| [m]
  double work = 0.0;  ///< [J], not negative
};
FaceSlip slip_of(const Vec3& force_before, double k0, const Vec3& force, double k, const Vec3& motion,
                 const Vec3& normal);

/// Throws InputError for numbers that are no law: A c > 1 + c (slip would give energy back), c outside (0, 1), r_c not
/// above 0, anything negative but lambda.
void require_valid(const ShearMemory& memory);

}  // namespace softgrain

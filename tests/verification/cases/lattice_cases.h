// Cubic lattices of equal Hertz spheres in a periodic cell: stress and elastic constants.
#pragma once

#include <array>
#include <string>

#include "common/core/cell.h"

namespace softgrain::verification {

/// `turned`: the face-centred lattice with x and y along its [110] and [1-10], where c44 is (c11 - c12)/2 of the cube.
enum class Lattice { simple_cubic, body_centred, face_centred, face_centred_turned };
inline constexpr std::array<Lattice, 4> kLattices{Lattice::simple_cubic, Lattice::body_centred, Lattice::face_centred,
                                                  Lattice::face_centred_turned};
std::string name_of(Lattice lattice);

/// A lattice under isotropic pressure and what its contacts are made of.
struct LatticeState {
  Lattice lattice = Lattice::face_centred;
  double overlap = 1e-3;      ///< of every contact, over the radius
  bool has_friction = false;  ///< tangential springs (Mindlin) that never slide, in the runs with shear
};

/// Stress of the contacts (tension positive) of the lattice stretched along its axes by `strain` beyond the state
/// [Pa], from positions in a rectangular cell.
Matrix<3> run_stretched(const LatticeState& state, const Vec3& strain);
std::string stretched_scene(const LatticeState& state, const Vec3& strain);
/// The same by the sum over bonds of -(1/V) f n (x) b, exact for any strain.
Matrix<3> stretched_closed_form(const LatticeState& state, const Vec3& strain);

/// Tangent moduli of the state, d(stress)/d(strain) at constant axes [Pa].
struct Moduli {
  double c11 = 0.0;       ///< d sigma_xx/d e_xx
  double c12 = 0.0;       ///< d sigma_yy/d e_xx
  double c44 = 0.0;       ///< d sigma_xy/d gamma_xy, simple shear; grains turn with half the rate
  double pressure = 0.0;  ///< of the state
};

/// c11 and c12 by central differences between stretched lattices without friction; c44 from a run with [cell]
/// shear_rate, which sees the springs.
Moduli run_moduli(const LatticeState& state);
double run_shear_modulus(const LatticeState& state);

/// With k = (3/2) K sqrt(h), kt = Dt sqrt(R h/2), f = K h^(3/2), l = 2R - h, V = volume per grain, and sums over the
/// bonds of a grain (each counted once) S1 = sum n_x^2, S4 = sum n_x^4, S22 = sum n_x^2 n_y^2:
/// c11 = [k l^2 S4 + f l (S4 - S1)]/V, c12 = [k l^2 S22 + f l (S22 + S1)]/V,
/// c44 = [k l^2 S22 + kt l^2 (S1/2 - S22) + f l (S22 - S1)]/V. For fcc and without the terms with f this is c44 = (k +
/// kt)/(sqrt(2) l) [Duffy and Mindlin 1957].
Moduli moduli_closed_form(const LatticeState& state);

}  // namespace softgrain::verification

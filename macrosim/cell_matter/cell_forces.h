// Forces on the sites of cells, stress and loads of walls: derivatives of the energy of the matter in them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/tessellation/radical_cells.h"
#include "macrosim/cell_matter/equation_of_state.h"
#include "macrosim/cell_matter/face_springs.h"

namespace softgrain {

struct CellLaw {
  EquationOfState equation;
  PoreGuard guard;
  FaceFriction friction;
  std::optional<ShearMemory> memory =
      std::nullopt;  ///< none: shear leaves nothing behind but the forces of the springs
};

/// How the volumes of both cells of a face change with the places of both sites.
struct FaceSlopes {
  Vec3 upper;  ///< dV_i/dx_j = -dV_j/dx_j of this face [m^2]
  Vec3 lower;  ///< dV_j/dx_i = -dV_i/dx_i of this face

  FaceSlopes(const CellFace& face, const Vec3& x_i) {
    const double share = face.area / face.distance;
    upper = (x_i + face.separation - face.centroid) * share;
    lower = (x_i - face.centroid) * share;
  }
};

/// One state of all cells. With U = sum U_i(V_i), dU_i/dV_i = -p_i, and for the face between i and j (area A, distance
/// d, centroid c) dV_i/dx_j = (A/d)(x_j - c), which is the motion of its plane when j moves [Reynolds' transport
/// theorem: the plane stays perpendicular to x_j - x_i]:
///   force on j: sum over its faces of (p_i - p_j)(A/d)(x_j - c) + T,
///   stress in a periodic cell: 1/V sum over faces, each once, of {(A/d)[p_i (x_j - c) + p_j (c - x_i)] + T} (x) (x_j -
///   x_i),
/// compression positive, T of FaceSprings. The resolved grains have no contact force on top: it is in p.
/// With ShearMemory U has the springs' energy too, whose stiffness goes with B of their cells: to the pressure of a
/// cell each face adds U_f (-dB_i/dV_i)/(B_i + B_j), B = -V dp/dV.
struct CellForces {
  std::vector<CellResponse> response;
  std::vector<double> pressure;  ///< pressures of the cells, with the part of their springs [Pa]
  SpringSet trial;               ///< trial springs of the faces, in their order
  std::vector<Vec3> force;       ///< net forces on the sites [N]
  std::vector<double> mass;      ///< masses in relaxations: half the sum of a row of the stiffness matrix [N/m]
  Matrix<3> stress;              ///< stress of a periodic cell [Pa]; between planes see wall_loads()
  double energy = 0.0;           ///< energy of the cells [J]
  double spring_energy = 0.0;    ///< energy of the springs [J]
  double mean_load = 0.0;        ///< mean of p A over the faces [N]
  double largest_force = 0.0;    ///< largest net force on a site [N]
  int guarded = 0;  ///< number of cells that only the guard keeps from collapse: beyond what the law was measured for
  int sliding = 0;  ///< number of faces at the Coulomb limit

  /// Largest net force over the mean load of a face; 0 where nothing bears.
  [[nodiscard]] double residual() const { return mean_load > 0.0 ? largest_force / mean_load : 0.0; }
  /// Every cell has pores, and every force is a number.
  [[nodiscard]] bool possible() const;
};

/// Forces, stress and energies of one state. `volume`: of the room; `keys`: of the faces, as springs remember them.
CellForces cell_forces(const CellLaw& law, const std::vector<CellContent>& content, const std::vector<Sphere<3>>& sites,
                       const RadicalCells& cells, double volume, const std::vector<FaceKey>& keys,
                       const FaceSprings& springs);

/// Keys of faces whose sites stay at one image (between planes, or where nobody moves far).
std::vector<FaceKey> face_keys(const RadicalCells& cells);
/// Keys of faces where site i has been moved back by periods[i] periods.
std::vector<FaceKey> face_keys(const RadicalCells& cells, const std::vector<std::array<std::int32_t, 3>>& periods);

/// Outward force on each of the six planes: the sum of p_i A over the cells at it. No excess pores beside a wall.
std::array<double, 6> wall_loads(const RadicalCells& cells, const std::vector<double>& pressure);

/// Throws InputError for what no state can be made of, with the cell: contents without pores or solid, sizes that
/// differ.
void require_valid(const CellLaw& law, const std::vector<CellContent>& content, std::size_t sites);

}  // namespace softgrain

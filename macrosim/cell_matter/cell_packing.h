// A periodic packing of cells: its sites come to rest at every strain, quasi-statically.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/dynamics/relaxation_result.h"
#include "macrosim/cell_matter/cell_forces.h"

namespace softgrain {

struct CellRelaxation {
  double tolerance = 1e-3;         ///< largest net force over the mean load of a face
  double largest_move = 0.05;      ///< of a site in one pass, over the spacing (V/N)^(1/3)
  std::int64_t max_passes = 2000;  ///< each is a tessellation
};

/// After one strain step.
struct CellPoint {
  RelaxationResult relaxation;
  std::int64_t tessellations = 0;  ///< of this step
  double volume = 0.0;             ///< of the cell [m^3]
  Matrix<3> stress;                ///< compression positive [Pa]
  double energy = 0.0;             ///< of cells and springs [J]
  int guarded = 0;                 ///< cells held by the guard alone
  double sliding = 0.0;            ///< share of the faces at the Coulomb limit
};

/// Sites, contents and springs of one periodic cell. Strains are diagonal: every axis is stretched by a factor, sites
/// go along (affine guess) and then relax by Fire, with masses as the stiffness of their faces, at fixed strain. Trial
/// states leave the springs alone; they are kept where the relaxation ends. A move that would leave a cell without
/// pores is taken back, and smaller ones follow. No randomness; the same bits for any number of threads.
class CellPacking {
 public:
  /// Centres anywhere (they are brought into the cell). Springs begin without force at these places. Throws BadInput
  /// for contents that do not fit and cells that are smaller than their solid.
  CellPacking(CellLaw law, const std::vector<Sphere<3>>& sites, std::vector<CellContent> content, const Cell<3>& cell);

  /// Lengths along the axes times `stretch` (below 1 compresses), then to rest; springs are kept. A step whose
  /// relaxation was capped or diverged is kept too, and says so. Throws BadInput for factors that are not above 0, and
  /// NotUsable where the affine guess already leaves a cell without pores (take smaller steps).
  CellPoint strain(const Vec3& stretch, const CellRelaxation& options = {});

  [[nodiscard]] CellPoint now() const;
  [[nodiscard]] const CellForces& forces() const { return forces_; }
  [[nodiscard]] const RadicalCells& cells() const { return cells_; }
  [[nodiscard]] const std::vector<Sphere<3>>& sites() const { return sites_; }
  [[nodiscard]] const Cell<3>& cell() const { return cell_; }

 private:
  RelaxationResult relax(const CellRelaxation& options);
  bool move(const std::vector<Vec3>& velocity, double step, double longest);
  bool evaluate();
  void bring_home();

  CellLaw law_;
  std::vector<Sphere<3>> sites_;
  std::vector<CellContent> content_;
  Cell<3> cell_;
  std::vector<std::array<std::int32_t, 3>> periods_;  ///< by which sites were moved back
  FaceSprings springs_;
  RadicalCells cells_;
  CellForces forces_;
  std::int64_t tessellations_ = 0;
};

}  // namespace softgrain

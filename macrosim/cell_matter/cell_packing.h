// A packing of cells, periodic or between planes: its sites relax at every strain, quasi-statically, the room
// with them where it is held by stress.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/core/cell.h"
#include "common/dynamics/residual.h"
#include "macrosim/cell_matter/cell_forces.h"
#include "macrosim/cell_matter/cell_room.h"

namespace softgrain {

struct CellRelaxation {
  double tolerance = 1e-3;         ///< largest net force over the mean load of a face
  double largest_move = 0.05;      ///< largest move of a site in one pass, over the spacing (V/N)^(1/3)
  std::int64_t max_passes = 2000;  ///< largest number of passes; each is a tessellation
  bool by_tangent = true;          ///< whether steps of the tangent are used; false: Fire alone, the slow reference
};

/// State after one strain step.
struct CellPoint {
  RelaxationResult relaxation;
  std::int64_t tessellations = 0;  ///< number of tessellations in this step
  std::int64_t faces = 0;          ///< number of faces whose forces were computed in this step
  double volume = 0.0;             ///< volume of the room [m^3]
  Matrix<3> stress;                ///< compression positive; between planes their loads over their areas [Pa]
  double energy = 0.0;             ///< energy of cells and springs [J]
  int guarded = 0;                 ///< number of cells held by the guard alone
  double sliding = 0.0;            ///< share of the faces at the Coulomb limit
};

/// What is conserved between two strain steps, for checkpoints.
struct CellState {
  std::vector<Sphere<3>> sites;
  std::vector<CellContent> content;
  std::vector<std::array<std::int32_t, 3>> periods;
  SpringSet springs;
  Vec3 low{};
  Vec3 high{};
  std::vector<double> strength;    ///< of cells, with ShearMemory
  std::vector<double> next_pores;  ///< CellContent::pores of the next strain step, with ShearMemory
  Matrix<3> stress{};              ///< when it was kept, with ShearMemory [Pa]
};

/// Sites, contents and springs in one room. Strains are diagonal: every axis is stretched by a factor, sites go along
/// (affine guess) and then relax at fixed strain; or the lengths of axes that are held by stress do with them,
/// their logarithmic strains as coordinates (as in PressedBox). The relaxation takes steps of the tangent (CellTangent)
/// that are mixed (StepMixer), two to five tessellations in all. Where these do not converge, it uses Fire, with the
/// stiffness of the faces of each site as its mass. Trial states leave the springs alone; they are kept where the
/// relaxation ends, so what is kept depends on the end alone. A move that would leave a cell without pores, or a site
/// outside planes, is taken back, and smaller ones follow; a strain whose affine guess would do so is applied in
/// smaller parts.
/// With ShearMemory a strain is applied in parts of at most kMemoryStrain; axes held by stress follow in each part, and
/// parts in which they strain by more than twice that are taken back and halved.
/// What the slip of a part does to phi_J and to strengths counts from the next part on, so that every state is at rest
/// as it is reported. There is no randomness, and the results are bitwise the same for any number of threads.
class CellPacking {
 public:
  /// Centres anywhere (they are brought into a periodic cell). Springs begin without force at these places. Throws
  /// InputError for contents that do not fit, cells that are smaller than their solid, sites that are not between
  /// planes.
  CellPacking(CellLaw law, const std::vector<Sphere<3>>& sites, std::vector<CellContent> content, const CellRoom& room);

  /// Goes on from a state() of a rectangular room. With ShearMemory now() then is of the next part of a strain: with
  /// the limits and faces that slip has left.
  CellPacking(CellLaw law, const CellState& state, bool periodic);

  /// Multiplies the lengths along the axes by `stretch` (below 1 compresses), then relaxes the sites; springs are kept.
  /// A step whose relaxation was capped or diverged is kept too, and says so. Throws InputError for factors that are
  /// not above 0, and UnusableResult where even a small part of the strain leaves a cell without pores.
  CellPoint strain(const Vec3& stretch, const CellRelaxation& options = {});

  /// Stretches as strain() does. Then the sites relax together with the lengths of the axes that `control` holds
  /// by stress.
  CellPoint press(const Vec3& stretch, const BoxControl& control, const CellRelaxation& options = {});

  [[nodiscard]] CellPoint now() const;
  [[nodiscard]] CellState state() const;
  [[nodiscard]] const CellForces& forces() const { return forces_; }
  [[nodiscard]] const RadicalCells& cells() const { return cells_; }
  [[nodiscard]] const std::vector<Sphere<3>>& sites() const { return sites_; }
  [[nodiscard]] const std::vector<CellContent>& content() const { return content_; }
  [[nodiscard]] const CellRoom& room() const { return room_; }

 private:
  class Axes;
  static constexpr Vec3 kAsItIs{{1.0, 1.0, 1.0}};

  void keep();
  void remember();
  CellPoint step(const Vec3& stretch, const BoxControl* control, const CellRelaxation& options);
  void stretch(const Vec3& factor);
  RelaxationResult rest(const CellRelaxation& options, Axes* axes);
  RelaxationResult settle(const CellRelaxation& options, Axes* axes);
  RelaxationResult glide(const CellRelaxation& options, Axes* axes);
  [[nodiscard]] double unrest(const CellRelaxation& options, const Axes* axes) const;
  bool move(const std::vector<Vec3>& steps, const Vec3& factors);
  bool evaluate();
  [[nodiscard]] Matrix<3> stress() const;

  CellLaw law_;
  std::vector<Sphere<3>> sites_;
  std::vector<CellContent> content_;
  CellRoom room_;
  std::vector<std::array<std::int32_t, 3>> periods_;  ///< number of periods by which each site was moved back, per axis
  FaceSprings springs_;
  std::vector<double> next_pores_;
  Matrix<3> kept_stress_{};
  RadicalCells cells_;
  CellForces forces_;
  std::int64_t tessellations_ = 0;
  std::int64_t faces_ = 0;
};

}  // namespace softgrain

// A material point of the cell law with ShearMemory: cells all alike, faces of all directions, affine motion. This is
// the mean field of a CellPacking.
#pragma once

#include <vector>

#include "common/core/vec.h"
#include "macrosim/cell_matter/cell_forces.h"

namespace softgrain {

/// Axes of strain and stress are the coordinates. Faces: Gauss's rule over one octant, to which the others are mirror
/// images; around a point sum A d = 3 V with d the distance of the plane from it. What slip leaves counts from the next
/// strain on, as in CellPacking.
class MaterialPoint {
 public:
  /// Solid fractions now, at the onset and at the critical state. Throws InputError for a law without ShearMemory, and
  /// for fractions outside (0, 1).
  MaterialPoint(const CellLaw& law, double solid_fraction, double onset, double critical);

  /// Compresses by these logarithmic strains; in memory_parts().
  void strain(const Vec3& logarithmic);

  /// Compresses along z by a logarithmic strain while x and y, which strain alike, keep the stress `lateral` [Pa].
  /// False where no lateral strain within twice the axial one does so; the state is that of the nearest then.
  bool strain_at(double axial, double lateral);

  [[nodiscard]] Vec3 stress() const;  ///< compression positive [Pa]
  [[nodiscard]] double solid_fraction() const { return content_.solid; }
  [[nodiscard]] double onset() const { return content_.solid / (content_.solid + content_.pores); }

 private:
  struct Face {
    SpringForces force{};  ///< over the area [Pa]
    Vec3 sum;
  };

  void part(const Vec3& strain);

  CellLaw law_;
  CellContent content_;  ///< of a volume of 1
  CellResponse response_;
  double strength_ = 0.0;
  double stiffness_ = 0.0;  ///< chi B [Pa]
  double spring_pressure_ = 0.0;
  double next_pores_ = 0.0;
  std::vector<Face> faces_;
};

}  // namespace softgrain

#include "microsim/powder/powder_rigidity.h"

#include "microsim/powder/powder_contacts.h"

namespace softgrain {

Rigidity rigidity_of(const RigidityMatrix& matrix) {
  Rigidity out;
  out.freedoms = matrix.entries.columns;
  out.constraints = matrix.entries.rows;
  out.of_matrix = sparse_rank(matrix.entries);
  out.of_transpose = sparse_rank(matrix.entries.transposed());
  out.floppy = out.freedoms - out.of_matrix.rank;
  out.indeterminacy = out.constraints - out.of_transpose.rank;
  out.stiffness = stiffness_definiteness(matrix);
  return out;
}

PowderRigidity powder_rigidity(const System<2>& system, const std::vector<PowderInteraction>& pairs, bool cohesive) {
  const auto of = [&](const std::vector<bool>& keep, CellMotions cell) {
    return rigidity_of(rigidity_matrix(pairs, system, keep, cell));
  };
  PowderRigidity out;
  const bool has_cell = system.cell.any_periodic();
  std::vector<bool> keep(static_cast<std::size_t>(system.particles.grains), true);
  out.fixed = of(keep, CellMotions::none);
  if (has_cell) out.free = of(keep, CellMotions::lengths);
  if (cohesive) return out;
  keep = powder_rattlers(system);
  keep.flip();
  out.backbone = of(keep, CellMotions::none);
  if (has_cell) out.backbone_free = of(keep, CellMotions::lengths);
  return out;
}

}  // namespace softgrain

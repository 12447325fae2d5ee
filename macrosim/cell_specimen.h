// A specimen of coarse bodies and fines: where its bodies are, and what their cells hold at the start.
#pragma once

#include <string>

#include "common/io/hdf5_file.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/cell_start.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

/// The law of a card for grains of modulus E [Pa].
CellLaw cell_law_of(const CellCard& card, double youngs_modulus);
FinesLaw fines_law_of(const CellCard& card, double youngs_modulus);

/// Solid volume of the fines between coarse grains of this volume [m^3].
double fines_volume(const CellMatter& matter, double coarse);

/// Places for the coarse bodies of a specimen that nobody has resolved: every solid grain wears a mantle of fines, all
/// of one thickness, so that the dressed bodies fill kThickenedFraction of the room as hard spheres at rest do; they
/// are prepared as spec.protocol says and undressed, and the room takes the volume that the density asks for, or the
/// law at the start pressure. Throws InputError where soft particles alone fill more than that, and what pack_bodies
/// throws.
MacroPacking make_cell_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                               const PreparationWatch& watch = {});
inline constexpr double kThickenedFraction = 0.64;

/// Cells at the start: spec.cells says from what. Throws InputError.
struct CellSpecimen {
  CellPacking packing;
  CellStart start;
};
CellSpecimen make_cells(const MacroSpec& spec, const MacroPacking& bodies);

/// What to mind about a start: empty when nothing.
std::string start_remark(const MacroSpec& spec, const CellStart& start);

/// Throws InputError where the card was measured on grains of another nu or mu.
void require_same_grains(const CellCard& card, const MacroSpec& spec);

void write_cell_state(const h5::Group& group, const CellState& state);
CellState read_cell_state(const h5::Group& group);

}  // namespace softgrain

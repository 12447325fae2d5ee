// A specimen of coarse bodies and fines: where its bodies are, what their cells hold at the start, and its tests, in
// the stages that tests of contacts have.
#pragma once

#include <string>

#include "common/data/macro_result.h"
#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"
#include "common/state/run_control.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/cell_start.h"
#include "macrosim/curve_notes.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

/// The law of a card for the grains of a scene. x_r is that of the card, or lower where the start pressure of the scene
/// asks for it (kUnloadedPressure).
CellLaw cell_law_of(const CellCard& card, const MacroSpec& spec);
/// `preparation`: of the material; empty: that of the card. All its void ratios are those of the card times the factor
/// of that preparation, but the pores at the critical state, which no preparation changes. Throws InputError where the
/// card has no factor for it.
FinesLaw fines_law_of(const CellCard& card, double youngs_modulus, const std::string& preparation = "");

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

/// Which stages of a test a card without shear memory does not serve; empty where it has one, or serves them all.
std::string compression_only_text(const MacroSpec& spec);

/// That the specimen is prepared otherwise than the card's grains and nobody said of what preparation its fines are;
/// empty otherwise.
std::string other_preparation_text(const MacroSpec& spec);

/// What to mind about a start: empty when nothing.
std::string start_remark(const MacroSpec& spec, const CellStart& start);

/// Throws InputError where the card was measured on grains of another nu or mu.
void require_same_grains(const CellCard& card, const MacroSpec& spec);

void write_cell_state(const h5::Group& group, const CellState& state);
CellState read_cell_state(const h5::Group& group);

// Tests of a specimen of cells.

struct CellTestState {
  CellPacking packing;
  MacroCurve curve;
  std::int64_t increments = 0;
  IncrementRest worst{};
  bool over = false;
};

/// State of a test before its first point.
CellTestState begin_cell_test(const MacroSpec& spec, const MacroPacking& bodies, const std::string& engine,
                              std::int64_t sample);

/// Runs the stages of the test, as compress() does: strains the room, relaxes sites and axes that go by stress, records
/// strain and stress. The coordination is that of cells (faces per cell); `more` has the solid fraction, the share of
/// the faces that slide and the cells that only the guard keeps open; costs are tessellations (passes) and faces
/// (evaluations). Cells beyond the pressure that the law was fitted to are counted as contacts beyond a law are, and
/// reported in the note. Throws UnusableResult, Interrupted.
void test_cells(CellTestState& state, const MacroSpec& spec, const RunControl<CellTestState>& control = {});

/// Names of columns of MacroCurve::more.
inline constexpr const char* kSlidingFaces = "sliding_faces";
inline constexpr const char* kGuardedCells = "guarded_cells";
inline constexpr const char* kBulkDensity = "bulk_density";  ///< mass of all grains over the volume [kg/m^3]

/// Snapshot of the coarse grains and soft particles where they are now, without contacts.
Snapshot cell_snapshot(const CellPacking& packing, const MacroPacking& bodies);

}  // namespace softgrain

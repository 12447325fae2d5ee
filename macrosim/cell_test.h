// Tests of a specimen of cells, in the stages that tests of contacts have.
#pragma once

#include "common/data/macro_result.h"
#include "common/data/snapshot.h"
#include "common/state/run_control.h"
#include "macrosim/cell_specimen.h"
#include "macrosim/curve_notes.h"

namespace softgrain {

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

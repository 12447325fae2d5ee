#include "macrosim/cell_specimen.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "common/core/cost.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"
#include "macrosim/body_contacts.h"
#include "macrosim/staged_test.h"

namespace softgrain {

namespace {

CellRelaxation options_of(const MacroSpec& spec, const MacroStage& stage) {
  CellRelaxation options;
  options.tolerance = stage.tolerance;
  options.max_passes = spec.max_passes;
  return options;
}

/// Notes at the end of a test how many cells were beyond the range that the law was fitted to.
void note_range(const MacroSpec& spec, MacroCurve& c) {
  const double beyond = std::accumulate(c.law_beyond.begin(), c.law_beyond.end(), 0.0);
  if (!(beyond > 0.0)) return;
  const double asked = std::accumulate(c.law_evaluations.begin(), c.law_evaluations.end(), 0.0);
  const double largest = *std::max_element(c.law_largest.begin(), c.law_largest.end());
  append_part(c.note,
              fmt::format("{:.2g} % of the cells at recorded points are beyond p/E = {:.3g}, up to which the law was "
                          "fitted (at most {:.3g} times that)",
                          100.0 * beyond / asked, spec.cells->card.pressure_high, largest));
}

struct CellTest {
  const MacroSpec& spec;

  RelaxationResult step(CellTestState& state, const MacroStage& stage, const Vec3& strain,
                        const std::optional<Vec3>& stress) const {
    const Stopwatch watch;
    const Vec3 stretch{{1.0 - strain[0], 1.0 - strain[1], 1.0 - strain[2]}};
    CellPacking& cells = state.packing;
    CellPoint point;
    try {
      if (!stress) {
        point = cells.strain(stretch, options_of(spec, stage));
      } else {
        const auto mean = mean_first(spec, stage, *stress);
        if (mean) {
          CellRelaxation roughly = options_of(spec, stage);
          roughly.tolerance *= kRoughly;
          (void)cells.press(stretch, *mean, roughly);
          add_cost(state, cells.now());
        }
        point = cells.press(mean ? Vec3{{1.0, 1.0, 1.0}} : stretch, box_control(spec, stage, *stress),
                            options_of(spec, stage));
      }
    } catch (const InputError& e) {  // a room that has become too small: no fault of the scene
      throw UnusableResult(e.what());
    }
    add_cost(state, point);
    state.curve.cost.seconds += watch.seconds();
    return point.relaxation;
  }

  static void add_cost(CellTestState& state, const CellPoint& point) {
    state.curve.cost.loop_passes += point.tessellations;
    state.curve.cost.contact_evaluations += point.faces;
  }

  void record(CellTestState& state, const MacroStage& stage, std::int64_t number, const RelaxationResult& rest) const {
    const CellPacking& cells = state.packing;
    MacroCurve& c = state.curve;
    const CellPoint point = cells.now();
    const Vec3 stress{{point.stress[0][0], point.stress[1][1], point.stress[2][2]}};
    record_stress_strain(c, spec, number, cells.room().high() - cells.room().low(), stress);
    c.stress_axial_contacts.push_back(stress[2]);
    const auto n = static_cast<double>(cells.sites().size());
    c.coordination.push_back(2.0 * static_cast<double>(cells.cells().faces.size()) / n);
    c.residual.push_back(rest.residual);
    double solid = 0.0;
    for (const CellContent& content : cells.content()) solid += content.solid;
    c.more[kSolidFraction].push_back(solid / point.volume);
    c.more[kBulkDensity].push_back(spec.density * solid / point.volume);
    c.more[kSlidingFaces].push_back(point.sliding);
    c.more[kGuardedCells].push_back(point.guarded);
    record_range(cells, c);
    note_unrest(c, state.worst, stage);
  }

  void record_range(const CellPacking& cells, MacroCurve& c) const {
    const double end = spec.cells->card.pressure_high * spec.youngs_modulus;
    double beyond = 0.0;
    double largest = 0.0;
    for (const CellResponse& r : cells.forces().response) {
      beyond += r.pressure > end ? 1.0 : 0.0;
      largest = std::max(largest, r.pressure / end);
    }
    c.law_evaluations.push_back(static_cast<double>(cells.sites().size()));
    c.law_beyond.push_back(beyond);
    c.law_largest.push_back(largest);
  }

  static LawUse watch(CellTestState&) { return {}; }
  void note_use(CellTestState& state, const LawUse&) const { note_range(spec, state.curve); }
  static bool ended(CellTestState&) { return false; }
};

std::string hash_of(const CellMatter& matter) {
  std::string text = to_string(matter.card.form);
  for (const CellCardNumber& n : numbers_of(matter.card))
    if (n.key != "K0") text += fmt::format(" {:a}", n.estimate.value);
  if (const auto factor = void_ratio_factor(matter.card, matter.preparation); factor && *factor != 1.0)
    text += fmt::format(" void ratios times {:a}", *factor);
  if (matter.card.memory && !matter.preparation.empty()) text += " critical state follows the start";
  return short_hash(text);
}

}  // namespace

CellTestState begin_cell_test(const MacroSpec& spec, const MacroPacking& bodies, const std::string& engine,
                              std::int64_t sample) {
  CellSpecimen specimen = make_cells(spec, bodies);
  CellTestState state{std::move(specimen.packing), blank_curve(spec, bodies, engine, sample)};
  const CellCard& card = spec.cells->card;
  state.curve.law = {std::nullopt,        0.0, spec.youngs_modulus, card.poisson_ratio, card.grain_friction,
                     hash_of(*spec.cells)};
  state.curve.note = start_remark(spec, specimen.start);
  state.curve.warning = compression_only_text(spec);
  return state;
}

void test_cells(CellTestState& state, const MacroSpec& spec, const RunControl<CellTestState>& control) {
  run_stages(state, spec, CellTest{spec}, control);
}

Snapshot cell_snapshot(const CellPacking& packing, const MacroPacking& bodies) {
  Snapshot s;
  s.kind = SnapshotKind::macro;
  for (std::size_t i = 0; i < packing.sites().size(); ++i) {
    SnapshotParticle p;
    p.position = packing.sites()[i].x;
    p.radius = packing.sites()[i].r;
    p.id = p.body = static_cast<std::int64_t>(i);
    p.role = bodies.bodies[i].soft ? ParticleRole::soft : ParticleRole::solid;
    s.particles.push_back(p);
  }
  const CellRoom& room = packing.room();
  const Vec3 size = room.high() - room.low();
  for (int k = 0; k < 3; ++k) {
    const auto u = static_cast<std::size_t>(k);
    s.cell_edges[u][k] = size[k];
    s.periodic[u] = room.periodic();
    for (const double way : {1.0, -1.0}) {
      if (room.periodic()) continue;
      SnapshotWall wall;
      wall.point = way > 0.0 ? room.low() : room.high();
      wall.normal[k] = way;
      s.walls.push_back(wall);
    }
  }
  return s;
}

}  // namespace softgrain

#include "macrosim/lammps_run/lammps_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "macrosim/curve_notes.h"
#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/lammps_run/script_parts.h"
#include "macrosim/preparation.h"
#include "macrosim/test_protocol.h"

namespace softgrain::lammps {

namespace {

/// End of a relaxation from its number in fix softgrain/relax.
RelaxationEnd end_of(double code) {
  if (code == 1.0) return RelaxationEnd::converged;
  if (code == 2.0) return RelaxationEnd::capped;
  return code == 3.0 ? RelaxationEnd::diverged : RelaxationEnd::not_run;
}

LawUse law_use(const PointRow& row) {
  const auto whole = [&](Point p) { return static_cast<std::int64_t>(row[p]); };
  return {whole(Point::law_evaluations), whole(Point::law_beyond), row[Point::law_largest], whole(Point::law_refused),
          whole(Point::law_clamped)};
}

/// Mean of both walls across an axis, over their area [Pa].
double wall_stress(const PointRow& row, Point low, Point high, double area) {
  return 0.5 * (row[low] + row[high]) / area;
}

void add_stresses(const PointRow& row, MacroCurve& c) {
  const double lx = row[Point::lx];
  const double ly = row[Point::ly];
  const double lz = row[Point::lz];
  if (!(lx > 0.0 && ly > 0.0 && lz > 0.0)) throw IoError("points.txt: a box without room");
  const double volume = lx * ly * lz;
  const bool periodic = c.boundary == Boundary::periodic;
  const double x =
      periodic ? row[Point::branch_xx] / volume : wall_stress(row, Point::wall_xlo, Point::wall_xhi, ly * lz);
  const double y =
      periodic ? row[Point::branch_yy] / volume : wall_stress(row, Point::wall_ylo, Point::wall_yhi, lx * lz);
  const double z =
      periodic ? row[Point::branch_zz] / volume : wall_stress(row, Point::wall_zlo, Point::wall_zhi, lx * ly);
  c.strain_x.push_back(1.0 - lx / c.start.size_x);
  c.strain_y.push_back(1.0 - ly / c.start.size_y);
  c.strain_z.push_back(1.0 - lz / c.start.size_z);
  c.stress_axial.push_back(z);
  c.stress_lateral.push_back(0.5 * (x + y));
  c.stress_x.push_back(x);
  c.stress_y.push_back(y);
  c.stress_deviator.push_back(z - x);
  c.stress_axial_contacts.push_back(row[Point::branch_zz] / volume);
}

/// What the row says, of tests in stages; else what the test has at this point, which the row must agree with.
double strain_of(const PointRow& row, const MacroSpec& spec, const MacroCurve& c) {
  if (spec.test == MacroTest::stages) return 1.0 - row[Point::lz] / c.start.size_z;
  const double strain = strain_at(spec, static_cast<std::int64_t>(c.strain.size()));
  if (std::abs(row[Point::strain] - strain) > 1e-9)
    throw IoError(fmt::format("points.txt: point {} is at strain {}, the test has {} there: another test was run",
                              row[Point::number], row[Point::strain], strain));
  return strain;
}

/// Rows of a run that went on without the stresses at which its stages began are refused: it took another way. Where a
/// stress was not reached, the row has that of an increment before its last one.
void require_asked(const PointRow& row, const MacroSpec& spec, const std::vector<MacroStage>& stages,
                   const MacroCurve& c) {
  constexpr double kRounding = 1e-6;  // stresses at the begin were summed in another order
  const auto point = static_cast<std::int64_t>(c.strain.size());
  const StagePoint at = stage_point(stages, point);
  const MacroStage& stage = stages[static_cast<std::size_t>(at.stage)];
  if (point == 0 || !stage.by_stress() || row[Point::over] > 0.0) return;
  const std::vector<Vec3> starts = stage_starts(stages, c, point);
  const Vec3 there = stress_at(stage, at.number * stage.increments_per_step, starts);
  const Vec3 asked{{row[Point::asked_x], row[Point::asked_y], row[Point::asked_z]}};
  const double scale = least_stress(spec) + norm(there) + norm(starts.back());
  for (int k = 0; k < 3; ++k)
    if (!(std::abs(asked[k] - there[k]) <= kRounding * scale))
      throw IoError(fmt::format(
          "points.txt: point {} asks for {:.6g} Pa along {}, the test for {:.6g} Pa there: the run went on without the "
          "stresses at which its stages began (-var begin{}{} ...; --resume gives them). Remove the rows from this "
          "point on, in {} and {}",
          row[Point::number], asked[k], "xyz"[k], there[k], at.stage + 1, "xyz"[k], kPointsFile, kPointsCopy));
}

void add_point(const PointRow& row, const MacroSpec& spec, const std::vector<MacroStage>& stages, MacroCurve& c) {
  const double strain = strain_of(row, spec, c);
  require_asked(row, spec, stages, c);
  const std::int64_t number = stage_point(stages, static_cast<std::int64_t>(c.strain.size())).stage;
  const MacroStage& stage = stages[static_cast<std::size_t>(number)];
  c.stage.push_back(static_cast<double>(number));
  c.strain.push_back(strain);
  add_stresses(row, c);
  const auto bodies = static_cast<double>(c.bodies);
  c.coordination.push_back(2.0 * row[Point::contacts] / bodies);
  c.coordination_bodies.push_back((2.0 * row[Point::contacts] - row[Point::wall_contacts]) / bodies);
  c.fabric.push_back(row[Point::fabric]);
  c.fabric_bodies.push_back(row[Point::fabric]);
  c.residual.push_back(row[Point::residual]);
  c.cost += {static_cast<std::int64_t>(row[Point::passes]), static_cast<std::int64_t>(row[Point::looked_at]),
             row[Point::seconds]};
  const auto passes = static_cast<std::int64_t>(row[Point::passes]);
  const auto increment = static_cast<std::int64_t>(row[Point::unrest_at]);
  note_unrest(c, {{end_of(row[Point::unrest_end]), passes, row[Point::unrest]}, increment}, stage);
  if (row[Point::over] > 0.0)
    note_out_of_reach(c, stage, {{row[Point::asked_x], row[Point::asked_y], row[Point::asked_z]}});
  record_law_use(c, law_use(row));
}

namespace fs = std::filesystem;

/// A row of the table of a compaction.
struct CompactionRound {
  std::int64_t number = 0;
  double next_pressure = 0.0;     ///< next pressure over the final one of the compaction
  std::int64_t passes_under = 0;  ///< number of passes under it so far
};

/// Complete rows of the table of a compaction.
std::vector<CompactionRound> rounds_of(const std::string& directory) {
  std::vector<CompactionRound> rounds;
  if (!fs::exists(directory + "/" + kCompactionFile)) return rounds;
  std::istringstream in(read_text(directory + "/" + kCompactionFile));
  for (std::string line; std::getline(in, line) && !in.eof();) {
    std::istringstream words(line);
    CompactionRound round;
    if (words >> round.number >> round.next_pressure >> round.passes_under) rounds.push_back(round);
  }
  return rounds;
}

/// The last round whose restart file is there, and what comes next.
std::vector<std::string> last_round(const std::string& directory) {
  if (fs::exists(directory + "/" + kTouchingFile)) return {"-var", "prepared", "1"};
  std::vector<std::string> settings;
  for (const CompactionRound& r : rounds_of(directory))
    if (fs::exists(fmt::format("{}/restart.compaction.{}", directory, r.number)))
      settings = {"-var", "round_done",    fmt::format("{}", r.number),
                  "-var", "next_pressure", fmt::format("{}", r.next_pressure),
                  "-var", "passes_under",  fmt::format("{}", r.passes_under)};
  return settings;
}

}  // namespace

bool ended_early(const PointRow& row) {
  return row[Point::law_refused] > 0.0 || row[Point::behind_walls] > 0.0 || row[Point::over] > 0.0;
}

void add_points(const std::vector<PointRow>& rows, const MacroSpec& spec, MacroCurve& curve) {
  const std::vector<MacroStage> stages = stages_of(spec);
  for (const PointRow& row : rows) add_point(row, spec, stages, curve);
  if (!rows.empty() && curve.soft > 0) note_law_use(curve, law_use(rows.back()), curve.strain.back());
  note_stages(curve, spec);
}

std::vector<double> normal_forces(const std::vector<DumpedContact>& contacts) {
  std::vector<double> forces;
  for (const DumpedContact& c : contacts) forces.push_back(c.normal_force);
  return forces;
}

void move_to(const DumpedBodies& bodies, MacroSystem& macro) {
  auto& p = macro.system.particles;
  if (macro.box.periodic) {
    const Vec3 size = bodies.high - bodies.low;
    for (std::size_t k = 0; k < bodies.x.size(); ++k) p.sphere[k].x = bodies.x[k] - bodies.low;
    for (int k = 0; k < 3; ++k) macro.system.cell.edges[k][k] = size[k];
    return;
  }
  for (std::size_t k = 0; k < bodies.x.size(); ++k) p.sphere[k].x = bodies.x[k];
  const Vec3 middle = (bodies.low + bodies.high) * 0.5;
  for (int wall = 0; wall < 6; ++wall) {
    Vec3 x = middle;
    x[wall / 2] = wall % 2 == 0 ? bodies.low[wall / 2] : bodies.high[wall / 2];
    p.sphere[static_cast<std::size_t>(macro.box.plane[static_cast<std::size_t>(wall)])].x = x;
  }
}

std::vector<SnapshotContact> snapshot_contacts_of(const std::vector<DumpedContact>& contacts,
                                                  const MacroSystem& macro) {
  const auto& sphere = macro.system.particles.sphere;
  std::vector<SnapshotContact> out;
  for (const DumpedContact& c : contacts) {
    SnapshotContact s;
    s.i = c.i;
    s.j = c.j;
    s.from = sphere[static_cast<std::size_t>(c.i)].x;
    const double length = norm(c.branch);
    const double r = sphere[static_cast<std::size_t>(c.i)].r;
    const bool wall = c.j >= macro.bodies;
    const double overlap = r + (wall ? 0.0 : sphere[static_cast<std::size_t>(c.j)].r) - length;
    s.point = s.from - c.branch * ((r - 0.5 * overlap) / length);
    s.to = wall ? s.point : s.from - c.branch;
    if (!wall && macro.box.periodic) {
      const Vec3& partner = sphere[static_cast<std::size_t>(c.j)].x;
      s.shift = macro.system.cell.image_shift(macro.system.cell.image_near(s.from, partner));
      s.to = partner + s.shift;
    }
    s.force = c.force;
    s.normal_force = c.normal_force;
    out.push_back(s);
  }
  return out;
}

double compaction_share(const std::string& directory) {
  // Of all passes about two fifths are made under the first pressure and a third under the last one.
  constexpr double kFirst = 0.4;
  constexpr double kLast = 0.7;
  if (fs::exists(directory + "/" + kTouchingFile)) return 1.0;
  const auto rounds = rounds_of(directory);
  if (rounds.empty()) return 0.0;
  const double first = std::log(rounds.front().next_pressure / kPressureFall);
  return first > 0.0 ? kLast - (kLast - kFirst) * std::log(rounds.back().next_pressure) / first : kLast;
}

ResumePoint find_resume_point(const std::string& directory, const std::string& key, std::int64_t points,
                              const std::vector<MacroStage>& stages, const std::vector<std::string>& more) {
  auto rows = read_points(directory, key, more);
  const auto there = [&](const std::string& file) { return fs::exists(directory + "/" + file); };
  const bool early = !rows.empty() && ended_early(rows.back());
  if (early || static_cast<std::int64_t>(rows.size()) >= points) {
    if (there(kEndFile)) return {true, {}};
    if (early) rows.pop_back();  // the script would go on beyond it
  }
  while (!rows.empty() && !there(fmt::format("restart.{}", rows.size() - 1))) rows.pop_back();
  fs::remove(directory + "/" + kEndFile);
  if (rows.empty()) return {false, last_round(directory)};
  write_points(directory, key, rows, more);
  ResumePoint out{false, {"-var", "from", std::to_string(rows.size() - 1)}};
  if (stages.empty()) return out;
  const auto begins = begin_settings(stages, rows);
  out.settings.insert(out.settings.end(), begins.begin(), begins.end());
  return out;
}

}  // namespace softgrain::lammps

#include "pipelines/kinds/material_law/fines_in_cells.h"

#include <algorithm>
#include <cmath>

#include "calibrate/face_friction_fit.h"
#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/io/interrupt.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/face_springs.h"
#include "macrosim/preparation.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

namespace {

/// Bodies of one size would order.
constexpr double kSiteRatio = 1.5;
/// Compared points of a stage: steps of one percent give what those of a quarter do.
constexpr std::size_t kComparedPoints = 8;
/// Tolerance of a relaxation; at a tenth of it stress ratios differ by 1e-4.
constexpr double kTolerance = 1e-2;

std::size_t last_stage_begins(const MacroCurve& curve) {
  std::size_t first = curve.stage.size();
  while (first > 1 && curve.stage[first - 1] == curve.stage.back()) --first;
  return first;
}

EquationOfState equation_of_fines(const FinesState& s) {
  if (s.form == StateForm::porosity) return PorosityForm{s.modulus, s.exponent};
  return PoreForm{s.modulus, s.exponent};
}

/// Image of a point in the periodic cell whose low corner is the origin.
Vec3 home(const Vec3& x, const Vec3& size) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) {
    out[k] = x[k] - size[k] * std::floor(x[k] / size[k]);
    if (!(out[k] < size[k])) out[k] = 0.0;
  }
  return out;
}

double measure_of(const Matrix<3>& stress, FinesMeasure measure) {
  const double x = stress[0][0];
  const double y = stress[1][1];
  const double z = stress[2][2];
  if (measure == FinesMeasure::lateral_ratio) return 0.5 * (x + y) / z;
  const double q = std::sqrt(0.5 * ((x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x)));
  return 3.0 * q / (x + y + z);
}

}  // namespace

FinesPath path_of(const MacroCurve& curve, FinesMeasure measure) {
  FinesPath path;
  path.measure = measure;
  const std::size_t first = last_stage_begins(curve);
  const std::size_t all = curve.strain_z.size();
  const std::size_t every = std::max<std::size_t>(1, (all - first) / kComparedPoints);
  for (std::size_t k = 0; k < all; ++k)
    if (k < first || (all - 1 - k) % every == 0) {
      path.points.push_back(k);
      path.length.push_back({{1.0 - curve.strain_x[k], 1.0 - curve.strain_y[k], 1.0 - curve.strain_z[k]}});
      path.compared += k < first ? 0 : 1;
    }
  return path;
}

std::vector<double> measured_on(const MacroCurve& curve, const FinesPath& path) {
  std::vector<double> out;
  const std::vector<double> ratio = stress_ratios(curve);
  for (std::size_t at = path.points.size() - path.compared; at < path.points.size(); ++at) {
    const std::size_t k = path.points[at];
    out.push_back(path.measure == FinesMeasure::stress_ratio ? ratio[k]
                                                             : curve.stress_lateral[k] / curve.stress_axial[k]);
  }
  return out;
}

MacroPacking pack_sites(std::int64_t count, std::uint64_t seed) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.soft_share = 0.0;
  spec.bodies = count;
  spec.solid_polydispersity = kSiteRatio;
  spec.start_pressure = 1e-4;
  spec.protocol = protocol_of(spec.preparation, 0.0);
  return make_macro_packing(spec, seed, 0);
}

std::vector<double> strain_fines(const MacroPacking& sites, const FinesState& state, const FaceFriction& friction,
                                 const FinesPath& path) {
  const Vec3 size = sites.size();
  const Cell<3> cell = box_cell<3>(size, {true, true, true});
  std::vector<Sphere<3>> spheres;
  for (const MacroBody& b : sites.bodies) spheres.push_back({home(b.x - sites.low, size), b.r});
  const double onset = 1.0 / (1.0 + state.void_ratio);
  const double phi = state_phi(state.form, state.modulus, state.exponent, onset, state.start_pressure);
  std::vector<CellContent> content;
  for (const double v : radical_cells(spheres, cell).volume) content.push_back({phi * v, state.void_ratio * phi * v});
  CellPacking packing({equation_of_fines(state), {}, friction}, spheres, std::move(content), cell);
  std::vector<double> out;
  try {
    for (std::size_t k = 1; k < path.length.size(); ++k) {
      Vec3 stretch;
      for (int a = 0; a < 3; ++a) stretch[a] = path.length[k][a] / path.length[k - 1][a];
      const CellPoint point = packing.strain(stretch, {.tolerance = kTolerance});
      if (point.relaxation.end != RelaxationEnd::converged) return {};
      if (k + path.compared >= path.length.size()) out.push_back(measure_of(point.stress, path.measure));
    }
  } catch (const UnusableResult&) {
    return {};
  }
  return out;
}

std::vector<std::vector<double>> strain_fines(const MacroPacking& sites, const FinesState& state,
                                              const std::vector<FaceFrictionTrial>& trials,
                                              const std::vector<FinesPath>& paths) {
  std::vector<std::vector<double>> parts(trials.size() * paths.size());
  parallel_tasks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t task) {
    const auto k = static_cast<std::size_t>(task);
    const FaceFrictionTrial& t = trials[k / paths.size()];
    parts[k] = strain_fines(sites, state, FaceFriction{t.friction, t.stiffness}, paths[k % paths.size()]);
  });
  stop_if_interrupted("straining cells of fines");
  std::vector<std::vector<double>> rows(trials.size());
  for (std::size_t k = 0; k < parts.size(); ++k)
    rows[k / paths.size()].insert(rows[k / paths.size()].end(), parts[k].begin(), parts[k].end());
  return rows;
}

double friction_seconds(std::int64_t cells) {
  constexpr double kSecondsPerCell = 0.14;  // two rounds of 3 x 3 trials and the last one, two paths each
  return kSecondsPerCell * static_cast<double>(cells);
}

}  // namespace softgrain

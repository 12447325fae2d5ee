#include "macrosim/cell_matter/cell_packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/error.h"
#include "common/dynamics/fire.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

/// Moves that are taken back in a row before a relaxation counts as diverged.
constexpr int kMaxRefusals = 30;

}  // namespace

CellPacking::CellPacking(CellLaw law, const std::vector<Sphere<3>>& sites, std::vector<CellContent> content,
                         const Cell<3>& cell)
    : law_(std::move(law)), sites_(sites), content_(std::move(content)), cell_(cell), periods_(sites.size()) {
  require_sound(law_, content_, sites_.size());
  bring_home();
  if (!evaluate())
    for (std::size_t i = 0; i < sites_.size(); ++i)
      if (!(cells_.volume[i] > content_[i].solid))
        throw BadInput(fmt::format("cells: cell {} has a volume of {:.4g} m^3 and holds {:.4g} m^3 of solid", i,
                                   cells_.volume[i], content_[i].solid));
  springs_.keep(forces_.springs);
}

/// Into the cell; what was moved back is remembered, so that faces keep their names.
void CellPacking::bring_home() {
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    const Vec3 s = cell_.fractional(sites_[i].x);
    Vec3 back;
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(s[k])) throw BadInput(fmt::format("cells: site {} has no place", i));
      back[k] = std::floor(s[k]);
      periods_[i][static_cast<std::size_t>(k)] += static_cast<std::int32_t>(back[k]);
    }
    if (back != Vec3{}) sites_[i].x -= cell_.edges * back;
  }
}

/// False: a cell has no pores, or a force is no number.
bool CellPacking::evaluate() {
  ++tessellations_;
  cells_ = radical_cells(sites_, cell_);
  forces_ = cell_forces(law_, content_, sites_, cells_, cell_.volume(), face_keys(cells_, periods_), springs_);
  return forces_.possible();
}

/// False, and the sites where they were: the move would leave a cell without pores.
bool CellPacking::move(const std::vector<Vec3>& velocity, double step, double longest) {
  const auto sites = sites_;
  const auto periods = periods_;
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    Vec3 d = velocity[i] * step;
    const double size = norm(d);
    if (size > longest) d *= longest / size;
    sites_[i].x += d;
  }
  bring_home();
  auto cells = cells_;
  auto forces = forces_;
  if (evaluate()) return true;
  sites_ = sites;
  periods_ = periods;
  cells_ = std::move(cells);
  forces_ = std::move(forces);
  return false;
}

RelaxationResult CellPacking::relax(const CellRelaxation& options) {
  RelaxationResult result;
  Fire fire;
  std::vector<Vec3> velocity(sites_.size());
  double longest = options.largest_move * std::cbrt(cell_.volume() / static_cast<double>(sites_.size()));
  const double usual = longest;
  std::vector<double> mass = forces_.mass;
  for (int refusals = 0; result.end == RelaxationEnd::not_run;) {
    result.residual = forces_.residual();
    if (result.residual <= options.tolerance)
      result.end = RelaxationEnd::converged;
    else if (refusals > kMaxRefusals)
      result.end = RelaxationEnd::diverged;
    else if (result.passes >= options.max_passes)
      result.end = RelaxationEnd::capped;
    if (result.end != RelaxationEnd::not_run) break;
    stop_if_interrupted("relaxing");
    if (result.passes % PseudoMasses::kInterval == 0) mass = forces_.mass;
    double power = 0.0;
    double speed2 = 0.0;
    double pull2 = 0.0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      power += dot(velocity[i], forces_.force[i]);
      speed2 += norm2(velocity[i]) * mass[i];
      pull2 += norm2(forces_.force[i]) / mass[i];
    }
    const Fire::Steering steering = fire.steer(power, speed2, pull2);
    for (std::size_t i = 0; i < sites_.size(); ++i)
      velocity[i] = velocity[i] * steering.keep + forces_.force[i] * ((steering.pull + fire.step) / mass[i]);
    ++result.passes;
    if (move(velocity, fire.step, longest)) {
      refusals = 0;
      longest = std::min(usual, 1.1 * longest);
    } else {
      ++refusals;
      longest *= 0.25;
      fire = {};
      std::fill(velocity.begin(), velocity.end(), Vec3{});
    }
  }
  return result;
}

CellPoint CellPacking::strain(const Vec3& stretch, const CellRelaxation& options) {
  for (int k = 0; k < 3; ++k)
    if (!(stretch[k] > 0.0) || !std::isfinite(stretch[k]))
      throw BadInput(fmt::format("cells: axis {} stretched by a factor of {}; it must be above 0", k, stretch[k]));
  const auto sites = sites_;
  const Cell<3> cell = cell_;
  tessellations_ = 0;
  for (int k = 0; k < 3; ++k) cell_.edges[k] *= stretch[k];
  for (auto& s : sites_)
    for (int k = 0; k < 3; ++k) s.x[k] *= stretch[k];
  if (!evaluate()) {
    sites_ = sites;
    cell_ = cell;
    evaluate();
    throw NotUsable("cells: the strain step would leave a cell without pores; take smaller steps");
  }
  CellPoint point;
  const RelaxationResult end = relax(options);
  springs_.keep(forces_.springs);
  point = now();
  point.relaxation = end;
  return point;
}

CellPoint CellPacking::now() const {
  CellPoint point;
  point.tessellations = tessellations_;
  point.volume = cell_.volume();
  point.stress = forces_.stress;
  point.energy = forces_.energy + forces_.spring_energy;
  point.guarded = forces_.guarded;
  point.sliding =
      cells_.faces.empty() ? 0.0 : static_cast<double>(forces_.sliding) / static_cast<double>(cells_.faces.size());
  return point;
}

}  // namespace softgrain

#include "macrosim/cell_matter/cell_packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/core/error.h"
#include "macrosim/cell_matter/cell_axes.h"

namespace softgrain {

namespace {

/// A part of a strain step is halved until it is 1/kFinest of its first size, and no further.
constexpr int kFinest = 1024;

CellRoom room_of(const CellState& state, bool periodic) {
  if (periodic) return box_cell(state.high, {true, true, true});
  return PlaneBox{state.low, state.high};
}

}  // namespace

CellPacking::CellPacking(CellLaw law, const std::vector<Sphere<3>>& sites, std::vector<CellContent> content,
                         const CellRoom& room)
    : law_(std::move(law)), sites_(sites), content_(std::move(content)), room_(room), periods_(sites.size()) {
  require_valid(law_, content_, sites_.size());
  room_.bring_home(sites_, periods_);
  if (!room_.holds(sites_)) throw InputError("cells: a site lies outside the planes");
  if (!evaluate())
    for (std::size_t i = 0; i < sites_.size(); ++i)
      if (!(cells_.volume[i] > content_[i].solid))
        throw InputError(fmt::format("cells: cell {} has a volume of {:.4g} m^3 and holds {:.4g} m^3 of solid", i,
                                     cells_.volume[i], content_[i].solid));
  keep();
}

CellPacking::CellPacking(CellLaw law, const CellState& state, bool periodic)
    : law_(std::move(law)),
      sites_(state.sites),
      content_(state.content),
      room_(room_of(state, periodic)),
      periods_(state.periods) {
  require_valid(law_, content_, sites_.size());
  if (periods_.size() != sites_.size()) throw IoError("cells: periods of other sites");
  const auto fits = [&](std::size_t cells, std::size_t parts) {
    return law_.memory ? cells == sites_.size() && parts == state.springs.springs.size() : cells == 0 && parts == 0;
  };
  if (!fits(state.strength.size(), state.springs.parts.size()) || state.next_pores.size() != state.strength.size())
    throw IoError("cells: a state of a law with another memory");
  springs_.keep(state.springs);
  springs_.keep_strength(state.strength);
  next_pores_ = state.next_pores;
  kept_stress_ = state.stress;
  if (!room_.holds(sites_) || !evaluate()) throw IoError("cells: a state that cannot be");
}

CellState CellPacking::state() const {
  return {sites_,      content_,    periods_, springs_.kept(), room_.low(), room_.high(), springs_.strength(),
          next_pores_, kept_stress_};
}

/// False: a cell has no pores, a site is outside, or a force is no number.
bool CellPacking::evaluate() {
  if (!room_.holds(sites_)) return false;
  ++tessellations_;
  cells_ = room_.cells_of(sites_);
  faces_ += static_cast<std::int64_t>(cells_.faces.size());
  forces_ = cell_forces(law_, content_, sites_, cells_, room_.volume(), face_keys(cells_, periods_), springs_);
  return forces_.possible();
}

Matrix<3> CellPacking::stress() const {
  if (room_.periodic()) return forces_.stress;
  const auto loads = wall_loads(cells_, forces_.pressure);
  const Vec3 size = room_.high() - room_.low();
  Matrix<3> out;
  for (int k = 0; k < 3; ++k) {
    const auto u = static_cast<std::size_t>(2 * k);
    out[k][k] = 0.5 * (loads[u] + loads[u + 1]) * size[k] / room_.volume();
  }
  return out;
}

/// Stretches the room and moves its sites along affinely.
void CellPacking::stretch(const Vec3& factor) {
  const Vec3 c = room_.centre();
  room_.stretch(factor);
  for (auto& s : sites_)
    for (int k = 0; k < 3; ++k) s.x[k] = c[k] + (s.x[k] - c[k]) * factor[k];
}

namespace {

/// Adds the relaxation of one part of a strain to `all`: the one that ended farthest from rest is kept, with the passes
/// of all parts.
void add_part(const RelaxationResult& part, RelaxationResult& all) {
  const std::int64_t passes = all.passes + part.passes;
  if (all.end == RelaxationEnd::not_run || farther_from_rest(part, all)) all = part;
  all.passes = passes;
}

double largest_strain(const Vec3& factor) {
  double out = 0.0;
  for (int k = 0; k < 3; ++k) out = std::max(out, std::abs(std::log(factor[k])));
  return out;
}

/// Stresses that are asked for when a share `done` of a strain is applied.
BoxControl on_the_way(BoxControl control, const Matrix<3>& before, double done) {
  for (int k = 0; k < 3; ++k) control.stress[k] = before[k][k] + (control.stress[k] - before[k][k]) * done;
  return control;
}

/// Parts in which held stresses go to their targets: with a large change at once a relaxation may strain the cells far
/// beyond the strain at which the stress is reached in small parts.
int stress_parts(const BoxControl* control, const Matrix<3>& before) {
  constexpr double kChange = 0.15;  // of the logarithm
  constexpr double kMost = 64.0;
  double largest = 0.0;
  for (int k = 0; control != nullptr && k < 3; ++k) {
    const bool pressed = control->by_stress[static_cast<std::size_t>(k)] && control->stress[k] > 0.0;
    if (pressed && before[k][k] > 0.0)
      largest = std::max(largest, std::abs(std::log(control->stress[k] / before[k][k])));
  }
  return static_cast<int>(std::clamp(std::ceil(largest / kChange), 1.0, kMost));
}

}  // namespace

/// What a trial leaves behind.
void CellPacking::keep() {
  if (law_.memory)
    remember();
  else
    springs_.keep(forces_.trial);
}

/// The slip of faces moves phi_J of the next part of a strain and, with it, strengths.
void CellPacking::remember() {
  const ShearMemory& memory = *law_.memory;
  const double mu_f = law_.friction.coefficient;
  kept_stress_ = stress();
  std::vector<double> slip(sites_.size());
  std::vector<double> used(sites_.size());
  SpringSet now = forces_.trial;
  for (std::size_t f = 0; f < now.springs.size(); ++f) {
    FaceSpring& spring = now.springs[f];
    const CellFace& face = cells_.faces[f];
    if (const auto at = springs_.find(spring.key)) {
      const FaceSpring& before = springs_.kept().springs[*at];
      const FaceSlip one = slip_of(before.force, before.stiffness, spring.force, spring.stiffness,
                                   spring.separation - before.separation, face.separation * (1.0 / face.distance));
      const double pressure = 0.5 * (forces_.response[static_cast<std::size_t>(face.i)].pressure +
                                     forces_.response[static_cast<std::size_t>(face.j)].pressure);
      for (const std::int32_t c : {face.i, face.j}) {
        if (!(pressure > 0.0)) continue;
        const auto k = static_cast<std::size_t>(c);
        slip[k] += face.area * one.slip / (3.0 * cells_.volume[k]);
        used[k] += one.work / (2.0 * cells_.volume[k] * pressure);
      }
    }
    const double shape = face.area / face.distance;
    const double ratio = shape / spring.shape;
    spring.stiffness *= ratio;
    spring.shape = shape;
    if (ratio >= 1.0) continue;
    spring.force *= ratio;
    for (Vec3& part : now.parts[f]) part *= ratio;
  }
  springs_.keep(std::move(now));
  std::vector<double> strength;
  next_pores_.clear();
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    CellContent next = content_[i];
    next.pores = memory.pores_after(mu_f, next, cells_.volume[i], slip[i], used[i]);
    next_pores_.push_back(next.pores);
    strength.push_back(memory.strength(mu_f, next, cells_.volume[i]));
  }
  springs_.keep_strength(std::move(strength));
}

/// Applies the affine part of a strain, then relaxes. Where this leaves a cell without pores, the strain is applied in
/// parts.
CellPoint CellPacking::step(const Vec3& factor, const BoxControl* control, const CellRelaxation& options) {
  for (int k = 0; k < 3; ++k)
    if (!(factor[k] > 0.0) || !std::isfinite(factor[k]))
      throw InputError(fmt::format("cells: axis {} stretched by a factor of {}; it must be above 0", k, factor[k]));
  const CellPacking before = *this;
  tessellations_ = faces_ = 0;
  RelaxationResult end;
  const Matrix<3> stress_before = kept_stress_;
  const int parts =
      law_.memory ? std::max(memory_parts(largest_strain(factor)), stress_parts(control, stress_before)) : 1;
  const int whole = parts * kFinest;
  int size = kFinest;
  for (int left = whole; left > 0;) {
    size = std::min(size, left);
    const auto sites = sites_;
    const auto periods = periods_;
    const CellRoom room = room_;
    const auto halve = [&] {
      sites_ = sites;
      periods_ = periods;
      room_ = room;
      size /= 2;
    };
    for (std::size_t i = 0; i < next_pores_.size(); ++i) content_[i].pores = next_pores_[i];
    const double share = static_cast<double>(size) / static_cast<double>(whole);
    Vec3 part;
    for (int k = 0; k < 3; ++k) part[k] = std::pow(factor[k], share);
    stretch(part);
    if (!evaluate()) {
      halve();
      if (size > 0) continue;
      *this = before;
      throw UnusableResult("cells: even a small part of this strain leaves a cell without pores");
    }
    const bool last = left == size;
    std::optional<Axes> axes;
    if (control != nullptr && (last || law_.memory)) {
      const double done = 1.0 - static_cast<double>(left - size) / static_cast<double>(whole);
      axes.emplace(*this, last ? *control : on_the_way(*control, stress_before, done));
    }
    const RelaxationResult part_end = rest(options, axes ? &*axes : nullptr);
    const bool steered = law_.memory && axes;
    const bool rested = part_end.end == RelaxationEnd::converged;
    if (steered && rested && axes->strained() > 2.0 * kMemoryStrain && size > 1) {
      halve();
      continue;
    }
    left -= size;
    add_part(part_end, end);
    keep();
    if (steered && !rested) break;  // a stress that is not borne: what comes after would start from nowhere
    if (steered && axes->strained() < kMemoryStrain) size = std::min(2 * size, kFinest);
  }
  CellPoint point = now();
  point.relaxation = end;
  return point;
}

CellPoint CellPacking::strain(const Vec3& factor, const CellRelaxation& options) {
  return step(factor, nullptr, options);
}

CellPoint CellPacking::press(const Vec3& factor, const BoxControl& control, const CellRelaxation& options) {
  return step(factor, &control, options);
}

CellPoint CellPacking::now() const {
  CellPoint point;
  point.tessellations = tessellations_;
  point.faces = faces_;
  point.volume = room_.volume();
  point.stress = stress();
  point.energy = forces_.energy + forces_.spring_energy;
  point.guarded = forces_.guarded;
  point.sliding =
      cells_.faces.empty() ? 0.0 : static_cast<double>(forces_.sliding) / static_cast<double>(cells_.faces.size());
  return point;
}

}  // namespace softgrain

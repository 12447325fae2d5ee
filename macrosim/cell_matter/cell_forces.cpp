#include "macrosim/cell_matter/cell_forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// Half the row sums of the stiffness matrix, entries by their size: sum_c (-p'_c) |dV_c/dx_j| sum_k |dV_c/dx_k|, plus
/// springs and the turning of faces under different pressures. A bound of the frequencies (Gershgorin) as Fire wants
/// it.
class RowSums {
 public:
  explicit RowSums(std::size_t sites) : own_(sites), spread_(sites, 0.0), rows_(sites, 0.0) {}

  void add(std::size_t i, std::size_t j, const FaceSlopes& slopes, double spring, double turn) {
    own_[i] -= slopes.lower;
    own_[j] -= slopes.upper;
    spread_[i] += norm(slopes.upper);
    spread_[j] += norm(slopes.lower);
    rows_[i] += 2.0 * spring + turn;
    rows_[j] += 2.0 * spring + turn;
  }

  [[nodiscard]] std::vector<double> masses(const RadicalCells& cells, const std::vector<Sphere<3>>& sites,
                                           const std::vector<CellResponse>& response) {
    for (std::size_t i = 0; i < rows_.size(); ++i) spread_[i] += norm(own_[i]);
    for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] += response[i].stiffness * norm(own_[i]) * spread_[i];
    for (const CellFace& face : cells.faces) {
      const auto i = static_cast<std::size_t>(face.i);
      const auto j = static_cast<std::size_t>(face.j);
      if (i == j) continue;
      const FaceSlopes slopes(face, sites[i].x);
      rows_[j] += response[i].stiffness * norm(slopes.upper) * spread_[i];
      rows_[i] += response[j].stiffness * norm(slopes.lower) * spread_[j];
    }
    double mean = 0.0;
    for (const double r : rows_) mean += r / static_cast<double>(rows_.size());
    for (double& r : rows_) r = 0.5 * std::max(r, 0.1 * mean);
    return std::move(rows_);
  }

 private:
  std::vector<Vec3> own_;
  std::vector<double> spread_;
  std::vector<double> rows_;
};

void add_dyad(Matrix<3>& m, const Vec3& a, const Vec3& b) {
  for (int k = 0; k < 3; ++k) m[k] += b * a[k];
}

/// Pressures with the part of the springs. Bits of a law without memory: the responses alone.
std::vector<double> pressures(const CellForces& forces, const RadicalCells& cells) {
  std::vector<double> out;
  out.reserve(forces.response.size());
  for (const CellResponse& r : forces.response) out.push_back(r.pressure);
  for (std::size_t f = 0; f < forces.trial.energy.size(); ++f) {
    if (!(forces.trial.energy[f] > 0.0)) continue;
    const auto i = static_cast<std::size_t>(cells.faces[f].i);
    const auto j = static_cast<std::size_t>(cells.faces[f].j);
    const auto bulk = [&](std::size_t c) { return forces.response[c].stiffness * cells.volume[c]; };
    const auto falls = [&](std::size_t c) {
      return -forces.response[c].stiffness - cells.volume[c] * forces.response[c].hardening;
    };
    const double share = forces.trial.energy[f] / (bulk(i) + bulk(j));
    out[i] += share * falls(i);
    out[j] += share * falls(j);
  }
  return out;
}

}  // namespace

bool CellForces::possible() const { return std::isfinite(energy) && std::isfinite(largest_force); }

CellForces cell_forces(const CellLaw& law, const std::vector<CellContent>& content, const std::vector<Sphere<3>>& sites,
                       const RadicalCells& cells, double volume, const std::vector<FaceKey>& keys,
                       const FaceSprings& springs) {
  CellForces out;
  out.force.resize(sites.size());
  out.response.reserve(sites.size());
  const double tail = law.memory ? law.memory->least_state : 0.0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    out.response.push_back(respond(law.equation, law.guard, content[i], cells.volume[i], tail));
    out.energy += out.response[i].energy;
    if (relative_pores(content[i], cells.volume[i]) < law.guard.from) ++out.guarded;
  }
  if (!std::isfinite(out.energy)) return out;
  out.trial = springs.trial(law.friction, law.memory.has_value(), cells, keys, out.response);
  out.pressure = pressures(out, cells);
  RowSums rows(sites.size());
  for (std::size_t f = 0; f < cells.faces.size(); ++f) {
    const CellFace& face = cells.faces[f];
    const auto i = static_cast<std::size_t>(face.i);
    const auto j = static_cast<std::size_t>(face.j);
    const double p_i = out.pressure[i];
    const double p_j = out.pressure[j];
    const FaceSlopes slopes(face, sites[i].x);
    const FaceSpring& spring = out.trial.springs[f];
    add_dyad(out.stress, (slopes.upper * p_i - slopes.lower * p_j + spring.force) * (1.0 / volume), face.separation);
    out.spring_energy += law.memory ? out.trial.energy[f] : spring.energy();
    out.mean_load += 0.5 * (p_i + p_j) * face.area / static_cast<double>(cells.faces.size());
    if (spring.slides) ++out.sliding;
    if (i == j) continue;
    out.force[j] += slopes.upper * (p_i - p_j) + spring.force;
    out.force[i] += slopes.lower * (p_j - p_i) - spring.force;
    rows.add(i, j, slopes, law.friction.coefficient > 0.0 ? spring.stiffness : 0.0,
             std::abs(p_i - p_j) * face.area / face.distance);
  }
  out.mass = rows.masses(cells, sites, out.response);
  for (const Vec3& f : out.force) out.largest_force = std::max(out.largest_force, norm(f));
  return out;
}

std::vector<FaceKey> face_keys(const RadicalCells& cells) {
  return face_keys(cells, std::vector<std::array<std::int32_t, 3>>(cells.volume.size()));
}

std::vector<FaceKey> face_keys(const RadicalCells& cells, const std::vector<std::array<std::int32_t, 3>>& periods) {
  std::vector<FaceKey> out;
  out.reserve(cells.faces.size());
  for (const CellFace& face : cells.faces) {
    FaceKey key{face.i, face.j, {}};
    int image = face.image;
    for (std::size_t k = 0; k < 3; ++k) {
      key.periods[k] =
          image % 3 - 1 - periods[static_cast<std::size_t>(face.j)][k] + periods[static_cast<std::size_t>(face.i)][k];
      image /= 3;
    }
    out.push_back(key);
  }
  return out;
}

std::array<double, 6> wall_loads(const RadicalCells& cells, const std::vector<double>& pressure) {
  std::array<double, 6> out{};
  for (const WallFace& face : cells.at_walls)
    out[static_cast<std::size_t>(face.plane)] += pressure[static_cast<std::size_t>(face.site)] * face.area;
  return out;
}

void require_valid(const CellLaw& law, const std::vector<CellContent>& content, std::size_t sites) {
  require_valid(law.equation, law.guard);
  const auto& f = law.friction;
  if (!(f.coefficient >= 0.0 && f.stiffness >= 0.0) || !std::isfinite(f.coefficient) || !std::isfinite(f.stiffness))
    throw InputError("cells: friction and stiffness of faces are numbers from 0 on");
  if (content.size() != sites) throw InputError(fmt::format("cells: {} contents for {} sites", content.size(), sites));
  for (std::size_t i = 0; i < content.size(); ++i)
    if (!(content[i].solid > 0.0 && content[i].pores > 0.0) || !std::isfinite(content[i].solid + content[i].pores))
      throw InputError(fmt::format(
          "cells: cell {} holds {} m^3 of solid and {} m^3 of pores where pressure begins; both must be above 0", i,
          content[i].solid, content[i].pores));
  if (!law.memory) return;
  require_valid(*law.memory);
  if (!std::holds_alternative<PorosityForm>(law.equation))
    throw InputError("cells: shear memory goes with the porosity form of the equation of state");
  if (!(f.coefficient > 0.0 && f.stiffness > 0.0))
    throw InputError("cells: shear memory needs friction and stiffness of faces above 0");
  for (std::size_t i = 0; i < content.size(); ++i)
    if (!(content[i].critical > 0.0) || !std::isfinite(content[i].critical))
      throw InputError(fmt::format("cells: cell {} has {} m^3 of pores at the critical state; above 0 are needed", i,
                                   content[i].critical));
}

}  // namespace softgrain

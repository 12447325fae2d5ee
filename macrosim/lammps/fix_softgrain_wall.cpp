// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/fix_softgrain_wall.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "macrosim/lammps/pair_softgrain.h"
#include "macrosim/lammps/words.h"
#include "neighbor.h"
#include "update.h"

namespace LAMMPS_NS {

using softgrain::ContactGeometry;
using softgrain::ContactResponse;
using softgrain::Vec;
namespace bridge = softgrain::lammps;

FixSoftgrainWall::FixSoftgrainWall(LAMMPS* engine, int count, char** words) : Fix(engine, count, words) {
  law_of_type_.assign(static_cast<std::size_t>(atom->ntypes) + 1, -1);
  int at = 3;
  while (at < count) {
    const std::string word = words[at++];
    if (word == "box") {
      box_ = true;
    } else if (word == "plane") {
      read_plane(words, count, at);
    } else if (word == "law") {
      read_law(words, count, at);
    } else {
      error->all(FLERR, "fix softgrain/wall: '" + word + "': known are box, plane, move and law");
    }
  }
  if (box_ == !planes.empty()) error->all(FLERR, std::string("fix softgrain/wall: give box, or at least one plane"));
  if (box_) {
    if (domain->triclinic) error->all(FLERR, std::string("fix softgrain/wall box: needs a box with right angles"));
    planes.resize(6);
    for (std::size_t k = 0; k < 6; ++k) planes[k].normal[static_cast<int>(k / 2)] = k % 2 == 0 ? 1.0 : -1.0;
  }
  for (const bridge::Plane& p : planes) from_.push_back(p.point);
  start_ = update->ntimestep;
  force_.assign(planes.size(), 0.0);
  force_all_ = force_;
  vector_flag = 1;
  size_vector = static_cast<int>(planes.size());
  global_freq = 1;
  extvector = 1;
  restart_global = moving_ ? 1 : 0;
  time_depend = moving_ ? 1 : 0;
  force_reneighbor = 1;
  next_reneighbor = -1;
  dynamic_group_allow = 0;
}

/// Nobody asks a wall that is gone; at the end of LAMMPS the pair style goes first.
FixSoftgrainWall::~FixSoftgrainWall() {
  if (force == nullptr) return;
  if (auto* pair = dynamic_cast<PairSoftgrain*>(force->pair)) std::erase(pair->walls, this);
}

void FixSoftgrainWall::read_plane(char** words, int count, int& at) {
  if (at + 6 > count) error->all(FLERR, std::string("fix softgrain/wall: plane PX PY PZ NX NY NZ"));
  bridge::Plane p;
  for (int k = 0; k < 3; ++k) {
    p.point[k] = bridge::number(words[at + k], "coordinate of a plane", error);
    p.normal[k] = bridge::number(words[at + 3 + k], "normal of a plane", error);
  }
  const double length = norm(p.normal);
  if (!(length > 0.0)) error->all(FLERR, std::string("fix softgrain/wall: the normal of a plane must not be zero"));
  p.normal *= 1.0 / length;
  at += 6;
  if (at < count && std::string(words[at]) == "move") {
    if (at + 4 > count) error->all(FLERR, std::string("fix softgrain/wall: move VX VY VZ"));
    for (int k = 0; k < 3; ++k) p.velocity[k] = bridge::number(words[at + 1 + k], "velocity of a plane", error);
    moving_ = true;
    at += 4;
  }
  planes.push_back(p);
}

void FixSoftgrainWall::read_law(char** words, int count, int& at) {
  if (at + 3 > count) error->all(FLERR, std::string("fix softgrain/wall: law TYPES FILE NAME"));
  const auto [low, high] = bridge::type_range(words[at], atom->ntypes, error);
  int end = at + 3;
  if (std::string(words[at + 1]) == "card")
    while (end < count && std::string(words[end]) != "law" && std::string(words[end]) != "plane" &&
           std::string(words[end]) != "box")
      ++end;
  laws.push_back(bridge::read_law_words(words + at + 1, end - at - 1, world, error));
  bridge::check_dimension(laws.back(), domain->dimension, error);
  for (int t = low; t <= high; ++t) law_of_type_[static_cast<std::size_t>(t)] = static_cast<int>(laws.size()) - 1;
  at = end;
}

int FixSoftgrainWall::setmask() { return FixConst::POST_FORCE; }

void FixSoftgrainWall::init() {
  pair_ = dynamic_cast<PairSoftgrain*>(force->pair);
  if (pair_ == nullptr) error->all(FLERR, std::string("fix softgrain/wall needs pair style softgrain"));
  for (int i = 0; i < atom->nlocal; ++i) {
    const auto type = static_cast<std::size_t>(atom->type[i]);
    if (law_of_type_[type] < 0)
      error->one(FLERR, "fix softgrain/wall: no law for atoms of type " + std::to_string(type));
  }
  for (std::size_t t = 1; t < law_of_type_.size(); ++t) {
    if (law_of_type_[t] < 0) continue;
    auto& law = laws[static_cast<std::size_t>(law_of_type_[t])];
    law = pair_->oriented(law, "of a wall", pair_->is_soft(static_cast<int>(t)), false);
  }
}

void FixSoftgrainWall::follow_box() {
  for (std::size_t k = 0; k < 6; ++k) {
    bridge::Plane& p = planes[k];
    const int axis = static_cast<int>(k / 2);
    Vec<3> point = bridge::Bodies::vec(domain->boxlo);
    if (k % 2 != 0) point[axis] = domain->boxhi[axis];
    const bool one_on = update->setupflag == 0 && followed_ == update->ntimestep - 1 && update->dt > 0.0;
    p.velocity = {};
    if (one_on) p.velocity[axis] = (point[axis] - p.point[axis]) / update->dt;
    if (pair_->flows) p.velocity[axis] = pair_->flow_at(axis, point[axis]);
    p.point = point;
  }
}

/// Where the time step changes, planes go on from where they are.
void FixSoftgrainWall::restart_motion() {
  if (followed_ >= 0) {
    for (std::size_t k = 0; k < planes.size(); ++k) from_[k] = planes[k].point;
    start_ = followed_;
  }
  dt_ = update->dt;
}

void FixSoftgrainWall::follow() {
  if (followed_ == update->ntimestep && update->setupflag == 0) return;  // a list was made in this step
  if (box_) {
    follow_box();
  } else if (moving_) {
    if (dt_ != update->dt) restart_motion();
    const double time = static_cast<double>(update->ntimestep - start_) * dt_;
    for (std::size_t k = 0; k < planes.size(); ++k) planes[k].point = from_[k] + planes[k].velocity * time;
  }
  followed_ = update->ntimestep;
}

void FixSoftgrainWall::build(const bridge::Bodies& b, const std::vector<bridge::AtomMemory>& past_of, int before) {
  follow();
  std::vector<bridge::NearPair> near;
  for (int i = 0; i < b.own; ++i) {
    const int law = law_of_type_[static_cast<std::size_t>(b.type[i])];
    const softgrain::PairBodies pair{b.r(i), 0.0, 1.0 / b.mass[i], 0.0};
    std::visit(
        [&](const auto& l) {
          const double reach = b.r(i) - softgrain::onset_of(l, pair) + neighbor->skin;
          for (std::size_t k = 0; k < planes.size(); ++k)
            if (dot(b.vec(b.x[i]) - planes[k].point, planes[k].normal) < reach)
              near.push_back({i, static_cast<int>(k), law, l.pair_constants(pair)});
        },
        laws[static_cast<std::size_t>(law)]);
  }
  store.assign(near, laws.size());
  for (std::size_t c = 0; c < store.size(); ++c) {
    const bridge::Remembered* past =
        bridge::find(past_of[static_cast<std::size_t>(store.i[c])], -(before + store.j[c] + 1));
    if (past == nullptr) continue;
    store.touched[c] = 1;
    store.spring[c] = past->spring;
    store.memory[c] = past->memory;
    store.roll[c] = past->roll;
  }
  listed_.clear();
  for (const bridge::Plane& p : planes) listed_.push_back(p.point);
}

/// Atoms may move half the skin between two lists, and so may planes.
void FixSoftgrainWall::ask_for_list() {
  if (box_ && pair_->box_followed) return;  // walls and bodies go with the box
  double way = 0.0;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const double time = pair_->flows ? std::max(pair_->spring_dt, 0.0) : update->dt;
    const double step = std::abs(dot(planes[k].velocity, planes[k].normal)) * time;
    way = std::max(way, std::abs(dot(planes[k].point - listed_[k], planes[k].normal)) + 2.0 * step);
  }
  if (way > 0.5 * neighbor->skin) next_reneighbor = update->ntimestep + 1;
}

void FixSoftgrainWall::add_shares(const bridge::Bodies& b, const bridge::Pass& now) const {
  const bridge::PlaneSurface surface{b, planes};
  const bridge::StorePairs source{store, surface, now};
  bridge::over_sections(store, laws, [&](const auto& law, const softgrain::PairRange& range) {
    softgrain::add_shares(source, law, range);
  });
}

void FixSoftgrainWall::close_sums(const bridge::Bodies& b, const bridge::Pass& now) const {
  const bridge::PlaneSurface surface{b, planes};
  const bridge::StorePairs source{store, surface, now};
  bridge::over_sections(store, laws, [&](const auto& law, const softgrain::PairRange& range) {
    softgrain::close_sums(source, law, range);
  });
}

void FixSoftgrainWall::post_force(int) {
  const bridge::Bodies b = pair_->bodies();
  const bridge::PlaneSurface surface{b, planes};
  const bridge::Pass now = pair_->pass();
  std::fill(force_.begin(), force_.end(), 0.0);
  auto& gathered = pair_->gathered;
  auto sink = bridge::to_sink([&](int i, int plane, const ContactGeometry<3>& g, const ContactResponse<3>& r) {
    const Vec<3> push = g.normal * r.normal_force + r.tangential_force;
    const Vec<3> moment = cross(g.normal, r.tangential_force);
    for (int k = 0; k < 3; ++k) {
      atom->f[i][k] += push[k];
      atom->torque[i][k] += r.rolling_moment[k] - moment[k] * g.arm_i;
    }
    force_[static_cast<std::size_t>(plane)] += r.normal_force;
    if (!gathered.wanted) return;
    gathered.add(i, r.normal_stiffness + r.tangential_stiffness,
                 r.tangential_stiffness * g.arm_i * g.arm_i + r.rolling_stiffness);
    if (r.normal_force == 0.0) return;
    gathered.force_sum += std::abs(r.normal_force);
    gathered.contacts += 1.0;
  });
  bridge::StorePairs source{store, surface, now};
  bridge::over_sections(
      store, laws, [&](const auto& law, const softgrain::PairRange& range) { run_section(source, law, range, sink); });
  pair_->evaluations += static_cast<double>(store.size());
  summed_ = -1;
  if (update->setupflag == 0) ask_for_list();
}

double FixSoftgrainWall::compute_vector(int k) {
  if (summed_ != update->ntimestep) {
    MPI_Allreduce(force_.data(), force_all_.data(), static_cast<int>(force_.size()), MPI_DOUBLE, MPI_SUM, world);
    summed_ = update->ntimestep;
  }
  return force_all_[static_cast<std::size_t>(k)];
}

/// Where moving planes started, so that a restarted run finds them where they are. The step is written as -1 - step,
/// which says that the number of planes follows: earlier versions wrote none.
void FixSoftgrainWall::write_restart(FILE* file) {
  std::vector<double> data{-1.0 - static_cast<double>(update->ntimestep), static_cast<double>(planes.size())};
  for (const bridge::Plane& p : planes)
    for (int k = 0; k < 3; ++k) data.push_back(p.point[k]);
  if (comm->me != 0) return;
  const int size = static_cast<int>(data.size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, file);
  fwrite(data.data(), sizeof(double), data.size(), file);
}

void FixSoftgrainWall::restart(char* buf) {
  std::array<double, 2> head{};
  std::memcpy(head.data(), buf, sizeof head);
  const bool counted = head[0] < 0.0;
  if (counted && head[1] != static_cast<double>(from_.size()))
    error->all(FLERR, "fix softgrain/wall " + std::string(id) + ": the restart file has " +
                          std::to_string(static_cast<int>(head[1])) + " planes of it, the script " +
                          std::to_string(from_.size()) + ": give it another ID, or the same planes");
  start_ = static_cast<bigint>(counted ? -1.0 - head[0] : head[0]);
  std::vector<double> places(3 * from_.size());
  std::memcpy(places.data(), buf + (counted ? 2 : 1) * sizeof(double), places.size() * sizeof(double));
  for (std::size_t k = 0; k < from_.size(); ++k)
    for (int a = 0; a < 3; ++a) from_[k][a] = places[3 * k + static_cast<std::size_t>(a)];
}

double FixSoftgrainWall::memory_usage() { return static_cast<double>(store.size()) * 80.0; }

}  // namespace LAMMPS_NS

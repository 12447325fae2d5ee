// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/fix_softgrain_relax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
#include "macrosim/lammps/pair_softgrain.h"
#include "macrosim/lammps/words.h"
#include "modify.h"
#include "output.h"
#include "timer.h"
#include "update.h"

namespace LAMMPS_NS {

using softgrain::PseudoMasses;
namespace bridge = softgrain::lammps;

namespace {

double norm2(const double* a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }
double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void limit_length(double* v, double longest) {
  const double size2 = norm2(v);
  if (!(size2 > longest * longest)) return;
  for (int k = 0; k < 3; ++k) v[k] *= longest / std::sqrt(size2);
}

/// The present name of a keyword, which may be that of an earlier version.
std::string current_key(const std::string& key) {
  constexpr std::array<std::array<const char*, 2>, 5> kOld{{{"restless", "unbalanced_fraction"},
                                                            {"lead", "max_displacement_ratio"},
                                                            {"alike", "isotropic"},
                                                            {"lists", "log_lists"},
                                                            {"follow", "track_box"}}};
  for (const auto& [before, now] : kOld)
    if (key == before) return now;
  return key;
}

}  // namespace

FixSoftgrainRelax::FixSoftgrainRelax(LAMMPS* engine, int count, char** words) : Fix(engine, count, words) {
  for (int at = 3; at < count;) at += set(count - at, words + at);
  time_integrate = 1;
  nevery = 1;
  scalar_flag = vector_flag = 1;
  size_vector = 9;
  global_freq = 1;
  extscalar = extvector = 0;
  restart_global = 1;
  dynamic_group_allow = 0;
  maxexchange = 2;
  note_box();
  FixSoftgrainRelax::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

/// One key and what belongs to it; how many words that were.
int FixSoftgrainRelax::set(int count, char** words) {
  const std::string key = current_key(words[0]);
  const int values = key == "stress" ? 3 : 1;
  if (count < 1 + values)
    error->all(FLERR, "fix softgrain/relax: '" + key + "' needs " + (values == 3 ? "three values" : "a value"));
  if (key == "stress")
    set_stress(words + 1);
  else
    set_number(key, words[1]);
  box_change = pressed() ? BOX_CHANGE_SIZE : NO_BOX_CHANGE;
  return 1 + values;
}

void FixSoftgrainRelax::set_number(const std::string& key, const std::string& word) {
  if ((key == "track_box" || key == "isotropic" || key == "log_lists") && (word == "yes" || word == "no")) {
    (key == "isotropic" ? isotropic_ : key == "log_lists" ? log_lists_ : track_box_) = word == "yes";
    force_reneighbor = log_lists_ ? 1 : 0;
    next_reneighbor = -1;
    return;
  }
  const double value = bridge::number(word, key, error);
  if (key == "tolerance" && value > 0.0)
    tolerance_ = value;
  else if (key == "floor" && value >= 0.0)
    floor_ = value;
  else if (key == "max_passes" && value >= 1.0)
    max_passes_ = value;
  else if (key == "max_move" && value > 0.0)
    limit_.most = value;
  else if (key == "max_displacement_ratio" && value > 0.0)
    limit_.lead = value;
  else if (key == "unbalanced_fraction" && value >= 0.0 && value < 1.0)
    unbalanced_fraction_ = value;
  else if (key == "least_stiffness" && value >= 0.0)
    least_stiffness_ = value;
  else if (key == "stress_tolerance" && value > 0.0)
    stress_tolerance_ = value;
  else if (key == "least_stress" && value >= 0.0)
    least_stress_ = value;
  else if (key == "farthest" && value > 0.0)
    farthest_ = value;
  else
    error->all(
        FLERR,
        "fix softgrain/relax: '" + key + " " + word +
            "': known are tolerance > 0, floor >= 0, max_passes >= 1, max_move > 0, max_displacement_ratio > 0, "
            "0 <= unbalanced_fraction < 1, least_stiffness >= 0, track_box yes|no, log_lists yes|no, "
            "stress SX|no SY|no SZ|no, isotropic yes|no, stress_tolerance > 0, least_stress >= 0 and farthest > 0");
}

int FixSoftgrainRelax::modify_param(int count, char** words) {
  if (count < 2) error->all(FLERR, std::string("fix_modify of softgrain/relax: KEY VALUE"));
  return set(count, words);
}

FixSoftgrainRelax::~FixSoftgrainRelax() {
  atom->delete_callback(id, Atom::GROW);
  if (pair_ != nullptr && force != nullptr && force->pair == pair_) {
    pair_->spring_dt = -1.0;
    pair_->flows = pair_->box_followed = false;
    pair_->gathered.wanted = pair_->gathered.pressed = false;
  }
}

int FixSoftgrainRelax::setmask() {
  return FixConst::PRE_EXCHANGE | FixConst::INITIAL_INTEGRATE | FixConst::END_OF_STEP | FixConst::POST_RUN |
         FixConst::PRE_FORCE | FixConst::PRE_NEIGHBOR;
}

void FixSoftgrainRelax::init() {
  pair_ = dynamic_cast<PairSoftgrain*>(force->pair);
  if (pair_ == nullptr) error->all(FLERR, std::string("fix softgrain/relax needs pair style softgrain"));
  pair_->box_followed = log_lists_;
  bool before = true;
  for (int k = 0; k < modify->nfix; ++k) {
    if (modify->fix[k] == this) before = false;
    if (!before && dynamic_cast<FixSoftgrainWall*>(modify->fix[k]) != nullptr)
      error->all(FLERR, std::string("fix softgrain/wall must come before fix softgrain/relax in the script"));
  }
  // What moves the box knows lengths alone: a strain of x would shear a tilted box besides.
  if (domain->triclinic != 0 && (pressed() || log_lists_))
    error->all(FLERR, std::string("fix softgrain/relax: stress and log_lists need a box with right angles"));
  const bool periodic = domain->xperiodic != 0 && domain->yperiodic != 0 && domain->zperiodic != 0;
  if (pressed() && !periodic && box_walls() == nullptr)
    error->all(FLERR, std::string("fix softgrain/relax: stress needs boundary p p p, or fix softgrain/wall box"));
}

void FixSoftgrainRelax::stop_motion() {
  for (int i = 0; i < atom->nlocal; ++i) {
    std::fill(atom->v[i], atom->v[i] + 3, 0.0);
    std::fill(atom->omega[i], atom->omega[i] + 3, 0.0);
  }
}

void FixSoftgrainRelax::note_box() {
  for (int k = 0; k < 3; ++k) box_[k] = domain->boxhi[k] - domain->boxlo[k];
  tilt_ = {{domain->xy, domain->xz, domain->yz}};
}

/// Stops all motion and finds the strain of the box since the last run. Ghosts, which are made afterwards, need the
/// velocities too.
void FixSoftgrainRelax::setup_pre_exchange() {
  const softgrain::Vec<3> before = box_;
  const softgrain::Vec<3> tilt_before = tilt_;
  note_box();
  if (track_box_ && domain->triclinic != 0 && (before != box_ || tilt_before != tilt_))
    error->all(FLERR, std::string("fix softgrain/relax: contact springs follow boxes with right angles: a triclinic "
                                  "box has been strained; give track_box no"));
  stop_motion();
  pair_->strained = pair_->flows = track_box_ && before != box_;
  for (int k = 0; k < 3; ++k) pair_->flow[k] = 0.0;
  if (!pair_->strained) return;
  for (int k = 0; k < 3; ++k) {
    const double strain = 1.0 - box_[k] / before[k];
    pair_->flow[k] = -strain / (1.0 - strain);
  }
}

/// Resets the relaxation before the force pass of the setup.
void FixSoftgrainRelax::setup_pre_force(int) {
  pair_->gathered.wanted = true;
  pair_->gathered.pressed = pressed();
  if (update->nsteps == 0) return;  // a look at the state as it is
  fire_ = {};
  box_velocity_ = {};
  box_strain_ = {};
  passes_before_ += passes_;
  passes_ = 0.0;
  end_ = not_run;
}

void FixSoftgrainRelax::setup(int) {
  pair_->strained = pair_->flows = false;
  stop_motion();
  take_box_sums();
  if (update->nsteps > 0) judge();
}

/// Square of the net force on a body, or of its moment over its radius where that is larger; infinite where it is not
/// finite.
double FixSoftgrainRelax::net_force2(int i) const {
  const double f2 = norm2(atom->f[i]);
  const double m2 = norm2(atom->torque[i]) / (atom->radius[i] * atom->radius[i]);
  return std::isfinite(f2 + m2) ? std::max(f2, m2) : std::numeric_limits<double>::infinity();
}

double FixSoftgrainRelax::worst_net_force() const {
  double worst = 0.0;
  for (int i = 0; i < atom->nlocal && !std::isinf(worst); ++i) worst = std::max(worst, net_force2(i));
  double all = 0.0;
  MPI_Allreduce(&worst, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return std::sqrt(all);
}

/// The largest but for those of the restless few: of every rank as many as might be among them, and the one after.
double FixSoftgrainRelax::settled_net_force() const {
  const auto few = static_cast<std::size_t>(unbalanced_fraction_ * static_cast<double>(atom->natoms));
  if (few == 0) return worst_net_force();
  std::vector<double> own(static_cast<std::size_t>(atom->nlocal));
  for (int i = 0; i < atom->nlocal; ++i) own[static_cast<std::size_t>(i)] = net_force2(i);
  const std::size_t sent = few + 1;
  own.resize(std::max(own.size(), sent), -1.0);
  const auto at_few = static_cast<std::ptrdiff_t>(few);
  std::nth_element(own.begin(), own.begin() + at_few, own.end(), std::greater<>());
  std::vector<double> all(sent * static_cast<std::size_t>(comm->nprocs));
  MPI_Allgather(own.data(), static_cast<int>(sent), MPI_DOUBLE, all.data(), static_cast<int>(sent), MPI_DOUBLE, world);
  std::nth_element(all.begin(), all.begin() + at_few, all.end(), std::greater<>());
  if (std::isinf(*std::max_element(all.begin(), all.begin() + at_few + 1))) return HUGE_VAL;
  return std::sqrt(std::max(all[few], 0.0));
}

/// Whether this run is at its end.
void FixSoftgrainRelax::judge() {
  const std::array<double, 2> own{pair_->gathered.force_sum, pair_->gathered.contacts};
  std::array<double, 2> all{};
  MPI_Allreduce(own.data(), all.data(), 2, MPI_DOUBLE, MPI_SUM, world);
  mean_force_ = all[1] > 0.0 ? all[0] / all[1] : 0.0;
  const double scale = std::max(mean_force_, floor_);
  const double worst = settled_net_force();
  residual_ = scale > 0.0 ? worst / scale : 0.0;
  if (!std::isfinite(worst))
    end_ = diverged;
  else if (worst <= tolerance_ * scale && (!pressed() || box_residual() <= 1.0))
    end_ = converged;
  else if (passes_ >= max_passes_ || (pressed() && std::max({std::abs(box_strain_[0]), std::abs(box_strain_[1]),
                                                             std::abs(box_strain_[2])}) > farthest_))
    end_ = capped;
  if (end_ != not_run) finish();
}

/// Ends the loop of LAMMPS as fix halt does, with output of this step.
void FixSoftgrainRelax::finish() {
  stop_motion();
  pair_->flows = false;
  if (update->setupflag == 0) output->next = output->next_thermo = update->ntimestep;
  timer->force_timeout();
}

void FixSoftgrainRelax::scale_masses() {
  const auto own = static_cast<std::size_t>(atom->nlocal);
  const auto& gathered = pair_->gathered;
  std::array<double, 2> sum{};
  for (std::size_t i = 0; i < own; ++i) {
    sum[0] += gathered.translation[i];
    sum[1] += atom->radius[i];
  }
  std::array<double, 2> all{};
  MPI_Allreduce(sum.data(), all.data(), 2, MPI_DOUBLE, MPI_SUM, world);
  const PseudoMasses masses(all[0], all[1], least_stiffness_, all[0] > 0.0 ? 0.0 : worst_net_force());
  for (std::size_t i = 0; i < own; ++i) {
    inverse_mass_[i] = masses.inverse_mass(gathered.translation[i], atom->radius[i]);
    inverse_inertia_[i] = masses.inverse_inertia(gathered.rotation[i], atom->radius[i]);
  }
  if (pressed()) scale_box(masses);
}

void FixSoftgrainRelax::steer() {
  std::array<double, 4> sum{};
  double** v = atom->v;
  double** f = atom->f;
  double** omega = atom->omega;
  double** torque = atom->torque;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double mass = 1.0 / inverse_mass_[static_cast<std::size_t>(i)];
    const double inertia = 1.0 / inverse_inertia_[static_cast<std::size_t>(i)];
    sum[0] += dot(v[i], f[i]) + dot(omega[i], torque[i]);
    sum[1] += norm2(v[i]) * mass + norm2(omega[i]) * inertia;
    sum[2] += norm2(f[i]) / mass + norm2(torque[i]) / inertia;
    sum[3] += norm2(v[i]) / (atom->radius[i] * atom->radius[i]);
  }
  std::array<double, 4> all{};
  MPI_Allreduce(sum.data(), all.data(), 4, MPI_DOUBLE, MPI_SUM, world);
  if (pressed()) steer_box(all.data());
  const softgrain::Fire::Steering steering = fire_.steer(all[0], all[1], all[2]);
  typical_move_ = fire_.step * std::sqrt(all[3] / static_cast<double>(atom->natoms));
  if (pressed()) box_velocity_ = box_velocity_ * steering.keep + box_force_ * (steering.pull * box_inverse_mass_);
  if (steering.stop) {
    stop_motion();
    return;
  }
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = 0; k < 3; ++k) {
      const auto u = static_cast<std::size_t>(i);
      v[i][k] = v[i][k] * steering.keep + f[i][k] * (steering.pull * inverse_mass_[u]);
      omega[i][k] = omega[i][k] * steering.keep + torque[i][k] * (steering.pull * inverse_inertia_[u]);
    }
}

void FixSoftgrainRelax::move() {
  const double longest = limit_.at(typical_move_, static_cast<std::int64_t>(passes_));
  for (int i = 0; i < atom->nlocal; ++i) {
    const auto u = static_cast<std::size_t>(i);
    double* v = atom->v[i];
    double* omega = atom->omega[i];
    for (int k = 0; k < 3; ++k) {
      v[k] += atom->f[i][k] * (fire_.step * inverse_mass_[u]);
      omega[k] += atom->torque[i][k] * (fire_.step * inverse_inertia_[u]);
    }
    limit_length(v, longest * atom->radius[i] / fire_.step);
    limit_length(omega, limit_.most / fire_.step);
    for (int k = 0; k < 3; ++k) atom->x[i][k] += v[k] * fire_.step;
  }
}

/// Whether convergence is checked after this many passes.
bool FixSoftgrainRelax::checks_convergence(double passes) const {
  return static_cast<std::int64_t>(passes) % PseudoMasses::kInterval == 0 || passes >= max_passes_;
}

void FixSoftgrainRelax::initial_integrate(int) {
  const auto pass = static_cast<std::int64_t>(passes_);
  if (pass % PseudoMasses::kInterval == 0) scale_masses();
  steer();
  move();
  if (pressed()) carry();
  if (log_lists_) watch_lists();
  pair_->spring_dt = fire_.step;
  pair_->gathered.wanted = checks_convergence(passes_ + 1.0);
}

void FixSoftgrainRelax::end_of_step() {
  passes_ += 1.0;
  if (pressed()) {
    take_box_sums();
    // A body that nothing pushes would hit its neighbours again and again while they relax.
    for (int i = 0; i < atom->nlocal; ++i)
      if (norm2(atom->f[i]) == 0.0) std::fill(atom->v[i], atom->v[i] + 3, 0.0);
  }
  if (checks_convergence(passes_)) judge();
}

void FixSoftgrainRelax::post_run() {
  if (end_ != not_run) timer->reset_timeout();
}

double FixSoftgrainRelax::compute_vector(int k) {
  if (k > 5) return stress_[k - 6];
  if (k == 5) {
    double all = 0.0;
    MPI_Allreduce(&pair_->evaluations, &all, 1, MPI_DOUBLE, MPI_SUM, world);
    return evaluations_before_ + all;
  }
  const std::array<double, 5> values{passes_, residual_, static_cast<double>(end_), mean_force_,
                                     passes_before_ + passes_};
  return values[static_cast<std::size_t>(k)];
}

void FixSoftgrainRelax::write_restart(FILE* file) {
  const double evaluations = compute_vector(5);
  if (comm->me != 0) return;
  const std::array<double, 2> data{passes_before_ + passes_, evaluations};
  const int size = static_cast<int>(data.size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, file);
  fwrite(data.data(), sizeof(double), data.size(), file);
}

void FixSoftgrainRelax::restart(char* buf) {
  std::array<double, 2> data{};
  std::memcpy(data.data(), buf, sizeof data);
  passes_before_ = data[0];
  evaluations_before_ = data[1];
}

void FixSoftgrainRelax::grow_arrays(int n) {
  inverse_mass_.resize(static_cast<std::size_t>(n));
  inverse_inertia_.resize(static_cast<std::size_t>(n));
}

void FixSoftgrainRelax::copy_arrays(int i, int j, int) {
  inverse_mass_[static_cast<std::size_t>(j)] = inverse_mass_[static_cast<std::size_t>(i)];
  inverse_inertia_[static_cast<std::size_t>(j)] = inverse_inertia_[static_cast<std::size_t>(i)];
}

int FixSoftgrainRelax::pack_exchange(int i, double* buf) {
  buf[0] = inverse_mass_[static_cast<std::size_t>(i)];
  buf[1] = inverse_inertia_[static_cast<std::size_t>(i)];
  return 2;
}

int FixSoftgrainRelax::unpack_exchange(int i, double* buf) {
  inverse_mass_[static_cast<std::size_t>(i)] = buf[0];
  inverse_inertia_[static_cast<std::size_t>(i)] = buf[1];
  return 2;
}

}  // namespace LAMMPS_NS

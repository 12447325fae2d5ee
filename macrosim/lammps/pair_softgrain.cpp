// Pair style softgrain, and all styles of softgrain made known to a LAMMPS.
// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/pair_softgrain.h"

#include <algorithm>
#include <cmath>

#include "atom.h"
#include "comm.h"
#include "common/contact/law_set.h"
#include "common/core/error.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "lammps.h"
#include "macrosim/lammps/compute_softgrain_contacts.h"
#include "macrosim/lammps/fix_softgrain_history.h"
#include "macrosim/lammps/fix_softgrain_relax.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
#include "macrosim/lammps/forward_values.h"
#include "macrosim/lammps/words.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

namespace LAMMPS_NS {

using softgrain::AnyLaw;
using softgrain::ContactGeometry;
using softgrain::ContactResponse;
using softgrain::MultiContactSum;
using softgrain::PairRange;
using softgrain::Vec;
namespace bridge = softgrain::lammps;

namespace {

constexpr const char* kHistoryFix = "SOFTGRAIN_HISTORY";
constexpr int kSumSize = 14;

/// Stiffness sums of one contact to its own bodies.
void gather(PairSoftgrain::Gathered& out, int i, int j, int own, const ContactGeometry<3>& g,
            const ContactResponse<3>& r) {
  const double k = r.normal_stiffness + r.tangential_stiffness;
  out.add(i, k, r.tangential_stiffness * g.arm_i * g.arm_i + r.rolling_stiffness);
  if (j < own) out.add(j, k, r.tangential_stiffness * g.arm_j * g.arm_j + r.rolling_stiffness);
  if (r.normal_force == 0.0) return;
  const double share = j < own ? 1.0 : 0.5;
  out.force_sum += share * std::abs(r.normal_force);
  out.contacts += share;
}

void pack(const MultiContactSum<3>& s, double* buf) {
  *buf++ = s.volume;
  *buf++ = s.square;
  for (int k = 0; k < 3; ++k) *buf++ = s.first[k];
  for (const double x : s.second) *buf++ = x;
  *buf++ = s.gain;
  *buf++ = s.gain_slope;
  *buf++ = s.ready ? 1.0 : 0.0;
}

void unpack(const double* buf, MultiContactSum<3>& s) {
  s.volume = *buf++;
  s.square = *buf++;
  for (int k = 0; k < 3; ++k) s.first[k] = *buf++;
  for (double& x : s.second) x = *buf++;
  s.gain = *buf++;
  s.gain_slope = *buf++;
  s.ready = *buf++ != 0.0;
}

}  // namespace

PairSoftgrain::PairSoftgrain(LAMMPS* engine) : Pair(engine) {
  single_enable = 1;
  single_extra = 7;
  extra_.assign(7, 0.0);
  svector = extra_.data();
  restartinfo = 0;
  manybody_flag = 0;
  finitecutflag = 1;
  no_virial_fdotr_compute = 1;
}

PairSoftgrain::~PairSoftgrain() {
  svector = nullptr;
  if (history_ != nullptr) modify->delete_fix(kHistoryFix);
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

void PairSoftgrain::allocate() {
  allocated = 1;
  const int n = types_ = atom->ntypes;
  memory->create(setflag, n + 1, n + 1, "pair:setflag");
  memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) setflag[i][j] = 0;
  law_index_.assign(static_cast<std::size_t>((n + 1) * (n + 1)), -1);
}

void PairSoftgrain::settings(int count, char** words) {
  if (count < 2 || std::string(words[0]) != "soft")
    error->all(FLERR,
               std::string("pair_style softgrain: name the soft types: pair_style softgrain soft TYPES ...|none"));
  soft_.assign(static_cast<std::size_t>(atom->ntypes) + 1, 0);
  if (count > 3 && std::string(words[count - 2]) == "springs") {
    springs_file_ = words[count - 1];
    count -= 2;
  }
  if (count == 2 && std::string(words[1]) == "none") return;
  for (int k = 1; k < count; ++k) {
    const auto [low, high] = bridge::type_range(words[k], atom->ntypes, error);
    for (int t = low; t <= high; ++t) soft_[static_cast<std::size_t>(t)] = 1;
  }
}

int PairSoftgrain::add_law(const AnyLaw& law) {
  bridge::check_dimension(law, domain->dimension, error);
  laws.push_back(law);
  comm_forward = std::max(comm_forward, traits_of(law).needs_particle_pass ? kSumSize : 0);
  return static_cast<int>(laws.size()) - 1;
}

AnyLaw PairSoftgrain::oriented(const AnyLaw& law, const std::string& name, bool first_soft, bool second_soft) {
  const softgrain::SoftSides s = softgrain::soft_sides(law);
  if (!s.i && !s.j) return law;  // soft bodies may be taken as hard, as preparations do
  if (s.i == first_soft && s.j == second_soft) return law;
  if (s.i == second_soft && s.j == first_soft) return softgrain::mirrored(law);
  error->all(FLERR, "law '" + name + "': its bodies are " + (s.i ? "soft" : "solid") + " and " +
                        (s.j ? "soft" : "solid") + ", the types are " + (first_soft ? "soft" : "solid") + " and " +
                        (second_soft ? "soft" : "solid"));
}

void PairSoftgrain::coeff(int count, char** words) {
  if (count < 4) error->all(FLERR, std::string("pair_coeff softgrain: I J FILE NAME, or I J card FILE KIND ..."));
  if (!allocated) allocate();
  const auto [ilow, ihigh] = bridge::type_range(words[0], atom->ntypes, error);
  const auto [jlow, jhigh] = bridge::type_range(words[1], atom->ntypes, error);
  const std::string name = words[3];
  const AnyLaw law = bridge::read_law_words(words + 2, count - 2, world, error);
  int set = 0;
  int index[2][2] = {{-1, -1}, {-1, -1}};  // one law for all pairs of types that are soft alike
  for (int i = ilow; i <= ihigh; ++i)
    for (int j = jlow; j <= jhigh; ++j) {
      for (const auto& [a, b] : {std::pair{i, j}, std::pair{j, i}}) {
        int& known = index[is_soft(a) ? 1 : 0][is_soft(b) ? 1 : 0];
        if (known < 0) known = add_law(oriented(law, name, is_soft(a), is_soft(b)));
        law_index_[static_cast<std::size_t>(a * (types_ + 1) + b)] = known;
      }
      setflag[std::min(i, j)][std::max(i, j)] = 1;
      ++set;
    }
  if (set == 0) error->all(FLERR, std::string("pair_coeff softgrain: no pair of types"));
}

void PairSoftgrain::init_style() {
  if (!atom->radius_flag || !atom->omega_flag || atom->rmass == nullptr)
    error->all(FLERR, std::string("pair style softgrain needs atom_style sphere"));
  if (force->newton_pair) error->all(FLERR, std::string("pair style softgrain needs newton off"));
  if (comm->ghost_velocity == 0) error->all(FLERR, std::string("pair style softgrain needs comm_modify vel yes"));
  neighbor->request(this, instance_me);
  if (history_ == nullptr) {
    history_ =
        dynamic_cast<FixSoftgrainHistory*>(modify->add_fix(std::string(kHistoryFix) + " all softgrain/history", 0));
    if (history_ == nullptr) error->all(FLERR, std::string("pair style softgrain: its history could not be made"));
    history_->pair = this;
    if (!springs_file_.empty()) history_->read_springs(springs_file_);
  }
  walls.clear();
  for (int k = 0; k < modify->nfix; ++k)
    if (auto* wall = dynamic_cast<FixSoftgrainWall*>(modify->fix[k])) walls.push_back(wall);
  find_radii();
}

void PairSoftgrain::find_radii() {
  std::vector<double> own(static_cast<std::size_t>(atom->ntypes) + 1, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    double& r = own[static_cast<std::size_t>(atom->type[i])];
    r = std::max(r, atom->radius[i]);
  }
  radius_max_.assign(own.size(), 0.0);
  MPI_Allreduce(own.data(), radius_max_.data(), static_cast<int>(own.size()), MPI_DOUBLE, MPI_MAX, world);
}

double PairSoftgrain::init_one(int i, int j) {
  if (setflag[i][j] == 0)
    error->all(FLERR, "pair_coeff of types " + std::to_string(i) + " and " + std::to_string(j) + " is missing");
  const double reach = std::visit([](const auto& law) { return softgrain::reach_of(law); },
                                  laws[static_cast<std::size_t>(law_of(i, j))]);
  return radius_max_[static_cast<std::size_t>(i)] + radius_max_[static_cast<std::size_t>(j)] + reach;
}

bridge::Bodies PairSoftgrain::bodies() const {
  bridge::Bodies b{atom->x, atom->v, atom->omega, atom->radius, atom->rmass, atom->tag, atom->type, atom->nlocal};
  b.flows = flows;
  b.rate = flow;
  for (int k = 0; k < 3; ++k) b.centre[k] = 0.5 * (domain->boxlo[k] + domain->boxhi[k]);
  return b;
}

bridge::Pass PairSoftgrain::pass() {
  if (update->setupflag != 0) return {strained, strained ? 1.0 : 0.0, sums.data()};
  return {true, spring_dt >= 0.0 ? spring_dt : update->dt, sums.data()};
}

double PairSoftgrain::flow_at(int axis, double x) const {
  const double centre = 0.5 * (domain->boxlo[axis] + domain->boxhi[axis]);
  return flow[axis] * (x - centre);
}

void PairSoftgrain::build(const std::vector<bridge::AtomMemory>& memory_of) {
  const bridge::Bodies b = bodies();
  std::vector<bridge::NearPair> near;
  for (int n = 0; n < list->inum; ++n) {
    const int i = list->ilist[n];
    for (int m = 0; m < list->numneigh[i]; ++m) {
      const int j = list->firstneigh[i][m] & NEIGHMASK;
      const int law = law_of(b.type[i], b.type[j]);
      const softgrain::PairBodies pair{b.r(i), b.r(j), 1.0 / b.mass[i], 1.0 / b.mass[j]};
      std::visit(
          [&](const auto& l) {
            const double reach =
                b.r(i) + b.r(j) - softgrain::onset_of(l, pair) + softgrain::reach_of(l) + neighbor->skin;
            if (norm2(b.vec(b.x[i]) - b.vec(b.x[j])) < reach * reach)
              near.push_back({i, j, law, l.pair_constants(pair)});
          },
          laws[static_cast<std::size_t>(law)]);
    }
  }
  store.assign(near, laws.size());
  entries_.clear();
  for (std::size_t c = 0; c < store.size(); ++c) {
    const auto i = static_cast<std::size_t>(store.i[c]);
    const bridge::Remembered* past = bridge::find(memory_of[i], b.tag[store.j[c]]);
    if (past == nullptr) continue;
    store.touched[c] = 1;
    store.spring[c] = past->spring;
    store.memory[c] = past->memory;
    store.roll[c] = past->roll;
  }
}

void PairSoftgrain::particle_pass() {
  if (comm_forward == 0) return;
  const bridge::Bodies b = bodies();
  sums.assign(static_cast<std::size_t>(atom->nlocal + atom->nghost), {});
  const bridge::AtomSurface surface{b};
  const bridge::Pass now{false, 0.0, sums.data()};
  const bridge::StorePairs source{store, surface, now};
  bridge::over_sections(store, laws, [&](const auto& law, const PairRange& range) { add_shares(source, law, range); });
  for (const FixSoftgrainWall* wall : walls) wall->add_shares(b, now);
  bridge::over_sections(store, laws, [&](const auto& law, const PairRange& range) { close_sums(source, law, range); });
  for (const FixSoftgrainWall* wall : walls) wall->close_sums(b, now);
  bridge::forward_values(*comm, this);
}

void PairSoftgrain::compute(int eflag, int vflag) {
  ev_init(eflag, vflag);
  for (FixSoftgrainWall* wall : walls) wall->follow();
  particle_pass();
  const bridge::Bodies b = bodies();
  const bridge::AtomSurface surface{b};
  const bridge::Pass now = pass();
  if (gathered.wanted) {
    gathered.translation.assign(static_cast<std::size_t>(b.own), 0.0);
    gathered.rotation.assign(static_cast<std::size_t>(b.own), 0.0);
    gathered.force_sum = gathered.contacts = 0.0;
  }
  const bool virial = gathered.wanted || gathered.pressed;
  gathered.virial = {};
  double** f = atom->f;
  double** torque = atom->torque;
  auto sink = bridge::to_sink([&](int i, int j, const ContactGeometry<3>& g, const ContactResponse<3>& r) {
    const Vec<3> push = g.normal * r.normal_force + r.tangential_force;
    const Vec<3> moment = cross(g.normal, r.tangential_force);
    for (int k = 0; k < 3; ++k) {
      f[i][k] += push[k];
      torque[i][k] += r.rolling_moment[k] - moment[k] * g.arm_i;
      if (j >= b.own) continue;
      f[j][k] -= push[k];
      torque[j][k] -= r.rolling_moment[k] + moment[k] * g.arm_j;
    }
    if (gathered.wanted) gather(gathered, i, j, b.own, g, r);
    if (virial)
      for (int k = 0; k < 3; ++k) gathered.virial[k] += (j < b.own ? 1.0 : 0.5) * push[k] * g.branch[k];
    if (evflag)
      ev_tally_xyz(i, j, b.own, 0, 0.0, 0.0, push[0], push[1], push[2], g.branch[0], g.branch[1], g.branch[2]);
  });
  bridge::StorePairs source{store, surface, now};
  bridge::over_sections(store, laws,
                        [&](const auto& law, const PairRange& range) { run_section(source, law, range, sink); });
  evaluations += static_cast<double>(store.size());
}

/// Place in the list of a pair; -1 when it is not there in this order. The index is made when somebody asks.
int PairSoftgrain::entry(int i, int j) {
  if (i >= atom->nlocal) return -1;
  if (entries_.empty()) {
    entries_.resize(static_cast<std::size_t>(atom->nlocal));
    for (std::size_t c = 0; c < store.size(); ++c)
      entries_[static_cast<std::size_t>(store.i[c])].push_back(static_cast<int>(c));
  }
  for (const int c : entries_[static_cast<std::size_t>(i)])
    if (store.j[static_cast<std::size_t>(c)] == j) return c;
  return -1;
}

double PairSoftgrain::single(int i, int j, int, int, double, double, double, double& fforce) {
  std::fill(extra_.begin(), extra_.end(), 0.0);
  fforce = 0.0;
  const int ij = entry(i, j);
  const int at = ij >= 0 ? ij : entry(j, i);
  if (at < 0) return 0.0;
  const double sign = ij >= 0 ? 1.0 : -1.0;
  const auto c = static_cast<std::size_t>(at);
  const bridge::Bodies b = bodies();
  const bridge::AtomSurface surface{b};
  const bridge::Pass still{false, 0.0, sums.data()};
  const bridge::StorePairs source{store, surface, still};
  const auto section = std::find_if(store.sections.begin(), store.sections.end(),
                                    [&](const bridge::Section& s) { return at >= s.begin && at < s.end; });
  std::visit(
      [&](const auto& law) {
        ContactGeometry<3> g;
        const auto near = source.pair(c);
        if (!source.meet(near, softgrain::reach_of(law), g)) return;
        const ContactResponse<3> r = response_of(source, law, c, near, g);
        fforce = r.normal_force / norm(g.branch);
        for (int k = 0; k < 3; ++k) extra_[static_cast<std::size_t>(k)] = sign * r.tangential_force[k];
        extra_[3] = norm(r.tangential_force);
        extra_[4] = r.normal_force;
        extra_[5] = g.overlap;
        extra_[6] = r.sliding ? 1.0 : 0.0;
      },
      laws[static_cast<std::size_t>(section->law)]);
  return 0.0;
}

int PairSoftgrain::pack_forward_comm(int n, int* list_of, double* buf, int, int*) {
  for (int k = 0; k < n; ++k) pack(sums[static_cast<std::size_t>(list_of[k])], buf + k * kSumSize);
  return n * kSumSize;
}

void PairSoftgrain::unpack_forward_comm(int n, int first, double* buf) {
  for (int k = 0; k < n; ++k) unpack(buf + k * kSumSize, sums[static_cast<std::size_t>(first + k)]);
}

double PairSoftgrain::memory_usage() {
  const double pair = 2 * sizeof(int) + sizeof(softgrain::PairConstants) + sizeof(Vec<3>) + sizeof(double) + 1;
  return Pair::memory_usage() + static_cast<double>(store.size()) * pair +
         static_cast<double>(sums.capacity()) * sizeof(MultiContactSum<3>);
}

}  // namespace LAMMPS_NS

namespace {

using namespace LAMMPS_NS;

template <class Style>
Fix* make_fix(LAMMPS* lmp, int count, char** words) {
  return new Style(lmp, count, words);
}

}  // namespace

void softgrain::lammps::add_styles(const LAMMPS& lmp) {
  (*lmp.force->pair_map)["softgrain"] = [](LAMMPS* l) -> Pair* { return new PairSoftgrain(l); };
  (*lmp.modify->fix_map)["softgrain/history"] = make_fix<FixSoftgrainHistory>;
  (*lmp.modify->fix_map)["softgrain/wall"] = make_fix<FixSoftgrainWall>;
  (*lmp.modify->fix_map)["softgrain/relax"] = make_fix<FixSoftgrainRelax>;
  (*lmp.modify->compute_map)["softgrain/contacts"] = [](LAMMPS* l, int count, char** words) -> Compute* {
    return new ComputeSoftgrainContacts(l, count, words);
  };
}

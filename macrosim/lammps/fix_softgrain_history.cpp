// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/fix_softgrain_history.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "macrosim/lammps/contact_loop.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
#include "macrosim/lammps/pair_softgrain.h"
#include "update.h"

namespace LAMMPS_NS {

namespace bridge = softgrain::lammps;

namespace {

constexpr int kWords = 8;      ///< number of values per remembered contact
constexpr int kSpringRow = 5;  ///< number of values per row of a file of springs
constexpr int kRollRow = 8;    ///< with angles of rolling

double* put(const bridge::AtomMemory& memory, double* buf) {
  *buf++ = static_cast<double>(memory.size());
  for (const bridge::Remembered& r : memory) {
    *buf++ = r.partner;
    for (int k = 0; k < 3; ++k) *buf++ = r.spring[k];
    *buf++ = r.memory;
    for (int k = 0; k < 3; ++k) *buf++ = r.roll[k];
  }
  return buf;
}

const double* take(const double* buf, bridge::AtomMemory& memory) {
  memory.resize(static_cast<std::size_t>(*buf++));
  for (bridge::Remembered& r : memory) {
    r.partner = static_cast<int>(*buf++);
    for (int k = 0; k < 3; ++k) r.spring[k] = *buf++;
    r.memory = *buf++;
    for (int k = 0; k < 3; ++k) r.roll[k] = *buf++;
  }
  return buf;
}

}  // namespace

FixSoftgrainHistory::FixSoftgrainHistory(LAMMPS* engine, int count, char** words) : Fix(engine, count, words) {
  restart_peratom = 1;
  create_attribute = 1;
  maxexchange_dynamic = 1;
  maxexchange = 1;
  FixSoftgrainHistory::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

FixSoftgrainHistory::~FixSoftgrainHistory() {
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

int FixSoftgrainHistory::setmask() { return FixConst::PRE_EXCHANGE | FixConst::POST_NEIGHBOR | FixConst::POST_RUN; }

void FixSoftgrainHistory::init() {
  if (pair == nullptr) error->all(FLERR, std::string("fix softgrain/history is made by pair style softgrain alone"));
}

/// Whether the atom is one of this rank.
bool FixSoftgrainHistory::remember(int tag, const bridge::Remembered& contact) {
  const int i = tag < atom->get_map_size() ? atom->map(tag) : -1;  // the map knows no bounds itself
  const bool own = i >= 0 && i < atom->nlocal;
  if (own) memory_[static_cast<std::size_t>(i)].push_back(contact);
  return own;
}

/// Takes the rows of a block that are of atoms of this rank. All ranks refuse rows of atoms that are nowhere: their
/// springs would be lost.
void FixSoftgrainHistory::take_springs(const std::vector<double>& rows, int width, const std::string& file) {
  double ends = 0.0;  // of springs: two between atoms, one at a wall
  double taken = 0.0;
  for (std::size_t k = 0; k < rows.size(); k += static_cast<std::size_t>(width)) {
    const double* r = rows.data() + k;
    const int first = static_cast<int>(r[0]);
    const int second = static_cast<int>(r[1]);
    if (first < 1 || second == 0 || first == second)
      error->all(FLERR, "springs of contacts: '" + file + "': no contact has the ids " + std::to_string(first) +
                            " and " + std::to_string(second));
    const softgrain::Vec<3> spring{{r[2], r[3], r[4]}};
    const softgrain::Vec<3> roll = width == kRollRow ? softgrain::Vec<3>{{r[5], r[6], r[7]}} : softgrain::Vec<3>{};
    ends += second > 0 ? 2.0 : 1.0;
    if (remember(first, {second, spring, 0.0, roll})) taken += 1.0;
    if (second > 0 && remember(second, {first, -spring, 0.0, -roll})) taken += 1.0;
  }
  double all = 0.0;
  MPI_Allreduce(&taken, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  if (all < ends) error->all(FLERR, "springs of contacts: '" + file + "' contains atom IDs that do not exist");
}

/// The first rank reads, in blocks; every rank keeps what its atoms need.
void FixSoftgrainHistory::read_springs(const std::string& file) {
  constexpr int kBlock = 20000;
  if (atom->map_style == 0) error->all(FLERR, std::string("springs of contacts need atom_modify map yes"));
  std::ifstream in;
  double count = -1.0;
  int width = kSpringRow;
  if (comm->me == 0) {
    in.open(file);
    std::string word;
    if (!(in >> count >> word) || word != "springs" || count != std::floor(count)) count = -1.0;
    std::getline(in, word);
    if (word == " rolls") width = kRollRow;
  }
  MPI_Bcast(&count, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&width, 1, MPI_INT, 0, world);
  if (count < 0.0) error->all(FLERR, "springs of contacts: '" + file + "' cannot be read");
  std::vector<double> rows;
  for (double done = 0.0; done < count; done += kBlock) {
    const int now = static_cast<int>(std::min<double>(kBlock, count - done));
    rows.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(now), 0.0);
    if (comm->me == 0)
      for (double& x : rows)
        if (!(in >> x)) error->one(FLERR, "springs of contacts: '" + file + "' ends too soon");
    MPI_Bcast(rows.data(), width * now, MPI_DOUBLE, 0, world);
    take_springs(rows, width, file);
  }
}

/// Copies the history of contacts from the list to the atoms.
void FixSoftgrainHistory::store() {
  const auto own = static_cast<std::size_t>(atom->nlocal);
  for (std::size_t i = 0; i < own; ++i) memory_[i].clear();
  const bridge::ContactStore& s = pair->store;
  bridge::over_sections(s, pair->laws, [&]<class Law>(const Law&, const softgrain::PairRange& range) {
    constexpr double kOtherSide = Law::traits.memory_has_sides ? -1.0 : 1.0;
    for (auto c = static_cast<std::size_t>(range.begin); c < static_cast<std::size_t>(range.end); ++c) {
      if (s.touched[c] == 0) continue;
      const auto i = static_cast<std::size_t>(s.i[c]);
      const auto j = static_cast<std::size_t>(s.j[c]);
      memory_[i].push_back({atom->tag[j], s.spring[c], s.memory[c], s.roll[c]});
      if (j < own) memory_[j].push_back({atom->tag[i], -s.spring[c], kOtherSide * s.memory[c], -s.roll[c]});
    }
  });
  int before = 0;
  for (const FixSoftgrainWall* wall : pair->walls) {
    const bridge::ContactStore& w = wall->store;
    for (std::size_t c = 0; c < w.size(); ++c)
      if (w.touched[c] != 0)
        memory_[static_cast<std::size_t>(w.i[c])].push_back(
            {-(before + w.j[c] + 1), w.spring[c], w.memory[c], w.roll[c]});
    before += static_cast<int>(wall->planes.size());
  }
}

void FixSoftgrainHistory::store_once() {
  if (!live_ || stored_ == update->ntimestep) return;
  store();
  stored_ = update->ntimestep;
}

int FixSoftgrainHistory::largest() const {
  std::size_t most = 0;
  for (int i = 0; i < atom->nlocal; ++i) most = std::max(most, memory_[static_cast<std::size_t>(i)].size());
  return static_cast<int>(most);
}

void FixSoftgrainHistory::pre_exchange() {
  if (live_) store();
  live_ = false;
  maxexchange = kWords * largest() + 1;
}

void FixSoftgrainHistory::post_neighbor() {
  pair->build(memory_);
  int before = 0;
  for (FixSoftgrainWall* wall : pair->walls) {
    wall->build(pair->bodies(), memory_, before);
    before += static_cast<int>(wall->planes.size());
  }
  live_ = true;
  stored_ = -1;
}

void FixSoftgrainHistory::post_run() {
  if (live_) store();
  live_ = false;
  maxexchange = kWords * largest() + 1;
}

void FixSoftgrainHistory::grow_arrays(int n) { memory_.resize(static_cast<std::size_t>(n)); }

void FixSoftgrainHistory::copy_arrays(int i, int j, int) {
  memory_[static_cast<std::size_t>(j)] = memory_[static_cast<std::size_t>(i)];
}

void FixSoftgrainHistory::set_arrays(int i) { memory_[static_cast<std::size_t>(i)].clear(); }

int FixSoftgrainHistory::pack_exchange(int i, double* buf) {
  return static_cast<int>(put(memory_[static_cast<std::size_t>(i)], buf) - buf);
}

int FixSoftgrainHistory::unpack_exchange(int i, double* buf) {
  return static_cast<int>(take(buf, memory_[static_cast<std::size_t>(i)]) - buf);
}

int FixSoftgrainHistory::pack_restart(int i, double* buf) {
  store_once();
  buf[0] = size_restart(i);
  (void)put(memory_[static_cast<std::size_t>(i)], buf + 1);
  return size_restart(i);
}

void FixSoftgrainHistory::unpack_restart(int i, int nth) {
  const double* extra = atom->extra[i];
  for (int k = 0; k < nth; ++k) extra += static_cast<int>(*extra);
  (void)take(extra + 1, memory_[static_cast<std::size_t>(i)]);
}

int FixSoftgrainHistory::size_restart(int i) {
  store_once();
  return kWords * static_cast<int>(memory_[static_cast<std::size_t>(i)].size()) + 2;
}

int FixSoftgrainHistory::maxsize_restart() {
  store_once();
  int most = largest();
  int all = most;
  MPI_Allreduce(&most, &all, 1, MPI_INT, MPI_MAX, world);
  return kWords * all + 2;
}

double FixSoftgrainHistory::memory_usage() {
  double bytes = static_cast<double>(memory_.capacity() * sizeof(bridge::AtomMemory));
  for (const auto& m : memory_) bytes += static_cast<double>(m.capacity() * sizeof(bridge::Remembered));
  return bytes;
}

}  // namespace LAMMPS_NS

// Fix softgrain/history: what contacts remember (spring, memory) travels with the atoms, between ranks and into restart
// files. The pair style makes it; scripts do not. Each atom holds its own copy, of springs seen from its side.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <string>
#include <vector>

#include "fix.h"
#include "macrosim/lammps/contact_store.h"

namespace LAMMPS_NS {

class PairSoftgrain;

class FixSoftgrainHistory : public Fix {
 public:
  FixSoftgrainHistory(LAMMPS* engine, int count, char** words);
  ~FixSoftgrainHistory() override;
  FixSoftgrainHistory(const FixSoftgrainHistory&) = delete;
  FixSoftgrainHistory& operator=(const FixSoftgrainHistory&) = delete;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override { pre_exchange(); }
  void setup_post_neighbor() override { post_neighbor(); }
  void pre_exchange() override;
  void post_neighbor() override;
  void post_run() override;

  void grow_arrays(int n) override;
  void copy_arrays(int i, int j, int) override;
  void set_arrays(int i) override;
  int pack_exchange(int i, double* buf) override;
  int unpack_exchange(int i, double* buf) override;
  int pack_restart(int i, double* buf) override;
  void unpack_restart(int i, int nth) override;
  int size_restart(int i) override;
  int maxsize_restart() override;
  double memory_usage() override;

  /// Springs that contacts begin with: "N springs", then a row per contact: both tags (of a wall minus its number, from
  /// 1), the spring as the first sees it. "N springs rolls": the angle by which the first has rolled follows.
  void read_springs(const std::string& file);

  PairSoftgrain* pair = nullptr;

 private:
  bool remember(int tag, const softgrain::lammps::Remembered& contact);
  void take_springs(const std::vector<double>& rows, int width, const std::string& file);
  void store();
  void store_once();
  [[nodiscard]] int largest() const;

  std::vector<softgrain::lammps::AtomMemory> memory_;  ///< per atom
  bool live_ = false;   ///< the list of near pairs fits the atoms, and knows more than memory_
  bigint stored_ = -1;  ///< step for which memory_ is up to date although the list is live
};

}  // namespace LAMMPS_NS

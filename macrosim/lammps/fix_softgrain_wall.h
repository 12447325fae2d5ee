// Fix softgrain/wall: planes with the laws of the program, standing, moving, or in the faces of the simulation box.
//
//   fix ID all softgrain/wall box law TYPES LAW [law TYPES LAW ...]
//   fix ID all softgrain/wall plane PX PY PZ NX NY NZ [move VX VY VZ] [plane ...] law TYPES LAW ...
//
// LAW as in pair_coeff: FILE NAME, or card FILE KIND ... . Bodies are on the side that the normal points to. Vector:
// normal force of the bodies on every plane, pushing positive [N]; of the box x low, x high, y low, ..., z high.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <vector>

#include "fix.h"
#include "macrosim/lammps/contact_loop.h"

namespace LAMMPS_NS {

class PairSoftgrain;

class FixSoftgrainWall : public Fix {
 public:
  FixSoftgrainWall(LAMMPS* engine, int count, char** words);
  ~FixSoftgrainWall() override;
  FixSoftgrainWall(const FixSoftgrainWall&) = delete;
  FixSoftgrainWall& operator=(const FixSoftgrainWall&) = delete;

  int setmask() override;
  void init() override;
  void setup(int vflag) override { post_force(vflag); }
  void post_force(int vflag) override;
  void write_restart(FILE* file) override;
  void restart(char* buf) override;
  double compute_vector(int k) override;
  double memory_usage() override;

  /// Whether the planes are the faces of the simulation box.
  [[nodiscard]] bool in_box() const { return box_; }
  /// Brings the planes to where they are at this step.
  void follow();
  /// Near pairs of atoms and planes; `before`: planes of other fixes, whose numbers come first.
  void build(const softgrain::lammps::Bodies& bodies, const std::vector<softgrain::lammps::AtomMemory>& past_of,
             int before);
  void add_shares(const softgrain::lammps::Bodies& b, const softgrain::lammps::Pass& now) const;
  void close_sums(const softgrain::lammps::Bodies& b, const softgrain::lammps::Pass& now) const;

  std::vector<softgrain::lammps::Plane> planes;
  std::vector<softgrain::AnyLaw> laws;
  softgrain::lammps::ContactStore store;

 private:
  void read_plane(char** words, int count, int& at);
  void read_law(char** words, int count, int& at);
  void follow_box();
  void restart_motion();
  void ask_for_list();

  bool box_ = false;
  bool moving_ = false;
  bigint start_ = 0;                       ///< step at which moving planes were where the script says
  std::vector<softgrain::Vec<3>> from_;    ///< places of the planes at that step
  std::vector<softgrain::Vec<3>> listed_;  ///< places of the planes at the last list
  bigint followed_ = -1;
  double dt_ = -1.0;  ///< time step that moving planes go by
  std::vector<int> law_of_type_;
  std::vector<double> force_;      ///< normal force of the bodies of this rank on every plane [N]
  std::vector<double> force_all_;  ///< normal force of the bodies of all ranks on every plane [N]
  bigint summed_ = -1;
  PairSoftgrain* pair_ = nullptr;
};

}  // namespace LAMMPS_NS

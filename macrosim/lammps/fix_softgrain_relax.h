// Fix softgrain/relax: the damped relaxation of the program (common/dynamics/damped_relaxation.h) as time integration.
//
//   fix ID all softgrain/relax tolerance T floor F max_passes N [max_move M] [max_displacement_ratio L]
//     [unbalanced_fraction S] [least_stiffness K] [track_box yes|no] [stress SX|no SY|no SZ|no] [isotropic yes|no]
//     [stress_tolerance T] [least_stress P] [farthest F] [log_lists yes|no]
//   fix_modify ID KEY VALUE ...         the same keys, later
//
// A box that was strained since the last run (change_box ... remap) takes the springs of the contacts along, unless
// `track_box no`: bodies slide on each other as the box moves them.
// Every run relaxes anew, from rest. Ends it when the largest net force is below T times the mean contact force (which
// never counts for less than F [N]), or after N passes. Time steps are pseudo-time. Fixes with forces come before it in
// the script. A share `unbalanced_fraction` of the bodies, rounded down, may have a larger net force at the end. No
// body moves farther per pass than `max_move` radii, and, with `max_displacement_ratio`, than so many times the root
// mean square move of all (common/dynamics/fire.h, MoveLimit); none counts as softer than `least_stiffness` [Pa] times
// its radius. Scalar: residual. Vector: passes of the last run, residual, end (0 not run, 1 converged, 2 capped, 3
// diverged), mean contact force [N], passes of all runs, near pairs looked at in all passes, stress on the box along x,
// y, z [Pa].
//
// `stress` holds the simulation box by stress [Pa, compression positive] along the axes that have a number: its faces
// relax together with the bodies, which they carry along (macrosim/pressed_box.h), at `stress_tolerance` times
// the largest stress asked for, which counts as `least_stress` at least. `isotropic`: all axes strain equally, by the
// mean of their stresses. A logarithmic strain beyond `farthest` since the run began ends it as capped: the stress is
// out of reach. The box has walls in all faces (boundary f f f and fix softgrain/wall box) or is periodic (p p p); the
// stress is that on the walls, or that of the contacts.
//
// `log_lists yes` with `neigh_modify delay 0 every 1000000 check no`: the fix says when lists of near pairs are made.
// It follows bodies relative to the box, whose motion alone brings no two of them together by more than its strain
// times their distance; LAMMPS follows them from where they were, and makes a list every pass while a large box
// shrinks.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <string>
#include <vector>

#include "common/core/vec.h"
#include "common/dynamics/fire.h"
#include "fix.h"

namespace LAMMPS_NS {

class FixSoftgrainWall;
class PairSoftgrain;

class FixSoftgrainRelax : public Fix {
 public:
  FixSoftgrainRelax(LAMMPS* engine, int count, char** words);
  ~FixSoftgrainRelax() override;
  FixSoftgrainRelax(const FixSoftgrainRelax&) = delete;
  FixSoftgrainRelax& operator=(const FixSoftgrainRelax&) = delete;

  int setmask() override;
  int modify_param(int count, char** words) override;
  void init() override;
  void setup_pre_exchange() override;
  void setup_pre_neighbor() override { pre_neighbor(); }
  void pre_neighbor() override;
  void setup_pre_force(int vflag) override;
  void setup(int vflag) override;
  void initial_integrate(int vflag) override;
  void end_of_step() override;
  void post_run() override;
  double compute_scalar() override { return residual_; }
  double compute_vector(int k) override;
  void write_restart(FILE* file) override;
  void restart(char* buf) override;

  void grow_arrays(int n) override;
  void copy_arrays(int i, int j, int) override;
  int pack_exchange(int i, double* buf) override;
  int unpack_exchange(int i, double* buf) override;

 private:
  enum End { not_run, converged, capped, diverged };

  int set(int count, char** words);
  void set_number(const std::string& key, const std::string& word);
  void set_stress(char** words);
  void take_box_sums();
  void scale_box(const softgrain::PseudoMasses& masses);
  void steer_box(double* sums);
  void carry();
  void watch_lists();
  void make_alike(softgrain::Vec<3>& a) const;
  [[nodiscard]] double box_residual() const;
  [[nodiscard]] bool pressed() const { return by_stress_[0] || by_stress_[1] || by_stress_[2]; }
  [[nodiscard]] FixSoftgrainWall* box_walls() const;
  void stop_motion();
  void note_box();
  [[nodiscard]] bool checks_convergence(double passes) const;
  void judge();
  void finish();
  void scale_masses();
  void steer();
  void move();
  [[nodiscard]] double net_force2(int i) const;
  [[nodiscard]] double worst_net_force() const;
  [[nodiscard]] double settled_net_force() const;

  double tolerance_ = 1e-2;
  double floor_ = 0.0;
  double max_passes_ = 20000.0;
  softgrain::MoveLimit limit_;
  double typical_move_ = 0.0;  ///< root mean square move of the last pass, in radii
  double unbalanced_fraction_ = 0.0;
  double least_stiffness_ = 0.0;  ///< least stiffness of a body over its radius [Pa]
  bool track_box_ = true;
  softgrain::Vec<3> box_{};   ///< lengths of the box at the last run
  softgrain::Vec<3> tilt_{};  ///< xy, xz and yz of a triclinic box then
  softgrain::Fire fire_;
  std::vector<double> inverse_mass_;  ///< inverse pseudo-masses, per atom
  std::vector<double> inverse_inertia_;
  double passes_ = 0.0;
  double passes_before_ = 0.0;  ///< passes of earlier runs
  double evaluations_before_ = 0.0;
  double residual_ = 0.0;
  double mean_force_ = 0.0;
  End end_ = not_run;
  PairSoftgrain* pair_ = nullptr;

  std::array<bool, 3> by_stress_{};
  softgrain::Vec<3> asked_{};  ///< stress asked for [Pa]
  bool isotropic_ = false;
  double stress_tolerance_ = 1e-3;
  double least_stress_ = 0.0;
  double farthest_ = 0.3;
  softgrain::Vec<3> stress_{};     ///< stress on the box in the last pass [Pa]
  softgrain::Vec<3> resisted_{};   ///< resistance of the contents of the box, W_k of PressedBox [N m]
  softgrain::Vec<3> box_force_{};  ///< force per logarithmic strain [N m]
  softgrain::Vec<3> box_velocity_{};
  softgrain::Vec<3> box_strain_{};  ///< strain since the run began
  double box_inverse_mass_ = 0.0;

  bool log_lists_ = false;
  std::vector<softgrain::Vec<3>> listed_;      ///< places of the bodies when the last list was made
  softgrain::Vec<3> shrunk_{{1.0, 1.0, 1.0}};  ///< lengths of the box over those at that time, per axis
};

}  // namespace LAMMPS_NS

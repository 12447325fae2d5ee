// Pair style softgrain: every contact law of the program between spheres, soft or solid.
//
//   pair_style softgrain soft TYPES ...|none [springs FILE]
//   pair_coeff I J FILE NAME
//   pair_coeff I J card FILE KIND modulus E friction MU [kt initial|secant] [damping Z] [beyond POLICY]
//
// And all styles of softgrain in a LAMMPS.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <string>
#include <vector>

#include "macrosim/lammps/contact_loop.h"
#include "pair.h"

namespace LAMMPS_NS {

class FixSoftgrainHistory;
class FixSoftgrainWall;

class PairSoftgrain : public Pair {
 public:
  /// Stiffness sums per own atom and sums of forces, for relaxations.
  struct Gathered {
    bool wanted = false;
    std::vector<double> translation;  ///< sum over the contacts of normal and tangential stiffness [N/m]
    std::vector<double> rotation;     ///< sum of tangential stiffness times the arm squared [N m]
    bool pressed = false;             ///< whether the virial is wanted too, at every pass
    softgrain::Vec<3> virial{};       ///< virial per axis, force times branch of the contacts between atoms [N m]; one
                                      ///< across ranks counts half on each
    double force_sum = 0.0;           ///< sum of |normal force| [N]; a contact across ranks counts half on each
    double contacts = 0.0;            ///< number of contacts that carry force

    void add(int atom, double stiffness, double turning) {
      translation[static_cast<std::size_t>(atom)] += stiffness;
      rotation[static_cast<std::size_t>(atom)] += turning;
    }
  };

  explicit PairSoftgrain(LAMMPS* engine);
  ~PairSoftgrain() override;
  PairSoftgrain(const PairSoftgrain&) = delete;
  PairSoftgrain& operator=(const PairSoftgrain&) = delete;

  void compute(int eflag, int vflag) override;
  void settings(int count, char** words) override;
  void coeff(int count, char** words) override;
  void init_style() override;
  double init_one(int i, int j) override;
  double single(int i, int j, int itype, int jtype, double rsq, double, double, double& fforce) override;
  int pack_forward_comm(int n, int* list, double* buf, int, int*) override;
  void unpack_forward_comm(int n, int first, double* buf) override;
  double memory_usage() override;

  /// Builds the list of near pairs; the fix for the history calls it after every list of LAMMPS.
  void build(const std::vector<softgrain::lammps::AtomMemory>& memory_of);
  [[nodiscard]] softgrain::lammps::Bodies bodies() const;
  /// What passes do now: history goes on unless LAMMPS sets up.
  [[nodiscard]] softgrain::lammps::Pass pass();
  /// How the box moves what is at x along an axis: a velocity, or after a strain of the box the way [m].
  [[nodiscard]] double flow_at(int axis, double x) const;
  [[nodiscard]] bool is_soft(int type) const { return soft_[static_cast<std::size_t>(type)] != 0; }
  /// The law for bodies of these kinds, turned round where that makes it fit; refuses one that does not.
  softgrain::AnyLaw oriented(const softgrain::AnyLaw& law, const std::string& name, bool first_soft, bool second_soft);

  softgrain::lammps::ContactStore store;
  std::vector<softgrain::AnyLaw> laws;
  std::vector<softgrain::MultiContactSum<3>> sums;  ///< sums over contacts in the last pass, per atom, ghosts included
  std::vector<FixSoftgrainWall*> walls;             ///< wall fixes in the order of the script
  Gathered gathered;
  /// The box has been strained since the last run: the pass of the setup lets the springs follow, velocities being
  /// moves.
  bool strained = false;
  bool flows = false;         ///< the box moves: what contacts see is the motion of bodies and that of the box
  bool box_followed = false;  ///< fix softgrain/relax says when lists are made: walls of the box ask for none
  softgrain::Vec<3> flow{};   ///< rate of the lengths of the box; after a strain: growth over the present length
  double spring_dt = -1.0;    ///< time step of the history in a relaxation; negative: the time step of LAMMPS
  double evaluations = 0.0;   ///< near pairs looked at by all passes of this rank

 private:
  void allocate();
  void find_radii();
  void particle_pass();
  int add_law(const softgrain::AnyLaw& law);
  int entry(int i, int j);
  [[nodiscard]] int law_of(int itype, int jtype) const {
    return law_index_[static_cast<std::size_t>(itype * (types_ + 1) + jtype)];
  }

  FixSoftgrainHistory* history_ = nullptr;
  std::string springs_file_;        ///< file of the springs that contacts begin with; empty: the restart file has them
  std::vector<char> soft_;          ///< whether bodies are soft, per type
  std::vector<int> law_index_;      ///< number of the law per pair of types, in both orders
  std::vector<double> radius_max_;  ///< largest radius per type, over all ranks [m]
  std::vector<std::vector<int>> entries_;  ///< per own atom: its pairs in the store, for single()
  std::vector<double> extra_;
  int types_ = 0;
};

}  // namespace LAMMPS_NS

namespace softgrain::lammps {

/// Makes pair style softgrain, fixes softgrain/wall and softgrain/relax and compute softgrain/contacts known. The
/// command `clear` of a script forgets them.
void add_styles(const LAMMPS_NS::LAMMPS& lmp);

}  // namespace softgrain::lammps

// The equilibrium problem of one increment: forces on all grains as a function of their displacements [QS 2.1-2.2].
// Unknowns theta: per grain the translation u and, with friction, the rotation Omega R [m]; all since the reference.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/cost.h"
#include "common/statics/links.h"
#include "common/statics/unknowns.h"

namespace softgrain::statics {

/// Forces at a state. Layout as the unknowns: force, then moment/R, per grain.
struct PackForces {
  Unknowns force;                ///< net force and moment/R on every grain [N]; minus the gradient of Pi, less what
                                 ///< symmetry planes bear
  std::vector<double> largest2;  ///< per grain, square of its largest contact force [N^2]
  double work = 0.0;             ///< Pi less the elastic energy of the reference state's normal forces [J]
  double contact_force = 0.0;    ///< sum over contacts of the normal force [N]
  std::int64_t contacts = 0;
};

/// One contact linearised. With delta = u_i - u_j + n x (Omega_i arm_i + Omega_j arm_j) and its tangential part delta_s
/// the force on i falls by normal_stiffness n (n.delta) + tangential delta_s. A sliding contact has its secant
/// stiffness, which is symmetric. What its force on i really falls by, when |Q| follows mu P, has in addition
/// slip (drag n.delta - tangential slip.delta): Q grows with P and does not grow along itself.
struct LinkTangent {
  Vec3 normal{};
  double normal_stiffness = 0.0;  ///< dP/dh [N/m]
  double tangential = 0.0;        ///< [N/m]
  double stick = 0.0;             ///< tangential stiffness if the contact did not slide [N/m]
  Vec3 slip{};                    ///< Q/|Q| where |Q| follows mu P, else 0
  double drag = 0.0;              ///< mu dP/dh there, else 0 [N/m]
  double arm_i = 0.0;             ///< arm over R_i
  double arm_j = 0.0;             ///< arm over R_j; 0 for walls
  double curvature_i = 0.0;       ///< 1/R_i
  double curvature_j = 0.0;       ///< 1/R_j; 0 for walls
  double twist = 0.0;             ///< k_t [N m]
  bool closed = false;
};

/// Forces on one grain, and its closed contacts linearised.
struct GrainForces {
  Unknowns force;         ///< force of this grain, as in PackForces
  double largest2 = 0.0;  ///< square of its largest contact force [N^2]
  std::vector<std::size_t> links;
  std::vector<LinkTangent> tangents;  ///< linearised contacts of `links`
};

class PackProblem {
 public:
  PackProblem(const GrainPack& pack, std::vector<Vec3> wall_moves, CoulombRule rule, bool torsion);

  [[nodiscard]] int stride() const { return friction_ ? 6 : 3; }  ///< unknowns per grain
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(pack_.grains() * stride()); }
  [[nodiscard]] const GrainPack& pack() const { return pack_; }
  [[nodiscard]] const Links& links() const { return links_; }
  [[nodiscard]] const SymmetryPlanes& symmetry() const { return symmetry_; }
  [[nodiscard]] const Cost& cost() const { return cost_; }

  /// Puts the walls at this part of their moves.
  void set_walls(double part);
  [[nodiscard]] const std::vector<Vec3>& wall_moves() const { return wall_moves_; }
  [[nodiscard]] const std::vector<Vec3>& wall_points() const { return wall_points_; }

  /// Pi of the reference state's normal forces, (2/5) P h each.
  [[nodiscard]] double reference_work() const;

  void evaluate(const Unknowns& theta, PackForces& out);
  void linearise(const Unknowns& theta, std::vector<LinkTangent>& out);
  /// Grain g alone has moved since the last evaluate(). Pairs that were out of reach then are not seen, and symmetry
  /// planes are not heeded.
  void evaluate_grain(const Unknowns& theta, std::size_t g, GrainForces& out);
  /// Contacts at theta, as they are stored in a pack.
  [[nodiscard]] std::vector<PackContact> contacts(const Unknowns& theta);
  [[nodiscard]] std::vector<Vec3> positions(const Unknowns& theta) const;

 private:
  template <class Law>
  void evaluate_as(const Unknowns& theta, PackForces& out) const;
  template <class Law>
  void linearise_as(const Unknowns& theta, std::vector<LinkTangent>& out) const;
  template <class Law>
  void evaluate_grain_as(const Unknowns& theta, std::size_t g, GrainForces& out) const;
  template <class Law>
  void contacts_as(const Unknowns& theta, std::vector<PackContact>& out) const;
  template <class F>
  void dispatch(const F& body) const;
  void place(const Unknowns& theta);

  const GrainPack& pack_;
  std::vector<Vec3> wall_moves_;
  std::vector<Vec3> wall_points_;
  double wall_part_ = 0.0;
  CoulombRule rule_;
  bool torsion_;
  bool friction_;
  SymmetryPlanes symmetry_;
  Links links_;
  std::vector<Vec3> place_;  ///< positions of the state being evaluated
  Cost cost_;
};

}  // namespace softgrain::statics

// Quasi-static increments by least work [QS 2.1-2.2]: from one equilibrium to the next when walls move. No mass, no
// damping, no time step.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/statics/grain_pack.h"

namespace softgrain {

/// Normal force that limits friction within an increment.
///
/// The published rule [QS 2.1] need not have an equilibrium, for two reasons, so `reference` deviates from it twice,
/// each time by as much as makes the tangential force continuous enough:
/// - A contact that slid or unloaded in an earlier increment starts with a force at or above the limit. It keeps it, Q
///   = Qp, unless it slips back. When it slips sideways, k' of the publication leaps between 0 and k* over next to no
///   displacement. Here an increment starts from at most 0.999 of max(mu P0, |Qp|); in slip |Q| is that limit itself.
/// - A contact that opens takes with it a tangential force that it still carries. Here |Q| is at most 100 mu P, and the
///   torsion likewise.
enum class CoulombRule {
  reference,  ///< the published rule: max(mu P0, |Q0|) of the reference state; a contact made in the increment has no
              ///< friction yet
  current     ///< P of the state as it is (return mapping)
};

enum class LeastWorkMethod {
  published,  ///< nonlinear conjugate gradient (Fletcher-Reeves with refresh), bounded line search, wall sub-increments
  fast        ///< finds the same equilibrium with fewer passes
};

struct LeastWorkOptions {
  LeastWorkMethod method = LeastWorkMethod::fast;
  CoulombRule coulomb = CoulombRule::current;
  bool torsion = true;
  // Published method.
  int refresh = 50;                 ///< k_SD: iterations between two steepest-descent directions
  int sub_increment_interval = 10;  ///< k_inc: iterations between two wall sub-increments
  int sub_increments = 5;
  double max_move = 1e-2;          ///< largest move of a grain per iteration, in its radius (1e-3..1e-1)
  double work_tolerance = 1e-11;   ///< stop at dPi < this |Pi| ...
  double force_tolerance = 1e-13;  ///< ... or |grad|^2 < this N (E R^2)^2
  // Fast method.
  double residual_tolerance = 1e-6;  ///< net force on every grain over its largest contact force, or over
                                     ///< 1e-3 of the mean contact force where that is larger (rattlers)
  double force_floor = 1e-6;  ///< least force to compare with, in mean E times mean R^2 (packs that carry nothing)
  std::int64_t max_iterations = 20000;
};

/// What ended a minimisation: a criterion of the published method (work, force), that of the fast one (residual), or a
/// failure.
enum class LeastWorkEnd { work, force, residual, cap, no_descent, not_finite };

template <>
inline constexpr auto enum_names<LeastWorkEnd> = enum_name_list<LeastWorkEnd>({{LeastWorkEnd::work, "work"},
                                                                               {LeastWorkEnd::force, "force"},
                                                                               {LeastWorkEnd::residual, "residual"},
                                                                               {LeastWorkEnd::cap, "cap"},
                                                                               {LeastWorkEnd::no_descent, "no descent"},
                                                                               {LeastWorkEnd::not_finite,
                                                                                "not finite"}});

struct LeastWorkResult {
  bool converged = false;
  LeastWorkEnd stopped_by = LeastWorkEnd::cap;
  std::int64_t iterations = 0;
  std::int64_t loop_passes = 0;  ///< evaluations of all contacts
  std::int64_t contact_evaluations = 0;
  std::int64_t factorisations = 0;     ///< factorisations of the preconditioner: all grains' own stiffness
  std::int64_t linear_iterations = 0;  ///< iterations of inner linear solves
  double worst_residual = 0.0;         ///< largest over grains: net force (or moment/R) over its largest contact force
  double residual_energy = 0.0;        ///< |grad|^2 [N^2]
  double work = 0.0;                   ///< Pi of the increment [J]
  std::int64_t floppy = 0;             ///< grains without enough contacts to be held
};

/// Moves every wall by its entry of `wall_moves` [m], finds the equilibrium of all grains, and makes it the reference
/// state. When it does not converge the pack is left as it was. Deterministic for any number of threads.
/// Throws UnusableResult when walls pass each other or a grain leaves the pack.
LeastWorkResult advance(GrainPack& pack, const std::vector<Vec3>& wall_moves, const LeastWorkOptions& options);

/// Contacts from geometry alone, without tangential forces (after placing or resizing grains): finds all overlaps,
/// keeps the history of pairs that were in contact before.
void refresh_contacts(GrainPack& pack);

/// Response of the linearised pack (no contact slides, forces do not turn with their contacts) to strains of a box of
/// six planes: stress[a][b] is the change of wall stress a per unit compressive strain b [Pa]. Walls in the order -x +x
/// -y +y -z +z.
struct ElasticResponse {
  double stiffness[3][3] = {};
  std::int64_t factorisations = 0;
  std::int64_t linear_iterations = 0;
  bool solved = false;
  [[nodiscard]] double bulk_modulus() const;   ///< sum of all entries / 9
  [[nodiscard]] double shear_modulus() const;  ///< (mean C_aa - mean C_ab)/2 from the three uniaxial probes
};
ElasticResponse elastic_probe(const GrainPack& pack, const LeastWorkOptions& options);

/// Force of the pack on each wall [N] (normal part along -normal positive; all three components). On a symmetry plane
/// with what it takes to hold its grains.
std::vector<Vec3> wall_forces(const GrainPack& pack);

}  // namespace softgrain

// The contact loop many contacts at a time: the laws' own text on lanes of the processor. The same arithmetic,
// operation by operation, as the scalar loop (pair_loop.h), which stays the reference: both give the same bits.
#pragma once

#include <cstdint>
#include <vector>

#include "common/contact/contact_loop.h"
#include "common/system.h"

namespace softgrain {

/// Force and moment of a contact, stored for bodies that another thread owns.
struct alignas(64) ContactLoad {
  double force[3];   ///< force on i [N]
  double arm_i;      ///< [m]
  double moment[3];  ///< moment for a unit arm along the normal [N]; in 2D moment[0] alone, and moment[1] is that of
                     ///< rolling [N m]
  double arm_j;      ///< [m]
};

/// Moment of rolling resistance of a contact in space, stored for bodies that another thread owns.
struct ContactRoll {
  double moment[3];  ///< moment on i [N m]
};

/// Loads that wait to be added to bodies, in list order.
class WaitingLoads {
 public:
  virtual ~WaitingLoads() = default;
  /// Place in the list of the next one; beyond every place when there is none.
  std::int32_t next = 0;
  /// Adds all that stand before place `c`.
  virtual void add_before(std::int32_t c) = 0;
};

/// Sums of contact stiffness per body, for mass scaling and step control, and the mean contact force of the same pass.
struct BodyStiffness {
  std::vector<double> translation;  ///< sum of kn + kt over the contacts of a body [N/m]
  std::vector<double> rotation;     ///< sum of kt arm^2, in space with that of rolling [N m]
  // Of the contacts whose first body it is, so that every contact counts once:
  std::vector<double> force;           ///< sum of |normal force| [N]
  std::vector<std::int32_t> contacts;  ///< number of contacts that carry a force

  void clear(std::size_t bodies);
  [[nodiscard]] double mean_force() const;
};

/// What a contact adds to the sums of BodyStiffness, stored for bodies that another thread owns.
struct ContactStiffness {
  double translation;  ///< kn + kt [N/m]
  double rotation_i;   ///< [N m]
  double rotation_j;   ///< [N m]
  double force;        ///< |normal force| [N]
};

/// Adds what a contact has to its first and second body.
void add_first(const ContactStiffness& of, std::size_t body, BodyStiffness& to);
void add_second(const ContactStiffness& of, std::size_t body, BodyStiffness& to);

/// What a pass over contacts does beside the forces.
template <int D>
struct BlockPass {
  double dt = 0.0;  ///< since the history was committed [s]
  History history = History::next;
  ContactLoad* loads =
      nullptr;  ///< when there, bodies are left alone: the load of pair k of the range goes to loads[k]
  ContactRoll* rolls = nullptr;  ///< gets the moment of pair k at rolls[k], for laws with rolling resistance in space
  std::uint8_t* touches = nullptr;          ///< gets at touches[k] whether pair k touches
  WaitingLoads* waiting = nullptr;          ///< added in between, in list order
  const std::uint8_t* lent = nullptr;       ///< one flag per place in the list, 1: pairs of the range that are left out
  BodyStiffness* stiffness = nullptr;       ///< gets the sums of what goes to the bodies
  ContactStiffness* stiffnesses = nullptr;  ///< stored with the loads
  Vec<D>* virial = nullptr;                 ///< sum over contacts of force times branch, per axis [N m]
};

/// Adds the forces and torques of some pairs of a section to their bodies, in the order of the range, and treats their
/// history as asked. Pairs that do not touch lose theirs.
template <int D>
void block_loop(System<D>& system, const ContactSection& section, const PairRange& range, const BlockPass<D>& pass);

/// All sections, in list order; `system.contacts.make_next()` where the history asks for it.
template <int D>
void block_loop(System<D>& system, const BlockPass<D>& pass);

}  // namespace softgrain

// The contact loop many contacts at a time: the laws' own text on lanes of the processor. The same arithmetic,
// operation by operation, as the scalar loop (pair_loop.h), which stays the reference: both give the same bits.
#pragma once

#include <cstdint>
#include <vector>

#include "common/contact/contact_loop.h"
#include "common/system.h"

namespace softgrain {

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

/// The part of a pass that one of several threads does: it evaluates every pair with a body of its own, and adds to
/// that body alone.
struct ThreadPart {
  const std::uint8_t* owner = nullptr;  ///< thread of every body; null: all bodies are of this thread
  const std::uint8_t* split = nullptr;  ///< flag per place in the list, 1: the bodies of the pair have two owners
  std::uint8_t thread = 0;
};

/// Pairs of a section whose first bodies and histories are not this thread's: copies of what a pass asks for, one
/// beside the other, so that the lists of other threads are left alone.
template <int D>
struct ForeignPairs {
  std::vector<std::int32_t> place;  ///< in the list
  std::vector<Slot> i;
  std::vector<Slot> j;
  std::vector<std::int32_t> image;
  std::vector<PairConstants> constants;
  std::vector<Stored<D>> spring;  ///< committed histories
  std::vector<double> memory;
  std::vector<Stored<D>> roll;

  void clear();
  void add(const ContactList<D>& list, std::int32_t at);
  /// Takes over the committed histories.
  void copy_histories(const ContactList<D>& list);
};

/// What a pass over contacts does beside the forces.
template <int D>
struct BlockPass {
  double dt = 0.0;  ///< since the history was committed [s]
  History history = History::next;
  ThreadPart part{};
  const ForeignPairs<D>* foreign = nullptr;  ///< when there, ranges go over these pairs: second bodies alone get loads
  Stored<D>* forces = nullptr;  ///< goes with `foreign`: bodies are left alone, and the force on the first body of pair
                                ///< k goes to forces[k] if the pair touches
  BodyStiffness* stiffness = nullptr;  ///< gets the sums of what goes to the bodies
  Vec<D>* virials = nullptr;           ///< force times branch, per axis, of every pair, at its place in the list [N m];
                                       ///< 0 where it does not touch. Of foreign pairs: not asked for
};

/// Adds the forces and torques of some pairs of a section to their bodies, in the order of the range, and treats their
/// history as asked. Pairs that do not touch lose theirs. First bodies must be of the thread, but those of foreign
/// pairs.
template <int D>
void block_loop(System<D>& system, const ContactSection& section, const PairRange& range, const BlockPass<D>& pass);

/// All sections, in list order; `system.contacts.make_next()` where the history asks for it.
template <int D>
void block_loop(System<D>& system, const BlockPass<D>& pass);

}  // namespace softgrain

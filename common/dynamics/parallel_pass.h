// The parts of a force pass: sums on several threads, bit for bit those of one, and the particle pass before them.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/contact/contact_loop.h"
#include "common/core/parallel_tasks.h"
#include "common/dynamics/block_loop.h"
#include "common/system.h"

namespace softgrain {

/// Adds all contact forces to their bodies, whose forces must be zero. Every thread owns the bodies of a part of the
/// space-filling curve, larger for a faster thread. It goes through all pairs that have a body of its own, in list
/// order, and adds their loads to that body. A pair of two threads is evaluated by both, from the same numbers. So
/// every body gets its sums in list order, whatever the number of threads and whoever owns it, and no thread writes
/// what another one reads in the same phase. `asked`: what it does beside the forces (stiffness sums, which must be
/// clear, and virials); its part and foreign pairs are not looked at.
template <int D>
void parallel_pass(System<D>& system, const BlockPass<D>& asked, int threads);

/// Bodies [begin, end).
struct BodyRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// What each thread owned in the last pass: who moves its own bodies finds in its cache what it wrote there. None when
/// that pass went over another list or ran on another number of threads than may run now.
template <int D>
const std::vector<std::vector<BodyRange>>* owned_bodies(System<D>& system);

/// What one thread does in a pass.
struct PartSize {
  std::int64_t pairs = 0;       ///< listed pairs that it looks at
  std::int64_t foreign = 0;     ///< those of them whose first body another thread owns
  std::int64_t neighbours = 0;  ///< bodies of other threads that it reads
};

/// The parts of the last pass, for tests and benchmarks; empty as above.
template <int D>
std::vector<PartSize> part_sizes(System<D>& system);

/// Who owned most of every piece of all bodies (in_pieces); null as above.
template <int D>
const PieceThreads* piece_threads(System<D>& system);

/// The largest of what work(body) returns for all bodies (at least 0), on the threads that own them.
template <int D, class Work>
double max_over_bodies(System<D>& s, const Work& work) {
  double most = 0.0;
  if (const auto* const own = owned_bodies(s)) {
    const int threads = static_cast<int>(own->size());
#pragma omp parallel for schedule(static, 1) reduction(max : most) num_threads(threads)
    for (int t = 0; t < threads; ++t)
      for (const BodyRange& part : (*own)[static_cast<std::size_t>(t)])
        for (std::size_t u = part.begin; u < part.end; ++u) most = std::max(most, work(u));
    return most;
  }
  const std::size_t bodies = s.particles.sphere.size();
#pragma omp parallel for schedule(static) reduction(max : most) if (bodies >= kParallelLength)
  for (std::size_t u = 0; u < bodies; ++u) most = std::max(most, work(u));
  return most;
}

// Laws of soft particles that know of all their contacts: what every contact takes from its bodies, and the closing of
// the sums, before the loop over forces.

/// The particle pass of all laws that ask for one; must precede the loop over contacts.
template <int D>
void particle_pass(System<D>& system);

/// Its parts for the bodies of a thread: sums become empty; contacts of a range, as block_loop() takes them with part
/// and foreign pairs, add their shares; and sums are closed once all sections were seen. Nothing in the plane.
template <int D>
void clear_particle_sums(System<D>& system, ThreadPart part);
template <int D>
void add_particle_shares(System<D>& system, const ContactSection& section, const PairRange& range,
                         const BlockPass<D>& pass);
template <int D>
void close_particle_sums(System<D>& system, ThreadPart part);

/// The system has come to rest in its last pass, whose sums are there: bodies of laws that unload more steeply than
/// they load (SoftMultiContact::remembers) take its volume for their largest one where it is. Nothing in the plane.
template <int D>
void keep_largest_volumes(System<D>& system);

}  // namespace softgrain

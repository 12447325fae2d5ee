// The loop over near pairs, one at a time, for every source of them (the program's own list, LAMMPS's atoms): geometry
// and law are types, what happens with each contact is the sink's business.
//
// A source has kDimension and knows its pairs by their place: pair(c) with the bodies i and j; meet(pair, reach, g);
// state<traits>(pair, c, g), which tells a law all but motion and sums, history included; move<kSpins>(pair, g, state)
// and turning(pair); give_sums(pair, state) and sums_of(pair, f), of laws with a particle pass; evaluate(law, state);
// and keep<Law>(c, response), forget<Law>(c) for the new history. A sink has apart(c) and touch<traits of the
// law>(c, i, j, geometry, response).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstddef>
#include <cstdint>

#include "common/contact/contact_geometry.h"

namespace softgrain {

/// Pairs that a loop visits: [begin, end).
struct PairRange {
  std::int32_t begin = 0;
  std::int32_t end = 0;
};

/// touch(c, pair, geometry) for pairs that touch or are within `reach`, apart(c) for the others.
template <class Source, class Touch, class Apart>
void visit_pairs(const Source& source, double reach, const PairRange& range, Touch&& touch, Apart&& apart) {
  for (std::int32_t k = range.begin; k < range.end; ++k) {
    const auto c = static_cast<std::size_t>(k);
    const auto pair = source.pair(c);
    ContactGeometry<Source::kDimension> g;
    if (source.meet(pair, reach, g))
      touch(c, pair, g);
    else
      apart(c);
  }
}

/// What a law answers to contact c as it is.
template <class Source, class Law, class Pair, int D = Source::kDimension>
ContactResponse<D> response_of(const Source& source, const Law& law, std::size_t c, const Pair& pair,
                               const ContactGeometry<D>& g) {
  ContactState<D> state = source.template state<Law::traits>(pair, c, g);
  if constexpr (Law::traits.needs_velocity) source.template move<Law::traits.has_tangential>(pair, g, state);
  if constexpr (Law::traits.has_rolling) state.turning = source.turning(pair);
  if constexpr (Law::traits.needs_particle_pass) source.give_sums(pair, state);
  return source.evaluate(law, state);
}

template <class Source, class Law, class Sink>
void run_section(Source& source, const Law& law, const PairRange& range, Sink& sink) {
  visit_pairs(
      source, reach_of(law), range,
      [&](std::size_t c, const auto& pair, const auto& g) {
        const auto response = response_of(source, law, c, pair, g);
        source.template keep<Law>(c, response);
        sink.template touch<Law::traits>(c, pair.i, pair.j, g, response);
      },
      [&](std::size_t c) {
        source.template forget<Law>(c);
        sink.apart(c);
      });
}

/// The pass over particles that a law may ask for: every contact adds its share to the sums of its bodies, before any
/// contact is evaluated.
template <class Source, class Law>
void add_shares(const Source& source, const Law& law, const PairRange& range) {
  if constexpr (Law::traits.needs_particle_pass)
    visit_pairs(
        source, 0.0, range,
        [&](std::size_t c, const auto& pair, const auto& g) {
          const auto state = source.template state<Law::traits>(pair, c, g);
          source.sums_of(pair, [&](bool of_i, auto& sum) { law.share(state, of_i, sum); });
        },
        [](std::size_t) {});
}

/// Closes the sums of the bodies of a range, once each.
template <class Source, class Law>
void close_sums(const Source& source, const Law& law, const PairRange& range) {
  if constexpr (Law::traits.needs_particle_pass)
    for (std::int32_t k = range.begin; k < range.end; ++k)
      source.sums_of(source.pair(static_cast<std::size_t>(k)), [&](bool, auto& sum) {
        if (!sum.ready && sum.square > 0.0) law.finish(sum);
      });
}

}  // namespace softgrain

// Draws of a law, as its data leave it open, and what it may be off besides: what error bars of a macro run come from.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/data/cell_card.h"
#include "pipelines/law/named_laws.h"

namespace softgrain {

/// Neighbours of one soft particle, pressed in by these overlaps [Rs].
struct PressedNeighbours {
  std::vector<MultiContactPartner> partners;
  std::vector<double> overlap;
};

/// A law that can be drawn: its numbers, those of every draw, and the law of any numbers.
struct LawDraws {
  NamedLaws law;                           ///< the law itself, not drawn
  std::vector<double> numbers;             ///< numbers of the law; those that are positive as logarithms
  std::vector<std::vector<double>> draws;  ///< numbers of every draw, in the same form
  std::string origin;                      ///< origin of the draws, for human readers
  /// Standard deviation of the logarithm of all forces that the form of the law is off by, besides its draws: root mean
  /// square of its errors on configurations that the fit did not see (leaving one out, where there are none), the noise
  /// of their means taken off. Of those pressed in proportion and those sheared the larger: in a scene, which holds
  /// both, all soft particles may be in the state that the form knows least. 0: not known.
  double discrepancy = 0.0;
  std::string discrepancy_origin;
  /// Independent ways in which the form may be off, changes of `numbers` by one standard deviation: of all forces and
  /// of the onset, as they would have put the law right on what the fit did not see. Empty: not known.
  std::vector<std::vector<double>> off;

  /// Sums of the forces on the neighbours over E Rs^2 in these states, for given numbers of the law; tables only.
  std::function<std::vector<double>(const std::vector<double>&, const std::vector<PressedNeighbours>&)>
      multi_contact_forces;
  /// Logarithms of the forces at some states, bounded below, for given numbers of the law.
  std::function<std::vector<double>(const std::vector<double>&)> effects;
  /// The law with other numbers.
  std::function<NamedLaws(const std::vector<double>&)> with;
};

/// `count` draws of a law of these sources; a law table gives the refits that it keeps, a card its covariance, that of
/// a cell law its correlations. Throws InputError: the law keeps none, or not so many.
LawDraws law_draws(const LawSources& sources, const NamedLaws& law, const MacroSpec& spec, double contents_fraction,
                   std::int64_t count);

/// The number of draws that a key asks for, at most `most`; 0: none. Between it and eight is an error of the scene: so
/// few draws say nothing of a 95 % band.
std::int64_t read_draw_count(const SceneTable& table, const Key& key, std::int64_t most, std::int64_t otherwise);

/// Whether a law of pairs has a covariance, so that it can be drawn.
bool has_draws(const PairLaw& law);

/// Normal draws of the numbers of a law of pairs in the order of kLawParameterNames, all `a` above 0 as logarithms, by
/// its covariance; that of few packings is widened by Student's t. Throws InputError where it has none.
std::vector<std::vector<double>> pair_draws(const PairLaw& law, std::int64_t count, std::uint64_t stream);

/// See LawDraws::discrepancy.
double form_discrepancy(const MultiContactLaw& law);

/// Offsets by which the form of a law may be off. That of all forces is form_discrepancy(), which also covers how
/// forces are shared among neighbours. That of the onset is the root mean square of what would correct the law on
/// configurations that the fit has not seen, where the table says it.
std::vector<FormOffset> form_offsets(const MultiContactLaw& law);

/// `count` draws of the numbers of a card, normal with its correlations (those of positive numbers in logarithms), each
/// as wide as its 95 % interval: that of few samples is Student's. Numbers without correlations, as those that no test
/// determined, are held, and LawDraws::origin names them. `name`: engine of the curves. Throws InputError for a card
/// without correlations.
LawDraws cell_draws(const CellCard& card, const std::string& name, std::int64_t count);

}  // namespace softgrain

// Draws of a law, as its data leave it open, and what it may be off besides: what error bars of a macro run come from.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipelines/law/named_laws.h"

namespace softgrain {

/// Neighbours of one soft particle, pressed in by these overlaps [Rs].
struct PressedNeighbours {
  std::vector<CrowdPartner> partners;
  std::vector<double> overlap;
};

/// A law that can be drawn: its numbers, those of every draw, and the law of any numbers.
struct LawDraws {
  NamedLaws law;                           ///< as it is
  std::vector<double> numbers;             ///< of it; those that are positive as logarithms
  std::vector<std::vector<double>> draws;  ///< likewise
  std::string origin;                      ///< of the draws, for people
  /// Standard deviation of the logarithm of all forces that the form of the law is off by, besides its draws: root mean
  /// square of its errors on configurations that the fit did not see (leaving one out, where there are none), the noise
  /// of their means taken off. Of those pressed in proportion and those sheared the larger: in a scene, which holds
  /// both, all soft particles may be in the state that the form knows least. 0: not known.
  double discrepancy = 0.0;
  std::string discrepancy_origin;
  /// Independent ways in which the form may be off, changes of `numbers` by one standard deviation: of all forces and
  /// of the onset, as they would have put the law right on what the fit did not see. Empty: not known.
  std::vector<std::vector<double>> off;

  /// Of tables: sums of the forces on the neighbours over E Rs^2 in these states, for numbers of its own.
  std::function<std::vector<double>(const std::vector<double>&, const std::vector<PressedNeighbours>&)> crowd_forces;
  /// What it says at some states, for numbers of its own: logarithms of forces, bounded below.
  std::function<std::vector<double>(const std::vector<double>&)> effects;
  /// The law of other numbers.
  std::function<NamedLaws(const std::vector<double>&)> with;
};

/// `count` draws of a law of these sources; a law table gives the refits that it keeps, a card its covariance. Throws
/// BadInput: the law keeps none, or not so many; cells.
LawDraws law_draws(const LawSources& sources, const NamedLaws& law, const MacroSpec& spec, double contents_fraction,
                   std::int64_t count);

/// See LawDraws::discrepancy.
double form_discrepancy(const CrowdLaw& law);

/// Of all forces by form_discrepancy(), which holds how forces are shared among neighbours too, and of the onset by the
/// root mean square of what would put the law right on configurations that the fit has not seen, where the table says
/// it.
std::vector<FormOffset> form_offsets(const CrowdLaw& law);

}  // namespace softgrain

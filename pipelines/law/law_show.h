// Laws as text for a terminal, never wider than 80 columns (but for single words that are).
#pragma once

#include <string>

#include "pipelines/law/fitted_law.h"

namespace softgrain::law {

/// Of a card: what was measured and how, parameters with intervals, range and status, and a small plot of the normal
/// law. Of a table: every entry with its laws, neighbours, friction, and how far off the laws are. Of a card of the
/// cell law: its numbers, and a small plot of the equation of state.
std::string law_text(const FittedLaw& file, bool utf8);

/// A number with `digits` significant digits.
std::string number(double x, int digits = 4);
/// The text of each kind of law; `file` says where it comes from.
std::string show(const LawCard& card, const FittedLaw& file, bool utf8);
std::string show(const LawTable& table, const FittedLaw& file, bool utf8);
std::string show(const CellCard& card, const FittedLaw& file, bool utf8);
/// "softgrain 0.1.0 (8b5b7b7fb7b0), seed 1: softgrain run ..."; empty when the file says nothing.
std::string origin_text(const LawOrigin& origin);
/// "Rs = 0.016 m, E = 5e+05 Pa, ..." of the soft particle that was measured.
std::string show_spec(const SoftParticleSpec& spec);

}  // namespace softgrain::law

// Laws as text for a terminal, never wider than 80 columns (but for single words that are).
#pragma once

#include <string>

#include "pipelines/law/law_file.h"

namespace softgrain::law {

/// Text of a card: what was measured and how, parameters with intervals, range and status, and a small plot of the
/// normal law.
std::string show_card(const LawFile& file, bool utf8);

/// Text of a table: every entry with its laws, neighbours, friction, and how far off the laws are.
std::string show_table(const LawFile& file, bool utf8);

/// Text of a card of the cell law, with a small plot of the equation of state.
std::string show_cells(const LawFile& file, bool utf8);

/// Text of whatever the file holds: a card, a table or a card of the cell law.
std::string law_text(const LawFile& file, bool utf8);

/// A number with `digits` significant digits.
std::string number(double x, int digits = 4);
/// "softgrain 0.1.0 (8b5b7b7fb7b0), seed 1: softgrain run ..."; empty when the file says nothing.
std::string origin_text(const LawOrigin& origin);
/// "Rs = 0.016 m, E = 5e+05 Pa, ..." of the soft particle that was measured.
std::string show_spec(const SoftParticleSpec& spec);

}  // namespace softgrain::law

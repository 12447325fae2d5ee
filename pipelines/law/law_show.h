// Laws as text for a terminal, never wider than 80 columns (but for single words that are).
#pragma once

#include <string>

#include "pipelines/law/law_file.h"

namespace softgrain::law {

/// What was measured and how, parameters with intervals, range and status, and the normal law drawn small.
std::string card_text_for_people(const LawFile& file, bool utf8);

/// The same for a table: every entry with its laws, neighbours, friction, and how far off the laws are.
std::string table_text_for_people(const LawFile& file, bool utf8);

/// The same for a card of the cell law, with the equation of state drawn small.
std::string cells_text_for_people(const LawFile& file, bool utf8);

/// One of the three.
std::string law_text(const LawFile& file, bool utf8);

/// With so many digits that count.
std::string number(double x, int digits = 4);
/// "softgrain 0.1.0 (8b5b7b7fb7b0), seed 1: softgrain run ..."; empty when the file says nothing.
std::string origin_text(const LawOrigin& origin);
/// "Rs = 0.016 m, E = 5e+05 Pa, ..." of the soft particle that was measured.
std::string spec_text_for_people(const SoftParticleSpec& spec);

}  // namespace softgrain::law

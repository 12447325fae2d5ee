// Pieces that all cards share: numbers that read back to the same double, the soft particle that was measured,
// estimates.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>

#include "common/data/law_card.h"
#include "common/data/measurements.h"
#include "common/io/scene.h"

namespace softgrain {

/// Shortest text that reads back to the same double; what is not finite goes into quotes.
std::string real(double value);
/// The text in quotes, with the escapes that TOML needs.
std::string quoted(const std::string& text);
/// A number, or what was not known at the time of writing: "nan", "inf", "-inf".
double read_real(const SceneTable& table, const std::string& key, const Range& range);

/// Largest exponent of a force or stiffness over overlap; fits end far below.
inline constexpr double kLargestExponent = 50.0;

/// Takes the words for people, which nothing depends on (of the definitions: those keys), and returns which .h5 belongs
/// to the card.
std::string read_words(const SceneTable& root, std::initializer_list<const char*> definitions);

/// Key `beyond`, of cards and of scenes that overrule them; empty when it is not there.
std::optional<Extrapolation> read_beyond(const SceneTable& table);

/// "key = value" lines of what is known of a soft particle, and back; `may_be_unknown`: all but Rs and E may be absent.
std::string spec_text(const SoftParticleSpec& spec);
SoftParticleSpec read_spec_text(const SceneTable& table, bool may_be_unknown);

/// An inline table { value, standard_error, low, high }, and back; the value must be in range and between the ends.
std::string estimate_text(const Estimate& estimate);
Estimate read_estimate_text(const SceneTable& table, const Range& range);

}  // namespace softgrain

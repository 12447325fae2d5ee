// toml++ for the sources of common/io. Version 3 answers some texts that are no TOML with an assertion ("[?a]" as a
// header, for one) and in a release build even takes the assertion for granted, so that anything may follow. Here an
// assertion of it that fails refuses the text, whatever the build.
#pragma once

namespace softgrain {

/// Thrown where toml++ would assert; says nothing about the place.
struct TomlAssertion {};

[[noreturn]] inline void toml_assertion_failed() { throw TomlAssertion{}; }

}  // namespace softgrain

#ifdef NDEBUG
#define SOFTGRAIN_TOML_NDEBUG
#undef NDEBUG
#endif
#define TOML_ASSERT(condition) ((condition) ? void() : ::softgrain::toml_assertion_failed())
#include <toml++/toml.h>
#ifdef SOFTGRAIN_TOML_NDEBUG
#undef SOFTGRAIN_TOML_NDEBUG
#define NDEBUG
#endif
// Everybody else's assertions as they were.
#include <cassert>

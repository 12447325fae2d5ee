// What is looked at in a text before toml++ reads it.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstddef>
#include <string_view>

namespace softgrain {

/// Most parts of a dotted key. toml++ 3 goes down a key of many parts by recursion and runs out of stack somewhere
/// beyond ten thousand; no scene has more than six.
inline constexpr std::size_t kMostKeyParts = 100;

/// The line, from 1, of the first key with more than `most` parts; 0: there is none. Text in quotation marks and
/// comments is skipped. Of a text that is no TOML the answer holds up to the first mistake, where a parser stops.
std::size_t line_of_long_key(std::string_view text, std::size_t most = kMostKeyParts);

}  // namespace softgrain

// What bytes of a text file mean: spreadsheets and instruments write more than UTF-8.
#pragma once

#include <string>

namespace softgrain {

/// Whether all bytes are UTF-8.
bool is_utf8(const std::string& bytes);

/// The text as UTF-8, without byte order mark: UTF-16 of both byte orders is recognised by its mark or by its zero
/// bytes; what is no UTF-8 counts as Windows-1252.
std::string utf8_of(const std::string& bytes);

/// The text with every byte that is no UTF-8 replaced by U+FFFD, for files that must be UTF-8.
std::string replaced_utf8(const std::string& text);

}  // namespace softgrain

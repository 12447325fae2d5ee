// A scene as a flat list of keys and values, for setting scenes side by side.
#pragma once

#include <map>
#include <string>

namespace softgrain {

/// Every key of a TOML text with its value as text: "macro.bodies" -> "40", elements of arrays of tables by their
/// numbers as --set counts them, "contact.0.mu" -> "0.3". Numbers that are equal have equal texts (0.3, 0.30); texts
/// come without quotes, lists in brackets. Throws InputError for what is no TOML; `name`: of the text in the message.
std::map<std::string, std::string> flat_scene(const std::string& text, const std::string& name);

}  // namespace softgrain

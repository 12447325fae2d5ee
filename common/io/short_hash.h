// Short names for long texts: caches and checkpoints.
#pragma once

#include <string>

namespace softgrain {

/// 64-bit FNV-1a as 16 hexadecimal digits: the same on every machine. Not for security.
std::string short_hash(const std::string& text);

}  // namespace softgrain

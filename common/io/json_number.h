// Numbers as JSON can hold them.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace softgrain {

/// JSON knows no infinity: what is not known is null.
inline nlohmann::json number_or_null(double x) {
  return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(nullptr);
}

}  // namespace softgrain

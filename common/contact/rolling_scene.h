// The keys of rolling resistance, once for all tables of scenes and cards that have them.
#pragma once

#include <string>

#include "common/core/material.h"
#include "common/io/scene.h"

namespace softgrain {

/// Names of these keys, for those who refuse them.
inline constexpr const char* kRollingKeys[] = {"mu_r", "kr_ratio"};

/// Reads them over what `rolling` is without. Rolling resistance needs `friction`, the `mu` of the same contacts.
void read_rolling_resistance(const SceneTable& t, double friction, RollingResistance& rolling);

/// ", mu_r = 0.1, kr_ratio = 1" behind the friction of grains; empty where they roll freely.
std::string rolling_text(const RollingResistance& rolling);

}  // namespace softgrain

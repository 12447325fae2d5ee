// Which variants of a material differ in the span of their sizes alone, so that one may be foretold from others.
#pragma once

#include <string>
#include <vector>

#include "pipelines/kinds/material/scene.h"

namespace softgrain {

/// Equal for variants that differ in nothing but the span of their sizes, the unit of length, and how many grains and
/// samples there are. Preparation, mu and the law of the sizes always stand in it, anything else where variants of the
/// scene differ in it. What a [[loading]] says is left out.
std::string material_family(const MaterialVariant& variant, const std::vector<MaterialVariant>& all);

/// Equal for variants of one material_family() under the same loading.
std::string family_of(const MaterialVariant& variant, const std::vector<MaterialVariant>& all);

}  // namespace softgrain

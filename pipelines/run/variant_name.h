// Names of [[variant]] tables.
#pragma once

#include <string>

#include "common/io/scene.h"

namespace softgrain {

/// The key "name", fit to be that of a file: letters, digits, '-', '_' and '.', which does not lead. Throws InputError.
std::string read_variant_name(const SceneTable& variant);

}  // namespace softgrain

// Which command runs which kind of scene.
#pragma once

#include "common/io/scene.h"

namespace softgrain {

/// Throws BadInput at `kind` when the scene is one that another command than `command` runs, and names that command.
/// Kinds that nobody knows pass: the reader of the kind says what there is.
void refuse_other_commands(const SceneTable& root, const std::string& command);

}  // namespace softgrain

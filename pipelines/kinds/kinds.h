// All kinds of scenes.
#pragma once

#include <span>

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// A kind is added here and in its folder; commands, `check`, tests and fuzzer go through this table.
std::span<const SceneKind> scene_kinds();

/// The kind that the scene names. Throws BadInput.
const SceneKind& kind_of(const Scene& scene);

/// The same when `command` runs it. Throws BadInput at `kind`, naming the command that does.
const SceneKind& kind_of(const Scene& scene, const std::string& command);

}  // namespace softgrain

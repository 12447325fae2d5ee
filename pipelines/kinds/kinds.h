// The kind of a scene. The table scene_kinds() is made here: a kind is added to it and in its folder; commands,
// `check`, report, export, tests and fuzzer go through it.
#pragma once

#include <span>

#include "pipelines/run/scene_kind.h"

namespace softgrain {

std::span<const SceneKind> scene_kinds();

/// The kind that the scene names. Throws InputError.
const SceneKind& kind_of(const Scene& scene);

/// The kind that the scene names, if `command` runs it. Otherwise throws InputError at `kind`, naming the command that
/// does.
const SceneKind& kind_of(const Scene& scene, const std::string& command);

}  // namespace softgrain

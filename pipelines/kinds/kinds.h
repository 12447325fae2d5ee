// The kind of a scene. The table scene_kinds() is made here: a kind is added to it and in its folder; commands,
// `check`, report, export, tests and fuzzer go through it.
#pragma once

#include <span>
#include <string>

#include "pipelines/run/scene_kind.h"

namespace softgrain {

std::span<const SceneKind> scene_kinds();

/// Members of the summary.json of a kind: those of every kind, then its own; none where it does not name its own.
std::vector<RecordMember> summary_members(const SceneKind& kind);

/// The kind that the scene names. Throws InputError.
const SceneKind& kind_of(const Scene& scene);

/// The kind that the scene names, if `command` runs it: "run" does in any case, else the kind's own command. Otherwise
/// throws InputError at `kind`, naming the commands that do.
const SceneKind& kind_of(const Scene& scene, const std::string& command);

/// "run or macrosim": names of the commands that run scenes of the kind.
std::string commands_of(const SceneKind& kind, const char* separator);

/// Throws InputError for options of the command line that scenes of this kind have no use for: caches, the law and its
/// bands, LAMMPS.
void refuse_idle_options(const SceneKind& kind, const CommonOptions& options);

}  // namespace softgrain

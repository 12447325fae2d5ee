// The law of a scene that asks the library: law = "library" and the material in [library].
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/law/fitted_law.h"

namespace softgrain {

/// The path of a law that a scene names, relative to the scene; "library", the library of the program, stays.
std::string law_path(const Scene& scene, const std::string& written);

/// Whether a path stands for a library: "library", or the file of one. Throws InputError, IoError.
bool asks_library(const std::string& path);

/// The law at a path: a file or run directory as load_or_fit_law() takes it; of a library the law of the material that
/// table [library] of `root` describes. Throws InputError, IoError.
FittedLaw law_at(const SceneTable& root, const std::string& path);

/// Reads table [library] alone, for scenes that are read without their law. Throws InputError.
void read_library_keys(const SceneTable& root);

/// Refuses table [library] where none of the laws at these paths is a library.
void refuse_idle_library(const SceneTable& root, const std::vector<std::string>& paths);

}  // namespace softgrain

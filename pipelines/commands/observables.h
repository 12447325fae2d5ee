// Observables and parameters of a run as two small text files, in the form that GrainLearning (and other calibration
// tools) read: a header line "# name name ..." and columns of numbers.
#pragma once

#include <string>
#include <vector>

namespace softgrain {

/// Throws InputError unless the scene is of a kind that has observables: pipeline, soft-particle, macro. Before any
/// work.
void require_observables(const std::string& scene, const std::vector<std::string>& overrides);

/// Writes PREFIX_sim.txt and PREFIX_param.txt.
///   A run with a macro part: strain, stress [Pa], lateral_stress [Pa], coordination, means over samples of the law's
///   curves. Other runs: Delta, Fn [N], Fn_error [N] (standard error over packings); of soft-solid contacts where they
///   were measured, and those of soft-soft contacts as Fn_soft_soft beside it where the overlaps are the same.
///   The parameters are the overrides "key=value" that are plain numbers, named by the last part of their key (the
///   whole key when two would share it).
/// Throws InputError, IoError.
void write_observables(const std::string& directory, const std::vector<std::string>& overrides,
                       const std::string& prefix);

}  // namespace softgrain

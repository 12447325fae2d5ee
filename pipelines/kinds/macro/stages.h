// [[stage]] of macro scenes: a test in parts.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Least strain of a test: what is left of less than that after the rounding of positions is no measurement.
inline constexpr double kLeastStrain = 1e-9;

/// Reads the tables `stage` of `holder`; where there are any they are the test, in place of what `spec` had, and
/// `macro`, the table that says everything else of the scene, must not name one. Steps, increments and tolerance of a
/// stage are those of `spec` unless it says them. `modulus_is_known`: whether E of `spec` is that of the grains, above
/// which no stress may be; false where it was refused, or where parts of the scene may have another one. Throws
/// InputError.
void read_stages(const SceneTable& holder, const SceneTable& macro, MacroSpec& spec, bool modulus_is_known);

/// Key `modulus_stress`: the two stresses [Pa] between which moduli are taken; as they were where the table has none.
void read_modulus_stress(const SceneTable& t, std::array<double, 2>& interval);

/// Reads the stages of a part of a scene ([[variant]], [[scene]]), table `t`. Without stages or a test of its own it
/// takes those of `common`, with its own steps, increments and tolerance where a stage says none. `modulus_is_known`:
/// as of read_stages(). Throws InputError.
void read_part_stages(const SceneTable& common, const SceneTable& t, MacroSpec& spec, bool modulus_is_known);

/// Refuses keys of a test in `t` that none of the tests that read them takes: the preload of a test without shear, the
/// strain of tests in stages, steps that every stage says itself. `stages`: the table whose tables `stage` they are, in
/// tests in stages.
void refuse_idle_test_keys(const SceneTable& t, const SceneTable& stages, const std::vector<const MacroSpec*>& tests);

/// Refuses the common tables `stage` of a scene all of whose parts ([[variant]], [[scene]]) give a test or stages of
/// their own. `part`: what parts are called.
void refuse_idle_stages(const SceneTable& root, const char* part, const std::vector<SceneTable>& parts);

/// Requires a periodic cell for a test or stage that slides, said at `key`.
void require_sliding(const SceneTable& t, const char* key, const MacroSpec& spec);

/// Whether `t` says this key of a test itself, or in each of its tables `stage`.
bool says_in_test(const SceneTable& t, const std::string& key);

/// What a test does to the box, roughly, were all bodies to move with it: for estimates before a run.
struct RoughStrains {
  double largest_axial = 0.0;       ///< shortening of z at its most
  double largest_volumetric = 0.0;  ///< loss of volume at its most
  double way = 0.0;                 ///< all strains of all axes, whatever their sign, largest axis of each stage
};
RoughStrains rough_strains(const MacroSpec& spec);

}  // namespace softgrain

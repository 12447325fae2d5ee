// Macro scenes: table [macro] of any kind that has one, and kind "macro" as a whole.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/io/scene.h"
#include "macrosim/density_search.h"
#include "macrosim/macro_packing.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// How the band of a law is found from its draws.
enum class BandEstimator {
  components,  ///< runs along the few combinations of parameters that change what the law says; every draw from those
  draws        ///< a run for every draw: the reference
};

template <>
inline constexpr auto enum_names<BandEstimator> =
    enum_name_list<BandEstimator>({{BandEstimator::components, "components"}, {BandEstimator::draws, "draws"}});

/// Of the largest over the smallest radius, and of b in P(r) ~ r^-b: powers of radii stay numbers.
inline constexpr Range kSizeRatios{1.0, 1e9, true, false};
inline constexpr Range kSizeExponents{1.0, 20.0, true, false};

struct MacroSetup {
  MacroSpec spec;
  std::int64_t samples = 1;
  std::vector<Twin> twins{Twin::shelled};  ///< resolved beside every sample
  std::optional<MacroPacking> given{};     ///< packing that every test starts from, in place of prepared ones
  std::int64_t kept_states = 0;            ///< number of kept states of the first sample of every engine, for pictures
  std::int64_t bands = 0;                  ///< draws of the law that error bars come from; 0: no error bars
  BandEstimator band_estimator = BandEstimator::components;
  std::int64_t law_increments = 1;  ///< increments of runs with laws for one increment of a twin
  std::int64_t noise_samples = 0;   ///< number of samples that every engine runs a second time: see slightly_changed()
  std::vector<std::string> assumed{};      ///< "nu = 0.3": of grains, where the law does not say them
  double start_stress = 0.0;               ///< start pressure where a table says it as a pressure [Pa]; 0: over E
  std::optional<DensityTarget> density{};  ///< what prepared packings have to reach
  std::set<std::string> said{};  ///< keys of the preparation that a table gave: others follow from mu and its name
};

[[nodiscard]] inline bool has_twin(const MacroSetup& setup, Twin twin) {
  return std::find(setup.twins.begin(), setup.twins.end(), twin) != setup.twins.end();
}

/// Reads [macro]; material defaults come from the measured soft particle, as far as it is known. Throws InputError.
MacroSetup read_macro_setup(const SceneTable& macro, const SoftParticleSpec& defaults);

/// Replaces what a table says, keeps the rest. Throws InputError.
MacroSetup read_macro_setup(const SceneTable& macro, const MacroSetup& base);

/// Parts of [macro] that other kinds of scene share. The first needs spec.friction: what no table said follows from it
/// and from the name of the preparation, what one said stays. Throw InputError.
void read_preparation(const SceneTable& t, MacroSetup& setup);
/// `solid_fraction`, `void_ratio` or `dry_density`, which the preparation has to reach, over what `setup` has.
void read_density(const SceneTable& t, MacroSetup& setup);
/// Requires that the preparation of a setup with a target has friction to search, and that grains fit the target.
void require_density(const SceneTable& t, const MacroSetup& setup);
/// Keys of a target.
inline constexpr std::array kDensityKeys{"solid_fraction", "void_ratio", "dry_density", "solid_fraction_tolerance"};
/// Refuses the keys of a preparation by this program where LAMMPS prepares.
void refuse_protocol_keys(const SceneTable& t);
void read_test(const SceneTable& t, MacroSpec& spec);

/// Twins are filled with packings like the one that was measured. Throws InputError, at key `resolved`, when the scene
/// has twins and `spec` of the law in this file does not say what is inside.
void require_known_contents(const SceneTable& macro, const MacroSetup& setup, const SoftParticleSpec& spec,
                            const std::string& law_file);

/// Refuses keys of the motion of twins where there are none, and of bands likewise.
void refuse_idle_keys(const SceneTable& macro, bool twins, bool bands);

/// Refuses keys in `macro` of the sizes of a kind of body of which none of these scenes has any.
void refuse_idle_sizes(const SceneTable& macro, const std::vector<const MacroSetup*>& scenes);

/// What was assumed because the law does not say it, as a sentence; empty when nothing was.
std::string assumed_text(const MacroSetup& setup);

/// Refuses preparation "lammps", for commands that do not run LAMMPS. Throws InputError.
void require_own_preparation(const SceneTable& macro, const MacroSetup& setup);

/// A scene of kind "macro".
struct MacroScene {
  std::string title;
  std::uint64_t seed = 1;
  std::string law_file;  ///< empty: the scene names none
  LawSources law;        ///< sources of the law
  MacroSetup setup;
  SoftParticleSpec spec;      ///< soft particle that the law was measured on, and of the contents of twins
  std::int64_t contents = 7;  ///< number of different ones
};

/// Reads it to the last key, and its law; `law` (a file) replaces the key of that name. Throws InputError, IoError.
MacroScene read_macro_scene(const Scene& scene, const std::string& law);

/// The scene without its law, whatever it names: twins are not held against what the law says. Throws InputError.
MacroScene read_macro_scene_alone(const Scene& scene);

/// Runs all samples by law, in our engine or in LAMMPS, and the twins; writes macro.h5, macro_initial.h5, the kept
/// states, summary.json and the report. Status not_usable when a curve is not usable or carries no stress.
SceneKind macro_kind();

// What macro runs leave behind.

KindResults macro_results();

namespace report {
std::string macro_section(const RunData& run);  ///< stress and strain, law against resolved twin
}

namespace report {
/// Part of the section of macro scenes on stages: moduli and strength of all stages. For tests in stages it also has
/// q/p and the change of volume over the axial strain. Empty where curves do not name their stages.
std::string stage_parts(const std::vector<MacroCurve>& curves, MacroTest test);

/// Part on the state at the end: stress over the mean stress, fabric of all contacts and of the strong ones, and the
/// distribution of the contact forces. `id` begins the name of its plot. Empty where curves have none of these.
std::string tensor_parts(const std::vector<MacroCurve>& curves, const std::string& id);
}  // namespace report

// Starting states that are not prepared: kept by another run, or given as a file.

/// Raised whenever the same key would give another packing: when random numbers, preparations or what a packing holds
/// change. The test of cached results holds the packings of this number.
inline constexpr int kPackingSchema = 4;

/// Everything that determines a prepared packing, as text.
std::string packing_key(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample);

/// A table of bodies as CSV: columns "x [m]", "y [m]", "z [m]", "r [m]" (or other lengths) and "kind", which is solid
/// or soft. The box in a comment "# box [mm] = x y z x y z" (any unit of length), its low and its high corner; without
/// it the tightest one. A periodic cell must be said. Other columns and other comments that name a value are refused.
/// Throws IoError, and InputError with line and column for what is no body, for a body outside the box and for two
/// that overlap by more than kGivenOverlap of the smaller radius.
MacroPacking read_packing_file(const std::string& path, Boundary boundary = Boundary::walls);

/// More than any test here presses bodies into each other at its start; soft particles that overlap by more would be
/// beyond the range of any measured law in most of their contacts.
inline constexpr double kGivenOverlap = 0.2;

}  // namespace softgrain

// Scenes of kind "material-law": what the cell law needs to know of a material, measured on its fines, its coarse
// grains and mixtures of both.
#pragma once

#include <string>
#include <vector>

#include "common/packing/grading.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Where the packings that the scene makes by itself stand among its variants, in the order in which they run. Each
/// packing of fines is followed by its further tests.
struct LawPlaces {
  std::size_t fines = 0;
  std::size_t sheared_fines = 1;
  std::size_t coarse = 2;
  std::size_t first_mixture = 3;  ///< a mixture for each share from here on
  // With shear memory.
  std::vector<std::size_t> shear_tests{};   ///< tests of fines that shear memory is fitted to
  std::size_t oedometer = 0;                ///< one of them: where the lateral stress is taken from
  std::vector<std::size_t> preparations{};  ///< fines of other preparations, of which nothing but the onset is taken
};

struct MaterialLawScene {
  MaterialScene material;        ///< variants as LawPlaces says
  Grading sizes;                 ///< sizes of the whole material
  double split = 1.0 / 3.0;      ///< fines are below this share of the largest radius
  std::vector<double> mixtures;  ///< shares of fines by solid volume, ascending
  std::int64_t cells = 100;      ///< sites of the cells that friction is fitted with
  bool memory = false;           ///< whether the law has shear memory
  bool dense = false;            ///< with it: whether dense fines are measured too
  LawPlaces at{};
};

/// What its tables mean where they say nothing.
MacroSetup material_law_defaults();

/// Coarse and fine grains of a drawn sample, and their solid volumes [m^3].
struct GrainShares {
  std::int64_t coarse = 0;
  std::int64_t fines = 0;
  double coarse_volume = 0.0;
  double fines_volume = 0.0;
};
GrainShares shares_of(const MaterialLawScene& scene, const MaterialVariant& variant, std::uint64_t seed,
                      std::uint64_t sample);

/// Reads the whole scene. Throws InputError, IoError.
MaterialLawScene read_material_law_scene(const Scene& scene);

/// Variants, time, and what to mind. Throws InputError, IoError.
void check_material_law(const MaterialLawScene& law, Findings& out);

/// Measures all variants, fits the cell law; writes cell_law.toml beside what a scene of kind "material" leaves. Status
/// not_usable, and no card, where a part of the law could not be determined.
SceneKind material_law_kind();

// What runs of kind "material-law" leave behind, beside the files of kind "material".

inline constexpr const char* kCellLawFile = "cell_law.toml";

KindResults material_law_results();

namespace report {
std::string cell_law_section(const RunData& run);  ///< numbers of the law, excess pores, friction of the fines
}

}  // namespace softgrain

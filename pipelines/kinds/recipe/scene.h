// Scenes of kind "recipe": from a sieve curve, or a list of constituents, to the law of the matter.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/data/multi_contact_measurements.h"
#include "common/packing/grading.h"
#include "pipelines/kinds/material/constituents.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// A level of a size distribution: slices follow each other, from the coarsest to the finest.
struct RecipeLevel {
  double low = 0.0;    ///< smallest radius in it [m]
  double high = 0.0;   ///< largest
  double share = 0.0;  ///< share of the solid volume of all levels
  std::vector<SizePiece> pieces;
};

/// Cuts [m], descending, that split the sizes into the least number of slices of equal ratio, none above `ratio`.
/// Slices without a grain, or with less than `least_share` of the volume, are joined with their neighbour.
std::vector<double> find_cuts(const Grading& sizes, double ratio, double least_share);

/// The slices between the cuts (radii, descending), those without a grain left out.
std::vector<RecipeLevel> levels_of(const Grading& sizes, const std::vector<double>& cuts);

/// The grains of a level alone, and of a level with the next finer one, of which the fines have this share of the
/// volume; the largest radius is 1 cm, since nothing that is measured depends on the scale: slices of equal shape are
/// equal, wherever on the curve they are.
Grading slice_of(const RecipeLevel& level);
Grading pair_of(const RecipeLevel& coarse, const RecipeLevel& fine, double fines_share);
/// The largest radius of fines over that of the coarse level, in the units of pair_of().
double cut_of_pair(const RecipeLevel& coarse, const RecipeLevel& fine);

/// All levels from `first` on together, as they are in the whole.
Grading joined(const std::vector<RecipeLevel>& levels, std::size_t first, std::size_t count);

/// Mean solid volume of a grain [m^3].
double mean_grain_volume(const std::vector<SizePiece>& pieces);

/// The coarsest levels with all their grains, as they are in the whole: what laws of it are held against.
struct RecipeCheck {
  std::int64_t grains = 8000;  ///< 0: none
  std::int64_t samples = 2;
};

/// The coarsest level in cells of everything finer, pressed.
struct RecipeMacro {
  std::int64_t grains = 150;
  std::int64_t samples = 2;
  double strain = 0.0;  ///< 0: that of the test, or half of the pores if that is less
};

/// The hierarchy of soft particles beside it.
struct RecipeShells {
  std::int64_t levels = 0;  ///< 0: none
  std::int64_t packings = 4;
  double ratio = 10.0;  ///< largest over smallest radius of the grains of a level
  LawForm form = LawForm::isotropic;
};

/// Place among the variants of the second level, sheared at constant volume: behind it, whose packings it shares.
inline constexpr std::size_t kSheared = 1;

/// What a level measured together with the next finer one, place by place in RecipeScene::mixtures.
using MixtureVariants = std::vector<std::size_t>;

struct RecipeScene {
  MaterialScene material;  ///< all packings that are measured, none twice
  std::vector<Constituent> constituents;
  Grading sizes;                       ///< sizes of the whole
  std::vector<RecipeLevel> levels;     ///< the coarsest first
  std::vector<double> mixtures;        ///< shares of the finer level by solid volume, ascending
  std::vector<std::size_t> slice;      ///< variant of each level in `material`
  std::vector<MixtureVariants> mixed;  ///< mixtures of every level but the finest
  std::optional<std::size_t> checked;  ///< variant of the check
  std::size_t checked_levels = 0;      ///< number of levels in the check
  std::vector<std::string> raised;     ///< packings whose default number of grains was too small, and what they have
  std::vector<std::string> doubts;     ///< packings that may have no room when they are pressed
  RecipeCheck check;
  RecipeMacro macro;
  RecipeShells shells;
  std::int64_t cells = 100;  ///< sites of the cells that friction is fitted with
  /// E of the whole, which its stresses are over: of [material], or with grains of several materials the harmonic
  /// mean over the solid volume. That of a packing is the mean of its own grains, and it is loaded to stresses over E
  /// as the whole.
  double youngs_modulus = 0.0;
};

/// Reads the whole scene. Throws InputError, IoError.
RecipeScene read_recipe_scene(const Scene& scene);

/// Solid volume of everything finer than a level, over that of the level.
double fines_over_coarse(const RecipeScene& scene, std::size_t level);

// Parts of reading the scene.

/// Makes E and density of a packing those of its own grains (take_reference), and multiplies the stresses of its test
/// with the change of E: packings of stiff grains and of soft ones are compared at equal stresses over E.
void take_own_reference(MacroSpec& spec, const Grading& sizes);

/// The test of a packing as it is for the whole, of this E [Pa].
MacroSpec test_of_whole(MacroSpec spec, double youngs_modulus);

/// Gives every packing room for the images of its largest grains: numbers that nobody asked for are raised. Those of
/// the scene are refused where grains cannot even be placed, and doubted where they may have no room when they are
/// pressed. Throws InputError.
void require_room(const SceneTable& root, RecipeScene& scene);

/// "diameters 1 to 3.2 mm".
std::string level_text(const RecipeLevel& level);

/// Measures levels and mixtures, puts them together, loads the coarsest level by both laws; writes recipe.csv,
/// material_card.toml, cell_law.toml, law_table.toml (with [shells]), the files of kind "material" and the report.
SceneKind recipe_kind();

}  // namespace softgrain

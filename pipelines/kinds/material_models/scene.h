// Scenes of kind "material-models": resolved materials and what stands for them, on the same samples.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

enum class ModelKind {
  cells,       ///< coarse grains in cells of fines
  substitute,  ///< fines replaced by fewer, larger grains of the same volume
  mean_field,  ///< no bodies: the equation of state at the mean density
  coarse,      ///< coarse grains alone
  shells       ///< fines as soft particles between the coarse grains
};

template <>
inline constexpr auto enum_names<ModelKind> = enum_name_list<ModelKind>({{ModelKind::cells, "cells"},
                                                                         {ModelKind::substitute, "substitute"},
                                                                         {ModelKind::mean_field, "mean-field"},
                                                                         {ModelKind::coarse, "coarse"},
                                                                         {ModelKind::shells, "shells"}});

/// Where the coarse grains of a model are.
enum class ModelPlaces { truth, own };

template <>
inline constexpr auto enum_names<ModelPlaces> = enum_name_list<ModelPlaces>({{ModelPlaces::truth, "truth"},
                                                                             {ModelPlaces::own, "own"}});

/// What its start follows from.
enum class ModelStart { pressure, density };

template <>
inline constexpr auto enum_names<ModelStart> = enum_name_list<ModelStart>({{ModelStart::pressure, "pressure"},
                                                                           {ModelStart::density, "density"}});

/// One [[model]].
struct MaterialModel {
  std::string name;
  ModelKind kind = ModelKind::cells;
  std::vector<std::string> variants{};  ///< variants that it is for; empty: all
  double split = 1.0 / 3.0;             ///< radius over the largest below which grains are fines
  ModelPlaces places = ModelPlaces::truth;
  ModelStart start = ModelStart::pressure;
  std::optional<CellCard> card{};         ///< card for cells, mean fields and substitutes (for the equation of state)
  std::int64_t bands = 0;                 ///< draws of the card for error bands; 0: none
  double soft_share = 0.0;                ///< volume share of soft bodies among all bodies, for cells in own places
  double smallest = 0.2;                  ///< smallest radius of substitutes over the largest of the material
  bool mapped = false;                    ///< whether stresses of substitutes are mapped by the equation of state
  std::optional<LawSources> law{};        ///< law of shells
  std::array<double, 2> radii{0.2, 0.6};  ///< radii of shells and soft bodies over the largest grain: low, high
  double scale = 1.0;                     ///< factor on the radii of shells once they are placed
};

struct MaterialModelsScene {
  MaterialScene material;
  std::vector<MaterialModel> models;
  std::vector<std::string> blind;  ///< variants apart from the rest
  std::vector<std::string> files;  ///< files of laws
  std::string text;                ///< contents of these files
};

/// Whether `name` is that of the variant, or of the packings which its loadings share.
bool is_named(const MaterialVariant& v, const std::string& name);

/// Throws InputError, IoError.
MaterialModelsScene read_material_models_scene(const Scene& scene);

/// Runs materials and models; writes models.csv, models_NAME.h5 and what kind material does.
SceneKind material_models_kind();

// What runs of kind "material-models" leave behind, beside the files of kind "material".

KindResults material_models_results();

namespace report {
std::string material_models_section(const RunData& run);  ///< stress of truth and models, errors, error against cost
}

}  // namespace softgrain

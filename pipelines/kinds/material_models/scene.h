// Scenes of kind "material-models": resolved materials and what stands for them, on the same samples.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/words.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/law/named_laws.h"

namespace softgrain {

enum class ModelKind {
  cells,       ///< coarse grains in cells of fines
  stand_in,    ///< fines replaced by fewer, larger grains of the same volume
  mean_field,  ///< no bodies: the equation of state at the mean density
  coarse,      ///< coarse grains alone
  shells       ///< fines as soft particles between the coarse grains
};

template <>
inline constexpr auto words<ModelKind> = word_list<ModelKind>({{ModelKind::cells, "cells"},
                                                               {ModelKind::stand_in, "stand-in"},
                                                               {ModelKind::mean_field, "mean-field"},
                                                               {ModelKind::coarse, "coarse"},
                                                               {ModelKind::shells, "shells"}});

/// Where the coarse grains of a model are.
enum class ModelPlaces { truth, own };

template <>
inline constexpr auto words<ModelPlaces> = word_list<ModelPlaces>({{ModelPlaces::truth, "truth"},
                                                                   {ModelPlaces::own, "own"}});

/// What its start follows from.
enum class ModelStart { pressure, density };

template <>
inline constexpr auto words<ModelStart> = word_list<ModelStart>({{ModelStart::pressure, "pressure"},
                                                                 {ModelStart::density, "density"}});

/// One [[model]].
struct MaterialModel {
  std::string name;
  ModelKind kind = ModelKind::cells;
  std::vector<std::string> variants{};  ///< that it is for; empty: all
  double split = 1.0 / 3.0;             ///< radius over the largest below which grains are fines
  ModelPlaces places = ModelPlaces::truth;
  ModelStart start = ModelStart::pressure;
  std::optional<CellCard> card{};         ///< of cells, mean fields and stand-ins (for the equation of state)
  double soft_share = 0.0;                ///< of cells in own places: soft bodies, of the volume of all bodies
  double smallest = 0.2;                  ///< of stand-ins: smallest radius over the largest of the material
  bool mapped = false;                    ///< of stand-ins: stresses mapped by the equation of state
  std::optional<LawSources> law{};        ///< of shells
  std::array<double, 2> radii{0.2, 0.6};  ///< of shells and soft bodies: over the largest grain
  double scale = 1.0;                     ///< of shells: of their radii once they are placed
};

struct MaterialModelsScene {
  MaterialScene material;
  std::vector<MaterialModel> models;
  std::vector<std::string> blind;  ///< variants apart from the rest
  std::vector<std::string> files;  ///< of laws
  std::string text;                ///< of these
};

/// By its own name, or that of the packings which its loadings share.
bool is_named(const MaterialVariant& v, const std::string& name);

/// Throws BadInput, FileTrouble.
MaterialModelsScene read_material_models_scene(const Scene& scene);

/// Runs materials and models; writes models.csv, models_NAME.h5 and what kind material does.
SceneKind material_models_kind();

}  // namespace softgrain

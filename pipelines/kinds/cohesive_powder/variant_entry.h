// What one variant of a powder came to, in short.
#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "pipelines/kinds/cohesive_powder/variants.h"

namespace softgrain {

/// A number of a sample, and where it stands in the summary of the variant.
struct PowderQuantity {
  const char* name;
  const char* path;
};

inline constexpr std::array kPowderQuantities{PowderQuantity{"Phi", "/Phi"},
                                              PowderQuantity{"z", "/z"},
                                              PowderQuantity{"z_star", "/z_star"},
                                              PowderQuantity{"x_0", "/shares/0"},
                                              PowderQuantity{"x_1", "/shares/1"},
                                              PowderQuantity{"x_2", "/shares/2"},
                                              PowderQuantity{"x_3", "/shares/3"},
                                              PowderQuantity{"x_4", "/shares/4"},
                                              PowderQuantity{"x_5", "/shares/5"},
                                              PowderQuantity{"x_6", "/shares/6"},
                                              PowderQuantity{"mean_normal", "/mean_normal"},
                                              PowderQuantity{"mean_repulsive", "/mean_repulsive"},
                                              PowderQuantity{"mean_tensile", "/mean_tensile"},
                                              PowderQuantity{"quadratic_mean_normal", "/quadratic_mean_normal"},
                                              PowderQuantity{"repulsive", "/repulsive"},
                                              PowderQuantity{"tensile", "/tensile"},
                                              PowderQuantity{"unstressed", "/unstressed"},
                                              PowderQuantity{"distant", "/distant"},
                                              PowderQuantity{"rattlers", "/rattlers"},
                                              PowderQuantity{"zero_share", "/zero_share"},
                                              PowderQuantity{"rumpf_ratio", "/rumpf_ratio"},
                                              PowderQuantity{"F_perc", "/F_perc/either"},
                                              PowderQuantity{"solid_fraction_3d", "/solid_fraction_3d"},
                                              PowderQuantity{"h", "/rigidity/fixed/h"},
                                              PowderQuantity{"k", "/rigidity/fixed/k"},
                                              PowderQuantity{"h_free", "/rigidity/free/h"},
                                              PowderQuantity{"k_free", "/rigidity/free/k"},
                                              PowderQuantity{"h_backbone", "/rigidity/backbone/h"},
                                              PowderQuantity{"k_backbone", "/rigidity/backbone/k"},
                                              PowderQuantity{"dF", "/scattering/dF"},
                                              PowderQuantity{"xi", "/scattering/xi"},
                                              PowderQuantity{"R_w", "/holes/mean_radius"},
                                              PowderQuantity{"loop_passes", "/loop_passes"},
                                              PowderQuantity{"seconds", "/seconds"}};

/// {"name", "title", "status", "reason", "commit", "disks", "samples", "usable_samples", "values", "published",
/// "difference"}: "values" has mean, deviation, standard error and number of samples of every quantity over the samples
/// at rest; "difference" to the published values, also in combined standard errors where both are known. `summary`: of
/// the variant; null when it was not run.
nlohmann::json powder_variant_entry(const PowderVariant& variant, const nlohmann::json& summary);

}  // namespace softgrain

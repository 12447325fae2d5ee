// Variants of materials, prepared and tested: what kinds that measure materials share.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/text.h"
#include "pipelines/kinds/macro/lammps_stage.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/kinds/material/summary.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// Laws for packings without soft particles, which never evaluate them.
NamedLaws no_soft_laws();

struct VariantResult {
  const MaterialVariant* variant = nullptr;
  std::string file;  ///< file of its curves
  std::vector<MacroCurve> curves;
  /// Packings that the curves begin with, shared by the loadings of a material; null unless they are asked for.
  std::shared_ptr<const std::vector<MacroPacking>> packings;
};

/// A variant that could not be prepared or tested: what came in its way, and what to do. Of several variants that test
/// one packing, the first stands for all when the packing could not be made.
struct VariantFailure {
  const MaterialVariant* variant = nullptr;
  std::string problem;
};

struct VariantOptions {
  std::optional<LammpsEngine> lammps{};  ///< LAMMPS, where it runs the tests
  bool packings = false;                 ///< whether packings are kept in the results
};

/// Variants that were measured, in their order, and those that were not.
struct VariantRuns {
  std::vector<VariantResult> results;
  std::vector<VariantFailure> failures;
};

/// Which packing a variant has, as progress says it: "packing 7 of 26, NAME"; of one alone its name.
std::string packing_title(const std::vector<MaterialVariant>& variants, const MaterialVariant& of);

/// Prepares and tests all samples of all variants; writes material_NAME.h5, material_initial_NAME.h5 and kept states.
/// One that fails costs no other. Throws UnusableResult where none is left.
VariantRuns run_variants(const MaterialScene& scene, const Run& run, const VariantOptions& options = {});

/// Says in the head what failed, which then is not usable.
void reject_failures(const std::vector<VariantFailure>& failures, SummaryHead& head);

/// One row per recorded point of every sample of every variant.
TextTable points_of(const std::vector<VariantResult>& results);

struct MaterialOutcome {
  MaterialSummary summary;
  std::optional<StateFit> states;  ///< the fit behind the equation of state
};

/// Variants and equation of state; curves that are not usable are said in the head.
MaterialOutcome summarise(const MaterialScene& scene, const std::vector<VariantResult>& results, const Run& run);

std::string console_summary(const MaterialSummary& summary);

/// The results that the equation of state is fitted to. Packings take part once, by the first of their tests that
/// compresses them: what they do in another is no other sample.
std::vector<const VariantResult*> first_compressed(const std::vector<VariantResult>& results);

/// The least and the largest p/E above 0 that take part in the equation of state.
std::array<double, 2> pressure_range(const std::vector<VariantResult>& results);

/// Text of all distributions that the variants ask for: kept tasks of a run hold to it.
std::string sizes_text(const MaterialScene& scene);

}  // namespace softgrain

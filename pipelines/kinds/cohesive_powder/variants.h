// Variants of a powder: one scene, several times, each with other values of some keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/text.h"
#include "common/io/scene.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

/// A number of the publication, shown beside ours.
struct PublishedValue {
  std::string quantity;  ///< one of powder_comparable()
  double value = 0.0;
  std::optional<double> error;
};

struct PowderVariant {
  Scene scene;            ///< scene of the variant, as it would stand in a file of its own
  std::string name = {};  ///< name of the variant and of its directory
  bool picked = true;     ///< whether `only` names it; without that key all are picked
  PowderSetup setup = {};
  std::vector<PublishedValue> published = {};
};

[[nodiscard]] bool has_powder_variants(const Scene& scene);

/// Reads every variant to its last key. Throws InputError.
std::vector<PowderVariant> read_powder_variants(const Scene& scene);

// What one variant of a powder came to, in short.

/// What the summary in the directory of a variant says.
struct VariantRun {
  AnySummary run;
  PowderSummary powder;
};

/// Names of the quantities of an entry, in the order of the table.
const std::vector<const char*>& powder_quantities();

/// Names of the quantities that may be published: all but the cost of a run.
std::vector<const char*> powder_comparable();

/// "values" has mean, deviation, standard error and number of samples of every quantity over the samples at rest;
/// "difference" to the published values, also in combined standard errors where both are known. `ended`: null when the
/// variant was not run.
VariantEntry powder_variant_entry(const PowderVariant& variant, const VariantRun* ended);

// The entries of all variants of a powder as tables.

/// Every quantity with deviation and standard error, and what is published, in full precision; empty where unknown.
TextTable powder_data_table(const std::vector<VariantEntry>& entries);

/// Table of all variants for people, with fewer columns and digits than powder_data_table().
TextTable powder_console_table(const std::vector<VariantEntry>& entries);

/// "rr-mu015: Phi 0.7105 +- 0.0011 (published 0.71 +- 0.002), z ...; 4 of 4 samples at rest", and why not.
std::string powder_variant_line(const VariantEntry& entry);

// A powder in variants: one after another, and the table of them.

/// Runs each variant in DIR/NAME like a scene of its own; writes table.csv, table.md and summary.json. Variants that
/// have ended before are not run again with --resume. Status not_usable when one of them has a sample not at rest.
ExitStatus run_powder_variants(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain

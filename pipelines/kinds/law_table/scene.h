// Scene kind "law-table": what is measured with which neighbours, and how it is fitted.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/law_table/law_prior.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// The main measurement repeated on looser or denser packings.
struct LawTableVariant {
  SoftParticleSpec spec;
  std::optional<std::int64_t> packings;  ///< packings of every configuration; empty: as in the main measurement
};

/// What is measured for it: all that the main one measures, or, on packings of its own number, what the fit takes.
MultiContactSetup setup_of(const LawTableVariant& variant, const MultiContactSetup& main);

struct LawTableSetup {
  std::string title;
  MultiContactSetup multi_contact;
  std::vector<LawTableVariant> variants;
  MultiContactFitOptions fit;
  std::optional<LawLibrary> prior{};  ///< what the packings correct
};

/// Reads a scene of kind "law-table" to the last key. Throws InputError.
LawTableSetup read_law_table(const Scene& scene);

/// Measures and fits; writes multi_contact.h5, law_table.toml, law_table.h5, summary.json and the report. Status
/// not_usable when a recorded point did not converge or the best law is not good.
SceneKind law_table_kind();

/// Counts, overlaps, memory, time, and what the table will lack. Throws InputError.
void check_law_table(const LawTableSetup& setup, Findings& out);

/// What a card or a table holds, and what to mind when it is used. Throws InputError, IoError.
void check_laws(const std::string& path, Findings& out);

// What multi-contact measurements leave behind, and the tables fitted to them.

KindResults law_table_results();

namespace report {
std::string law_table_section(const RunData& run);  ///< several neighbours at once: measured and fitted
}

}  // namespace softgrain

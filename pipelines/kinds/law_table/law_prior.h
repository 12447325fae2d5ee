// [prior] of scenes that measure a law table: a library of law tables, which own packings correct.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "pipelines/law/law_library.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Reads [prior]; empty: the scene has none. `calibrate`: the table of `fit`, which must suit. Throws InputError.
std::optional<LawLibrary> read_law_prior(const SceneTable& root, const SceneTable& calibrate,
                                         const MultiContactFitOptions& fit);

/// Says how near the library is to a packing of this solid fraction, and warns where it does not reach it.
void check_law_prior(const std::optional<LawLibrary>& prior, const SoftParticleSpec& spec, double solid_fraction,
                     Findings& out);

/// The measurements behind the entry of a table.
struct EntryMeasurements {
  double solid_fraction = 0.0;
  MultiContactMeasurements data;
};

/// Replaces the isotropic law of every entry by that of own packings and the library together (corrected()), which
/// becomes the best one. Where the library does not reach one of them, all entries stay as they were fitted, since a
/// table is interpolated between entries of the same neighbours; a warning says so, and others what contradicts. No
/// library: nothing.
void combine_with_prior(MultiContactLawFit& fit, const std::optional<LawLibrary>& prior,
                        const std::vector<EntryMeasurements>& measured, const MultiContactFitOptions& options);

}  // namespace softgrain

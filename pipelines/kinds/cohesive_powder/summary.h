// What powders came to: summary.json of their runs, which the report and the tables of variants read back.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/consolidation_fit.h"
#include "common/data/fields.h"
#include "common/io/hdf5_file.h"
#include "microsim/powder/powder_analysis.h"
#include "microsim/powder/powder_assembly.h"
#include "pipelines/kinds/cohesive_powder/structure.h"
#include "pipelines/results/summary.h"

namespace softgrain {

void fields(auto&& visit, Of<SparseRank> auto& s) {
  visit("rank", s.rank);
  visit("smallest_kept", s.smallest_kept);
  visit("largest_dropped", s.largest_dropped);
}

void fields(auto&& visit, Of<Rigidity> auto& s) {
  visit("freedoms", s.freedoms);
  visit("constraints", s.constraints);
  visit("h", s.indeterminacy);
  visit("k", s.floppy);
  visit("identity_holds", s.identity_holds());
  visit("of_matrix", s.of_matrix);
  visit("of_transpose", s.of_transpose);
  visit("positive_definite", s.stiffness.positive);
  visit("smallest_pivot", s.stiffness.smallest_pivot);
}

void fields(auto&& visit, Of<PowderRigidity> auto& s) {
  visit("fixed", s.fixed);
  visit("free", s.free);
  visit("backbone", s.backbone);
  visit("backbone_free", s.backbone_free);
}

void fields(auto&& visit, Of<PowderPercolation> auto& s) {
  visit("x", s.x);
  visit("y", s.y);
  visit("either", s.either);
  visit("both", s.both);
}

void fields(auto&& visit, Of<PowderModuli> auto& s) {
  visit("bulk", s.bulk);
  visit("shear", s.shear);
  visit("shear_axes", s.shear_axes);
  visit("shear_cross", s.shear_cross);
  visit("distant", s.distant);
}

/// Forces, percolation and rigidity, without pairs, histograms and contacts.
void fields(auto&& visit, Of<PowderAnalysis> auto& s) {
  visit("zero_force", s.zero);
  visit("zero_share", s.forces.zero_share);
  visit("F_perc", s.percolation);
  visit("rumpf_ratio", s.rumpf_ratio);
  visit("moduli", s.moduli);
  visit("solid_fraction_3d", s.solid_fraction_3d);
  visit("rigidity", s.rigidity);
}

void fields(auto&& visit, Of<PowderContacts> auto& s) {
  visit("z", s.coordination);
  visit("z_star", s.coordination_backbone);
  visit("shares", s.shares);
  visit("contacts", s.contacts);
  visit("distant", s.distant);
  visit("rattlers", s.rattlers);
  visit("repulsive", s.repulsive);
  visit("tensile", s.tensile);
  visit("unstressed", s.unstressed);
  visit("mean_normal", s.mean_normal);
  visit("mean_repulsive", s.mean_repulsive);
  visit("mean_tensile", s.mean_tensile);
  visit("quadratic_mean_normal", s.square_mean_normal);
  visit("rumpf_pressure", s.rumpf_pressure);
  visit("branch_pressure", s.branch_pressure);
}

/// A radius is NaN when a hole percolates.
void fields(auto&& visit, Of<PowderHoles> auto& s) {
  visit("count", s.count);
  visit("fragments", s.fragments);
  visit("mean_radius", s.mean_radius);
  visit("largest_radius", s.largest_radius);
  visit("largest_share", s.largest_share);
  visit("void_fraction", s.void_fraction);
  visit("percolating", s.percolating);
}

/// Fit of I(k); its numbers are left out where there was no fit.
void fields(auto&& visit, Of<ScatteringFit> auto& s) {
  constexpr bool kWrites = std::is_const_v<std::remove_reference_t<decltype(s)>>;
  visit("usable", s.usable);
  visit("reason", s.reason);
  visit("bins", s.bins);
  if (kWrites && s.covariance.empty()) return;
  visit("chi2_per_degree", s.chi2_per_degree);
  range_field(visit, "k_range", s.k_low, s.k_high);
  const auto estimate = [&](const std::string& name, auto& e) {
    visit(name, e.value);
    visit(name + "_error", e.error);
    range_field(visit, name + "_interval", e.low, e.high);
  };
  estimate("dF", s.dimension);
  estimate("xi", s.length);
  estimate("amplitude", s.amplitude);
  estimate("c", s.background);
  estimate("l", s.lower_length);
  visit("bounded", s.bounded, kLeftOut);
  visit("tie_cost", s.tie_cost);
}

/// One sample. What is not defined is NaN, or absent.
struct PackSummary {
  bool usable = false;
  std::string reason;  ///< why not
  double time = 0.0;
  std::int64_t steps = 0;
  std::int64_t loop_passes = 0;
  std::int64_t contact_evaluations = 0;
  double fraction = 0.0;
  std::array<double, 2> stress{};
  std::vector<PowderStage> stages;  ///< stages of a sample under several pressures
  PowderContacts contacts;
  PowderAnalysis analysis;  ///< its scalars
  std::optional<std::array<std::int64_t, 2>> mesh;
  std::optional<ScatteringFit> scattering;
  std::optional<PowderHoles> holes;
};

void fields(auto&& visit, Of<PackSummary> auto& s) {
  visit("usable", s.usable);
  visit("reason", s.reason);
  visit("time", s.time);
  visit("steps", s.steps);
  visit("loop_passes", s.loop_passes);
  visit("contact_evaluations", s.contact_evaluations);
  visit("Phi", s.fraction);
  visit("stress", s.stress);
  visit("stages", s.stages, kLeftOut);
  fields(visit, s.contacts);
  fields(visit, s.analysis);
  visit("mesh", s.mesh, kLeftOut);
  visit("scattering", s.scattering, kLeftOut);
  visit("holes", s.holes, kLeftOut);
}

/// Adds what the density field shows.
void add_structure(PackSummary& sample, const PowderStructure& structure);

/// One fit to all samples, and those with other upper ends of k.
struct EnsembleFit {
  ScatteringFit fit;
  std::vector<ScatteringFit> other_ranges;
};

void fields(auto&& visit, Of<EnsembleFit> auto& s) {
  fields(visit, s.fit);
  visit("other_ranges", s.other_ranges);
}

void fields(auto&& visit, Of<ConsolidationNumber> auto& s) {
  visit("value", s.value);
  visit("error", s.error);
}

void fields(auto&& visit, Of<ConsolidationFit> auto& s) {
  visit("usable", s.usable);
  visit("reason", s.reason);
  visit("lambda", s.slope);
  range_field(visit, "lambda_pressures", s.low, s.high);
  visit("regime_1_ends", s.begin);
  visit("alpha", s.exponent);
  visit("Phi_max", s.densest);
}

struct PowderSummary {
  SummaryHead head;
  std::vector<PackSummary> samples;
  std::vector<double> seconds;  ///< seconds of each sample
  nlohmann::json statistics;    ///< mean, deviation and number of every scalar over the samples at rest
  nlohmann::json histograms;
  nlohmann::json mean;
  std::optional<EnsembleFit> scattering;
  std::optional<ConsolidationFit> consolidation;  ///< fit over the rising pressures
};

void fields(auto&& visit, Of<PowderSummary> auto& s) {
  fields(visit, s.head);
  visit("samples", s.samples, kLeftOut);
  visit("seconds", s.seconds);
  visit("statistics", s.statistics);
  visit("histograms", s.histograms);
  visit("mean", s.mean);
  visit("scattering", s.scattering, kLeftOut);
  visit("consolidation", s.consolidation, kLeftOut);
}

/// Mean of a quantity over the samples at rest of a variant.
struct QuantityMean {
  double mean = kNaN;
  double deviation = kNaN;
  std::size_t samples = 0;
  double error = kNaN;  ///< standard error
};

void fields(auto&& visit, Of<QuantityMean> auto& s) {
  visit("mean", s.mean);
  visit("deviation", s.deviation);
  visit("samples", s.samples);
  visit("error", s.error);
}

struct PublishedNumber {
  double value = kNaN;
  double error = kNaN;
};

void fields(auto&& visit, Of<PublishedNumber> auto& s) {
  visit("value", s.value);
  visit("error", s.error);
}

/// Ours minus the published; also in combined standard errors where both are known.
struct PublishedDifference {
  double value = kNaN;
  double in_errors = kNaN;
};

void fields(auto&& visit, Of<PublishedDifference> auto& s) {
  visit("value", s.value);
  visit("in_errors", s.in_errors);
}

/// What one variant came to, in short.
struct VariantEntry {
  std::string name;
  std::string title;
  RunStatus status = RunStatus::not_run;
  std::string reason;
  std::string commit;  ///< commit of the build that ran it
  std::int64_t disks = 0;
  std::int64_t samples = 0;
  std::size_t usable_samples = 0;
  std::map<std::string, QuantityMean> values;
  std::map<std::string, PublishedNumber> published;
  std::map<std::string, PublishedDifference> difference;

  /// NaN throughout where there is none.
  [[nodiscard]] QuantityMean ours(const std::string& quantity) const { return find(values, quantity); }
  [[nodiscard]] PublishedNumber theirs(const std::string& quantity) const { return find(published, quantity); }
  [[nodiscard]] PublishedDifference off(const std::string& quantity) const { return find(difference, quantity); }

 private:
  template <class T>
  static T find(const std::map<std::string, T>& list, const std::string& quantity) {
    const auto at = list.find(quantity);
    return at == list.end() ? T{} : at->second;
  }
};

void fields(auto&& visit, Of<VariantEntry> auto& s) {
  visit("name", s.name);
  visit("title", s.title);
  visit("status", s.status);
  visit("reason", s.reason);
  visit("commit", s.commit);
  visit("disks", s.disks);
  visit("samples", s.samples);
  visit("usable_samples", s.usable_samples);
  visit("values", s.values);
  visit("published", s.published);
  visit("difference", s.difference);
}

struct PowderVariantsSummary {
  SummaryHead head;
  std::vector<VariantEntry> variants;
};

void fields(auto&& visit, Of<PowderVariantsSummary> auto& s) {
  fields(visit, s.head);
  visit("variants", s.variants);
}

// What was measured on a powder, for files and summaries, and the mean and scatter of the scalars of several samples.

/// Histograms of several samples, their counts added up.
nlohmann::json histograms_json(const std::vector<const PowderForces*>& samples);

/// Data set "pairs", one row per contact or attracting pair (its columns are named in the attribute), the group
/// "histograms" and the scalars as text.
void write_analysis(const h5::Group& group, const PowderAnalysis& analysis);

/// Statistics of every number in the objects, nested ones by their path ("rigidity.fixed.h"): {"mean", "deviation",
/// "samples"}, the deviation with n - 1. Samples where it is missing or null (undefined) do not count; without any, the
/// mean is null, with one the deviation. Flags, texts and lists are passed over.
nlohmann::json sample_statistics(const std::vector<nlohmann::json>& samples);

// Powders under several pressures: what their consolidation came to, in words and pictures.

using PowderStages = std::vector<PowderStage>;  ///< stages of one sample

/// Consolidation fit over the rising pressures, for samples that reached all pressures. Empty where fewer than two
/// pressures rise.
std::optional<ConsolidationFit> consolidation_of(const std::vector<PowderStages>& samples);

/// "lambda = 0.118(4) for P* from 0.05 to 1.6, ..."; one line.
std::string consolidation_text(const ConsolidationFit& fit);

namespace report {
/// 1/Phi, z and moduli over P*: a row of figures with the fit; empty without several pressures.
std::string consolidation_figures(const std::vector<PowderStages>& samples);
}  // namespace report

}  // namespace softgrain

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
  visit("rank", s.rank, Means{"rank of the matrix", "1"});
  visit("smallest_kept", s.smallest_kept, Means{"smallest singular value of the independent columns; 0: rank 0", "1"});
  visit("largest_dropped", s.largest_dropped, Means{"Frobenius norm of all that was taken for zero", "1"});
}

void fields(auto&& visit, Of<Rigidity> auto& s) {
  visit("freedoms", s.freedoms, Means{"number of freedoms N_f", "1"});
  visit("constraints", s.constraints, Means{"number of constraints M", "1"});
  visit("h", s.indeterminacy, Means{"degree of indeterminacy: independent self-stresses", "1"});
  visit("k", s.floppy, Means{"floppy motions, translations included", "1"});
  visit("identity_holds", s.identity_holds(), Means{"whether N_f + h = M + k"});
  visit("of_matrix", s.of_matrix, Means{"rank of the rigidity matrix"});
  visit("of_transpose", s.of_transpose, Means{"rank of its transpose"});
  visit("positive_definite", s.stiffness.positive, Means{"whether the stiffness matrix is positive definite"});
  visit("smallest_pivot", s.stiffness.smallest_pivot, Means{"smallest pivot of the stiffness matrix", "1"});
}

void fields(auto&& visit, Of<PowderRigidity> auto& s) {
  visit("fixed", s.fixed, Means{"cell held"});
  visit("free", s.free, Means{"cell free: the two strains are motions too"});
  visit("backbone", s.backbone, Means{"cell held, without rattlers; only without cohesion"});
  visit("backbone_free", s.backbone_free, Means{"cell free, without rattlers; only without cohesion"});
}

void fields(auto&& visit, Of<PowderPercolation> auto& s) {
  visit("x", s.x,
        Means{"largest threshold at which the forces above it percolate along x", "F0, without cohesion P a"});
  visit("y", s.y, Means{"the same along y", "F0, without cohesion P a"});
  visit("either", s.either, Means{"the same in one direction at least", "F0, without cohesion P a"});
  visit("both", s.both, Means{"the same of one cluster along x and along y", "F0, without cohesion P a"});
}

void fields(auto&& visit, Of<PowderModuli> auto& s) {
  visit("bulk", s.bulk, Means{"bulk modulus in the plane", "F0/a, without cohesion P"});
  visit("shear", s.shear, Means{"shear modulus, mean of the two", "F0/a, without cohesion P"});
  visit("shear_axes", s.shear_axes, Means{"shear modulus, one axis in, the other out", "F0/a, without cohesion P"});
  visit("shear_cross", s.shear_cross, Means{"shear modulus along the axes", "F0/a, without cohesion P"});
  visit("distant", s.distant, Means{"whether distant pairs are included"});
}

/// Forces, percolation and rigidity, without pairs, histograms and contacts.
void fields(auto&& visit, Of<PowderAnalysis> auto& s) {
  visit("zero_force", s.zero, Means{"forces below it count as unstressed", "F0, without cohesion P a"});
  visit("zero_share", s.forces.zero_share, Means{"share of interactions below it", "1"});
  visit("F_perc", s.percolation, Means{"largest forces whose network percolates"});
  visit("rumpf_ratio", s.rumpf_ratio, Means{"Rumpf's pressure over the imposed one", "1"});
  visit("moduli", s.moduli, Means{"elastic moduli"});
  visit("solid_fraction_3d", s.solid_fraction_3d, Means{"solid fraction of spheres that look the same", "1"});
  visit("rigidity", s.rigidity, Means{"rigidity of the contact network"});
}

void fields(auto&& visit, Of<PowderContacts> auto& s) {
  visit("z", s.coordination, Means{"coordination number, distant pairs included", "1"});
  visit("z_star", s.coordination_backbone, Means{"coordination number without disks that bear nothing", "1"});
  visit("shares", s.shares, Means{"share of disks with 0, 1, 2, ... interactions", "1"});
  visit("contacts", s.contacts, Means{"number of contacts", "1"});
  visit("distant", s.distant, Means{"number of pairs that attract across a gap", "1"});
  visit("rattlers", s.rattlers, Means{"number of rattlers; 0 with cohesion", "1"});
  visit("repulsive", s.repulsive, Means{"number of contacts that push", "1"});
  visit("tensile", s.tensile, Means{"number of contacts that pull", "1"});
  visit("unstressed", s.unstressed, Means{"number of contacts without force", "1"});
  visit("mean_normal", s.mean_normal, Means{"mean normal force over all interactions", "F0, without cohesion P a"});
  visit("mean_repulsive", s.mean_repulsive, Means{"mean of the forces that push", "F0, without cohesion P a"});
  visit("mean_tensile", s.mean_tensile, Means{"mean of the forces that pull, negative", "F0, without cohesion P a"});
  visit("quadratic_mean_normal", s.square_mean_normal,
        Means{"root mean square of the normal force", "F0, without cohesion P a"});
  visit("rumpf_pressure", s.rumpf_pressure, Means{"Rumpf's pressure, of means", "F0/a, without cohesion P"});
  visit("branch_pressure", s.branch_pressure,
        Means{"pressure from the forces times their branches", "F0/a, without cohesion P"});
}

/// A radius is NaN when a hole percolates.
void fields(auto&& visit, Of<PowderHoles> auto& s) {
  visit("count", s.count, Means{"holes of at least the asked area", "1"});
  visit("fragments", s.fragments, Means{"smaller holes", "1"});
  visit("mean_radius", s.mean_radius,
        Means{"mean radius of the holes, weighted by area; null when a hole percolates", "a"});
  visit("largest_radius", s.largest_radius, Means{"radius of the largest hole; null when a hole percolates", "a"});
  visit("largest_share", s.largest_share, Means{"share of the void in the hole of the largest area", "1"});
  visit("void_fraction", s.void_fraction, Means{"area of all holes over that of the cell", "1"});
  visit("percolating", s.percolating, Means{"holes that percolate", "1"});
}

/// Fit of I(k); its numbers are left out where there was no fit.
void fields(auto&& visit, Of<ScatteringFit> auto& s) {
  constexpr bool kWrites = std::is_const_v<std::remove_reference_t<decltype(s)>>;
  visit("usable", s.usable, Means{"whether the fit of I(k) is usable"});
  visit("reason", s.reason, Means{"why not"});
  visit("bins", s.bins, Means{"number of fitted bins", "1"});
  if (kWrites && s.covariance.empty() && !Describes<decltype(visit)>) return;
  visit("chi2_per_degree", s.chi2_per_degree, Means{"chi^2 per degree of freedom", "1"});
  range_field(visit, "k_range", s.k_low, s.k_high, Means{"range of k that was fitted", "1/a"});
  const auto estimate = [&](const std::string& name, auto& e, const Means& means) {
    visit(name, e.value, means);
    visit(name + "_error", e.error, Means{"its standard error", means.unit});
    range_field(visit, name + "_interval", e.low, e.high, Means{"its 95 % interval", means.unit});
  };
  estimate("dF", s.dimension, {"fractal dimension", "1"});
  estimate("xi", s.length, {"correlation length", "a"});
  estimate("amplitude", s.amplitude, {"amplitude of I(k)", "a^2"});
  estimate("c", s.background, {"background of I(k)", "a^2"});
  estimate("l", s.lower_length, {"length at which the fractal range begins", "a"});
  visit("bounded", s.bounded, kLeftOut, Means{"numbers that ended at a bound"});
  visit("tie_cost", s.tie_cost,
        Means{"above 0: the amplitude is free, as tying it to Phi would cost so much chi^2", "1"});
}

/// One sample. What is not defined is NaN, or absent.
struct PackSummary {
  bool usable = false;
  std::string reason;
  double time = 0.0;
  std::int64_t steps = 0;
  std::int64_t loop_passes = 0;
  std::int64_t contact_evaluations = 0;
  double fraction = 0.0;
  std::array<double, 2> stress{};
  std::vector<PowderStage> stages;
  PowderContacts contacts;
  PowderAnalysis analysis;  ///< its scalars
  std::optional<std::array<std::int64_t, 2>> mesh;
  std::optional<ScatteringFit> scattering;
  std::optional<PowderHoles> holes;
};

void fields(auto&& visit, Of<PackSummary> auto& s) {
  visit("usable", s.usable, Means{"whether the sample is usable"});
  visit("reason", s.reason, Means{"why not"});
  visit("time", s.time, Means{"time reached", "T0"});
  visit("steps", s.steps, Means{"number of time steps", "1"});
  visit("loop_passes", s.loop_passes, Means{"passes over all contacts", "1"});
  visit("contact_evaluations", s.contact_evaluations, Means{"evaluations of contact laws", "1"});
  visit("Phi", s.fraction, Means{"solid fraction", "1"});
  visit("stress", s.stress, Means{"stress along x and y", "F0/a, without cohesion P"});
  visit("stages", s.stages, kLeftOut, Means{"states under each pressure"});
  fields(visit, s.contacts);
  fields(visit, s.analysis);
  visit("mesh", s.mesh, kLeftOut, Means{"cells of the density field along x and y", "1"});
  visit("scattering", s.scattering, kLeftOut, Means{"fit of the scattered intensity I(k)"});
  visit("holes", s.holes, kLeftOut, Means{"holes of the density field"});
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
  visit("other_ranges", s.other_ranges, Means{"the same with other upper ends of k"});
}

void fields(auto&& visit, Of<ConsolidationNumber> auto& s) {
  visit("value", s.value, Means{"value", "1"});
  visit("error", s.error, Means{"standard error", "1"});
}

void fields(auto&& visit, Of<ConsolidationFit> auto& s) {
  visit("usable", s.usable, Means{"whether the fit is usable"});
  visit("reason", s.reason, Means{"why not"});
  visit("lambda", s.slope, Means{"fall of 1/Phi per unit of ln P*"});
  range_field(visit, "lambda_pressures", s.low, s.high, Means{"pressures P* between which it was fitted", "1"});
  visit("regime_1_ends", s.begin, Means{"P* at which that line meets the solid fraction of the lowest pressure", "1"});
  visit("alpha", s.exponent, Means{"exponent of the approach to Phi_max: Phi_max - Phi ~ P*^-alpha"});
  visit("Phi_max", s.densest, Means{"solid fraction of the densest state"});
}

struct PowderSummary {
  SummaryHead head;
  std::vector<PackSummary> samples;
  std::vector<double> seconds;
  nlohmann::json statistics;
  nlohmann::json histograms;
  nlohmann::json mean;
  std::optional<EnsembleFit> scattering;
  std::optional<ConsolidationFit> consolidation;
};

void fields(auto&& visit, Of<PowderSummary> auto& s) {
  fields(visit, s.head);
  visit("samples", s.samples, kLeftOut, Means{"the samples"});
  visit("seconds", s.seconds, Means{"duration of each sample", "s"});
  visit("statistics", s.statistics, Means{"mean, deviation and number of every scalar over the samples at rest"});
  visit("histograms", s.histograms, Means{"histograms of forces, counts of all samples"});
  visit("mean", s.mean, Means{"means over the samples"});
  visit("scattering", s.scattering, kLeftOut, Means{"fit of I(k) of all samples"});
  visit("consolidation", s.consolidation, kLeftOut, Means{"fit over the rising pressures"});
}

/// Mean of a quantity over the samples at rest of a variant.
struct QuantityMean {
  double mean = kNaN;
  double deviation = kNaN;
  std::size_t samples = 0;
  double error = kNaN;
};

void fields(auto&& visit, Of<QuantityMean> auto& s) {
  visit("mean", s.mean, Means{"mean over the samples at rest", "as the quantity"});
  visit("deviation", s.deviation, Means{"standard deviation", "as the quantity"});
  visit("samples", s.samples, Means{"number of samples", "1"});
  visit("error", s.error, Means{"standard error of the mean", "as the quantity"});
}

struct PublishedNumber {
  double value = kNaN;
  double error = kNaN;
};

void fields(auto&& visit, Of<PublishedNumber> auto& s) {
  visit("value", s.value, Means{"published value", "as the quantity"});
  visit("error", s.error, Means{"its standard error", "as the quantity"});
}

/// Ours minus the published; also in combined standard errors where both are known.
struct PublishedDifference {
  double value = kNaN;
  double in_errors = kNaN;
};

void fields(auto&& visit, Of<PublishedDifference> auto& s) {
  visit("value", s.value, Means{"ours minus the published", "as the quantity"});
  visit("in_errors", s.in_errors, Means{"the same over the combined standard error", "1"});
}

/// What one variant came to, in short.
struct VariantEntry {
  std::string name;
  std::string title;
  RunStatus status = RunStatus::not_run;
  std::string reason;
  std::string commit;
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
  visit("name", s.name, Means{"name of the variant"});
  visit("title", s.title, Means{"its title"});
  visit("status", s.status, Means{"good, not usable, not run or written"});
  visit("reason", s.reason, Means{"why it is not usable"});
  visit("commit", s.commit, Means{"commit of the build that ran it"});
  visit("disks", s.disks, Means{"number of disks", "1"});
  visit("samples", s.samples, Means{"number of samples", "1"});
  visit("usable_samples", s.usable_samples, Means{"number of usable samples", "1"});
  visit("values", s.values, Means{"means of its quantities"});
  visit("published", s.published, Means{"published values"});
  visit("difference", s.difference, Means{"ours minus the published"});
}

struct PowderVariantsSummary {
  SummaryHead head;
  std::vector<VariantEntry> variants;
};

void fields(auto&& visit, Of<PowderVariantsSummary> auto& s) {
  fields(visit, s.head);
  visit("variants", s.variants, Means{"the variants"});
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

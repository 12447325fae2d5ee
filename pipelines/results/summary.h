// Pieces of summary.json that several commands write, and the remarks that go with them.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/data/fields.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/io/json_record.h"
#include "common/io/provenance.h"
#include "macrosim/macro_spec.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

/// What a summary says of its run.
enum class RunStatus { good, not_usable, not_run, written };

template <>
inline constexpr auto enum_names<RunStatus> = enum_name_list<RunStatus>({{RunStatus::good, "good"},
                                                                         {RunStatus::not_usable, "not usable"},
                                                                         {RunStatus::not_run, "not run"},
                                                                         {RunStatus::written, "written"}});

/// Grains of one kind whose sizes a distribution said: what was asked, and what came out in the mean of samples.
struct SizesSummary {
  std::string of;     ///< "solid grains"
  std::string form;   ///< form of the distribution
  int dimension = 3;  ///< 2: of disks, whose shares are of the area
  std::int64_t samples = 0;
  double grains = 0.0;              ///< mean number of grains
  double largest_difference = 0.0;  ///< largest difference of the volume share that passes, over all samples and sizes
  double largest_grain = 0.0;       ///< volume share of the largest grain: half of it bounds the difference from below
  std::string unit;                 ///< unit of the diameters
  std::vector<double> diameter;
  std::vector<double> asked;  ///< share of the volume that passes there, as asked for
  std::vector<double> obtained;
};

void fields(auto&& visit, Of<SizesSummary> auto& s) {
  visit("of", s.of);
  visit("form", s.form);
  visit("dimension", s.dimension);
  visit("samples", s.samples);
  visit("grains", s.grains);
  visit("largest_difference", s.largest_difference);
  visit("largest_grain", s.largest_grain);
  visit("unit", s.unit);
  visit("diameter", s.diameter);
  visit("asked", s.asked);
  visit("obtained", s.obtained);
}

/// What shares of sizes are of, for people: "volume", of disks "area".
inline const char* share_of(int dimension) { return dimension == 2 ? "area" : "volume"; }

/// What the summary of every kind begins with.
struct SummaryHead {
  RunStatus status = RunStatus::good;
  std::string title;
  std::vector<std::string> remarks;          ///< notes: what else is to be known; of a run that is not usable, why
  std::map<std::string, std::string> files;  ///< files that were written
  std::vector<SizesSummary> sizes{};
  /// What may make the result wrong for its purpose, with what to do about it; the most important first.
  std::vector<std::string> warnings{};

  /// Not usable, and why: before all other remarks, as the first is taken for the reason (warnings_of).
  void mark_unusable(const std::string& remark) {
    remarks.insert(status == RunStatus::not_usable ? remarks.end() : remarks.begin(), remark);
    status = RunStatus::not_usable;
  }
};

void fields(auto&& visit, Of<SummaryHead> auto& s) {
  visit("status", s.status);
  visit("title", s.title);
  visit("warnings", s.warnings);
  visit("remarks", s.remarks);
  visit("files", s.files, kLeftOut);
  visit("sizes", s.sizes, kLeftOut);
}

/// The program that moved the bodies, when it was another.
struct EngineUse {
  MacroEngine name = MacroEngine::softgrain;
  std::int64_t ranks = 0;
  std::string program;
  std::string release;  ///< "29 Sep 2021"
};

void fields(auto&& visit, Of<EngineUse> auto& s) {
  visit("name", s.name);
  visit("ranks", s.ranks);
  visit("program", s.program);
  visit("lammps", s.release);
}

/// What any summary says of its run, whatever the kind and whoever wrote it.
struct AnySummary {
  std::string status;  ///< empty: no summary
  std::string title;
  std::string kind;  ///< of the scene; empty: none was run, or the summary is of a version that did not write it
  std::string command;
  std::string version;
  std::string commit;
  std::vector<std::string> warnings;
  std::optional<std::vector<std::string>> remarks;
  std::map<std::string, std::string> files;
  std::optional<double> seconds;
  std::optional<Provenance> provenance;
  std::optional<EngineUse> engine;
  std::vector<SizesSummary> sizes;
};

void fields(auto&& visit, Of<AnySummary> auto& s) {
  visit("status", s.status);
  visit("title", s.title);
  visit("kind", s.kind);
  visit("command", s.command);
  visit("version", s.version);
  visit("commit", s.commit);
  visit("warnings", s.warnings);
  visit("remarks", s.remarks);
  visit("files", s.files);
  visit("seconds", s.seconds);
  visit("provenance", s.provenance);
  visit("engine", s.engine);
  visit("sizes", s.sizes);
}

/// Warnings, most important first. Where the result is not usable its remarks come before them: the first says why.
std::vector<std::string> warnings_of(const AnySummary& summary);
/// All other remarks.
std::vector<std::string> notes_of(const AnySummary& summary);

/// Whether a status in words says that the result is to be used.
inline bool is_good(const std::string& status) { return parse_enum<RunStatus>(status) == RunStatus::good; }

/// Means over the packings that were measured, with standard deviations.
struct PackingsSummary {
  std::size_t count = 0;
  double solid_fraction = 0.0;
  double solid_fraction_deviation = 0.0;
  double exponent = 0.0;  ///< power-law exponent of the radii, by maximum likelihood
  double exponent_deviation = 0.0;
  double contacts_per_grain = 0.0;
  double grains = 0.0;
  double grains_deviation = 0.0;
  std::optional<std::size_t> broke_off;  ///< number of packings whose measurement did not come to its end
  std::optional<double> seconds;         ///< time that making them took [s]
};

void fields(auto&& visit, Of<PackingsSummary> auto& s) {
  visit("count", s.count);
  visit("solid_fraction", s.solid_fraction);
  visit("solid_fraction_deviation", s.solid_fraction_deviation);
  visit("exponent", s.exponent);
  visit("exponent_deviation", s.exponent_deviation);
  visit("contacts_per_grain", s.contacts_per_grain);
  visit("grains", s.grains);
  visit("grains_deviation", s.grains_deviation);
  visit("broke_off", s.broke_off, kLeftOut);
  visit("seconds", s.seconds, kLeftOut);
}

PackingsSummary summary_of(const std::vector<PackingInfo>& packings);

/// What one relaxation took, in all and per point.
struct MeasurementSummary {
  std::string relaxation;
  std::int64_t points = 0;
  Cost cost;
  double loop_passes_per_point = 0.0;
  double seconds_per_point = 0.0;
  std::optional<double> wall_seconds;
};

void fields(auto&& visit, Of<MeasurementSummary> auto& s) {
  visit("relaxation", s.relaxation);
  visit("points", s.points);
  fields(visit, s.cost);
  visit("loop_passes_per_point", s.loop_passes_per_point);
  visit("seconds_per_point", s.seconds_per_point);
  visit("wall_seconds", s.wall_seconds, kLeftOut);
}

/// Force at one overlap, over packings whose point converged [N].
struct ForceSummary {
  double delta = 0.0;
  double force = 0.0;
  double standard_error = 0.0;
  double deviation = 0.0;
  std::size_t packings = 0;
};

void fields(auto&& visit, Of<ForceSummary> auto& s) {
  visit("delta", s.delta);
  visit("force", s.force);
  visit("standard_error", s.standard_error);
  visit("deviation", s.deviation);
  visit("packings", s.packings);
}

/// What was measured on soft particles. The first relaxation gives the law; a second one checks it.
struct MeasuredSummary {
  PackingsSummary packings;
  MeasurementSummary measurement;
  std::map<std::string, std::vector<ForceSummary>> forces;  ///< forces of each kind of contact
  std::optional<MeasurementSummary> reference_measurement;
  nlohmann::json relaxations;  ///< {reference, candidate, kind of contact: {normal, kt_initial, ...}}: means and ratios
};

void fields(auto&& visit, Of<MeasuredSummary> auto& s) {
  visit("packings", s.packings);
  visit("measurement", s.measurement);
  visit("forces", s.forces);
  visit("reference_measurement", s.reference_measurement, kLeftOut);
  visit("relaxations", s.relaxations, kLeftOut);
}

MeasuredSummary summary_of(const Measurements& data, const std::vector<std::string>& relaxations);

void fields(auto&& visit, Of<LawIdentity> auto& law) {
  double fraction = law.solid_fraction > 0.0 ? law.solid_fraction : kNaN;  // of a card: none
  visit("form", law.form);
  law_fields([&](const char*, const char* key, auto& member, const auto&...) { visit(key, member); }, law, fraction);
  std::string picture = picture_of(law);
  visit("picture", picture, kLeftOut);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(law)>>)
    law.solid_fraction = fraction > 0.0 ? fraction : 0.0;
}

/// Slopes of a stage whose mean is not told apart from 0 by its samples (95 %).
inline std::vector<std::string> not_determined(const StageMeans& s) {
  std::vector<std::string> out;
  const auto add = [&](const char* name, const std::optional<MeanError>& m) {
    if (m && !is_told_from_zero(m->n, m->mean, m->error)) out.emplace_back(name);
  };
  add("modulus_begin", s.modulus_begin);
  add("modulus_end", s.modulus_end);
  add("poisson_begin", s.poisson_begin);
  return out;
}

/// Fields of a stage: means over samples with their errors; moduli and stresses in Pa.
void fields(auto&& visit, Of<StageMeans> auto& s) {
  visit("name", s.record.name);
  visit("kind", s.record.kind);
  visit("way", s.record.way);
  if constexpr (std::is_const_v<std::remove_reference_t<decltype(s)>>) visit("modulus", modulus_of(s.record.way));
  stage_numbers([&](const char* name, auto mean, auto) { visit(name, s.*mean, kLeftOut); });
  if constexpr (std::is_const_v<std::remove_reference_t<decltype(s)>>)
    visit("not_determined", not_determined(s), kLeftOut);
}

/// A sample that was prepared to a density.
struct DensitySample {
  std::int64_t sample = 0;
  double solid_fraction = 0.0;
  double difference = 0.0;  ///< from the target
  double friction = 0.0;    ///< friction while packed that was found
  std::int64_t tries = 0;   ///< preparations of the search
};

void fields(auto&& visit, Of<DensitySample> auto& s) {
  visit("sample", s.sample);
  visit("solid_fraction", s.solid_fraction);
  visit("difference", s.difference);
  visit("compaction_mu", s.friction);
  visit("tries", s.tries);
}

/// Samples that were prepared to a target density.
struct DensitySummary {
  double target = 0.0;     ///< solid fraction
  double tolerance = 0.0;  ///< largest difference that was allowed
  std::vector<DensitySample> samples;
};

void fields(auto&& visit, Of<DensitySummary> auto& s) {
  visit("solid_fraction", s.target);
  visit("solid_fraction_tolerance", s.tolerance);
  visit("samples", s.samples);
}

/// Of the samples of an engine; empty where none had a target.
std::optional<DensitySummary> density_of(const std::vector<MacroCurve>& curves, const std::string& engine);

/// "target solid fraction 0.62 +- 0.001: 0.6197 to 0.6204 of 3 samples, with compaction_mu from 0.089 to 0.11, found in
/// 4 to 9 preparations of each".
std::string density_text(const DensitySummary& density);

/// Summary of one engine: the largest number of bodies and grains, costs summed over its samples.
struct EngineSummary {
  std::int64_t samples = 0;
  std::int64_t bodies = 0;
  std::int64_t grains_inside = 0;
  double soft_volume_share = 0.0;  ///< mean share of soft particles in the volume
  Cost cost;
  std::optional<Cost> preparation;          ///< cost of the states that samples start from, which engines share
  std::optional<DensitySummary> density{};  ///< how these states came to a target density
  bool usable = false;
  std::optional<LawIdentity> law;
  std::vector<StageMeans> stages;
};

void fields(auto&& visit, Of<EngineSummary> auto& s) {
  visit("samples", s.samples);
  visit("bodies", s.bodies);
  visit("grains_inside", s.grains_inside);
  visit("soft_volume_share", s.soft_volume_share);
  fields(visit, s.cost);
  visit("preparation", s.preparation, kLeftOut);
  visit("target_density", s.density, kLeftOut);
  visit("usable", s.usable);
  visit("law", s.law, kLeftOut);
  visit("stages", s.stages, kLeftOut);
}

EngineSummary summary_of(const std::vector<MacroCurve>& curves, const std::string& engine);

/// One sample of a law run against its twin.
struct SampleDifference {
  std::int64_t sample = 0;
  double strain_high = 0.0;
  double stress_error = 0.0;
  double end_ratio = 0.0;
};

void fields(auto&& visit, Of<SampleDifference> auto& s) {
  visit("sample", s.sample);
  visit("strain_high", s.strain_high);
  visit("stress_error", s.stress_error);
  visit("end_ratio", s.end_ratio);
}

/// Law runs against the shelled twin, see Comparison.
struct ComparisonSummary {
  /// Relative L2 difference of the axial stress, mean over samples; in tests in stages of those that do not impose it.
  double stress_error = kNaN;
  double stress_error_standard_error = kNaN;
  double lateral_stress_error = kNaN;
  std::optional<double> strain_error;  ///< tests in stages: difference of the strains of axes that go by stress
  std::optional<double> deviator_error{};
  std::optional<double> unloading_modulus_ratio{};  ///< law over twin
  double end_stress_ratio = kNaN;
  double lateral_stress_ratio_law = kNaN;
  double lateral_stress_ratio_resolved = kNaN;
  double speedup_seconds = kNaN;
  double speedup_contact_evaluations = kNaN;
  std::vector<SampleDifference> samples;
  std::vector<std::string> left_out;
};

void fields(auto&& visit, Of<ComparisonSummary> auto& s) {
  visit("stress_error", s.stress_error);
  visit("stress_error_standard_error", s.stress_error_standard_error);
  visit("lateral_stress_error", s.lateral_stress_error);
  visit("strain_error", s.strain_error, kLeftOut);
  visit("deviator_error", s.deviator_error, kLeftOut);
  visit("unloading_modulus_ratio", s.unloading_modulus_ratio, kLeftOut);
  visit("end_stress_ratio", s.end_stress_ratio);
  visit("lateral_stress_ratio_law", s.lateral_stress_ratio_law);
  visit("lateral_stress_ratio_resolved", s.lateral_stress_ratio_resolved);
  visit("speedup_seconds", s.speedup_seconds);
  visit("speedup_contact_evaluations", s.speedup_contact_evaluations);
  visit("samples", s.samples);
  visit("left_out", s.left_out);
}

ComparisonSummary summary_of(const Comparison& comparison);

/// What macro runs took and how far the law is from the twin.
struct MacroSummary {
  std::optional<EngineSummary> macro;  ///< runs by law
  std::optional<EngineSummary> resolved;
  std::optional<EngineSummary> free;  ///< the twin without shells
  std::optional<ComparisonSummary> comparison;
};

void fields(auto&& visit, Of<MacroSummary> auto& s) {
  visit("macro", s.macro, kLeftOut);
  visit("resolved", s.resolved, kLeftOut);
  visit("free", s.free, kLeftOut);
  visit("comparison", s.comparison, kLeftOut);
}

/// Sentences about what must not be overlooked: points that did not converge, curves that are not usable.
std::vector<std::string> measurement_remarks(const Measurements& data);
/// Whether every run with a law, and every shelled twin, ends under stress: else nothing can be said relative to it.
bool all_carry_stress(const std::vector<MacroCurve>& curves);

/// What runs say of themselves, after `of` (with its blank or comma), one line for all of an engine. Warnings: what
/// makes a result doubtful. Notes: first each that cannot be used or carries no stress, then all else.
std::vector<std::string> run_warnings(const std::vector<MacroCurve>& curves, const std::string& of);
std::vector<std::string> run_notes(const std::vector<MacroCurve>& curves, const std::string& of);

std::vector<std::string> macro_warnings(const std::vector<MacroCurve>& curves);
std::vector<std::string> macro_remarks(const std::vector<MacroCurve>& curves);

}  // namespace softgrain

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
  std::string of;  ///< "solid grains"
  std::string form;
  int dimension = 3;
  std::int64_t samples = 0;
  double grains = 0.0;
  double largest_difference = 0.0;
  double largest_grain = 0.0;
  std::string unit;
  std::vector<double> diameter;
  std::vector<double> asked;
  std::vector<double> obtained;
};

void fields(auto&& visit, Of<SizesSummary> auto& s) {
  visit("of", s.of, Means{"grains whose sizes were asked for, such as \"solid grains\""});
  visit("form", s.form, Means{"form of the distribution"});
  visit("dimension", s.dimension, Means{"3, or 2 of disks, whose shares are of the area", "1"});
  visit("samples", s.samples, Means{"number of samples", "1"});
  visit("grains", s.grains, Means{"mean number of grains", "1"});
  visit("largest_difference", s.largest_difference,
        Means{"largest difference of the share that passes, over all samples and sizes", "1"});
  visit("largest_grain", s.largest_grain,
        Means{"share of the largest grain: half of it bounds the difference from below", "1"});
  visit("unit", s.unit, Means{"unit of the diameters"});
  visit("diameter", s.diameter, Means{"diameters at which shares are given", "as `unit` says"});
  visit("asked", s.asked, Means{"share of the volume that passes there, as asked for", "1"});
  visit("obtained", s.obtained, Means{"share of the volume that passes there, in the mean of the samples", "1"});
}

/// What shares of sizes are of, for people: "volume", of disks "area".
inline const char* share_of(int dimension) { return dimension == 2 ? "area" : "volume"; }

/// What the summary of every kind begins with.
struct SummaryHead {
  RunStatus status = RunStatus::good;
  std::string title;
  std::vector<std::string> remarks;
  std::map<std::string, std::string> files;
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
  visit("status", s.status, Means{"good, not usable, not run or written"});
  visit("title", s.title, Means{"title of the scene"});
  visit("warnings", s.warnings,
        Means{"what may make the result wrong for its purpose, with what to do about it; the most important first"});
  visit("remarks", s.remarks, Means{"notes; of a run that is not usable, why"});
  visit("files", s.files, kLeftOut, Means{"files that were written"});
  visit("sizes", s.sizes, kLeftOut, Means{"sizes of the grains where a distribution was asked for"});
}

/// The program that moved the bodies, when it was another.
struct EngineUse {
  MacroEngine name = MacroEngine::softgrain;
  std::int64_t ranks = 0;
  std::string program;
  std::string release;  ///< "29 Sep 2021"
};

void fields(auto&& visit, Of<EngineUse> auto& s) {
  visit("name", s.name, Means{"program that moved the bodies"});
  visit("ranks", s.ranks, Means{"number of MPI processes", "1"});
  visit("program", s.program, Means{"path of the program"});
  visit("lammps", s.release, Means{"version of LAMMPS"});
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
  visit("status", s.status, Means{"good, not usable, not run or written"});
  visit("title", s.title, Means{"title of the scene"});
  visit("kind", s.kind, Means{"kind of the scene"});
  visit("command", s.command, Means{"command that ran it"});
  visit("version", s.version, Means{"version of softgrain"});
  visit("commit", s.commit, Means{"git commit of the build"});
  visit("warnings", s.warnings,
        Means{"what may make the result wrong for its purpose, with what to do about it; the most important first"});
  visit("remarks", s.remarks, Means{"notes; of a run that is not usable, why"});
  visit("files", s.files, Means{"files that were written"});
  visit("seconds", s.seconds, Means{"duration of the run; of a resumed one since it was resumed", "s"});
  visit("provenance", s.provenance, Means{"where the result comes from"});
  visit("engine", s.engine, Means{"program that moved the bodies, when it was another"});
  visit("sizes", s.sizes, Means{"sizes of the grains where a distribution was asked for"});
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
  double exponent = 0.0;
  double exponent_deviation = 0.0;
  double contacts_per_grain = 0.0;
  double grains = 0.0;
  double grains_deviation = 0.0;
  std::optional<std::size_t> broke_off;
  std::optional<double> seconds;
};

void fields(auto&& visit, Of<PackingsSummary> auto& s) {
  visit("count", s.count, Means{"number of packings measured", "1"});
  visit("solid_fraction", s.solid_fraction, Means{"mean solid fraction", "1"});
  visit("solid_fraction_deviation", s.solid_fraction_deviation,
        Means{"standard deviation of it between packings", "1"});
  visit("exponent", s.exponent, Means{"mean power-law exponent of the radii, by maximum likelihood", "1"});
  visit("exponent_deviation", s.exponent_deviation, Means{"standard deviation of it between packings", "1"});
  visit("contacts_per_grain", s.contacts_per_grain, Means{"mean number of contacts of a grain", "1"});
  visit("grains", s.grains, Means{"mean number of grains", "1"});
  visit("grains_deviation", s.grains_deviation, Means{"standard deviation of it between packings", "1"});
  visit("broke_off", s.broke_off, kLeftOut, Means{"number of packings whose measurement did not come to its end", "1"});
  visit("seconds", s.seconds, kLeftOut, Means{"time that making the packings took", "s"});
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
  visit("relaxation", s.relaxation, Means{"relaxation that measured"});
  visit("points", s.points, Means{"number of points", "1"});
  fields(visit, s.cost);
  visit("loop_passes_per_point", s.loop_passes_per_point, Means{"passes over all contacts per point, mean", "1"});
  visit("seconds_per_point", s.seconds_per_point, Means{"core seconds per point, mean", "s"});
  visit("wall_seconds", s.wall_seconds, kLeftOut, Means{"duration of the measurement", "s"});
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
  visit("delta", s.delta, Means{"overlap Delta = hn/Rs", "1"});
  visit("force", s.force, Means{"mean force over packings whose point converged", "N"});
  visit("standard_error", s.standard_error, Means{"standard error of the force", "N"});
  visit("deviation", s.deviation, Means{"standard deviation of the force between packings", "N"});
  visit("packings", s.packings, Means{"number of packings", "1"});
}

/// What was measured on soft particles. The first relaxation gives the law; a second one checks it.
struct MeasuredSummary {
  PackingsSummary packings;
  MeasurementSummary measurement;
  std::map<std::string, std::vector<ForceSummary>> forces;
  std::optional<MeasurementSummary> reference_measurement;
  nlohmann::json relaxations;  ///< {reference, candidate, kind of contact: {normal, kt_initial, ...}}: means and ratios
};

void fields(auto&& visit, Of<MeasuredSummary> auto& s) {
  visit("packings", s.packings, Means{"packings that were measured"});
  visit("measurement", s.measurement, Means{"what the first relaxation, which gives the law, took"});
  visit("forces", s.forces, Means{"normal forces, by kind of contact"});
  visit("reference_measurement", s.reference_measurement, kLeftOut, Means{"what the second relaxation, a check, took"});
  visit("relaxations", s.relaxations, kLeftOut,
        Means{"the relaxations compared: for each kind of contact means and ratios of forces and stiffnesses"});
}

MeasuredSummary summary_of(const Measurements& data, const std::vector<std::string>& relaxations);

void fields(auto&& visit, Of<LawIdentity> auto& law) {
  double fraction = law.solid_fraction > 0.0 ? law.solid_fraction : kNaN;  // of a card: none
  visit("form", law.form, Means{"form of the law; null: a twin or cells"});
  law_fields(
      [&](const char*, const char* key, auto& member, const auto&... options) { visit(key, member, options...); }, law,
      fraction);
  std::string picture = picture_of(law);
  visit("picture", picture, kLeftOut, Means{"material that the law is for"});
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(law)>>)
    law.solid_fraction = fraction > 0.0 ? fraction : 0.0;
}

/// Slopes of a stage whose mean is not told apart from 0 by its samples (95 %).
inline std::vector<std::string> not_determined(const StageMeans& s) {
  std::vector<std::string> out;
  const auto add = [&](const char* name, const std::optional<MeanError>& m) {
    if (m && !is_told_from_zero(m->n, m->mean, m->error)) out.emplace_back(name);
  };
  add("modulus_secant", s.modulus);
  add("modulus_begin", s.modulus_begin);
  add("modulus_end", s.modulus_end);
  add("poisson_begin", s.poisson_begin);
  return out;
}

/// Fields of a stage: means over samples with their errors; moduli and stresses in Pa.
void fields(auto&& visit, Of<StageMeans> auto& s) {
  visit("name", s.record.name, Means{"name of the stage"});
  visit("kind", s.record.kind, Means{"kind of the stage"});
  visit("way", s.record.way, Means{"stage that an unloading, a reloading or a hold reverses, repeats or stays on"});
  if constexpr (std::is_const_v<std::remove_reference_t<decltype(s)>>)
    visit("modulus", modulus_of(s.record.way), Means{"kind of the modulus"});
  stage_numbers([&](const char* name, auto mean, auto, const Means& means) { visit(name, s.*mean, kLeftOut, means); });
  if constexpr (std::is_const_v<std::remove_reference_t<decltype(s)>>)
    visit("not_determined", not_determined(s), kLeftOut, Means{"slopes that the samples do not tell from 0"});
}

/// A sample that was prepared to a density.
struct DensitySample {
  std::int64_t sample = 0;
  double solid_fraction = 0.0;
  double difference = 0.0;
  double friction = 0.0;  ///< friction while packed that was found
  std::int64_t tries = 0;
};

void fields(auto&& visit, Of<DensitySample> auto& s) {
  visit("sample", s.sample, Means{"number of the sample", "1"});
  visit("solid_fraction", s.solid_fraction, Means{"solid fraction that was reached", "1"});
  visit("difference", s.difference, Means{"difference from the target", "1"});
  visit("compaction_mu", s.friction, Means{"friction between particles while they were packed", "1"});
  visit("tries", s.tries, Means{"preparations that the search took", "1"});
}

/// Samples that were prepared to a target density.
struct DensitySummary {
  double target = 0.0;  ///< solid fraction
  double tolerance = 0.0;
  std::vector<DensitySample> samples;
};

void fields(auto&& visit, Of<DensitySummary> auto& s) {
  visit("solid_fraction", s.target, Means{"target", "1"});
  visit("solid_fraction_tolerance", s.tolerance, Means{"largest difference that was allowed", "1"});
  visit("samples", s.samples, Means{"what each sample came to"});
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
  double soft_volume_share = 0.0;
  Cost cost;
  std::optional<Cost> preparation;
  std::optional<DensitySummary> density{};
  bool usable = false;
  std::optional<LawIdentity> law;
  std::vector<StageMeans> stages;
};

void fields(auto&& visit, Of<EngineSummary> auto& s) {
  visit("samples", s.samples, Means{"number of samples", "1"});
  visit("bodies", s.bodies, Means{"largest number of bodies of a sample: solid grains and soft particles", "1"});
  visit("grains_inside", s.grains_inside,
        Means{"largest number of grains resolved inside soft particles; 0 for laws", "1"});
  visit("soft_volume_share", s.soft_volume_share,
        Means{"mean share of soft particles in the volume of the bodies", "1"});
  fields(visit, s.cost);
  visit("preparation", s.preparation, kLeftOut,
        Means{"cost of the states that samples start from, which engines share"});
  visit("target_density", s.density, kLeftOut, Means{"how these states came to a target density"});
  visit("usable", s.usable, Means{"whether every sample is usable"});
  visit("law", s.law, kLeftOut, Means{"law that the runs were made with"});
  visit("stages", s.stages, kLeftOut, Means{"stages of the test, means over samples"});
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
  visit("sample", s.sample, Means{"number of the sample", "1"});
  visit("strain_high", s.strain_high, Means{"strain up to which law and twin are compared", "1"});
  visit("stress_error", s.stress_error, Means{"relative L2 difference of the axial stress from that of the twin", "1"});
  visit("end_ratio", s.end_ratio, Means{"axial stress over that of the twin at the end", "1"});
}

/// Law runs against the shelled twin, see Comparison.
struct ComparisonSummary {
  /// Relative L2 difference of the axial stress, mean over samples; in tests in stages of those that do not impose it.
  double stress_error = kNaN;
  double stress_error_standard_error = kNaN;
  double lateral_stress_error = kNaN;
  std::optional<double> strain_error;
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
  visit("stress_error", s.stress_error,
        Means{"relative L2 difference of the axial stress, mean over samples; of tests in stages where they do not "
              "impose it",
              "1"});
  visit("stress_error_standard_error", s.stress_error_standard_error, Means{"standard error of it", "1"});
  visit("lateral_stress_error", s.lateral_stress_error,
        Means{"relative L2 difference of the lateral stress, mean over samples", "1"});
  visit("strain_error", s.strain_error, kLeftOut,
        Means{"tests in stages: relative L2 difference of the strains of axes that go by stress", "1"});
  visit("deviator_error", s.deviator_error, kLeftOut, Means{"relative L2 difference of axial minus x stress", "1"});
  visit("unloading_modulus_ratio", s.unloading_modulus_ratio, kLeftOut,
        Means{"unloading modulus of the law over that of the twin", "1"});
  visit("end_stress_ratio", s.end_stress_ratio, Means{"axial stress of the law over that of the twin at the end", "1"});
  visit("lateral_stress_ratio_law", s.lateral_stress_ratio_law,
        Means{"lateral over axial stress at the end, by law", "1"});
  visit("lateral_stress_ratio_resolved", s.lateral_stress_ratio_resolved,
        Means{"lateral over axial stress at the end, of the twin", "1"});
  visit("speedup_seconds", s.speedup_seconds, Means{"core seconds of the twin over those of the law", "1"});
  visit("speedup_contact_evaluations", s.speedup_contact_evaluations,
        Means{"contact evaluations of the twin over those of the law", "1"});
  visit("samples", s.samples, Means{"each sample against its twin"});
  visit("left_out", s.left_out, Means{"samples that were left out, and why"});
}

ComparisonSummary summary_of(const Comparison& comparison);

/// What macro runs took and how far the law is from the twin.
struct MacroSummary {
  std::optional<EngineSummary> macro;
  std::optional<EngineSummary> resolved;
  std::optional<EngineSummary> free;
  std::optional<ComparisonSummary> comparison;
};

void fields(auto&& visit, Of<MacroSummary> auto& s) {
  visit("macro", s.macro, kLeftOut, Means{"runs by law"});
  visit("resolved", s.resolved, kLeftOut, Means{"the shelled twin: all grains, in moving shells"});
  visit("free", s.free, kLeftOut, Means{"the twin without shells"});
  visit("comparison", s.comparison, kLeftOut, Means{"runs by law against the shelled twin"});
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

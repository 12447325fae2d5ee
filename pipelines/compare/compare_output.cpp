// A comparison as JSON and as a table for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "common/data/fields.h"
#include "common/io/json_record.h"
#include "pipelines/compare/compare_inputs.h"

namespace softgrain {
namespace {

using nlohmann::json;

json number(double value) { return json_of(value); }

json to_json(const MeanError& m) { return json_of(m); }

json to_json(const SampleComparison& s) {
  json out{{"test", to_string(s.test)},
           {"sample", s.sample},
           {"strain_range", {s.strain_low, s.strain_high}},
           {"axial_difference", number(s.axial_difference)},
           {"lateral_difference", number(s.lateral_difference)},
           {"deviator_difference", number(s.deviator_difference)},
           {"strain_difference", number(s.strain_difference)},
           {"unloading_modulus_ratio", number(s.unloading_ratio)},
           {"axial_end_ratio", number(s.axial_end_ratio)},
           {"lateral_end_ratio", number(s.lateral_end_ratio)},
           {"lateral_stress_ratio",
            {{"candidate", number(s.lateral_stress_ratio_candidate)},
             {"reference", number(s.lateral_stress_ratio_reference)}}}};
  if (std::isfinite(s.shear_high)) out["shear_strain_range"] = {s.shear_low, s.shear_high};
  return out;
}

json to_json(const MacroPart& part) {
  const Comparison& c = part.result;
  json samples = json::array();
  for (const SampleComparison& s : c.samples) samples.push_back(to_json(s));
  return {{"candidate_engine", part.candidate_engine},
          {"reference_engine", part.reference_engine},
          {"axial_difference", to_json(c.axial_difference)},
          {"lateral_difference", to_json(c.lateral_difference)},
          {"deviator_difference", to_json(c.deviator_difference)},
          {"strain_difference", to_json(c.strain_difference)},
          {"unloading_modulus_ratio", to_json(c.unloading_ratio)},
          {"axial_end_ratio", to_json(c.axial_end_ratio)},
          {"lateral_stress_ratio",
           {{"candidate", to_json(c.lateral_stress_ratio_candidate)},
            {"reference", to_json(c.lateral_stress_ratio_reference)}}},
          {"band",
           {{"half_width", to_json(c.band_width)},
            {"reference_inside", to_json(c.in_band)},
            {"reference_end_inside", to_json(c.end_in_band)}}},
          {"speedup_seconds", number(c.speedup_seconds)},
          {"speedup_contact_evaluations", number(c.speedup_contact_evaluations)},
          {"left_out", c.left_out},
          {"undefined", c.undefined},
          {"samples", samples}};
}

json to_json(const std::vector<RatioRow>& rows) {
  json out = json::array();
  for (const RatioRow& r : rows) {
    out.push_back({{"delta", r.delta},
                   {"candidate", to_json(r.candidate)},
                   {"reference", to_json(r.reference)},
                   {"ratio", number(r.ratio.ratio)},
                   {"ratio_standard_error", number(r.ratio.error)}});
    if (r.jumps == 0) continue;
    out.back()["jumps"] = r.jumps;
    out.back()["ratio_without_jumps"] = number(r.ratio_without_jumps.ratio);
    out.back()["ratio_without_jumps_standard_error"] = number(r.ratio_without_jumps.error);
  }
  return out;
}

json to_json(const PointCost& c) {
  return {{"points", c.points},
          {"loop_passes_per_point", number(c.loop_passes)},
          {"contact_evaluations_per_point", number(c.contact_evaluations)},
          {"seconds_per_point", number(c.seconds)}};
}

json cost_json(const ForceComparison& c) {
  return {{"candidate_normal", to_json(c.candidate_normal_cost)},
          {"reference_normal", to_json(c.reference_normal_cost)},
          {"candidate_tangential", to_json(c.candidate_tangential_cost)},
          {"reference_tangential", to_json(c.reference_tangential_cost)}};
}

/// What all comparisons of forces say.
json forces_json(const ForceComparison& c) {
  return {{"pair", to_string(c.kind)},
          {"normal_force", to_json(c.normal)},
          {"stiffness_initial", to_json(c.stiffness_initial)},
          {"stiffness_secant", to_json(c.stiffness_secant)},
          {"cost", cost_json(c)}};
}

json to_json(const RelaxationComparison& c) {
  json out = forces_json(c);
  out["candidate"] = c.candidate;
  out["reference"] = c.reference;
  return out;
}

json to_json(const MeasurementComparison& c) {
  json out = forces_json(c);
  out["candidate_relaxation"] = c.candidate_relaxation;
  out["reference_relaxation"] = c.reference_relaxation;
  out["paired"] = c.paired;
  return out;
}

json to_json(const LawPartComparison& part) {
  json rows = json::array();
  for (const LawRow& r : part.rows) {
    rows.push_back({{"what", r.what},
                    {"candidate", number(r.candidate)},
                    {"candidate_standard_error", number(r.candidate_error)},
                    {"reference", number(r.reference)},
                    {"reference_standard_error", number(r.reference_error)}});
  }
  return {{"pair", to_string(part.kind)}, {"rows", rows}};
}

constexpr const char* kUndefined = "undefined";

std::string error_text(double value, double error, int digits = 4) {
  return with_error(value, if_finite(error), {.value = {digits}, .undefined = kUndefined});
}

std::string percent(const MeanError& m) {
  return error_text(100.0 * m.mean, 100.0 * m.error, 3) + (std::isfinite(m.mean) ? " %" : "");
}

std::string factor(double value) { return rounded_text(value, {3}, kUndefined); }

std::string text_of(const MacroPart& part) {
  const Comparison& c = part.result;
  std::string out = fmt::format("macro: {} against {}, {}\n", part.candidate_engine, part.reference_engine,
                                counted(c.samples.size(), "sample"));
  const bool given = std::ranges::any_of(c.samples, [](const auto& s) { return s.axial_imposed; });
  if (c.deviator_difference.n > 0)
    out += fmt::format("  deviator, relative L2 difference        {}\n", percent(c.deviator_difference));
  if (c.strain_difference.n > 0)
    out += fmt::format("  strains of axes that go by stress       {}\n", percent(c.strain_difference));
  if (c.unloading_ratio.n > 0)
    out += fmt::format("  unloading modulus over the reference's  {}\n",
                       error_text(c.unloading_ratio.mean, c.unloading_ratio.error));
  if (c.axial_difference.n > 0 || !given)
    out += fmt::format("  axial stress, relative L2 difference    {}{}\n", percent(c.axial_difference),
                       given ? ", where it is not given" : "");
  if (c.lateral_difference.n > 0 || !given)
    out += fmt::format("  lateral stress, relative L2 difference  {}\n", percent(c.lateral_difference));
  out += fmt::format("  axial stress ratio at the end           {}\n",
                     error_text(c.axial_end_ratio.mean, c.axial_end_ratio.error));
  out += fmt::format("  lateral over axial stress at the end    {} against {}\n",
                     error_text(c.lateral_stress_ratio_candidate.mean, c.lateral_stress_ratio_candidate.error),
                     error_text(c.lateral_stress_ratio_reference.mean, c.lateral_stress_ratio_reference.error));
  if (c.band_width.n > 0)
    out += fmt::format(
        "  95 % band of the candidate              +-{} at the end; {} of the reference's points inside, {} of "
        "its ends\n",
        percent(c.band_width), percent(c.in_band), percent(c.end_in_band));
  out += fmt::format("  speed-up                                {} in seconds, {} in contact evaluations\n",
                     factor(c.speedup_seconds), factor(c.speedup_contact_evaluations));
  for (const std::string& reason : c.left_out) out += "  left out: " + reason + "\n";
  return out;
}

std::string text_of(const std::string& quantity, const std::vector<RatioRow>& rows) {
  std::string out;
  for (const RatioRow& r : rows) {
    out += fmt::format("  {:<14} {:>6.3f} {:>5} {:>22} {:>22} {:>20}\n", quantity, r.delta, r.reference.n,
                       error_text(r.candidate.mean, r.candidate.error), error_text(r.reference.mean, r.reference.error),
                       error_text(r.ratio.ratio, r.ratio.error));
  }
  return out;
}

/// The line under the table for every row with jumps.
std::string jumps_text(const std::vector<RatioRow>& rows) {
  std::string out;
  for (const RatioRow& r : rows) {
    if (r.jumps == 0) continue;
    out += fmt::format(
        "  kt initial at {:.3f}: {} of {} packings rearranged between two angles (a negative slope above the median in "
        "size); ratio without: {}\n",
        r.delta, r.jumps, r.reference.n, error_text(r.ratio_without_jumps.ratio, r.ratio_without_jumps.error));
  }
  return out;
}

std::string ratio_header() {
  return fmt::format("  {:<14} {:>6} {:>5} {:>22} {:>22} {:>20}\n", "", "Delta", "n", "candidate", "reference",
                     "ratio");
}

std::string ratio_text(const ForceComparison& c) {
  return ratio_header() + text_of("Fn", c.normal) + text_of("kt initial", c.stiffness_initial) +
         text_of("kt secant", c.stiffness_secant) + jumps_text(c.stiffness_initial);
}

std::string cost_text(const ForceComparison& c) {
  const std::string speedup = factor(c.reference_normal_cost.seconds / c.candidate_normal_cost.seconds);
  return fmt::format(
      "  cost of a normal point: {:.3g} against {:.3g} loop passes, {:.3g} against {:.3g} s (speed-up {})\n",
      c.candidate_normal_cost.loop_passes, c.reference_normal_cost.loop_passes, c.candidate_normal_cost.seconds,
      c.reference_normal_cost.seconds, speedup);
}

std::string text_of(const RelaxationComparison& c) {
  return fmt::format("relaxations, {}: {} against {} (N, N/m)\n", to_string(c.kind), c.candidate, c.reference) +
         ratio_text(c) + cost_text(c);
}

std::string text_of(const MeasurementComparison& c) {
  return fmt::format("measurements, {}: {} against {} (Fn/(E Rs^2), kt/(E Rs); {})\n", to_string(c.kind),
                     c.candidate_relaxation, c.reference_relaxation,
                     c.paired ? "the same packings, paired" : "different packings") +
         ratio_text(c) + cost_text(c);
}

std::string text_of(const LawPartComparison& part) {
  std::string out =
      fmt::format("laws, {}\n  {:<32} {:>24} {:>24}\n", to_string(part.kind), "", "candidate", "reference");
  for (const LawRow& r : part.rows) {
    out += fmt::format("  {:<32} {:>24} {:>24}\n", r.what, error_text(r.candidate, r.candidate_error),
                       error_text(r.reference, r.reference_error));
  }
  return out;
}

template <class Part>
json list_of(const std::vector<Part>& parts) {
  json out = json::array();
  for (const Part& part : parts) out.push_back(to_json(part));
  return out;
}

}  // namespace

json to_json(const CompareResult& result) {
  return {{"macro", list_of(result.macro)},
          {"relaxations", list_of(result.relaxations)},
          {"measurements", list_of(result.measurements)},
          {"laws", list_of(result.laws)},
          {"differences", result.differences},
          {"remarks", result.remarks},
          {"undefined", result.undefined}};
}

std::string to_text(const CompareResult& result) {
  std::string out;
  for (const std::string& difference : result.differences) out += "differs: " + difference + "\n";
  for (const auto& part : result.macro) out += text_of(part);
  for (const auto& part : result.relaxations) out += text_of(part);
  for (const auto& part : result.measurements) out += text_of(part);
  for (const auto& part : result.laws) out += text_of(part);
  for (const std::string& one : result.undefined) out += "undefined: " + one + "\n";
  for (const std::string& remark : result.remarks) out += "not compared: " + remark + "\n";
  return out;
}

}  // namespace softgrain

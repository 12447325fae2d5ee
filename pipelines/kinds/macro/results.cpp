#include "pipelines/kinds/macro/scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "pipelines/compare/compare.h"
#include "pipelines/kinds/macro/values.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using namespace report;

void check_macro_file(const std::string& path, Findings& out) {
  const std::vector<MacroCurve> curves = load_macro(path);
  out.add("kind", "macro curves", fmt::format("macro curves: {}", curves.size()));
  out.facts["curves"] = nlohmann::json::array();
  for (const MacroCurve& c : curves) {
    const bool recorded = !c.strain.empty() && !c.stress_axial.empty();
    out.facts["curves"].push_back({{"engine", c.engine}, {"sample", c.sample}, {"usable", c.usable}});
    if (recorded)
      out.lines += fmt::format(
          "    {} sample {}: {} bodies, {} points to a strain of {:.3g}, axial stress {:.4g} Pa{}\n", c.engine,
          c.sample, c.bodies, c.strain.size(), c.strain.back(), c.stress_axial.back(), c.usable ? "" : ", not usable");
    if (!c.usable) out.warn(fmt::format("{} sample {} is not usable: {}", c.engine, c.sample, c.note));
    if (!c.law_beyond.empty() && c.law_beyond.back() > 0.0)
      out.warn(fmt::format("{} sample {}: {:.0f} of {:.0f} uses of its law lay beyond what was measured at the end",
                           c.engine, c.sample, c.law_beyond.back(),
                           c.law_evaluations.empty() ? 0.0 : c.law_evaluations.back()));
  }
}

/// Where runs of one engine ended, when there is nothing to compare with.
std::string end_line(const std::vector<MacroCurve>& curves) {
  std::vector<double> stress;
  for (const MacroCurve& c : curves)
    if (!c.stress_axial.empty()) stress.push_back(c.stress_axial.back());
  if (stress.empty()) return "";
  const MeanError mean = mean_error(stress);
  return fmt::format("Axial stress {} Pa at strain {} ({}; {} {}).",
                     stress.size() > 1 ? format_with_error(mean.mean, mean.error) : format_number(mean.mean, 4),
                     format_number(curves.front().strain.back(), 3), to_string(curves.front().test), stress.size(),
                     stress.size() > 1 ? "samples, mean" : "sample");
}

/// What law and twin differ by, of tests in stages in what these do not impose.
std::string difference_line(const Comparison& c) {
  const std::vector<ComparedQuantity> all = headline_of(c);
  if (all.size() == 1 && all.front().what == "stress")
    return fmt::format("Stress by the law differs from the resolved twin by {} %",
                       format_with_error(100 * c.axial_difference.mean, 100 * c.axial_difference.error));
  std::string text = "Law and resolved twin differ";
  const char* before = ": ";
  for (const ComparedQuantity& q : all) {
    text += before + q.what +
            (q.is_ratio ? " " + format_with_error(q.value.mean, q.value.error)
                        : fmt::format(" {} %", format_with_error(100 * q.value.mean, 100 * q.value.error)));
    before = ", ";
  }
  return all.empty() ? "Law and resolved twin: the test imposes all that could differ" : text;
}

std::string macro_line(const std::vector<MacroCurve>& macro) {
  const auto laws = curves_of(macro, "law");
  const auto twins = curves_of(macro, "shelled");
  if (laws.empty() || twins.empty()) return end_line(laws.empty() ? macro : laws);
  try {
    const Comparison c = compare_curves(laws, twins);
    if (!c.undefined.empty()) return "Law and resolved twin: " + c.undefined.front() + ".";
    return fmt::format("{} ({} samples); {} times fewer contact evaluations, {} times faster.", difference_line(c),
                       c.samples.size(), format_number(c.speedup_contact_evaluations, 3),
                       format_number(c.speedup_seconds, 3));
  } catch (const InputError& error) {
    return error.what();
  }
}

std::vector<HeadLine> lines_of(const RunData& run) {
  if (run.macro.empty()) return {};
  return {{kResultLabel, macro_line(run.macro)}};
}

/// What the law is off by, and what it saves, beside the shelled twin.
void add_comparison(const std::vector<MacroCurve>& macro, std::vector<RunValue>& out) {
  const auto laws = curves_of(macro, "law");
  const auto twins = curves_of(macro, "shelled");
  if (laws.empty() || twins.empty()) return;
  try {
    const Comparison c = compare_curves(laws, twins);
    if (!c.undefined.empty()) return;
    for (const ComparedQuantity& q : headline_of(c)) {
      const double unit = q.is_ratio ? 1.0 : 100.0;
      out.push_back({q.is_ratio ? q.what : q.what + " of the law, off from the twin", q.is_ratio ? "" : "%",
                     unit * q.value.mean, unit * q.value.error});
    }
    out.push_back({"contact evaluations of the twin over those of the law", "", c.speedup_contact_evaluations});
  } catch (const InputError&) {  // no sample with two usable curves: said elsewhere
  }
}

std::vector<RunValue> values_beside(const RunData& run) {
  std::vector<RunValue> out = stress_values(by_engine(run.macro));
  add_comparison(run.macro, out);
  return out;
}

std::vector<RunCurve> curves_beside(const RunData& run) { return stress_curves(by_engine(run.macro)); }

NextSteps next_of(const RunData& run) {
  const auto any = [&](auto&& is) { return std::any_of(run.macro.begin(), run.macro.end(), is); };
  const bool twin = any([](const MacroCurve& c) { return c.twin() == Twin::shelled; });
  const bool pair = any([](const MacroCurve& c) { return c.law.form == LawForm::pair; });
  const bool several = any([](const MacroCurve& c) { return c.sample > 0; });
  const char* law = !twin ? "How far the law is off: the resolved twin of the same scene (`--set macro.resolved=true`; "
                            "`softgrain check` says "
                            "what it takes), or error bars from the law itself (`--bands 64`)."
                    : pair ? "The pair law knows one contact: take one that knows all, `softgrain macrosim SCENE.toml "
                             "--law LAW_TABLE.toml` (one "
                             "comes along, `results/law_table`; `softgrain run pipelines/law_table.toml` measures one)."
                           : "Where law and twin differ: `--bands 64` shows what the law is not sure of, `softgrain "
                             "law plan LAW_TABLE.toml --for "
                             "SCENE.toml` what to measure next.";
  return {
      law,
      several
          ? "What the result depends on: `softgrain sweep SCENE.toml --over macro.bodies=40,80,160 --seeds 1..4`."
          : "One sample tells nothing of scatter: `softgrain macrosim SCENE.toml --seeds 1..8` gives mean, spread and "
            "standard error."};
}

}  // namespace

KindResults macro_results() {
  return {.files = {{.names = "macro(_initial)?\\.h5",
                     .is = [](const h5::Group& root) { return root.has("curves"); },
                     .check = check_macro_file},
                    {.names = "states_macro\\.h5|lammps-[0-9]+"}},
          .sections = {{Part::macro, macro_section}},
          .lines = lines_of,
          .values = values_beside,
          .curves = curves_beside,
          .next = next_of};
}

}  // namespace softgrain

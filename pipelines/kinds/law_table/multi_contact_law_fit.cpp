#include "pipelines/kinds/law_table/multi_contact_law_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/law/law_json.h"

namespace softgrain {

namespace {

bool all_converged(const MultiContactMeasurements& data) {
  for (const MultiContactRun& run : data.runs)
    for (const MultiContactPoint& p : run.points)
      if (!p.converged) return false;
  return true;
}

/// Entries ascend in solid fraction; two at the same one could not be told apart.
void insert(LawTable& table, LawTableEntry entry) {
  constexpr double kSame = 1e-6;
  const auto at = std::ranges::find_if(
      table.entries, [&](const LawTableEntry& e) { return e.solid_fraction > entry.solid_fraction - kSame; });
  if (at != table.entries.end() && at->solid_fraction < entry.solid_fraction + kSame)
    throw InputError(
        fmt::format("law table: two measurements have the same solid fraction {:.6f}; every entry needs its own",
                    entry.solid_fraction));
  table.entries.insert(at, std::move(entry));
}

std::string law_line(const LawTableEntry& entry, const MultiContactLaw& law) {
  return fmt::format("  {}: {}off by {:.1f} % on what it was fitted to, {}, {}\n", form_label(entry, law),
                     law.status == LawStatus::good ? "" : to_string(law.status) + ", ", 100.0 * law.error_fitted,
                     held_out_text(law), cross_text(law));
}

}  // namespace

std::string held_out_text(const MultiContactLaw& law) {
  if (std::isnan(law.error_held_out)) return "nothing held out";
  return fmt::format("{:.1f} % on what was held out", 100.0 * law.error_held_out);
}

std::string cross_text(const MultiContactLaw& law) {
  if (std::isnan(law.error_cross)) return "nothing to leave out";
  return fmt::format("{:.1f} % leaving one out", 100.0 * law.error_cross);
}

MultiContactFitOptions read_multi_contact_fit(const SceneTable& t) {
  MultiContactFitOptions o;
  o.discrepancy =
      t.number({"discrepancy", "error of the law that the fit allows in addition to the noise, over the force"},
               Unit::none, Range{0.0, 1.0, true, false}, o.discrepancy);
  o.replicates = static_cast<int>(t.count(
      {"replicates",
       "bootstrap refits (fits to data drawn with replacement) that must converge; at most twice as many are tried"},
      0, 100000, o.replicates));
  o.min_packings =
      static_cast<int>(t.count({"min_packings", "with fewer packings there is no fit"}, 2, 100000, o.min_packings));
  if (t.has("best"))
    o.best = t.choice<LawForm>({"best", "form of the law that is used where none is named",
                                "the form with the smallest leave-one-out error on fitted loadings"});
  o.largest_error = t.number({"largest_error",
                              "a law with a larger held-out or leave-one-out error is marked `inaccurate`. If it is "
                              "the best one, the exit status is 3"},
                             Unit::none, Range::positive(), o.largest_error);
  return o;
}

void require_law_of_multi_contact(const SceneTable& root, const MultiContactSetup& setup, const SceneTable& calibrate,
                                  const MultiContactFitOptions& fit) {
  if (!calibrate.has_errors() && setup.packings_max < fit.min_packings)
    root.table_or_empty("multi_contact")
        .add_error("packings_max",
                   fmt::format("below min_packings = {} of [calibrate{}]: there would be no fit", fit.min_packings,
                               root.table_or_empty("calibrate").has("multi_contact") ? ".multi_contact" : ""));
  const auto& all = setup.configurations;
  if (std::ranges::none_of(all, [](const MultiContactConfiguration& c) {
        return c.partners.size() == 1 && c.partners[0].kind == PartnerKind::plane && !c.held_out && !c.centre_free;
      }))
    root.add_error("configuration", "a law table needs one plane alone (arrangement \"one\", partner \"plane\")");
}

double add_entry(MultiContactLawFit& fit, const MultiContactMeasurements& data, const MultiContactFitOptions& options,
                 double target) {
  const LawTableEntry entry = fit_multi_contact_laws(data, options);
  fit.usable = fit.usable && all_converged(data);
  for (const std::string& r : multi_contact_remarks(data, target))
    fit.remarks.push_back(fmt::format("solid fraction {:.3f}: {}", entry.solid_fraction, r));
  std::string failed;
  for (const MultiContactLaw& law : entry.laws)
    if (law.replicates_failed > 0)
      append_part(failed,
                  fmt::format("{} law {} of {}", to_string(law.form), law.replicates_failed,
                              law.replicates_failed + static_cast<int>(law.replicates.size())),
                  ", ");
  if (!failed.empty())
    fit.remarks.push_back(
        fmt::format("solid fraction {:.3f}: refits to drawn packings that did not come to a minimum, left out of the "
                    "intervals: {}",
                    entry.solid_fraction, failed));
  for (const MultiContactLaw& law : entry.laws) {
    if (law.status == LawStatus::good) continue;
    fit.usable = fit.usable && law.form != entry.best;
    fit.remarks.push_back(to_string(law.form) + " law: " + to_string(law.status) + ": " + law.reason);
  }
  insert(fit.table, entry);
  return entry.solid_fraction;
}

std::vector<EntrySummary> summaries_of(const LawTable& table) {
  std::vector<EntrySummary> out;
  for (const LawTableEntry& entry : table.entries) out.push_back({entry});
  return out;
}

std::string entries_text(const LawTable& table) {
  std::string text;
  for (const LawTableEntry& entry : table.entries) {
    text += fmt::format("laws at solid fraction {:.3f} ({}{}):\n", entry.solid_fraction,
                        counted(entry.packings, "packing"), entry.prior ? " and a library" : "");
    for (const MultiContactLaw& law : entry.laws) text += law_line(entry, law);
  }
  return text;
}

}  // namespace softgrain

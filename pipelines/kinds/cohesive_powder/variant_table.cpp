
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/text.h"
#include "pipelines/kinds/cohesive_powder/variants.h"

namespace softgrain {

namespace {

/// What a table for people shows of a variant beside Phi and z.
constexpr std::array kShown{"z_star",       "x_0",         "x_1",         "x_2",        "mean_normal", "mean_repulsive",
                            "mean_tensile", "rumpf_ratio", "F_perc",      "zero_share", "bulk",        "shear",
                            "lambda",       "alpha",       "Phi_max",     "h",          "k",           "dF",
                            "xi",           "R_w",         "loop_passes", "seconds"};

/// Phi and z always, others where the publication gives them for a variant.
std::vector<std::string> compared(const std::vector<VariantEntry>& entries) {
  std::vector<std::string> out;
  for (const std::string name : powder_comparable())
    if (name == "Phi" || name == "z" ||
        std::ranges::any_of(entries, [&](const VariantEntry& e) { return e.published.contains(name); }))
      out.push_back(name);
  return out;
}

/// A number in full precision; empty where it is not finite.
std::string exact(double x) { return std::isfinite(x) ? nlohmann::json(x).dump() : ""; }

constexpr NumberForm kFourDecimals{4, true};

/// "0.7105 +- 0.0011"; empty where there is no value.
std::string ours(const VariantEntry& entry, const std::string& quantity, const NumberForm& form) {
  const QuantityMean own = entry.ours(quantity);
  return with_error(own.mean, if_finite(own.error), {.value = form, .undefined = ""});
}

std::string theirs(const VariantEntry& entry, const std::string& quantity) {
  const auto published = entry.theirs(quantity);
  return with_error(published.value, if_finite(published.error), {.value = {5}, .undefined = ""});
}

/// "+0.0012 (0.8 errors)"
std::string difference(const VariantEntry& entry, const std::string& quantity) {
  const PublishedDifference off = entry.off(quantity);
  const std::string errors = rounded_text(off.in_errors, {1, true, true}, "");
  return rounded_text(off.value, {2, false, true}, "") + (errors.empty() ? "" : " (" + errors + ")");
}

std::string samples_text(const VariantEntry& entry) {
  return fmt::format("{}/{}", entry.usable_samples, entry.samples);
}

}  // namespace

TextTable powder_data_table(const std::vector<VariantEntry>& entries) {
  TextTable table{{"name", "status", "reason", "disks", "samples", "usable_samples"}, {}};
  for (const std::string name : powder_quantities())
    for (const char* ending : {"", "_deviation", "_error"}) table.header.push_back(name + ending);
  const std::vector<std::string> published = compared(entries);
  for (const std::string& name : published)
    for (const char* ending : {"_published", "_published_error", "_difference", "_difference_in_errors"})
      table.header.push_back(name + ending);
  for (const VariantEntry& e : entries) {
    std::vector<std::string> row{e.name,
                                 to_string(e.status),
                                 e.reason,
                                 std::to_string(e.disks),
                                 std::to_string(e.samples),
                                 std::to_string(e.usable_samples)};
    for (const char* name : powder_quantities())
      for (const double x : {e.ours(name).mean, e.ours(name).deviation, e.ours(name).error}) row.push_back(exact(x));
    for (const std::string& name : published)
      for (const double x : {e.theirs(name).value, e.theirs(name).error, e.off(name).value, e.off(name).in_errors})
        row.push_back(exact(x));
    table.rows.push_back(std::move(row));
  }
  return table;
}

TextTable powder_console_table(const std::vector<VariantEntry>& entries) {
  TextTable table{{"variant", "status", "at rest"}, {}};
  const std::vector<std::string> published = compared(entries);
  for (const std::string& name : published)
    for (const char* ending : {"", " published", " difference (in errors)"}) table.header.push_back(name + ending);
  std::vector<std::string> others(kShown.begin(), kShown.end());
  std::erase_if(others, [&](const std::string& name) { return std::ranges::find(published, name) != published.end(); });
  table.header.insert(table.header.end(), others.begin(), others.end());
  for (const VariantEntry& e : entries) {
    std::vector<std::string> row{e.name, to_string(e.status), samples_text(e)};
    for (const std::string& name : published)
      row.insert(row.end(), {ours(e, name, kFourDecimals), theirs(e, name), difference(e, name)});
    for (const std::string& name : others) row.push_back(ours(e, name, {4}));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string powder_variant_line(const VariantEntry& entry) {
  std::string line = entry.name + ": ";
  if (entry.status == RunStatus::not_run) return line + "not run\n";
  for (const std::string& name : compared({entry})) {
    const std::string published = theirs(entry, name);
    line += fmt::format("{} {}{}, ", name, ours(entry, name, kFourDecimals),
                        published.empty() ? "" : " (published " + published + ")");
  }
  line += samples_text(entry) + " samples at rest";
  return line + (entry.reason.empty() ? "" : "; NOT USABLE: " + entry.reason) + "\n";
}

}  // namespace softgrain

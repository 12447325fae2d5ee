#include "pipelines/kinds/cohesive_powder/variant_table.h"

#include <fmt/format.h>

#include <array>

#include "pipelines/kinds/cohesive_powder/variant_entry.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// What a table for people shows of a variant beside Phi and z.
constexpr std::array kShown{"z_star",       "x_0",         "x_1",         "x_2",    "mean_normal", "mean_repulsive",
                            "mean_tensile", "rumpf_ratio", "F_perc",      "h",      "k",           "dF",
                            "xi",           "R_w",         "loop_passes", "seconds"};

constexpr std::array kCompared{"Phi", "z"};

/// The number at a path of keys in full precision; empty where there is none.
std::string exact(const json& entry, const std::string& path) {
  const json::json_pointer pointer(path);
  if (!entry.contains(pointer) || !entry.at(pointer).is_number()) return "";
  return entry.at(pointer).dump();
}

std::string rounded(const json& entry, const std::string& path, const char* format) {
  const json::json_pointer pointer(path);
  if (!entry.contains(pointer) || !entry.at(pointer).is_number()) return "";
  return fmt::format(fmt::runtime(format), entry.at(pointer).get<double>());
}

/// "0.7105 +- 0.0011", with an error where there is one.
std::string with_error(const json& entry, const std::string& value, const std::string& error, const char* format) {
  std::string text = rounded(entry, value, format);
  const std::string band = rounded(entry, error, "{:.2g}");
  if (!text.empty() && !band.empty()) text += " +- " + band;
  return text;
}

std::string ours(const json& entry, const std::string& quantity, const char* format) {
  return with_error(entry, "/values/" + quantity + "/mean", "/values/" + quantity + "/error", format);
}

std::string theirs(const json& entry, const std::string& quantity) {
  return with_error(entry, "/published/" + quantity + "/value", "/published/" + quantity + "/error", "{:.5g}");
}

/// "+0.0012 (0.8 errors)"
std::string difference(const json& entry, const std::string& quantity) {
  std::string text = rounded(entry, "/difference/" + quantity + "/value", "{:+.2g}");
  const std::string errors = rounded(entry, "/difference/" + quantity + "/in_errors", "{:+.1f}");
  return errors.empty() ? text : text + " (" + errors + ")";
}

std::string samples_text(const json& entry) {
  return fmt::format("{}/{}", entry["usable_samples"].get<std::int64_t>(), entry["samples"].get<std::int64_t>());
}

}  // namespace

TextTable powder_data_table(const json& entries) {
  TextTable table{{"name", "status", "reason", "disks", "samples", "usable_samples"}, {}};
  for (const auto& [name, path] : kPowderQuantities)
    for (const char* ending : {"", "_deviation", "_error"}) table.header.push_back(std::string(name) + ending);
  for (const std::string name : kCompared)
    for (const char* ending : {"_published", "_published_error", "_difference", "_difference_in_errors"})
      table.header.push_back(name + ending);
  for (const json& e : entries) {
    std::vector<std::string> row{e["name"],         e["status"],         e["reason"],
                                 e["disks"].dump(), e["samples"].dump(), e["usable_samples"].dump()};
    for (const auto& [name, path] : kPowderQuantities)
      for (const char* part : {"mean", "deviation", "error"})
        row.push_back(exact(e, fmt::format("/values/{}/{}", name, part)));
    for (const std::string name : kCompared)
      for (const char* part :
           {"published/{}/value", "published/{}/error", "difference/{}/value", "difference/{}/in_errors"})
        row.push_back(exact(e, "/" + fmt::format(fmt::runtime(part), name)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

TextTable powder_people_table(const json& entries) {
  TextTable table{{"variant", "status", "at rest"}, {}};
  for (const std::string name : kCompared)
    for (const char* ending : {"", " published", " difference (in errors)"}) table.header.push_back(name + ending);
  table.header.insert(table.header.end(), kShown.begin(), kShown.end());
  for (const json& e : entries) {
    std::vector<std::string> row{e["name"], e["status"], samples_text(e)};
    for (const std::string name : kCompared)
      row.insert(row.end(), {ours(e, name, "{:.4f}"), theirs(e, name), difference(e, name)});
    for (const std::string name : kShown) row.push_back(ours(e, name, "{:.4g}"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string powder_variant_line(const json& entry) {
  std::string line = entry["name"].get<std::string>() + ": ";
  for (const std::string name : kCompared) {
    if (has_status(entry, RunStatus::not_run)) break;
    const std::string published = theirs(entry, name);
    line += fmt::format("{} {}{}, ", name, ours(entry, name, "{:.4f}"),
                        published.empty() ? "" : " (published " + published + ")");
  }
  if (has_status(entry, RunStatus::not_run)) return line + "not run\n";
  line += samples_text(entry) + " samples at rest";
  const std::string reason = entry["reason"];
  return line + (reason.empty() ? "" : "; NOT USABLE: " + reason) + "\n";
}

}  // namespace softgrain

#include "pipelines/kinds/cohesive_powder/variants_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/variant_entry.h"
#include "pipelines/kinds/cohesive_powder/variant_table.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/run/run_summary.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// The summary in the directory of a variant; null when there is none.
json summary_of(const PowderVariant& variant, const RunContext& context) {
  const std::string path = context.path(variant.name + "/summary.json");
  if (!std::filesystem::exists(path)) return nullptr;
  const json summary = json::parse(read_text(path), nullptr, false);
  return summary.is_object() ? summary : json(nullptr);
}

/// Whether that summary is of the same scene and seed, so that another run would end in the same.
bool belongs(const json& summary, const PowderVariant& variant, const RunContext& context) {
  if (!summary.is_object() || !summary.contains("samples") || !summary.contains("provenance")) return false;
  const json& provenance = summary["provenance"];
  return provenance.value("scene", "") == variant.scene.text() &&
         provenance.value("seed", std::uint64_t{0}) == context.seed(variant.setup.seed) &&
         std::filesystem::exists(context.path(variant.name + "/powder.h5"));
}

/// A variant without result is one that has come to an end, not the end of all.
void run_variant(const PowderVariant& variant, const RunContext& context) {
  try {
    run_powder_ensemble(variant.setup, variant.scene, context.part(variant.name));
  } catch (const NotUsable& e) {
    context.say(fmt::format("{}: {}", variant.name, e.what()));
  }
}

/// The entry of a variant, which is run unless it has ended before or is left out. Always made from the summary in its
/// file, so that one run now and one run earlier give the same.
json entry_of(const PowderVariant& variant, const RunContext& context) {
  const json earlier = summary_of(variant, context);
  const bool known = belongs(earlier, variant, context);
  if (!variant.picked) return powder_variant_entry(variant, known ? earlier : json(nullptr));
  if (known && context.resume()) {
    context.say(variant.name + ": has ended before");
    return powder_variant_entry(variant, earlier);
  }
  run_variant(variant, context);
  return powder_variant_entry(variant, summary_of(variant, context));
}

/// After each variant, so that what is there can be looked at while the others run.
void write_tables(const json& entries, const RunContext& context) {
  write_text_atomic(context.path("table.csv"), as_csv(powder_data_table(entries)));
  write_text_atomic(context.path("table.md"), as_markdown(powder_people_table(entries)));
}

/// Samples that do not rest, and results that another build of the program left.
json remarks_on(const json& entries) {
  json remarks = json::array();
  const std::string commit = build_provenance().commit;
  for (const json& e : entries) {
    const std::string name = e["name"];
    if (const std::string reason = e["reason"]; !reason.empty()) remarks.push_back(name + ": " + reason);
    if (const std::string of = e["commit"]; !of.empty() && of != commit)
      remarks.push_back(fmt::format("{}: was run by another build of the program (commit {})", name, of));
  }
  return remarks;
}

}  // namespace

ExitStatus run_powder_variants(const Scene& scene, const CommonOptions& options) {
  const std::vector<PowderVariant> variants = read_powder_variants(scene);
  const RunContext context(options, "microsim", std::filesystem::path(scene.path()).stem().string());
  json entries = json::array();
  std::string people;
  bool usable = true;
  for (const PowderVariant& variant : variants) {
    entries.push_back(entry_of(variant, context));
    const std::string line = powder_variant_line(entries.back());
    if (variant.picked) context.say(line.substr(0, line.size() - 1));
    people += line;
    usable = usable && (!variant.picked || has_status(entries.back(), RunStatus::good));
    write_tables(entries, context);
  }
  const std::uint64_t seed = context.seed(variants.front().setup.seed);
  json summary{{"kind", "cohesive-powder"}, {"status", usable ? "good" : "not usable"}};
  summary["title"] = scene.root().text("title", "");
  summary["variants"] = entries;
  summary["remarks"] = remarks_on(entries);
  summary["files"] = {{"table", context.path("table.csv")}, {"table for people", context.path("table.md")}};
  summary["provenance"] = provenance_json(context.provenance(scene, seed));
  context.finish(summary, people + "tables: " + context.path("table.md") + ", " + context.path("table.csv"));
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain

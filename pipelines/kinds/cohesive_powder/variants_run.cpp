
#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/report/report.h"

namespace softgrain {

namespace {

/// The summary in the directory of a variant; empty when there is none.
std::optional<VariantRun> ended_run(const PowderVariant& variant, const RunContext& context) {
  const std::string path = context.path(variant.name + "/summary.json");
  if (!std::filesystem::exists(path)) return std::nullopt;
  const auto summary = nlohmann::json::parse(read_text(path), nullptr, false);
  if (!summary.is_object()) return std::nullopt;
  return VariantRun{record_of<AnySummary>(summary), record_of<PowderSummary>(summary)};
}

/// Whether that summary is of the same scene and seed, so that another run would end in the same.
bool belongs(const VariantRun& ended, const PowderVariant& variant, const RunContext& context) {
  const auto& provenance = ended.run.provenance;
  return provenance && !ended.powder.samples.empty() && provenance->scene == variant.scene.text() &&
         provenance->seed == context.seed(variant.setup.seed) &&
         std::filesystem::exists(context.path(variant.name + "/powder.h5"));
}

/// A variant without result is one that has come to an end, not the end of all.
void run_variant(const PowderVariant& variant, const RunContext& context) {
  try {
    run_powder_ensemble(variant.setup,
                        Run(context.part(variant.name), variant.scene, variant.setup.seed, powder_text(variant.setup)));
  } catch (const UnusableResult& e) {
    context.say(fmt::format("{}: {}", variant.name, e.what()));
  }
}

/// The entry of a variant, which is run unless it has ended before or is left out. Always made from the summary in its
/// file, so that one run now and one run earlier give the same.
VariantEntry entry_of(const PowderVariant& variant, const RunContext& context) {
  const auto earlier = ended_run(variant, context);
  const bool known = earlier && belongs(*earlier, variant, context);
  if (!variant.picked) return powder_variant_entry(variant, known ? &*earlier : nullptr);
  if (known && context.resume()) {
    context.say(variant.name + ": has ended before");
    return powder_variant_entry(variant, &*earlier);
  }
  run_variant(variant, context);
  const auto ended = ended_run(variant, context);
  return powder_variant_entry(variant, ended ? &*ended : nullptr);
}

/// Writes the tables after each variant, so that they can be looked at while the others run.
void write_tables(const std::vector<VariantEntry>& entries, const RunContext& context) {
  write_text_atomic(context.path("table.csv"), as_csv(powder_data_table(entries)));
  write_text_atomic(context.path("table.md"), as_markdown(powder_console_table(entries)));
}

/// Samples that do not rest, and results that another build of the program left.
std::vector<std::string> remarks_on(const std::vector<VariantEntry>& entries) {
  std::vector<std::string> remarks;
  const std::string commit = build_provenance().commit;
  for (const VariantEntry& e : entries) {
    if (!e.reason.empty()) remarks.push_back(e.name + ": " + e.reason);
    if (!e.commit.empty() && e.commit != commit)
      remarks.push_back(fmt::format("{}: was run by another build of the program (commit {})", e.name, e.commit));
  }
  return remarks;
}

}  // namespace

ExitStatus run_powder_variants(const Scene& scene, const CommonOptions& options) {
  const std::vector<PowderVariant> variants = read_powder_variants(scene);
  const RunContext context(options, "microsim", std::filesystem::path(scene.path()).stem().string());
  PowderVariantsSummary summary;
  std::vector<VariantEntry>& entries = summary.variants;
  std::string console;
  bool usable = true;
  for (const PowderVariant& variant : variants) {
    entries.push_back(entry_of(variant, context));
    const std::string line = powder_variant_line(entries.back());
    if (variant.picked) context.say(line.substr(0, line.size() - 1));
    console += line;
    usable = usable && (!variant.picked || entries.back().status == RunStatus::good);
    write_tables(entries, context);
  }
  const std::uint64_t seed = context.seed(variants.front().setup.seed);
  summary.head = {usable ? RunStatus::good : RunStatus::not_usable,
                  scene.root().text("title", ""),
                  remarks_on(entries),
                  {{"table", context.path("table.csv")},
                   {"table for people", context.path("table.md")},
                   {"report", context.path("report.html")}}};
  context.finish(json_of(summary), context.provenance(scene, seed),
                 console + "tables: " + context.path("table.md") + ", " + context.path("table.csv") +
                     "; report: " + context.path("report.html"));
  write_report(context.directory());
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain

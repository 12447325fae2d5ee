// Variants of a powder: read from a scene, and run one after another.
#include "pipelines/kinds/cohesive_powder/variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <set>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/report/report.h"
#include "pipelines/run/run.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

namespace {

/// What stands beside the variants in the directory of the run.
constexpr std::array kTakenNames{report::kFigureFolder, report::kCurveFolder, "work",    "summary.json", "log.txt",
                                 "report.html",         "table.csv",          "table.md"};

/// Keys of a variant that replace those of the scene.
constexpr std::array kReplacing{"title", "samples", "disks", "contact", "assembly", "analysis"};

/// Quantities that may be below 0: forces of both signs, what they are divided by, and slopes.
constexpr std::array kSigned{"mean_normal", "mean_tensile", "rumpf_ratio", "lambda", "alpha"};

Range published_range(const std::string& quantity) {
  const bool is_signed = std::ranges::find(kSigned, quantity) != kSigned.end();
  return is_signed ? Range::any() : Range::not_negative();
}

std::vector<PublishedValue> read_published(const SceneTable& t) {
  std::vector<PublishedValue> out;
  for (const std::string quantity : powder_comparable()) {
    const Key error{quantity + "_error", "error of the published value"};
    const bool there = t.has(quantity);
    if (there)
      out.push_back({quantity,
                     t.number({quantity, "published value, for comparison"}, Unit::none, published_range(quantity)),
                     std::nullopt});
    if (!t.has(error.name)) continue;
    const double value = t.number(error, Unit::none, Range::positive());
    if (there)
      out.back().error = value;
    else
      t.add_error(error.name, "without the value " + quantity);
  }
  return out;
}

/// The variant's own keys; those that replace keys of the scene are looked at where they end up.
void read_own(const SceneTable& t, PowderVariant& variant) {
  variant.name = read_variant_name(t);
  if (std::find(kTakenNames.begin(), kTakenNames.end(), variant.name) != kTakenNames.end())
    t.add_error("name", "is that of a file or folder beside the variants");
  variant.published = read_published(t.table_or_empty(
      {"published",
       "published values for comparison: `Phi`, `Phi_error` or any other quantity of `table.csv`, with its error; "
       "`z_plus`, `z_minus`, `z_zero`: compressive, tensile and unstressed interactions per disk"}));
  for (const char* key : kReplacing) (void)t.has(key);
}

void read_as_scene(PowderVariant& variant) {
  try {
    variant.setup = read_powder(variant.scene);
  } catch (const BadScene& e) {
    std::vector<SceneError> errors = e.errors();
    for (SceneError& m : errors) m.of = fmt::format(" (in the variant \"{}\")", variant.name);
    throw BadScene(e.file(), errors);
  }
}

/// Names after `only`, one alone also without brackets.
std::vector<std::string> read_only(const SceneTable& root) {
  const Key only{"only", "names of the variants to run", "all"};
  if (root.is_text(only.name)) return {root.text(only)};
  std::vector<std::string> names = root.texts(only);
  if (names.empty()) root.add_error(only.name, "at least one name is needed");
  return names;
}

void pick(const SceneTable& root, std::vector<PowderVariant>& variants) {
  if (!root.has("only")) return;
  std::vector<std::string> known;
  for (PowderVariant& v : variants) {
    known.push_back(v.name);
    v.picked = false;
  }
  for (const std::string& name : read_only(root)) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) {
      variants[static_cast<std::size_t>(found - known.begin())].picked = true;
      continue;
    }
    const std::string near = nearest_word(name, known);
    root.add_error("only", fmt::format("there is no variant \"{}\"; {}", name,
                                       near.empty() ? fmt::format("variants are {}", fmt::join(known, ", "))
                                                    : fmt::format("nearest is \"{}\"", near)));
  }
}

}  // namespace

bool has_powder_variants(const Scene& scene) { return scene.root().has("variant"); }

std::vector<PowderVariant> read_powder_variants(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    const std::vector<SceneTable> tables = root.tables(
        {"variant", "one of several powders of the scene; its tables replace those of the scene key by key"});
    if (tables.empty()) root.throw_error("variant", "at least one is needed");
    std::vector<PowderVariant> variants;
    std::set<std::string> names;
    for (const SceneTable& table : tables) {
      variants.push_back({.scene = scene.variant(variants.size(), {"only", "name", "published"})});
      read_own(table, variants.back());
      if (!names.insert(variants.back().name).second) table.add_error("name", "is used twice");
      table.check([&] { read_as_scene(variants.back()); });
    }
    for (const std::string& key : root.keys()) (void)root.has(key);  // those of the scene are theirs too
    pick(root, variants);
    return variants;
  });
}

namespace {

/// The summary in the directory of a variant; empty when there is none.
std::optional<VariantRun> ended_run(const PowderVariant& variant, const RunContext& context) {
  const std::string path = context.path(variant.name + "/summary.json");
  if (!std::filesystem::exists(path)) return std::nullopt;
  const auto summary = nlohmann::json::parse(read_text(path), nullptr, false);
  if (!summary.is_object()) return std::nullopt;
  return VariantRun{record_of<AnySummary>(summary), record_of<PowderSummary>(summary)};
}

/// Whether that summary is of the same scene, seed and files, so that another run would end in the same.
bool belongs(const VariantRun& ended, const PowderVariant& variant, const RunContext& context) {
  const auto& provenance = ended.run.provenance;
  return provenance && !ended.powder.samples.empty() && provenance->scene == variant.scene.text() &&
         provenance->seed == context.seed(variant.setup.seed) &&
         began_with(context.path(variant.name), powder_text(variant.setup)).value_or(true) &&
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
    complete_ended_run(context.path(variant.name));
    return powder_variant_entry(variant, &*earlier);
  }
  std::error_code ignored;  // what is no longer true must not outlive a run that fails
  if (!known) std::filesystem::remove(context.path(variant.name + "/summary.json"), ignored);
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
                  scene.root().title(),
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

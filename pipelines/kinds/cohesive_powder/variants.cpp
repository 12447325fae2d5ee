#include "pipelines/kinds/cohesive_powder/variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "common/core/error.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

namespace {

/// What stands beside the variants in the directory of the run.
constexpr std::array kTakenNames{"figures", "work", "summary.json", "log.txt", "report.html", "table.csv", "table.md"};

/// Keys of a variant that replace those of the scene.
constexpr std::array kReplacing{"title", "samples", "disks", "contact", "assembly", "analysis"};

std::vector<PublishedValue> read_published(const SceneTable& t) {
  std::vector<PublishedValue> out;
  for (const std::string quantity : powder_comparable()) {
    const Key error{quantity + "_error", "error of the published value"};
    const bool there = t.has(quantity);
    if (there)
      out.push_back(
          {quantity, t.number({quantity, "published value, for comparison"}, Unit::none, Range::any()), std::nullopt});
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

}  // namespace softgrain

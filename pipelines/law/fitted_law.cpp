#include "pipelines/law/fitted_law.h"

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

std::string file_in(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return path;
  for (const char* name : {"law_table.toml", "law.toml", "cell_law.toml"})
    if (std::filesystem::exists(path + "/" + name, ignored)) return path + "/" + name;
  throw InputError(path + ": a directory without law_table.toml, law.toml or cell_law.toml");
}

LawOrigin read_origin(const SceneTable& root) {
  const SceneTable t = root.table_or_empty("provenance");
  return {t.text("version", ""), t.text("commit", ""), t.text("command", ""), t.text("seed", "")};
}

decltype(FittedLaw::content) read_content(const Scene& file) {
  const SceneTable root = file.root();
  if (root.has("pair")) return load_card(file);
  if (root.has("entry")) return load_law_table(file);
  if (root.has("cell")) return read_cell_card(file);
  if (is_material_card(file))
    throw InputError(file.path() +
                     ": the card of a whole material, whose bodies no scene has: take the card of the cell law "
                     "that its recipe left beside it");
  throw InputError(file.path() +
                   ": neither a law card (it has no [[pair]]) nor a law table (it has no [[entry]]) nor a card of "
                   "the cell law (it has no [cell])");
}

}  // namespace

std::string kind_text(const FittedLaw& law) {
  if (law.cells() != nullptr) return "cell law";
  return law.card() != nullptr ? "law card" : "law table";
}

bool is_curve_file(const std::string& path) {
  const auto form = file_form(path);
  return form == FileForm::csv || form == FileForm::tsv || form == FileForm::txt || form == FileForm::dat;
}

FittedLaw load_law(const std::string& given) {
  const std::string path = file_in(given);
  if (is_curve_file(path))
    throw InputError(path + ": the table of a press test, not a law: softgrain calibrate fits one to it");
  if (std::filesystem::path(path).extension() == ".h5")
    throw InputError(path + ": give the card or table itself, the .toml beside it");
  return load_law(Scene::load(path));
}

FittedLaw load_law(const Scene& file) {
  return {read_content(file), file.path(), file.text(), read_origin(file.root())};
}

void read_refits(FittedLaw& law) {
  auto* table = std::get_if<LawTable>(&law.content);
  const auto has_refits = [](const LawTableEntry& e) {
    return std::ranges::any_of(e.laws, [](const MultiContactLaw& one) { return !one.replicates.empty(); });
  };
  if (table == nullptr || law.path.empty() || std::ranges::any_of(table->entries, has_refits)) return;
  read_replicates(*table, law.path);
}

bool is_material_card(const Scene& file) {
  const SceneTable root = file.root();
  return root.has("material") && root.table("material").has("phi_J");
}

}  // namespace softgrain

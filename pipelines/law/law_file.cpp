#include "pipelines/law/law_file.h"

#include <filesystem>

#include "common/core/error.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/scene.h"
#include "pipelines/law/law_file_kind.h"

namespace softgrain::law {

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

}  // namespace

LawFile load_law_file(const std::string& given) {
  LawFile out;
  out.path = file_in(given);
  if (std::filesystem::path(out.path).extension() == ".h5")
    throw InputError(out.path + ": give the card or table itself, the .toml beside it");
  const Scene text = Scene::load(out.path);
  const SceneTable root = text.root();
  const LawFileKind kind = law_file_kind(out.path);
  if (kind == LawFileKind::card) {
    out.card = load_card(out.path);
  } else if (kind == LawFileKind::cells) {
    out.cells = read_cell_card(out.path);
  } else {
    out.table = load_law_table(out.path);
    read_replicates(*out.table, out.path);
  }
  out.origin = read_origin(root);
  return out;
}

std::vector<double> even(double low, double high, std::size_t n) {
  std::vector<double> values;
  for (std::size_t k = 0; k < n; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(n - 1);
    values.push_back(k + 1 == n ? high : low + (high - low) * share);
  }
  return values;
}

}  // namespace softgrain::law

#include "pipelines/law/law_file_kind.h"

#include "common/io/scene.h"

namespace softgrain {

bool is_material_card(const std::string& path) {
  const Scene file = Scene::load(path);
  return file.root().has("material") && file.root().table("material").has("phi_J");
}

LawFileKind law_file_kind(const std::string& path) {
  const Scene file = Scene::load(path);
  if (file.root().has("pair")) return LawFileKind::card;
  if (file.root().has("entry")) return LawFileKind::table;
  if (file.root().has("cell")) return LawFileKind::cells;
  if (is_material_card(path))
    throw InputError(path +
                     ": the card of a whole material, whose bodies no scene has: take the card of the cell law "
                     "that its recipe left beside it");
  throw InputError(path +
                   ": neither a law card (it has no [[pair]]) nor a law table (it has no [[entry]]) nor a card of "
                   "the cell law (it has no [cell])");
}

}  // namespace softgrain

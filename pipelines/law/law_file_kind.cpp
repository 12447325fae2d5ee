#include "pipelines/law/law_file_kind.h"

#include "common/io/scene.h"

namespace softgrain {

LawFileKind law_file_kind(const std::string& path) {
  const Scene file = Scene::load(path);
  if (file.root().has("pair")) return LawFileKind::card;
  if (file.root().has("entry")) return LawFileKind::table;
  if (file.root().has("cell")) return LawFileKind::cells;
  throw BadInput(path +
                 ": neither a law card (it has no [[pair]]) nor a law table (it has no [[entry]]) nor a card of "
                 "the cell law (it has no [cell])");
}

}  // namespace softgrain

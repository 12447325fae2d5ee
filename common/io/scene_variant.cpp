// A scene with one of its variants laid over it.
#include <utility>

#include "common/core/error.h"
#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

/// Moves everything from `over` into `base`, and into tables of the same name. Nodes are moved because copies forget
/// the line that they came from.
void lay_over(SceneDocument& document, toml::table& base, toml::table& over) {
  for (auto&& [key, node] : over) {
    toml::table* below = base.get_as<toml::table>(key.str());
    if (below != nullptr && node.is_table()) {
      lay_over(document, *below, *node.as_table());
      continue;
    }
    const bool overridden = document.overridden.contains(&node);
    node.visit([&base, &name = key](auto& concrete) { base.insert_or_assign(name, std::move(concrete)); });
    if (overridden) document.overridden.insert(base.get(key.str()));
  }
}

toml::table take_variant(toml::table& root, std::size_t number) {
  toml::array* variants = root.get_as<toml::array>("variant");
  toml::node* one = variants == nullptr ? nullptr : variants->get(number);
  if (one == nullptr || !one->is_table()) throw InputError("no [[variant]] of number " + std::to_string(number));
  toml::table taken = std::move(*one->as_table());
  root.erase("variant");
  return taken;
}

}  // namespace

Scene Scene::variant(std::size_t number, const std::vector<std::string>& apart) const {
  auto document = read_document(document_->source, document_->name, document_->overrides);
  document->variant = "variant." + std::to_string(number);
  toml::table& root = *document->content;
  toml::table over = take_variant(root, number);
  for (const std::string& key : apart) {
    root.erase(key);
    over.erase(key);
  }
  lay_over(*document, root, over);
  std::string text = as_toml(root);
  return {path_, std::move(text), std::move(document)};
}

}  // namespace softgrain

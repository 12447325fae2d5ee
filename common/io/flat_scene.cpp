#include "common/io/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "common/core/text.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

using Flat = std::map<std::string, std::string>;

std::string text_of(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* list = node.as_array()) {
    std::string out;
    for (const toml::node& one : *list) append_part(out, text_of(one), ", ");
    return "[" + out + "]";
  }
  std::ostringstream out;  // dates, which no scene knows
  node.visit([&](const auto& concrete) { out << concrete; });
  return out.str();
}

bool holds_tables(const toml::array& list) {
  return !list.empty() && std::ranges::all_of(list, [](const toml::node& n) { return n.is_table(); });
}

void flatten(const toml::node& node, const std::string& path, Flat& out) {
  const auto below = [&](std::string_view key) {
    return path.empty() ? std::string(key) : path + "." + std::string(key);
  };
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) flatten(child, below(key.str()), out);
  } else if (const toml::array* list = node.as_array(); list != nullptr && holds_tables(*list)) {
    for (std::size_t k = 0; k < list->size(); ++k) flatten(*list->get(k), below(std::to_string(k)), out);
  } else {
    out[path] = text_of(node);
  }
}

}  // namespace

Flat flat_scene(const std::string& text, const std::string& name) {
  Flat out;
  flatten(parse_toml(text, name), "", out);
  return out;
}

}  // namespace softgrain

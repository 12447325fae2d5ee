// Tables of a scene: finding keys, places for messages, keys that nobody asked for.
#include <algorithm>
#include <sstream>

#include "common/core/error.h"
#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

constexpr std::size_t kLongestShown = 60;

std::string joined(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string number_text(double value) {
  std::ostringstream out;
  out.precision(15);
  out << value;
  return out.str();
}

std::string cut(const std::string& text) {
  return text.size() <= kLongestShown ? text : text.substr(0, kLongestShown) + "...";
}

/// As much as there is room for.
std::string shown_list(const toml::array& list) {
  std::string text = "[";
  for (const toml::node& element : list) {
    text += (text.size() > 1 ? ", " : " ") + shown(element);
    if (text.size() > kLongestShown) return cut(text);
  }
  return text + " ]";
}

}  // namespace

std::string shown(const toml::node& node) {
  if (const auto number = node.as_floating_point()) return number_text(number->get());
  if (const auto list = node.as_array(); list != nullptr && !list->empty()) return shown_list(*list);
  std::ostringstream out;
  if (const auto text = node.as_string()) {
    out << '"' << text->get() << '"';
  } else {
    node.visit([&](const auto& concrete) { out << concrete; });
  }
  std::string text = out.str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return cut(text);
}

const toml::node* SceneTable::Impl::find(const std::string& key) {
  known.insert(key);
  return content == nullptr ? nullptr : content->get(key);
}

const toml::node& SceneTable::Impl::require(const std::string& key) {
  if (const toml::node* node = find(key)) return *node;
  std::string message = place + ": missing key '" + key + "' " + location();
  std::vector<std::string> unused;
  if (content != nullptr)
    for (const auto& [name_here, node] : *content)
      if (!known.contains(std::string(name_here.str()))) unused.emplace_back(name_here.str());
  const std::string near = nearest_word(key, unused);
  if (!near.empty()) message += "; did '" + near + "' at " + where(near, *content->get(near)) + " mean it?";
  throw BadInput(message);
}

std::string SceneTable::Impl::location() const {
  if (name.empty()) return "at the top level";
  return element ? "in [[" + name + "]]" : "in [" + name + "]";
}

std::string SceneTable::Impl::where(const std::string& key, const toml::node& node) const {
  const auto line = node.source().begin.line;
  if (line == 0 || document->overridden.contains(&node)) return document->name + " (--set " + dotted(key) + ")";
  return document->name + ":" + std::to_string(line);
}

void SceneTable::Impl::reject(const std::string& key, const toml::node& node, const std::string& problem) const {
  const std::string value = node.is_table() || node.is_array_of_tables() ? "" : " = " + shown(node);
  throw BadInput(where(key, node) + ": " + key + value + ": " + problem);
}

std::shared_ptr<SceneTable::Impl> SceneTable::Impl::make_child(const std::string& key, const toml::table* table,
                                                               bool is_element) const {
  auto child = std::make_shared<Impl>();
  child->document = document;
  child->content = table;
  child->name = dotted(key);
  child->element = is_element;
  child->place = table == nullptr ? place : where(key, *table);
  return child;
}

void SceneTable::Impl::finish() const {
  const toml::node* first = nullptr;
  std::string first_key;
  if (content != nullptr)
    for (const auto& [key, node] : *content) {
      if (known.contains(std::string(key.str()))) continue;
      if (first != nullptr && first->source().begin.line <= node.source().begin.line) continue;
      first = &node;
      first_key = key.str();
    }
  if (first != nullptr) {
    const std::string near = nearest_word(first_key, {known.begin(), known.end()});
    const std::string help = !near.empty() ? "nearest known key is '" + near + "'" : "known keys are " + joined(known);
    throw BadInput(where(first_key, *first) + ": unknown key '" + first_key + "' " + location() +
                   (known.empty() ? "" : "; " + help));
  }
  for (const auto& [key, tables] : children)
    for (const auto& table : tables) table->finish();
}

bool SceneTable::has(const std::string& key) const { return impl_->find(key) != nullptr; }

bool SceneTable::is_text(const std::string& key) const {
  const toml::node* node = impl_->find(key);
  return node != nullptr && node->is_string();
}

bool SceneTable::is_list(const std::string& key) const {
  const toml::node* node = impl_->find(key);
  return node != nullptr && node->is_array();
}

SceneTable SceneTable::table(const std::string& key) const {
  if (!impl_->find(key)) throw BadInput(impl_->place + ": missing table [" + impl_->dotted(key) + "]");
  return table_or_empty(key);
}

SceneTable SceneTable::table_or_empty(const std::string& key) const {
  const toml::node* node = impl_->find(key);
  if (node != nullptr && !node->is_table()) impl_->reject(key, *node, "must be a table [" + impl_->dotted(key) + "]");
  auto& made = impl_->children[key];
  if (made.empty()) made.push_back(impl_->make_child(key, node == nullptr ? nullptr : node->as_table(), false));
  return SceneTable(made.front());
}

std::vector<SceneTable> SceneTable::tables(const std::string& key) const {
  const toml::node* node = impl_->find(key);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  const std::string problem = "must be an array of tables [[" + impl_->dotted(key) + "]]";
  if (array == nullptr) impl_->reject(key, *node, problem);
  auto& made = impl_->children[key];
  if (made.empty())
    for (const toml::node& element : *array) {
      if (!element.is_table()) impl_->reject(key, element, problem);
      made.push_back(impl_->make_child(key, element.as_table(), true));
    }
  std::vector<SceneTable> result;
  for (const auto& table : made) result.emplace_back(table);
  return result;
}

std::vector<std::string> SceneTable::keys() const {
  std::vector<std::string> names;
  if (impl_->content == nullptr) return names;
  for (const auto& [key, node] : *impl_->content) names.emplace_back(key.str());
  return names;
}

SceneTable SceneTable::named(const std::string& key) const { return table(key); }

std::string SceneTable::where(const std::string& key) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? impl_->place : impl_->where(key, *node);
}

void SceneTable::reject(const std::string& key, const std::string& problem) const {
  if (const toml::node* node = impl_->find(key)) impl_->reject(key, *node, problem);
  throw BadInput(impl_->place + ": " + key + ": " + problem);
}

void SceneTable::finish() const { impl_->finish(); }

}  // namespace softgrain

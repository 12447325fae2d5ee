// Tables of a scene: finding keys, places for messages, keys that nobody asked for.
#include <algorithm>
#include <sstream>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

constexpr std::size_t kLongestShown = 60;

std::string cut(const std::string& text) {
  return text.size() <= kLongestShown ? text : text.substr(0, kLongestShown) + "...";
}

/// The list as text, as much of it as there is room for.
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
  if (const auto number = node.as_floating_point()) return rounded_text(number->get(), {15});
  if (const auto list = node.as_array(); list != nullptr && !list->empty()) return shown_list(*list);
  std::ostringstream out;
  if (const auto text = node.as_string()) {
    out << '"' << text->get() << '"';
  } else {
    node.visit([&](const auto& concrete) { out << concrete; });
  }
  return cut(on_one_line(out.str()));
}

const toml::node* SceneTable::Impl::find(const std::string& key) {
  known.insert(key);
  note_asked(key, {});
  return content == nullptr ? nullptr : content->get(key);
}

const toml::node& SceneTable::Impl::require(const std::string& key) {
  if (const toml::node* node = find(key)) return *node;
  if (document->errors && (missing || misread)) throw BadScene(document->name, {});
  std::string message = place + ": missing key '" + key + "' " + location();
  std::vector<std::string> unused;
  if (content != nullptr)
    for (const auto& [name_here, node] : *content)
      if (!known.contains(std::string(name_here.str()))) unused.emplace_back(name_here.str());
  const std::string near = nearest_word(key, unused);
  if (!near.empty()) {
    message += "; did '" + near + "' at " + where(near, *content->get(near)) + " mean it?";
    if (document->errors) document->errors->meant.insert(dotted(near));
  }
  throw BadScene(document->name, {{.line = line, .text = message}});
}

std::string SceneTable::Impl::location() const {
  if (name.empty()) return "at the top level";
  return element ? "in [[" + name + "]]" : "in [" + name + "]";
}

std::size_t SceneTable::Impl::line_of(const toml::node& node) const {
  return document->overridden.contains(&node) ? 0 : node.source().begin.line;
}

std::string SceneTable::Impl::where(const std::string& key, const toml::node& node) const {
  const std::size_t at = line_of(node);
  return document->name +
         (at == 0 ? " (--set " + (path.empty() ? key : path + "." + key) + ")" : ":" + std::to_string(at));
}

SceneError SceneTable::Impl::error_at(const std::string& key, const toml::node* node,
                                      const std::string& problem) const {
  const std::string name_of_key = on_one_line(key);
  if (node == nullptr) return {.line = line, .text = place + ": " + name_of_key + ": " + problem};
  const std::string value = node->is_table() || node->is_array_of_tables() ? "" : " = " + shown(*node);
  return {.line = line_of(*node), .text = where(key, *node) + ": " + name_of_key + value + ": " + problem};
}

void SceneTable::Impl::throw_error(const std::string& key, const toml::node& node, const std::string& problem) const {
  throw BadScene(document->name, {error_at(key, &node, problem)});
}

void SceneTable::Impl::note(const Error& error) {
  const auto* own = dynamic_cast<const BadScene*>(&error);
  if (own != nullptr && own->file() == document->name)
    for (const SceneError& m : own->errors()) document->errors->note(m);
  else if (!any(&Impl::replaced))
    document->errors->note({.line = line, .text = error.what()});
  wrong = true;
}

bool SceneTable::Impl::any(bool Impl::*what) const {
  if (this->*what) return true;
  for (const auto& [key, tables] : children)
    for (const auto& table : tables)
      if (table->any(what)) return true;
  return false;
}

std::shared_ptr<SceneTable::Impl> SceneTable::Impl::make_child(const std::string& key, const toml::table* table,
                                                               bool is_element) const {
  auto child = std::make_shared<Impl>();
  child->document = document;
  child->content = table;
  child->name = on_one_line(dotted(key));
  child->path = path.empty() ? key : path + "." + key;
  child->element = is_element;
  child->place = table == nullptr ? place : where(key, *table);
  child->line = table == nullptr ? line : line_of(*table);
  return child;
}

/// Which key of this table --set gave, where `node` stands in the file: a value that it replaced may have asked for the
/// others. Empty: none, or the whole table is of --set.
std::string SceneTable::Impl::setting_beside(const toml::node& node) const {
  if (content == nullptr || path.empty() || document->overridden.contains(&node)) return "";
  for (const auto& [other, value] : *content)
    if (document->overridden.contains(&value))
      return "with --set " + path + "." + std::string(other.str()) + " it may no longer fit: --set '" + path +
             "={...}' replaces the whole table";
  return "";
}

void SceneTable::Impl::find_key(const std::string& key, bool as_setting, std::set<std::string>& out) const {
  if (known.contains(key))
    out.insert(as_setting ? "'" + (path.empty() ? key : path + "." + key) + "'" : "'" + key + "' " + location());
  for (const auto& [name_here, tables] : children)
    for (const auto& table : tables) table->find_key(key, as_setting, out);
}

/// What to write instead of an unknown key. A key of this name in another table is meant more probably than another
/// name here: "--set mu=0.5" means "material.mu".
std::string SceneTable::Impl::help_for_unknown(const std::string& key, const toml::node& node, const Impl& top) const {
  constexpr std::size_t kMostTables = 3;
  std::set<std::string> elsewhere;
  top.find_key(key, document->overridden.contains(&node), elsewhere);
  if (elsewhere.size() == 1) return "nearest known key is " + *elsewhere.begin();
  if (!elsewhere.empty() && elsewhere.size() <= kMostTables) return "nearest known keys are " + join_text(elsewhere);
  const std::string near = nearest_word(key, {known.begin(), known.end()});
  if (!near.empty()) return "nearest known key is '" + near + "'";
  return known.empty() ? "" : "known keys are " + join_text(known);
}

void SceneTable::Impl::find_unknown(std::vector<SceneError>& out, const Impl& top) const {
  if (broken) return;
  std::vector<std::string> absent;
  for (const std::string& key : known)
    if (content == nullptr || !content->contains(key)) absent.push_back(key);
  if (content != nullptr)
    for (const auto& [name_here, node] : *content) {
      const std::string key(name_here.str());
      if (known.contains(key)) continue;
      if (document->errors && document->errors->meant.contains(dotted(key))) continue;
      // With a word that is not that of the file other keys may have been asked for: then only typing errors count.
      if (misread && nearest_word(key, absent).empty()) continue;
      const std::string help = help_for_unknown(key, node, top);
      const std::string scope = out_of_scope_text(key) + (help.starts_with("nearest") ? "" : setting_beside(node));
      out.push_back({.line = line_of(node),
                     .text = where(key, node) + ": unknown key '" + on_one_line(key) + "' " + location() +
                             (help.empty() ? "" : "; " + help) + (scope.empty() ? "" : "; " + scope)});
    }
  for (const auto& [key, tables] : children)
    for (const auto& table : tables) table->find_unknown(out, top);
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

SceneTable SceneTable::table(const Key& key) const {
  const bool there = impl_->value(
      [&] {
        if (impl_->find(key.name) != nullptr) return true;
        const auto before = impl_->children.find(key.name);
        const bool said = before != impl_->children.end() && !before->second.empty() && before->second.front()->missing;
        if (impl_->missing || said) throw BadScene(impl_->document->name, {});
        const std::string why = key.meaning.empty() ? "" : ": " + key.meaning;
        throw BadScene(
            impl_->document->name,
            {{.line = impl_->line, .text = impl_->place + ": missing table [" + impl_->dotted(key.name) + "]" + why}});
      },
      false);
  SceneTable table = table_or_empty(key);
  if (!there) table.impl_->missing = table.impl_->replaced = true;
  return table;
}

SceneTable SceneTable::table_or_empty(const Key& key) const {
  const toml::node* node = impl_->find(key.name);
  const toml::table* table = impl_->value(
      [&] {
        if (node != nullptr && !node->is_table())
          impl_->throw_error(key.name, *node, "must be a table [" + impl_->dotted(key.name) + "]");
        return node == nullptr ? nullptr : node->as_table();
      },
      static_cast<const toml::table*>(nullptr));
  impl_->note_asked(key, {.form = KeyForm::table});
  auto& made = impl_->children[key.name];
  if (made.empty()) {
    made.push_back(impl_->make_child(key.name, table, false));
    made.front()->missing = made.front()->replaced = node != nullptr && table == nullptr;
  }
  return SceneTable(made.front());
}

std::vector<SceneTable> SceneTable::tables(const Key& key) const {
  const toml::node* node = impl_->find(key.name);
  impl_->note_asked(key, {.form = KeyForm::tables});
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  auto& made = impl_->children[key.name];
  const auto make = [&] {
    const std::string problem = "must be an array of tables [[" + impl_->dotted(key.name) + "]]";
    if (array == nullptr) impl_->throw_error(key.name, *node, problem);
    for (const toml::node& element : *array) {
      if (!element.is_table()) impl_->throw_error(key.name, element, problem);
      made.push_back(impl_->make_child(key.name, element.as_table(), true));
      made.back()->path += "." + std::to_string(made.size() - 1);
      if (made.back()->line == 0) made.back()->place = impl_->document->name + " (--set " + made.back()->path + ")";
    }
    return true;
  };
  if (made.empty()) (void)impl_->value(make, false);
  std::vector<SceneTable> result;
  for (const auto& table : made) result.emplace_back(table);
  return result;
}

std::vector<std::string> SceneTable::keys() const {
  std::vector<std::string> names;
  if (KeyRecord* const record = KeyRecord::current()) record->note_free(impl_->document->name, impl_->path);
  if (impl_->content == nullptr) return names;
  for (const auto& [key, node] : *impl_->content) names.emplace_back(key.str());
  return names;
}

SceneTable SceneTable::named(const Key& key) const { return table(key); }

std::string SceneTable::path() const { return impl_->path; }

std::string SceneTable::where(const std::string& key) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? impl_->place : impl_->where(key, *node);
}

void SceneTable::throw_error(const std::string& key, const std::string& problem) const {
  const toml::node* node = impl_->find(key);
  const bool again = impl_->document->errors != nullptr && !impl_->blamed.insert(key).second;
  if (again || impl_->any(&Impl::replaced)) throw BadScene(impl_->document->name, {});
  throw BadScene(impl_->document->name, {impl_->error_at(key, node, problem)});
}

void SceneTable::add_error(const std::string& key, const std::string& problem) const {
  check([&] { throw_error(key, problem); });
}

bool SceneTable::has_errors() const { return impl_->any(&Impl::wrong); }

void SceneTable::section(const std::function<void()>& read) const {
  bool whole = false;
  check([&] {
    read();
    whole = true;
  });
  impl_->broken = impl_->broken || !whole;
}

void SceneTable::check(const std::function<void()>& rule) const {
  try {
    rule();
  } catch (const InputError& e) {
    if (impl_->document->errors == nullptr) throw;
    impl_->note(e);
  }
}

void SceneTable::finish() const {
  std::vector<SceneError> unknown;
  impl_->find_unknown(unknown, *impl_);
  if (!unknown.empty()) throw BadScene(impl_->document->name, unknown);
}

}  // namespace softgrain

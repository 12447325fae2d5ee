// From text to a document: syntax, overrides, and back to text.
#include <filesystem>
#include <sstream>
#include <utility>

#include "common/core/error.h"
#include "common/io/scene_impl.h"
#include "common/io/text_file.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream in(path);
  for (std::string part; std::getline(in, part, '.');) parts.push_back(part);
  return parts;
}

/// A table with the one key "value". What is not TOML and does not begin like a TOML container or string is a bare
/// word.
toml::table parse_value(const std::string& value, const std::string& setting) {
  std::string problem;
  try {
    toml::table table = toml::parse("value = " + value);
    if (table.size() == 1) return table;
  } catch (const toml::parse_error& e) {
    problem = e.description();
  } catch (const TomlAssertion&) {
    problem = "not valid TOML";
  }
  if (!problem.empty() && !value.empty() && std::string("[{\"'").find(value.front()) != std::string::npos)
    throw InputError("--set " + setting + ": " + problem);
  return toml::table{{"value", value}};
}

/// The child under `part` on the way to the key that is set; missing tables are made.
toml::node& descend(toml::node& parent, const std::string& part, const std::string& setting) {
  if (toml::array* array = parent.as_array()) {
    const bool digits = !part.empty() && part.size() < 10 && part.find_first_not_of("0123456789") == std::string::npos;
    toml::node* element = digits ? array->get(std::stoul(part)) : nullptr;
    if (element == nullptr)
      throw InputError("--set " + setting + ": '" + part + "' " +
                       (array->empty() ? "names an entry, and there is none"
                                       : "must be a number from 0 to " + std::to_string(array->size() - 1)));
    return *element;
  }
  toml::table* table = parent.as_table();
  if (table == nullptr) throw InputError("--set " + setting + ": what stands before '." + part + "' is not a table");
  if (toml::node* child = table->get(part)) return *child;
  return table->insert(part, toml::table{}).first->second;
}

/// Puts `value` under `key` of a table or array and returns the new node.
const toml::node& assign(toml::node& parent, const std::string& key, toml::node& value, const std::string& setting) {
  if (toml::table* table = parent.as_table()) {
    value.visit([&](auto& concrete) { table->insert_or_assign(key, std::move(concrete)); });
    return *table->get(key);
  }
  if (!parent.is_array()) throw InputError("--set " + setting + ": what stands before '." + key + "' is not a table");
  descend(parent, key, setting);  // checks the index
  toml::array& array = *parent.as_array();
  const std::size_t index = std::stoul(key);
  const auto place = array.cbegin() + static_cast<std::ptrdiff_t>(index);
  value.visit([&](auto& concrete) { array.replace(place, std::move(concrete)); });
  return *array.get(index);
}

/// Lines inside a value from the command line say nothing about the file.
void note_overridden(SceneDocument& document, const toml::node& node) {
  document.overridden.insert(&node);
  if (const toml::table* table = node.as_table())
    for (const auto& [key, child] : *table) note_overridden(document, child);
  if (const toml::array* array = node.as_array())
    for (const toml::node& child : *array) note_overridden(document, child);
}

/// Applies one "a.b.c=value". Elements of arrays are counted from 0: "contact.0.mu=0.5". Throws InputError.
void apply_override(SceneDocument& document, const std::string& setting) {
  const std::size_t mark = setting.find('=');
  const std::string path = trimmed(setting.substr(0, mark));
  if (mark == std::string::npos || path.empty())
    throw InputError("--set " + setting + ": must be of the form key=value");
  const std::vector<std::string> parts = split(current_key(path));
  for (const std::string& part : parts)
    if (part.empty() || path.back() == '.') throw InputError("--set " + setting + ": a part of the key is empty");
  if (parts.size() > kMostKeyParts)
    throw InputError("--set " + path.substr(0, 20) + "...: a key of more than " + std::to_string(kMostKeyParts) +
                     " parts");
  toml::table value = parse_value(trimmed(setting.substr(mark + 1)), setting);
  toml::node* parent = document.content.get();
  for (std::size_t k = 0; k + 1 < parts.size(); ++k) parent = &descend(*parent, parts[k], setting);
  note_overridden(document, assign(*parent, parts.back(), *value.get("value"), setting));
}

}  // namespace

std::string as_toml(const toml::table& table) {
  std::ostringstream out;
  out << table << "\n";
  return out.str();
}

std::shared_ptr<SceneDocument> read_document(const std::string& text, const std::string& name,
                                             const std::vector<std::string>& overrides) {
  auto document = std::make_shared<SceneDocument>();
  document->name = name;
  document->source = text;
  document->overrides = overrides;
  document->content = std::make_shared<toml::table>(parse_toml(text, name));
  rename_old_keys(*document);
  for (const std::string& setting : overrides) apply_override(*document, setting);
  return document;
}

Scene Scene::load(const std::string& path, const std::vector<std::string>& overrides) {
  const std::string text = read_text(path);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw InputError(path + ":1: the text is UTF-16; save it as UTF-8");
  return parse(text, path, overrides);
}

Scene Scene::parse(const std::string& text, const std::string& name, const std::vector<std::string>& overrides) {
  auto document = read_document(text, name, overrides);
  std::string used = overrides.empty() ? text : as_toml(*document->content);
  return {name, std::move(used), std::move(document)};
}

Scene::Scene(const std::string& name, std::string text, std::shared_ptr<SceneDocument> document)
    : document_(document), path_(name), text_(std::move(text)), root_(std::make_shared<SceneTable::Impl>()) {
  root_->content = document->content.get();
  root_->place = name + ":1";
  root_->line = 1;
  root_->document = std::move(document);
}

SceneTable Scene::root() const { return SceneTable(root_); }

std::string SceneTable::resolve(const std::string& relative) const {
  const std::filesystem::path given(relative);
  if (given.is_absolute()) return relative;
  return (std::filesystem::path(impl_->document->name).parent_path() / given).lexically_normal().string();
}

std::string Scene::resolve(const std::string& relative) const { return root().resolve(relative); }

}  // namespace softgrain

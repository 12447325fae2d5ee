// All errors of a scene in one message.
#include <algorithm>
#include <span>
#include <utility>

#include "common/core/text.h"
#include "common/io/scene_impl.h"

namespace softgrain {

namespace {

constexpr std::size_t kMostShown = 20;

/// What is not of the file comes last.
bool earlier(const SceneError& a, const SceneError& b) {
  return b.line == 0 ? a.line > 0 : a.line > 0 && a.line < b.line;
}

std::vector<SceneError> in_file_order(std::vector<SceneError> errors) {
  std::stable_sort(errors.begin(), errors.end(), earlier);
  return errors;
}

std::string message_of(const std::string& file, const std::vector<SceneError>& errors) {
  std::string text = join_text(std::span(errors).first(std::min(errors.size(), kMostShown)), "\n",
                               [](const SceneError& e) { return e.text + e.of; });
  if (errors.size() > kMostShown) text += "\n" + file + ": " + std::to_string(errors.size() - kMostShown) + " more";
  return text;
}

}  // namespace

BadScene::BadScene(const std::string& file, std::vector<SceneError> errors)
    : InputError(message_of(file, in_file_order(errors))), file_(file), errors_(in_file_order(std::move(errors))) {}

void SceneErrors::note(const SceneError& error) {
  if (noted.emplace(error.line, error.text).second) all.push_back(error);
}

void Scene::collect(const std::function<void()>& reader) const {
  SceneErrors errors;
  const auto end = [this](SceneErrors*) { document_->errors = nullptr; };
  document_->errors = &errors;
  const std::unique_ptr<SceneErrors, decltype(end)> collecting(&errors, end);
  try {
    reader();
    root().finish();
  } catch (const Error& e) {
    if (errors.all.empty() && dynamic_cast<const BadScene*>(&e) == nullptr) throw;
    root_->note(e);
  }
  if (!errors.all.empty()) throw BadScene(path_, std::move(errors.all));
}

}  // namespace softgrain

// All mistakes of a scene in one message.
#include <algorithm>
#include <utility>

#include "common/io/scene_impl.h"

namespace softgrain {

namespace {

constexpr std::size_t kMostShown = 20;

/// What is not of the file comes last.
bool earlier(const SceneMistake& a, const SceneMistake& b) {
  return b.line == 0 ? a.line > 0 : a.line > 0 && a.line < b.line;
}

std::vector<SceneMistake> in_file_order(std::vector<SceneMistake> mistakes) {
  std::stable_sort(mistakes.begin(), mistakes.end(), earlier);
  return mistakes;
}

std::string message_of(const std::string& file, const std::vector<SceneMistake>& mistakes) {
  std::string text;
  for (std::size_t k = 0; k < std::min(mistakes.size(), kMostShown); ++k)
    text += (k == 0 ? "" : "\n") + mistakes[k].text + mistakes[k].of;
  if (mistakes.size() > kMostShown) text += "\n" + file + ": " + std::to_string(mistakes.size() - kMostShown) + " more";
  return text;
}

}  // namespace

BadScene::BadScene(const std::string& file, std::vector<SceneMistake> mistakes)
    : BadInput(message_of(file, in_file_order(mistakes))), file_(file), mistakes_(in_file_order(std::move(mistakes))) {}

void SceneMistakes::note(const SceneMistake& mistake) {
  if (noted.emplace(mistake.line, mistake.text).second) all.push_back(mistake);
}

void Scene::collect(const std::function<void()>& reader) const {
  SceneMistakes mistakes;
  const auto end = [this](SceneMistakes*) { document_->mistakes = nullptr; };
  document_->mistakes = &mistakes;
  const std::unique_ptr<SceneMistakes, decltype(end)> collecting(&mistakes, end);
  try {
    reader();
    root().finish();
  } catch (const Error& e) {
    if (mistakes.all.empty() && dynamic_cast<const BadScene*>(&e) == nullptr) throw;
    root_->note(e);
  }
  if (!mistakes.all.empty()) throw BadScene(path_, std::move(mistakes.all));
}

}  // namespace softgrain

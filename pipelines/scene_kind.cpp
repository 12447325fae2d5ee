#include "pipelines/scene_kind.h"

#include <array>

namespace softgrain {

namespace {

struct Kind {
  const char* name;
  const char* command;
};

constexpr std::array<Kind, 10> kKinds{{{"pipeline", "run"},
                                       {"macro-comparison", "run"},
                                       {"law-table", "run"},
                                       {"hierarchy", "run"},
                                       {"inverse", "run"},
                                       {"soft-particle", "microsim"},
                                       {"particles", "microsim"},
                                       {"grain-box", "microsim"},
                                       {"cohesive-powder", "microsim"},
                                       {"macro", "macrosim"}}};

}  // namespace

void refuse_other_commands(const SceneTable& root, const std::string& command) {
  if (!root.is_text("kind")) return;
  const std::string kind = root.text("kind");
  for (const Kind& k : kKinds)
    if (kind == k.name && command != k.command)
      root.reject("kind", "scenes of this kind run with softgrain " + std::string(k.command) + ", not with " + command);
}

}  // namespace softgrain

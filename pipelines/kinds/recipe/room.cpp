// Numbers of grains with which periodic cells of a recipe have room for the images of their largest grains.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/recipe/scene.h"

namespace softgrain {

namespace {

/// require_room(), packing by packing.
class RoomForImages {
 public:
  RoomForImages(const SceneTable& root, RecipeScene& scene) : root_(root), scene_(scene) {}

  void require() {
    for (std::size_t v = 0; v < scene_.material.variants.size(); ++v) {
      MaterialVariant& variant = scene_.material.variants[v];
      if (variant.same_packings) {
        variant.setup.spec.bodies = scene_.material.variants[v - 1].setup.spec.bodies;
        continue;
      }
      const bool check = scene_.checked == v;
      const MaterialVariant* sheared = v + 1 < scene_.material.variants.size() ? &variant + 1 : nullptr;
      MacroSetup widest = variant.setup;
      if (sheared != nullptr && sheared->same_packings) widen(widest, *sheared);
      variant.setup.spec.bodies =
          enough(widest, check ? "check" : "grains", check ? "grains" : "count", "packing " + variant.name);
      if (check) scene_.check.grains = variant.setup.spec.bodies;
    }
    MacroSetup coarsest = scene_.material.variants.front().setup;
    take_sizes(coarsest.spec, Grading::classes(scene_.levels[0].pieces));
    coarsest.spec.bodies = scene_.macro.grains;
    coarsest.samples = scene_.macro.samples;
    scene_.macro.grains = enough(coarsest, "macro", "grains", "the coarsest level under load");
  }

 private:
  /// Room for both tests of a packing.
  static void widen(MacroSetup& setup, const MaterialVariant& sheared) {
    const MacroSpec& other = sheared.setup.spec;
    if (setup.spec.test != MacroTest::stages)
      setup.spec.strain_end = std::max(setup.spec.strain_end, other.strain_end + other.preload);
    else if (rough_strains(other).largest_axial > rough_strains(setup.spec).largest_axial)
      setup.spec.stages = other.stages;
  }

  /// Number of grains in this packing: those asked for or more.
  std::int64_t enough(MacroSetup setup, const char* table, const char* key, const std::string& what) {
    constexpr std::int64_t kDearest = 5;  // times the default: what is dearer should be asked for
    const std::int64_t asked = setup.spec.bodies;
    const SceneTable t = root_.table_or_empty(table);
    const auto seed = scene_.material.seed;
    if (const std::string problem = room_problem(setup, seed, "grains"); t.has(key) && !problem.empty())
      t.throw_error(key, fmt::format("{}: {} ([{}] {}){}; levels closer to each other ([levels] ratio) take fewer",
                                     what, problem, table, key, std::string(key) == "count" ? enough_for_all() : ""));
    const std::string doubt = room_doubt(setup, seed, "grains");
    if (doubt.empty()) return asked;
    if (t.has(key)) {
      scene_.doubts.push_back(fmt::format("{}: {} ([{}] {})", what, doubt, table, key));
      return asked;
    }
    setup.spec.bodies = std::max(asked, least_bodies(setup.spec));
    while (setup.spec.bodies <= kDearest * asked && !room_doubt(setup, seed, "grains").empty())
      setup.spec.bodies += std::max<std::int64_t>(1, setup.spec.bodies / 10);
    if (setup.spec.bodies > kDearest * asked)
      t.throw_error(key, fmt::format("{}: {} ([{}] {}); levels closer to each other ([levels] ratio) take fewer", what,
                                     doubt, table, key));
    scene_.raised.push_back(
        fmt::format("{}: {} grains in place of the default {} ([{}] {}), for a periodic cell with room", what,
                    setup.spec.bodies, asked, table, key));
    return setup.spec.bodies;
  }

  /// Whether all packings of levels, of so many grains each, can be placed. Sizes are drawn anew for each number.
  bool all_have_room(std::int64_t bodies) const {
    for (std::size_t v = 0; v < scene_.material.variants.size(); ++v) {
      if (scene_.material.variants[v].same_packings || scene_.checked == v) continue;
      MacroSetup setup = scene_.material.variants[v].setup;
      setup.spec.bodies = bodies;
      if (!room_problem(setup, scene_.material.seed, "grains").empty()) return false;
    }
    return true;
  }

  /// For a message about the first packing that has no room.
  std::string enough_for_all() const {
    constexpr std::int64_t kStep = 100;
    std::int64_t bodies = scene_.material.variants.front().setup.spec.bodies / kStep * kStep + kStep;
    while (!all_have_room(bodies)) bodies += std::max(kStep, bodies / (20 * kStep) * kStep);
    return fmt::format("; {} are enough to place every packing", bodies);
  }

  const SceneTable& root_;
  RecipeScene& scene_;
};

}  // namespace

void require_room(const SceneTable& root, RecipeScene& scene) { RoomForImages(root, scene).require(); }

}  // namespace softgrain

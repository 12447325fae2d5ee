// What softgrain does not model, by the keys that people ask for it with.
#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "common/io/scene.h"

namespace softgrain {

namespace {

struct OutOfScope {
  std::string_view word;  ///< the key, or one of its parts between '_'
  std::string_view what;
};

constexpr std::string_view kShapes = "non-spherical grains";
constexpr std::string_view kBreakage = "breakage or bonds";
constexpr std::string_view kCohesion = "cohesion of spheres (powders of disks have it)";
constexpr std::string_view kFluids = "fluids";
constexpr std::string_view kMeshes = "walls from meshes";
constexpr std::string_view kHeat = "heat";
constexpr std::string_view kGravity = "gravity here (explicit particles, kind \"particles\", have it)";

constexpr std::array kOutOfScope{
    OutOfScope{"shapes", kShapes},     OutOfScope{"shape", kShapes},        OutOfScope{"aspect_ratio", kShapes},
    OutOfScope{"aspect", kShapes},     OutOfScope{"clump", kShapes},        OutOfScope{"clumps", kShapes},
    OutOfScope{"polyhedra", kShapes},  OutOfScope{"superquadric", kShapes}, OutOfScope{"sphericity", kShapes},
    OutOfScope{"roundness", kShapes},  OutOfScope{"breakage", kBreakage},   OutOfScope{"fragmentation", kBreakage},
    OutOfScope{"fracture", kBreakage}, OutOfScope{"crushing", kBreakage},   OutOfScope{"strength", kBreakage},
    OutOfScope{"bond", kBreakage},     OutOfScope{"bonds", kBreakage},      OutOfScope{"cohesion", kCohesion},
    OutOfScope{"cohesive", kCohesion}, OutOfScope{"adhesion", kCohesion},   OutOfScope{"surface_energy", kCohesion},
    OutOfScope{"jkr", kCohesion},      OutOfScope{"capillary", kCohesion},  OutOfScope{"fluid", kFluids},
    OutOfScope{"fluids", kFluids},     OutOfScope{"liquid", kFluids},       OutOfScope{"water", kFluids},
    OutOfScope{"viscosity", kFluids},  OutOfScope{"drag", kFluids},         OutOfScope{"cfd", kFluids},
    OutOfScope{"mesh", kMeshes},       OutOfScope{"meshes", kMeshes},       OutOfScope{"stl", kMeshes},
    OutOfScope{"temperature", kHeat},  OutOfScope{"heat", kHeat},           OutOfScope{"gravity", kGravity}};

/// Whether `word` is the key, or stands in it between two '_' or at an end.
bool has_word(std::string_view key, std::string_view word) {
  for (std::size_t at = key.find(word); at != std::string_view::npos; at = key.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || key[at - 1] == '_') && (end == key.size() || key[end] == '_')) return true;
  }
  return false;
}

}  // namespace

std::string out_of_scope_text(const std::string& key) {
  std::string lower = key;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const OutOfScope& one : kOutOfScope)
    if (has_word(lower, one.word))
      return "softgrain has no " + std::string(one.what) + ": see README, 'What it is not for'";
  return "";
}

}  // namespace softgrain

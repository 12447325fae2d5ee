#include "pipelines/compare/compare_inputs.h"

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;
constexpr PairKind kKinds[] = {PairKind::soft_solid, PairKind::soft_soft};

CompareSide load_directory(const std::string& path) {
  CompareSide side;
  const auto exists = [&](const char* file) { return fs::exists(path + "/" + file); };
  if (exists("macro.h5")) side.macro = load_macro(path + "/macro.h5");
  if (exists("measurements.h5")) side.measurements = load_measurements(path + "/measurements.h5");
  if (exists("law.toml")) side.card = load_card(path + "/law.toml");
  return side;
}

CompareSide load_one_file(const std::string& path) {
  CompareSide side;
  const std::string file = fs::path(path).filename().string();
  const std::string ending = fs::path(path).extension().string();
  if (ending == ".toml") {
    side.card = load_card(path);
  } else if (ending == ".h5" && file.find("macro") != std::string::npos) {
    side.macro = load_macro(path);
  } else if (ending == ".h5") {
    side.measurements = load_measurements(path);
  } else {
    throw BadInput(path + ": expected a run directory, macro.h5, measurements.h5 or law.toml");
  }
  return side;
}

std::vector<std::string> engines_of(const std::vector<MacroCurve>& curves) {
  std::vector<std::string> result;
  for (const MacroCurve& c : curves) {
    if (std::find(result.begin(), result.end(), c.engine) == result.end()) result.push_back(c.engine);
  }
  return result;
}

using NamePairs = std::vector<std::pair<std::string, std::string>>;

/// Equal names on both sides; without any, the first of each side.
NamePairs match_names(const std::vector<std::string>& candidate, const std::vector<std::string>& reference) {
  NamePairs pairs;
  for (const std::string& name : candidate) {
    if (std::find(reference.begin(), reference.end(), name) != reference.end()) pairs.emplace_back(name, name);
  }
  if (pairs.empty() && !candidate.empty() && !reference.empty())
    pairs.emplace_back(candidate.front(), reference.front());
  return pairs;
}

/// Runs one comparison; what is wrong with its data becomes a remark, so that the other comparisons still appear.
template <class Compare>
void attempt(CompareResult& result, const std::string& what, Compare&& compare) {
  try {
    compare();
  } catch (const ZeroReference& error) {
    result.undefined.push_back(what + ": " + error.what());
  } catch (const BadInput& error) {
    result.remarks.push_back(what + ": " + error.what());
  }
}

void compare_engines(CompareResult& result, const std::vector<MacroCurve>& candidate,
                     const std::vector<MacroCurve>& reference, const NamePairs& pairs) {
  for (const auto& [a, b] : pairs) {
    attempt(result, "macro, " + a + " against " + b, [&, &a = a, &b = b] {
      result.macro.push_back({a, b, compare_curves(curves_of(candidate, a), curves_of(reference, b))});
      for (const std::string& one : result.macro.back().result.undefined)
        result.undefined.push_back("macro, " + a + " against " + b + ": " + one);
    });
  }
}

StiffnessAngles angles_of(const CompareSide& side, PairKind kind) {
  const PairLaw* law = side.card ? side.card->find(kind) : nullptr;
  if (law == nullptr) return {};
  return {law->initial_angle_deg, law->secant_angle_deg};
}

void compare_relaxed(CompareResult& result, const CompareSide& candidate, const CompareSide& reference, PairKind kind) {
  const auto pairs =
      match_names(relaxations_of(*candidate.measurements, kind), relaxations_of(*reference.measurements, kind));
  for (const auto& [a, b] : pairs) {
    attempt(result, "measurements, " + to_string(kind), [&, &a = a, &b = b] {
      result.measurements.push_back(compare_measurements(*candidate.measurements, a, *reference.measurements, b, kind,
                                                         angles_of(reference, kind)));
    });
  }
}

void compare_kinds(CompareResult& result, const CompareSide& candidate, const CompareSide& reference) {
  for (const PairKind kind : kKinds) {
    if (candidate.measurements && reference.measurements) compare_relaxed(result, candidate, reference, kind);
    if (candidate.card && reference.card && candidate.card->find(kind) != nullptr &&
        reference.card->find(kind) != nullptr) {
      result.laws.push_back({kind, compare_laws(*candidate.card, *reference.card, kind)});
    }
  }
}

/// Every other relaxation of the same measurements against the published protocol, where that was run.
void compare_with_published(CompareResult& result, const CompareSide& side, PairKind kind) {
  const auto names = relaxations_of(*side.measurements, kind);
  if (std::find(names.begin(), names.end(), "published") == names.end()) return;
  for (const std::string& name : names) {
    if (name == "published") continue;
    attempt(result, "relaxations, " + to_string(kind), [&] {
      result.relaxations.push_back(
          compare_relaxations(*side.measurements, "published", name, kind, angles_of(side, kind)));
    });
  }
}

void require_something(const CompareResult& result) {
  if (!result.undefined.empty() || !result.macro.empty() || !result.relaxations.empty() ||
      !result.measurements.empty() || !result.laws.empty())
    return;
  const std::string why = result.remarks.empty() ? "the sides hold no data of the same kind" : result.remarks.front();
  throw BadInput("compare: nothing can be compared: " + why);
}

}  // namespace

CompareSide load_side(const std::string& path) {
  if (!fs::exists(path)) throw FileTrouble(path + ": no such file or directory");
  CompareSide side = fs::is_directory(path) ? load_directory(path) : load_one_file(path);
  side.name = path;
  if (side.macro.empty() && !side.measurements && !side.card) {
    throw BadInput(path + ": holds nothing to compare (macro.h5, measurements.h5 or law.toml)");
  }
  return side;
}

CompareResult compare_sides(const CompareSide& candidate, const CompareSide& reference) {
  CompareResult result;
  compare_engines(result, candidate.macro, reference.macro,
                  match_names(engines_of(candidate.macro), engines_of(reference.macro)));
  compare_kinds(result, candidate, reference);
  require_something(result);
  return result;
}

CompareResult compare_within(const CompareSide& side) {
  CompareResult result;
  const auto engines = engines_of(side.macro);
  const auto has = [&](const char* name) { return std::find(engines.begin(), engines.end(), name) != engines.end(); };
  if (has("law") && has("shelled")) compare_engines(result, side.macro, side.macro, {{"law", "shelled"}});
  for (const PairKind kind : kKinds)
    if (side.measurements) compare_with_published(result, side, kind);
  require_something(result);
  return result;
}

}  // namespace softgrain

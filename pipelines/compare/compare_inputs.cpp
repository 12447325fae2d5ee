#include "pipelines/compare/compare_inputs.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "microsim/protocol.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

/// What load_side() takes from a directory.
constexpr const char* kComparedFiles = "macro.h5, material.h5, material_NAME.h5, measurements.h5 or law.toml";

/// material.h5, or material_NAME.h5 of several materials, whose curves are then called by their names.
std::vector<MacroCurve> load_materials(const std::string& path) {
  const std::string kind = "material";
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string file = entry.path().stem().string();
    if (entry.path().extension() != ".h5" || !file.starts_with(kind) || holds_packings(file, kind)) continue;
    if (file == kind || file[kind.size()] == '_') files[file] = entry.path().string();
  }
  std::vector<MacroCurve> curves;
  for (const auto& [file, place] : files)
    for (MacroCurve& c : load_macro(place)) {
      if (file != kind) c.engine = file.substr(kind.size() + 1);
      curves.push_back(std::move(c));
    }
  return curves;
}

}  // namespace

bool holds_packings(const std::string& name, const std::string& kind) {
  return name == kind + "_initial" || name.starts_with(kind + "_initial_");
}

namespace {

CompareSide load_directory(const std::string& path) {
  CompareSide side;
  const auto exists = [&](const char* file) { return fs::exists(path + "/" + file); };
  side.macro = exists("macro.h5") ? load_macro(path + "/macro.h5") : load_materials(path);
  if (exists("measurements.h5")) side.measurements = load_measurements(path + "/measurements.h5");
  if (exists("law.toml")) side.card = load_card(path + "/law.toml");
  return side;
}

CompareSide load_one_file(const std::string& path) {
  CompareSide side;
  const std::string file = fs::path(path).filename().string();
  const auto form = file_form(path);
  if (form == FileForm::toml) {
    side.card = load_card(path);
  } else if (form == FileForm::hdf5 && (file.find("macro") != std::string::npos || file.starts_with("material"))) {
    side.macro = load_macro(path);
  } else if (form == FileForm::hdf5) {
    side.measurements = load_measurements(path);
  } else {
    throw InputError(path + ": expected a run directory, " + kComparedFiles);
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
  } catch (const InputError& error) {
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

/// Curves of the same test and sample; of the same sample where the two sides share no test.
Differences macro_differences(const std::vector<MacroCurve>& candidate, const std::vector<MacroCurve>& reference) {
  Differences same_test;
  Differences same_sample;
  bool any = false;
  for (const MacroCurve& a : candidate)
    for (const MacroCurve& b : reference) {
      if (a.sample != b.sample) continue;
      any = any || a.test == b.test;
      (a.test == b.test ? same_test : same_sample).add(differences(a, b));
    }
  return any ? same_test : same_sample;
}

Differences all_differences(const CompareSide& candidate, const CompareSide& reference, const NamePairs& engines) {
  Differences out;
  for (const auto& [a, b] : engines)
    out.add(macro_differences(curves_of(candidate.macro, a), curves_of(reference.macro, b)));
  if (candidate.measurements && reference.measurements) {
    out.add(differences(candidate.measurements->spec, reference.measurements->spec));
    if (candidate.measurements->shell_turns != reference.measurements->shell_turns)
      out.said.emplace_back("the first shell turned with its grains on one side alone");
    if (candidate.measurements->turn != reference.measurements->turn)
      out.said.emplace_back("kt was measured by a frozen turn on one side, by a slow turn on the other");
  }
  if (candidate.card && reference.card) out.add(differences(candidate.card->spec, reference.card->spec));
  return out;
}

void refuse(const CompareSide& candidate, const CompareSide& reference, const std::vector<std::string>& obstacles) {
  std::string text;
  for (const std::string& one : obstacles) text += "\n  " + one;
  throw InputError(
      "compare: " + candidate.name + " and " + reference.name +
      " are not of the same, and a difference of their results would say nothing (--different compares them "
      "all the same):" +
      text);
}

/// One test stands for another: what is asked for with --different.
void rename_test(std::vector<MacroCurve>& reference, const std::vector<MacroCurve>& candidate) {
  const auto same = [](const std::vector<MacroCurve>& curves) {
    return std::all_of(curves.begin(), curves.end(),
                       [&](const MacroCurve& c) { return c.test == curves.front().test; });
  };
  if (candidate.empty() || reference.empty() || !same(candidate) || !same(reference)) return;
  for (MacroCurve& c : reference) c.test = candidate.front().test;
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
      const char* others = "packings: not the same ones on both sides; how they scatter is in the errors";
      if (!result.measurements.back().paired &&
          std::find(result.differences.begin(), result.differences.end(), others) == result.differences.end())
        result.differences.emplace_back(others);
    });
  }
}

void compare_kinds(CompareResult& result, const CompareSide& candidate, const CompareSide& reference) {
  for (const PairKind kind : kPairKinds) {
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
  const std::string published = to_string(Relaxation::published);
  if (std::find(names.begin(), names.end(), published) == names.end()) return;
  for (const std::string& name : names) {
    if (name == published) continue;
    attempt(result, "relaxations, " + to_string(kind), [&] {
      result.relaxations.push_back(
          compare_relaxations(*side.measurements, published, name, kind, angles_of(side, kind)));
    });
  }
}

void require_something(const CompareResult& result) {
  if (!result.undefined.empty() || !result.macro.empty() || !result.relaxations.empty() ||
      !result.measurements.empty() || !result.laws.empty())
    return;
  const std::string why = result.remarks.empty() ? "the sides hold no data of the same kind" : result.remarks.front();
  throw InputError("compare: nothing can be compared: " + why);
}

}  // namespace

CompareSide load_side(const std::string& path) {
  if (!fs::exists(path)) throw IoError(path + ": no such file or directory");
  CompareSide side = fs::is_directory(path) ? load_directory(path) : load_one_file(path);
  side.name = path;
  if (side.macro.empty() && !side.measurements && !side.card) {
    throw InputError(path + ": holds nothing to compare (" + kComparedFiles + ")");
  }
  return side;
}

CompareResult compare_sides(const CompareSide& candidate, const CompareSide& reference, bool different) {
  CompareResult result;
  const NamePairs engines = match_names(engines_of(candidate.macro), engines_of(reference.macro));
  const Differences found = all_differences(candidate, reference, engines);
  if (!found.obstacles.empty() && !different) refuse(candidate, reference, found.obstacles);
  result.differences = found.obstacles;
  result.differences.insert(result.differences.end(), found.said.begin(), found.said.end());
  std::vector<MacroCurve> curves = reference.macro;
  if (different) rename_test(curves, candidate.macro);
  compare_engines(result, candidate.macro, curves, engines);
  compare_kinds(result, candidate, reference);
  require_something(result);
  return result;
}

CompareResult compare_within(const CompareSide& side) {
  CompareResult result;
  const auto engines = engines_of(side.macro);
  const auto has = [&](const char* name) { return std::find(engines.begin(), engines.end(), name) != engines.end(); };
  if (has("law") && has("shelled")) {
    const Differences found = macro_differences(curves_of(side.macro, "law"), curves_of(side.macro, "shelled"));
    for (const auto* list : {&found.obstacles, &found.said})
      result.differences.insert(result.differences.end(), list->begin(), list->end());
    compare_engines(result, side.macro, side.macro, {{"law", "shelled"}});
  }
  for (const PairKind kind : kPairKinds)
    if (side.measurements) compare_with_published(result, side, kind);
  require_something(result);
  return result;
}

}  // namespace softgrain

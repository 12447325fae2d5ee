// What to do next, at the end of every report, in two lines.
#include <algorithm>

#include "common/io/scene.h"
#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/set_summary.h"

namespace softgrain::report {
namespace {

/// The key `kind` of the scene that the run was made from; empty without.
std::string kind_of_scene(const AnySummary& summary) {
  if (!summary.provenance || summary.provenance->scene.empty()) return "";
  try {
    const auto keys = flat_scene(summary.provenance->scene, "scene");
    const auto at = keys.find("kind");
    return at == keys.end() ? "" : at->second;
  } catch (const InputError&) {
    return "";
  }
}

NextSteps steps_of_set(const RunData& run) {
  const auto set = run.summary_as<SetSummary>();
  if (set.over.empty() && set.seeds.empty())
    return {"Error norms of runs that are not of the same bodies or materials: `softgrain compare ... --different`.",
            "One scene over many values of a key, in one go: `softgrain sweep SCENE.toml --over key=a,b,c`."};
  const std::string more = set.seeds.size() > 1
                               ? "Standard errors fall with the square root of the number of seeds: "
                               : "How much of a difference is scatter: with several seeds (`--seeds 1..4`) ";
  return {more + "the same command with more values or seeds and `--resume` adds runs and repeats none.",
          "Two of the runs in detail: `softgrain compare " + run.directory + "/" + set.runs.front().directory + " " +
              run.directory + "/" + set.runs.back().directory + "`."};
}

/// Next steps for a card fitted to measurements, of an experiment or of this program.
NextSteps steps_of_card(const RunData& run) {
  return {"Values with 95 % intervals: `softgrain law eval " + run.directory +
              "/law.toml --delta 0.1 0.2`; in a scene: `softgrain macrosim "
              "SCENE.toml --law " +
              run.directory + "/law.toml`.",
          "More samples at the largest overlaps narrow a and b, more near the threshold delta."};
}

NextSteps steps_of(const RunData& run, const AnySummary& summary) {
  if (is_set(run)) return steps_of_set(run);
  const std::string kind = kind_of_scene(summary);
  for (const KindResults& one : results_of_kinds())
    if (kind == one.kind && one.next != nullptr) return one.next(run);
  return run.card ? steps_of_card(run) : NextSteps{};
}

/// Escaped, with what stands in backquotes as code.
std::string marked_up(const std::string& text) {
  std::string out;
  bool code = false;
  std::string part;
  const auto close = [&] {
    out += code ? "<code>" + escape(part) + "</code>" : escape(part);
    part.clear();
  };
  for (const char c : text) {
    if (c != '`') {
      part += c;
      continue;
    }
    close();
    code = !code;
  }
  close();
  return out;
}

}  // namespace

std::string next_section(const RunData& run) {
  const auto summary = run.summary_as<AnySummary>();
  NextSteps steps = steps_of(run, summary);
  if (steps.empty()) return "";
  if (!summary.status.empty() && !is_good(summary.status))
    steps.insert(steps.begin(),
                 "First: what the run is marked for, at the head of this page; `softgrain check` says what "
                 "the scene asks for and how long that takes.");
  constexpr std::size_t kLines = 2;
  std::string items;
  for (std::size_t k = 0; k < std::min(steps.size(), kLines); ++k) items += "<li>" + marked_up(steps[k]) + "</li>\n";
  return section("next", "What to do next", "Commands that go on from this run.", "<ul>\n" + items + "</ul>\n");
}

}  // namespace softgrain::report

// What a macro scene came to: summary.json of its run, which the report reads back.
#pragma once

#include "pipelines/results/summary.h"

namespace softgrain {

/// The law that a run took, and the file that it stands in.
struct RunLaw {
  LawIdentity identity;
  std::string file;
};

void fields(auto&& visit, Of<RunLaw> auto& s) {
  fields(visit, s.identity);
  visit("file", s.file);
}

struct MacroRunSummary {
  SummaryHead head;
  std::optional<RunLaw> law;
  MacroSummary runs;
  std::optional<EngineUse> engine;
};

void fields(auto&& visit, Of<MacroRunSummary> auto& s) {
  fields(visit, s.head);
  visit("law", s.law, kLeftOut);
  fields(visit, s.runs);
  visit("engine", s.engine, kLeftOut);
}

}  // namespace softgrain

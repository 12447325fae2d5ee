// What a run of kind "example" came to: its summary.json, which the report reads back.
#pragma once

#include <string>
#include <vector>

#include "pipelines/results/kind_results.h"
#include "pipelines/results/summary.h"

namespace softgrain {

struct ExampleImpact {
  double speed = 0.0;        ///< [m/s]
  double duration = 0.0;     ///< of the contact, integrated [s]
  double closed_form = 0.0;  ///< the same by Hertz [s]
};

void fields(auto&& visit, Of<ExampleImpact> auto& s) {
  visit("speed", s.speed, Means{"speed of the impact", "m/s"});
  visit("duration", s.duration, Means{"duration of the contact, integrated", "s"});
  visit("closed_form", s.closed_form, Means{"duration of the contact by the closed form of Hertz", "s"});
}

struct ExampleSummary {
  SummaryHead head;
  std::string grain;  ///< the grain in words
  std::vector<ExampleImpact> impacts;
};

void fields(auto&& visit, Of<ExampleSummary> auto& s) {
  fields(visit, s.head);
  visit("grain", s.grain, Means{"the grain in words"});
  visit("impacts", s.impacts, Means{"all impacts, in the order of the scene"});
}

/// Files, sections, head lines and numbers of the kind.
KindResults example_results();

}  // namespace softgrain

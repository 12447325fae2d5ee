#include "pipelines/kinds/grain_box/results.h"

#include <fmt/format.h>

#include "microsim/grain_box/record.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using namespace report;

void check_grain_box_file(const std::string& path, Findings& out) {
  out.add("kind", "grain boxes", fmt::format("grain boxes: {} packs", load_grain_boxes(path).size()));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return {};
  if (boxes->size() > 3) return {{"Packs", fmt::format("{} packs of grains.", boxes->size())}};
  std::vector<HeadLine> lines;
  for (const GrainBoxResult& r : *boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty()) continue;
    lines.emplace_back(
        "Pack " + r.spec.name,
        fmt::format("{} grains, {} loading to a confining stress of {} MPa; {} states.", format_count(r.spec.grains),
                    r.spec.loading.test, format_number(points.back()->pressure * 1e-6, 4), r.state.points.size()));
  }
  return lines;
}

}  // namespace

KindResults grain_box_results() {
  return {.files = {{.names = "grain_box\\.h5",
                     .is = [](const h5::Group& root) { return root.has("packs"); },
                     .check = check_grain_box_file,
                     .visit = visit_grain_boxes}},
          .sections = {{Place::grain_boxes, grain_box_section}},
          .lines = lines_of};
}

}  // namespace softgrain

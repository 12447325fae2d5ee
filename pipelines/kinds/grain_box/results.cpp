#include "pipelines/kinds/grain_box/scene.h"

#include <fmt/format.h>

#include "microsim/grain_box/record.h"
#include "pipelines/kinds/grain_box/curves.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using namespace report;

void check_grain_box_file(const std::string& path, Findings& out) {
  out.add("kind", "grain boxes", fmt::format("grain boxes: {} packs", load_grain_boxes(path).size()));
}

/// "E = 70 GPa, nu = 0.2, radii 0.07 to 0.13 mm"
HeadLine grains_line(const GrainBoxMaterial& m) {
  return {"Grains",
          fmt::format("E = {} GPa, nu = {:g}, radii {} to {} mm.", format_number(1e-9 * m.youngs_modulus),
                      m.poisson_ratio, format_number(1e3 * m.radius_min, 3), format_number(1e3 * m.radius_max, 3))};
}

std::vector<HeadLine> lines_of(const RunData& run) {
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return {};
  std::vector<HeadLine> lines;
  if (!boxes->empty()) lines.push_back(grains_line(boxes->front().spec.material));
  if (boxes->size() > 3) {
    lines.emplace_back("Packs", fmt::format("{} packs of grains.", boxes->size()));
    return lines;
  }
  for (const GrainBoxResult& r : *boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty()) continue;
    lines.emplace_back("Pack " + r.spec.name,
                       fmt::format("{} grains, mu = {:g}, {} loading to a confining stress of {} MPa; {} states.",
                                   format_count(r.spec.grains), r.spec.friction, r.spec.loading.test,
                                   format_number(points.back()->pressure * 1e-6, 4), r.state.points.size()));
  }
  return lines;
}

/// Values of the last state of the loading.
std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return out;
  for (const GrainBoxResult& r : *boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty()) continue;
    const std::string of = boxes->size() > 1 ? " (" + r.spec.name + ")" : "";
    out.push_back({"confining stress at the end" + of, "Pa", points.back()->pressure});
    out.push_back({"coordination number at the end" + of, "", points.back()->coordination});
    out.push_back({"sliding contacts at the end" + of, "%", 100.0 * points.back()->sliding_share});
  }
  return out;
}

std::vector<RunCurve> curves_of_run(const RunData& run) {
  std::vector<RunCurve> out;
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return out;
  for (const GrainBoxResult& r : *boxes) {
    const Series s = over_strain(r, [](const BoxPoint& p) { return p.pressure; }, 1.0, {});
    out.push_back({"Confining stress", "strain along the main axis [%]", "confining stress", "Pa",
                   boxes->size() > 1 ? r.spec.name : "", s.x, s.y});
  }
  return out;
}

NextSteps next_of(const RunData& run) {
  return {"Errors of K, G and sliding shares: `--set arrangements=4` makes every pack several times.",
          "What the moduli depend on: `softgrain sweep SCENE.toml --over material.mu=0.2,0.4`; states elsewhere: "
          "`softgrain export " +
              run.directory + " --to vtp`."};
}

}  // namespace

KindResults grain_box_results() {
  return {.files = {{.names = "grain_box\\.h5",
                     .is = [](const h5::Group& root) { return root.has("packs"); },
                     .check = check_grain_box_file,
                     .visit = visit_grain_boxes}},
          .sections = {{Part::states, grain_box_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of_run,
          .next = next_of};
}

}  // namespace softgrain

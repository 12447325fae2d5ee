// The report of kind "example": a table and a plot of all impacts.
#include <fmt/format.h>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"
#include "tests/example_kind/summary.h"

namespace softgrain {

namespace report {
namespace {

std::string example_section(const RunData& run) {
  const auto summary = run.summary_as<ExampleSummary>();
  if (run.kind() != "example" || summary.impacts.empty()) return "";
  HtmlTable table({"speed [m/s]", "duration [s]", "closed form [s]"});
  Series points{.label = "integrated", .hover = "integrated", .x = {}, .y = {}};
  Series curve{.label = "Hertz", .hover = "Hertz", .x = {}, .y = {}};
  for (const ExampleImpact& i : summary.impacts) {
    table.row({format_number(i.speed), format_number(i.duration, 6), format_number(i.closed_form, 6)});
    points.x.push_back(i.speed);
    points.y.push_back(i.duration);
    curve.x.push_back(i.speed);
    curve.y.push_back(i.closed_form);
  }
  points.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 3.0};
  curve.style = {.color = palette::blue, .width = 1.6};
  Plot plot({.id = "example-durations",
             .title = "Duration of the contact",
             .x = {.label = "speed [m/s]", .scale = Scale::logarithmic},
             .y = {.label = "duration [s]", .scale = Scale::logarithmic}});
  plot.add(std::move(curve));
  plot.add(std::move(points));
  return section("example", "Impacts", "How long a contact lasts at every speed, beside the closed form of Hertz.",
                 figure_row({figure(plot.svg(), "Duration over speed.")}) + table.html());
}

}  // namespace
}  // namespace report

namespace {

std::vector<HeadLine> lines_of(const report::RunData& run) {
  if (run.kind() != "example") return {};
  return {{"Grains", run.summary_as<ExampleSummary>().grain}};
}

std::vector<RunValue> values_of(const report::RunData& run) {
  std::vector<RunValue> out;
  if (run.kind() != "example") return out;
  for (const ExampleImpact& i : run.summary_as<ExampleSummary>().impacts)
    out.push_back({fmt::format("duration at {:.4g} m/s", i.speed), "s", i.duration});
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {"Whether the durations depend on the step: `softgrain sweep SCENE.toml --over impacts.steps=100,1000`.",
          "The numbers for a spreadsheet: `impacts.csv` in " + run.directory + "."};
}

}  // namespace

KindResults example_results() {
  return {.files = {{.names = "impacts\\.csv"}},
          .sections = {{Part::answer, report::example_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain

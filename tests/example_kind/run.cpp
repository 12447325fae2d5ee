#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/core/parallel_tasks.h"
#include "common/core/text.h"
#include "common/io/text_file.h"
#include "pipelines/run/typed_kind.h"
#include "tests/example_kind/scene.h"
#include "tests/example_kind/summary.h"

namespace softgrain {

namespace {

/// Duration of a contact by velocity Verlet steps of one `steps`-th of the closed form: F = 4/3 E* sqrt(R) h^(3/2).
double integrated_duration(const ExampleSetup& setup, double speed) {
  const double mass = 4.0 / 3.0 * std::numbers::pi * std::pow(setup.radius, 3) * setup.density;
  const double modulus = setup.youngs_modulus / (1.0 - setup.poisson_ratio * setup.poisson_ratio);
  const double stiffness = 4.0 / 3.0 * modulus * std::sqrt(setup.radius);
  const double step = hertz_duration(setup, speed) / static_cast<double>(setup.steps);
  double overlap = 0.0;
  double velocity = speed;
  double force = 0.0;
  for (double time = 0.0;; time += step) {
    velocity -= 0.5 * step * force / mass;
    const double before = overlap;
    overlap += step * velocity;
    if (overlap <= 0.0) return time + step * before / (before - overlap);
    force = stiffness * overlap * std::sqrt(overlap);
    velocity -= 0.5 * step * force / mass;
  }
}

/// An impact as an earlier part of the run kept it.
const KeptForm<ExampleImpact>& kept_impact() {
  static const KeptForm<ExampleImpact> form{
      .format = "softgrain example impact 1",
      .prefix = "impact-",
      .again = "the impact is integrated",
      .read =
          [](const h5::Group& g) {
            return ExampleImpact{g.number("speed"), g.number("duration"), g.number("closed_form")};
          },
      .write =
          [](const h5::Group& g, const ExampleImpact& impact) {
            g.attribute("speed", impact.speed);
            g.attribute("duration", impact.duration);
            g.attribute("closed_form", impact.closed_form);
          }};
  return form;
}

std::vector<ExampleImpact> run_impacts(const ExampleSetup& setup, const Run& run) {
  std::vector<ExampleImpact> impacts(setup.speeds.size());
  parallel_tasks(std::ssize(impacts), [&](std::int64_t k) {
    const double speed = setup.speeds[static_cast<std::size_t>(k)];
    impacts[static_cast<std::size_t>(k)] = run.get_or_make(kept_impact(), fmt::format("impact-{}", k), "", "", [&] {
      return ExampleImpact{speed, integrated_duration(setup, speed), hertz_duration(setup, speed)};
    });
  });
  return impacts;
}

RunInputs inputs_of(const ExampleSetup& setup) { return {.seed = setup.seed}; }

Outcome run_example(const ExampleSetup& setup, const Run& run) {
  ExampleSummary summary;
  run.guard([&] { summary.impacts = run_impacts(setup, run); });
  TextTable table{{"speed [m/s]", "duration [s]", "closed form [s]"}, {}};
  std::string console;
  for (const ExampleImpact& i : summary.impacts) {
    table.rows.push_back(
        {fmt::format("{:.9g}", i.speed), fmt::format("{:.9g}", i.duration), fmt::format("{:.9g}", i.closed_form)});
    console +=
        fmt::format("  {:.4g} m/s: contact of {:.4g} s (closed form {:.4g} s)\n", i.speed, i.duration, i.closed_form);
  }
  write_text_atomic(run.path("impacts.csv"), as_csv(table));
  summary.head.title = setup.title;
  summary.head.files = {{"impacts", run.path("impacts.csv")}, {"report", run.path("report.html")}};
  summary.grain = fmt::format("radius {:.4g} m, {:.4g} kg/m^3, E = {:.4g} Pa, nu = {:.3g}", setup.radius, setup.density,
                              setup.youngs_modulus, setup.poisson_ratio);
  return {json_of(summary), console};
}

/// As SceneKind::starter.
constexpr const char* kExampleStarter = R"(title = "Impacts of a grain"
[grain]
radius = "5 mm"
E = "70 GPa"
[impacts]
speeds = [0.1, 1.0]
)";

}  // namespace

SceneKind example_kind() {
  return scene_kind(TypedKind<ExampleSetup>{.name = "example",
                                            .command = "run",
                                            .read = read_example,
                                            .inputs = inputs_of,
                                            .run = run_example,
                                            .check = check_example,
                                            .results = example_results(),
                                            .summary = members_of<ExampleSummary>,
                                            .starter = kExampleStarter});
}

}  // namespace softgrain

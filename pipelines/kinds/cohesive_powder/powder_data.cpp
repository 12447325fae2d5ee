#include "pipelines/kinds/cohesive_powder/powder_data.h"

#include <fmt/format.h>

#include "microsim/powder/powder_state_io.h"

namespace softgrain {
namespace {

constexpr std::size_t kCourseColumns = 7;

/// The published picture of a pack with rolling resistance colours contacts below it as unstressed [CP 3.5].
constexpr double kRollingIdleColour = 1e-2;

std::vector<PowderMoment> read_course(const h5::Group& group) {
  const auto rows = group.doubles("course");
  std::vector<PowderMoment> out;
  for (std::size_t k = 0; k + kCourseColumns <= rows.size(); k += kCourseColumns)
    out.push_back({rows[k + 1], rows[k + 2], rows[k + 3], rows[k + 4]});
  return out;
}

std::optional<FittedCurve> read_scattering(const h5::Group& group) {
  if (!group.has("scattering")) return std::nullopt;
  const h5::Group g = group.open("scattering");
  FittedCurve out;
  out.curve = {g.doubles("k"), g.doubles("intensity"), g.doubles("modes")};
  out.model = {g.number("amplitude"), g.number("dF"), g.number("xi"), g.number("c")};
  out.usable = g.integer("fit_usable") != 0;
  out.k_low = g.number("fit_k_low");
  out.k_high = g.number("fit_k_high");
  return out;
}

PowderSample read_sample(const h5::Group& group, const PowderSpec& spec) {
  PowderSample out;
  out.usable = group.integer("usable") != 0;
  out.course = read_course(group);
  out.stages = read_stages(group);
  const System<2> system = read_powder_system(group, spec);
  out.packing = powder_snapshot(system);
  out.contacts = contact_records(system);
  out.snapshots = read_snapshots(group);
  out.scattering = read_scattering(group);
  return out;
}

}  // namespace

PowderRun load_powder(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  const PowderSpec spec = read_powder_spec(root.open("spec"));
  PowderRun run;
  run.cohesive = spec.cohesive;
  if (spec.rolling) run.idle_colour = kRollingIdleColour;
  for (std::size_t k = 0; root.has(fmt::format("sample_{}", k)); ++k)
    run.samples.push_back(read_sample(root.open(fmt::format("sample_{}", k)), spec));
  run.scattering = read_scattering(root);
  return run;
}

}  // namespace softgrain

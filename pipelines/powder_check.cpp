// softgrain check of powders.
#include <fmt/format.h>

#include <cmath>

#include "pipelines/powder_command.h"
#include "pipelines/powder_variants.h"

namespace softgrain {

namespace {

using nlohmann::json;

std::string check_setup(const PowderSetup& setup, json& facts) {
  const double step =
      setup.options.step * std::sqrt(setup.spec.diameter_min * setup.spec.diameter_min / setup.spec.stiffness);
  const auto phases = static_cast<double>(setup.phases().size());
  facts["samples"] = setup.samples;
  facts["disks"] = setup.spec.disks;
  facts["time_step"] = step;
  facts["steps_max"] = phases * setup.options.time_max / step;
  return fmt::format(
      "{} samples of {} disks, {:.0f} phases; time step {:.3g} T0 or a little more, at most {:.3g} steps each\n",
      setup.samples, setup.spec.disks, phases, step, phases * setup.options.time_max / step);
}

}  // namespace

void check_powder(const Scene& scene, json& facts, std::string& lines) {
  if (!has_powder_variants(scene)) {
    lines += "  " + check_setup(read_powder(scene), facts);
    return;
  }
  for (const PowderVariant& v : read_powder_variants(scene)) {
    json one{{"name", v.name}, {"picked", v.picked}};
    lines += fmt::format("  {}{}: {}", v.name, v.picked ? "" : " (left out)", check_setup(v.setup, one));
    facts["variants"].push_back(one);
  }
}

}  // namespace softgrain

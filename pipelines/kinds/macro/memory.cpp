#include "pipelines/kinds/macro/memory.h"

#include <fmt/format.h>

#include <cmath>

#include "microsim/particles/scene_memory.h"
#include "microsim/shell_packing.h"

namespace softgrain {

namespace {

constexpr double kBytesPerBody = 300.0;
constexpr double kBytesPerBodyContact = 160.0;
constexpr double kContactsPerBody = 3.0;
/// More than any soft particle of the published kind holds: what fits even so needs no closer look.
constexpr double kManyGrains = 1e5;

double mean_cube(const std::optional<Grading>& sizes, double exponent, double largest, double ratio) {
  return (sizes ? *sizes : Grading::power_law(exponent, largest / ratio, largest)).mean_volume();
}

/// Soft particles, by the mean volumes of both kinds: the share of the scene is one of volume.
double expected_softs(const MacroSetup& setup) {
  const MacroSpec& spec = setup.spec;
  if (setup.given) return static_cast<double>(setup.given->soft_count());
  const auto bodies = static_cast<double>(spec.bodies);
  const double share = spec.soft_share;
  if (!(share > 0.0)) return 0.0;
  if (share >= 1.0) return bodies;
  const double soft = share / mean_cube(spec.soft_sizes, spec.exponent, spec.soft_radius_max, spec.soft_polydispersity);
  const double solid =
      (1.0 - share) / mean_cube(spec.solid_sizes, spec.exponent, spec.solid_radius_max, spec.solid_polydispersity);
  return spec.construction == Construction::voids ? bodies * soft / solid : bodies * soft / (soft + solid);
}

/// Grains of the largest run: the twin, when there is one.
double resolved(const MacroSetup& setup, double grains) {
  const auto bodies = static_cast<double>(setup.spec.bodies);
  return setup.twins.empty() ? bodies : bodies + expected_softs(setup) * grains;
}

}  // namespace

double macro_memory(double bodies) { return bodies * (kBytesPerBody + kContactsPerBody * kBytesPerBodyContact); }

std::string macro_memory_problem(const MacroSetup& setup, double grains, double available) {
  const double all = resolved(setup, grains);
  const double needed = macro_memory(all);
  if (!(available > 0.0) || needed <= available) return "";
  const double fit = std::floor(static_cast<double>(setup.spec.bodies) * available / needed);
  return fmt::format("{} needs about {:.3g} GB of memory, {:.3g} GB are free; allowed: up to {:.0f}{}",
                     setup.twins.empty() ? "a run" : fmt::format("a resolved twin of about {:.3g} grains", all),
                     needed / 1e9, available / 1e9, fit, setup.twins.empty() ? "" : ", or more with resolved = false");
}

void require_macro_memory(const SceneTable& macro, const MacroSetup& setup, const SoftParticleSpec& content) {
  const double available = available_memory();
  if (setup.spec.preparation == Preparation::lammps || macro_memory_problem(setup, kManyGrains, available).empty())
    return;
  const double grains =
      setup.twins.empty() ? 0.0 : static_cast<double>(generate_shell_packing(content, 1, 0).radius.size());
  const std::string problem = macro_memory_problem(setup, grains, available);
  if (!problem.empty()) macro.throw_error("bodies", problem);
}

}  // namespace softgrain

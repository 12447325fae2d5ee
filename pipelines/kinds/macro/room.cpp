#include "pipelines/kinds/macro/room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrate/rod_packing.h"
#include "common/core/particles.h"
#include "common/packing/grading.h"
#include "macrosim/macro_packing.h"
#include "macrosim/preparation.h"
#include "microsim/particles/scene_memory.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/macro/stages.h"

namespace softgrain {

namespace {

/// Drawn bodies are smaller in the mean than their distribution, now and then.
constexpr double kMargin = 1.1;
/// Samples that are drawn at least where room is doubted: a doubt must not depend on the seed, which the command line
/// may replace. What is refused is judged by the samples of the run themselves.
constexpr std::int64_t kDraws = 32;

/// Share that rods of these sizes fill without friction. The same sizes are judged again and again, for numbers of
/// bodies that are tried: the last one is remembered.
double rod_fraction(const Grading& sizes) {
  constexpr double kFrictionless = 0.7654;  // gap of rods
  constexpr std::size_t kRods = 1000;
  thread_local std::string last;
  thread_local double fraction = 0.0;
  if (last != sizes.text()) {
    fraction = RodCurve(sizes, kRods).at(kFrictionless);
    last = sizes.text();
  }
  return fraction;
}

/// Share of the cell that bodies fill when they jam: that of rods without friction, less with it.
double jammed_fraction(const MacroSpec& spec) {
  constexpr double kLoosest = 0.07;  // less at mu = 0.3 and above
  double fraction = 0.72;            // of grains and soft particles together
  if (!(spec.soft_share > 0.0))
    fraction = rod_fraction(
        sizes_or_power_law(spec.solid_sizes, spec.exponent, spec.solid_radius_max, spec.solid_polydispersity));
  return fraction * (1.0 - kLoosest * std::min(1.0, spec.protocol.friction / 0.3));
}

/// Solid fraction under a pressure over E: p/E = 0.045 x^1.75, x the share of pores that is lost.
double fraction_under(double jammed, double pressure) {
  return std::min(1.0, jammed + (1.0 - jammed) * std::pow(pressure / 0.045, 1.0 / 1.75));
}

/// Least volume of bodies, over the cube of the largest radius, so that they can be placed at all.
double placed_volume() { return kPackedShare * cube(kShortestPeriod); }

/// Least volume of bodies, over the cube of the largest radius, so that they can be placed and have room. They need
/// room under the first pressure of the preparation, which is up to 128 times that of its end, and where the test
/// shortens the cell most.
double needed_volume(const MacroSpec& spec) {
  const double jammed = jammed_fraction(spec);
  const double first = fraction_under(jammed, spec.start_pressure * std::max(1.0, spec.protocol.first_pressure));
  const double shortened = std::clamp(1.0 - rough_strains(spec).largest_axial, 0.1, 1.0);
  const double strained = fraction_under(jammed, spec.start_pressure) / std::pow(shortened, 3);
  return std::max(placed_volume(), cube(kShortestPeriod) * std::max(first, strained));
}

bool needs_room(const MacroSetup& setup) {
  const MacroSpec& spec = setup.spec;
  return spec.boundary == Boundary::periodic && !setup.given && !spec.cells && spec.construction == Construction::mixed;
}

/// Two digits, upwards.
std::int64_t rounded_up(double number) {
  const double digit = std::pow(10.0, std::max(0.0, std::floor(std::log10(number)) - 1.0));
  return static_cast<std::int64_t>(digit * std::ceil(number / digit));
}

/// The first of the drawn samples whose bodies hold less than this, over the cube of their largest radius.
std::string short_of(const MacroSetup& setup, std::uint64_t seed, const std::string& what, std::int64_t draws,
                     double volume_needed, bool sure) {
  constexpr double kSurely = 4.0;  // times as many have room, whatever is drawn
  const MacroSpec& spec = setup.spec;
  if (!needs_room(setup)) return "";
  const std::int64_t least = least_bodies(spec);
  if (static_cast<double>(spec.bodies) >= kSurely * static_cast<double>(least)) return "";
  const double wanted = volume_needed / kSphereVolume;
  double drawn = 0.0;
  for (std::int64_t k = 0; k < draws && drawn < kMostDrawn; ++k) {
    double volume = 0.0;
    double largest = 0.0;
    for (const MacroBody& b : drawn_bodies(spec, seed, static_cast<std::uint64_t>(k))) {
      volume += cube(b.r);
      largest = std::max(largest, b.r);
      drawn += 1.0;
    }
    const double there = volume / (wanted * cube(largest));
    if (there >= 1.0) continue;
    const double more = static_cast<double>(spec.bodies) * kMargin / there;
    return fmt::format(
        "{} {} {} for a periodic cell: packed{}, its shortest side is about {:.3g} radii of the largest, and images "
        "of that one must be two diameters apart, {:.3g} radii: {} or more have room",
        spec.bodies, what, sure ? "are too few" : "may be too few", sure ? "" : " and strained",
        kShortestPeriod * std::cbrt(there), kShortestPeriod, std::max(least, rounded_up(more)));
  }
  return "";
}

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

std::int64_t least_bodies(const MacroSpec& spec) {
  const Grading solid =
      sizes_or_power_law(spec.solid_sizes, spec.exponent, spec.solid_radius_max, spec.solid_polydispersity);
  const Grading soft =
      sizes_or_power_law(spec.soft_sizes, spec.exponent, spec.soft_radius_max, spec.soft_polydispersity);
  const double share = spec.soft_share;
  // Bodies in a unit of volume: shares are by volume.
  const double number =
      (share < 1.0 ? (1.0 - share) / solid.mean_volume() : 0.0) + (share > 0.0 ? share / soft.mean_volume() : 0.0);
  double largest = 0.0;
  if (share < 1.0) largest = solid.largest();
  if (share > 0.0) largest = std::max(largest, soft.largest());
  return rounded_up(kMargin * needed_volume(spec) * std::pow(largest, 3) * number / kSphereVolume);
}

std::string room_problem(const MacroSetup& setup, std::uint64_t seed, const std::string& what) {
  return short_of(setup, seed, what, setup.samples, placed_volume(), true);
}

std::string room_doubt(const MacroSetup& setup, std::uint64_t seed, const std::string& what) {
  return short_of(setup, seed, what, std::max(setup.samples, kDraws), needed_volume(setup.spec), false);
}

void require_room_for_images(const SceneTable& macro, const char* key, const MacroSetup& setup, std::uint64_t seed) {
  const std::string problem = room_problem(setup, seed, "bodies");
  if (!problem.empty()) macro.add_error(key, problem + ", or boundary = \"walls\"");
}

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

// softgrain check of a sieve analysis.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "common/packing/grading_indices.h"
#include "common/packing/grading_scene.h"
#include "pipelines/commands/commands.h"

namespace softgrain {

namespace {

/// A sample follows a curve no closer than half the share of its largest grain; 2 % are less than a sieving scatters.
constexpr double kLargestGrain = 0.02;
constexpr double kManyGrains = 1e4;

/// Grains of a sample in which the largest has this share of the volume.
double grains_needed(const Grading& sizes) {
  return sizes.volume(sizes.largest()) / (kLargestGrain * sizes.mean_volume());
}

/// "1600", "2.4e+05": two digits are more than such an estimate is worth.
std::string grains_text(double grains) {
  if (grains >= 1e5) return rounded_text(grains, {2});
  const double unit = std::pow(10.0, std::max(std::floor(std::log10(grains)) - 1.0, 0.0));
  return fmt::format("{:.0f}", unit * std::ceil(grains / unit));
}

std::string scenes_for(const Grading& sizes) {
  const double grains = grains_needed(sizes);
  if (grains <= kManyGrains)
    return fmt::format("a sample of {} grains follows it within 2 %: use it in grain-box, particles, macro, material",
                       grains_text(grains));
  return fmt::format(
      "a sample of {} grains would follow it within 2 %: use it in a recipe (pipelines/graded_sand.toml; "
      "for moduli and K0 pipelines/sand_modulus.toml)",
      grains_text(grains));
}

std::string fuller_text(const GradingIndices& i) {
  constexpr double kFits = 0.1;
  const std::string difference = percent_text(i.fuller_difference);
  if (i.fuller_difference > kFits)
    return fmt::format("no Fuller curve fits: the nearest, q = {:.2f}, differs by up to {}", i.fuller, difference);
  return fmt::format("the Fuller curve with q = {:.2f} fits best, within {}", i.fuller, difference);
}

/// The curve as bars of one character for 2 %, at most sixteen of its sieves.
std::string picture_of(const std::vector<SieveRow>& rows) {
  constexpr std::size_t kMost = 16;
  const std::size_t every = (rows.size() + kMost - 1) / kMost;
  std::string text;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k % every != 0 && k + 1 != rows.size()) continue;
    const auto bar = static_cast<std::size_t>(std::lround(50.0 * rows[k].passing));
    text += fmt::format("  {:>9} mm {:>8}{}\n", rounded_text(1e3 * rows[k].opening), percent_text(rows[k].passing),
                        bar == 0 ? "" : " " + std::string(bar, '#'));
  }
  return text;
}

}  // namespace

void check_sieves(const std::string& path, const std::vector<std::string>& overrides, Findings& out) {
  const Scene keys = Scene::parse("", path, overrides);
  const SieveOptions options = keys.read([](const SceneTable& t) {
    SieveOptions read = read_sieve_options(t);
    t.finish();
    return read;
  });
  const SieveCurve curve = read_sieve_file(path, options);
  const Grading& sizes = curve.grading;
  const GradingIndices i = grading_indices(sizes);
  out.add("kind", "a sieve curve", fmt::format("{}a sieve curve; {}", kNoScene, kTakenBySizes));
  out.add("columns", curve.columns, "read: " + curve.columns);
  out.add("radius", {sizes.smallest(), sizes.largest()},
          fmt::format("radii {:.4g} to {:.4g} m", sizes.smallest(), sizes.largest()));
  out.add("diameters", {{"D10", i.d10}, {"D30", i.d30}, {"D50", i.d50}, {"D60", i.d60}},
          fmt::format("D10 {:.4g}, D30 {:.4g}, D50 {:.4g}, D60 {:.4g} mm", 1e3 * i.d10, 1e3 * i.d30, 1e3 * i.d50,
                      1e3 * i.d60));
  out.add("shape", {{"Cu", i.cu}, {"Cc", i.cc}},
          fmt::format("Cu = D60/D10 = {:.3g}, Cc = D30^2/(D60 D10) = {:.3g}", i.cu, i.cc));
  out.add("fuller", {{"exponent", i.fuller}, {"largest_difference", i.fuller_difference}}, fuller_text(i));
  out.add("grains", grains_needed(sizes), scenes_for(sizes));
  out.lines += picture_of(curve.rows);
  for (const std::string& remark : curve.remarks) out.warn(remark);
}

}  // namespace softgrain

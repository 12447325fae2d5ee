#include "common/data/force_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace softgrain {

std::vector<std::string> implausible_forces(const std::vector<double>& delta, const std::vector<double>& force,
                                            double shell_radius, double youngs_modulus) {
  constexpr double kTooSoft = 2e-4;
  constexpr double kDeep = 0.1;  // Delta from which on a published soft particle bears a share that can be judged
  std::vector<std::string> out;
  if (delta.empty() || delta.size() != force.size()) return out;
  const auto most = static_cast<std::size_t>(
      std::max_element(force.begin(), force.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      force.begin());
  if (std::accumulate(force.begin(), force.end(), 0.0) < 0.0)
    out.push_back(fmt::format(
        "forces are negative (down to {:.4g} N): compression counts positive here; turn the sign if the file counts "
        "tension so",
        *std::min_element(force.begin(), force.end())));
  const double solid =
      4.0 / 3.0 * youngs_modulus * shell_radius * shell_radius * std::pow(std::max(delta[most], 0.0), 1.5);
  const double share = std::abs(force[most]) / solid;
  const std::string what =
      fmt::format("{:.4g} N at Delta = {:.3g} is {:.2g} of what a solid sphere with this E and Rs bears", force[most],
                  delta[most], share);
  const char* const hint = ": check the units of force, E and radius";
  if (solid > 0.0 && share > 1.0) out.push_back(what + ", more than any soft particle" + hint);
  if (delta[most] > kDeep && share < kTooSoft) out.push_back(what + " (published soft particles: 0.01 to 0.1)" + hint);
  return out;
}

}  // namespace softgrain

// Settings of the fit of a law, and the fitted law as `softgrain calibrate` prints it.
#include "pipelines/law/law_fit.h"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "common/data/law_words.h"

namespace softgrain {

namespace {

/// Reads an angle in degrees. `plain` is another name of the key, without its unit, in scenes and command lines of
/// earlier versions.
std::optional<double> read_angle(const SceneTable& t, const Key& key, const std::string& plain) {
  if (t.has(plain) && t.has(key.name)) t.throw_error(plain, "is another name of " + key.name + ": give one of them");
  const Key given = t.has(plain) ? Key(plain, "another name of `" + key.name + "`") : key;
  if (!t.has(given.name)) return std::nullopt;
  return t.number(given, Unit::angle_degree, Range::positive());
}

}  // namespace

FitOptions read_fit_settings(const SceneTable& t) {
  FitOptions o;
  o.delta_low =
      t.number({"delta_low", "lower end of the fitted range of Delta"}, Unit::none, Range::not_negative(), o.delta_low);
  if (t.has("delta_high"))
    o.delta_high = t.number({"delta_high", "upper end of the fitted range of Delta", "all"}, Unit::none,
                            Range::above(o.delta_low));
  o.initial_angle_deg =
      read_angle(t, {"initial_angle_deg", "largest angle of the initial slope of the tangential force", "0.05"},
                 "initial_angle")
          .value_or(o.initial_angle_deg);
  o.secant_angle_deg = read_angle(t,
                                  {"secant_angle_deg", "angle of the secant of the tangential force",
                                   "1; soft-soft: 0.5 if measured (of an experiment 1)"},
                                  "secant_angle");
  o.noise_floor = t.number({"noise_floor", "a mean force below this value, over E Rs^2, counts as zero"}, Unit::none,
                           Range::not_negative(), o.noise_floor);
  o.scatter_floor =
      t.number({"scatter_floor", "least standard deviation in the weight of a point, over that pooled from all points"},
               Unit::none, {0.0, 1.0, true, false}, o.scatter_floor);
  o.min_packings = static_cast<int>(
      t.count({"min_packings", "with fewer packings the law is marked underdetermined"}, 2, 1000000, o.min_packings));
  o.replicates = static_cast<int>(t.count(
      {"replicates", "number of bootstrap replicates (fits to packings drawn with replacement); 0: no intervals"}, 0,
      1000000, o.replicates));
  return o;
}

namespace {

std::string threshold_text(const ThresholdPowerLaw& n, double newton) {
  if (n.delta.value > 0.0) return fmt::format("c = {:.3g} N, delta = {}", newton * n.c.value, bracket_text(n.delta));
  const bool known = interval_known(n.delta.low, n.delta.high);
  return "no threshold shows: c and delta are not determined" +
         (known ? fmt::format(" (delta below {:.3g})", n.delta.high) : std::string());
}

}  // namespace

bool is_by_symmetry(const PairLaw& law) {
  return law.points == 0 && has_numbers(law.status) && law.normal.b.value > 0.0;
}

std::string verdict_text(const PairLaw& law) {
  std::string text = to_string(law.kind) + ": " + (is_by_symmetry(law) ? "by symmetry" : to_string(law.status));
  if (!law.reason.empty()) text += " - " + law.reason;
  return text;
}

std::string normal_law_text(const FitReport& report, const SoftParticleSpec& spec) {
  const PairLaw& law = report.law;
  const ThresholdPowerLaw& n = law.normal;
  const double newton = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const std::vector<double> ends{law.delta_max};
  const Band band = law_band(report, LawCurve::normal, ends).front();
  const Estimate force{band.value, 0.0, band.low, band.high};
  return fmt::format("  F = a D^b + c [N]: a = {}, b = {}, {}\n  F({:.3g}) = {} N\n", bracket_text(n.a, newton),
                     bracket_text(n.b), threshold_text(n, newton), band.delta, bracket_text(force, newton));
}

}  // namespace softgrain

#include "pipelines/compare/stage_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "common/core/few_samples.h"
#include "common/core/text.h"
#include "common/core/vec.h"

namespace softgrain {

namespace {

/// A quantity over another one at the points of a stage.
using Quantity = std::function<double(std::size_t)>;

double tangent(const Quantity& x, const Quantity& y, std::size_t from, std::size_t last, bool at_end) {
  constexpr std::size_t kPoints = 4;
  constexpr double kSteepest = 3.0;
  const std::size_t n = std::min(kPoints, last - from + 1);
  std::vector<double> xs;
  std::vector<double> ys;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t point = at_end ? last - k : from + k;
    xs.push_back(x(point));
    ys.push_back(y(point));
  }
  if (xs.size() < 2) return kNaN;
  const double secant = (ys[1] - ys[0]) / (xs[1] - xs[0]);
  const double slope = slope_at_first(xs, ys);
  return slope * secant > 0.0 && std::abs(slope) <= kSteepest * std::abs(secant) ? slope : secant;
}

/// Points of a stage: strain and stress whose slope is the modulus.
struct StressStrain {
  std::vector<double> strain;
  std::vector<double> stress;

  [[nodiscard]] bool falls() const { return stress.back() < stress.front(); }
};

/// Moduli that are taken up to half of the strength.
bool is_fifty(Modulus modulus) {
  return modulus == Modulus::young || modulus == Modulus::shear || modulus == Modulus::undrained;
}

/// The stresses of an interval that nobody named.
std::array<double, 2> usual_interval(Modulus modulus, const StressStrain& s) {
  const double begin = s.stress.front();
  const double end = s.stress.back();
  if (s.falls()) return {begin, end};
  if (is_fifty(modulus)) return {begin, begin + 0.5 * (*std::max_element(s.stress.begin(), s.stress.end()) - begin)};
  return {std::max(begin, 0.5 * end), end};
}

/// Where the stress is first met, straight between points, and behind the place `from` (a point and a part of the way
/// to the next); NaN where it is not. An end that misses it by a trifle of the stage's change counts as met: stresses
/// are imposed within a tolerance.
double place_of(const StressStrain& s, double stress, double from) {
  constexpr double kTrifle = 0.02;
  const double near = kTrifle * std::abs(s.stress.back() - s.stress.front());
  const double sign = s.falls() ? -1.0 : 1.0;
  const auto beyond = [&](std::size_t k) { return sign * (s.stress[k] - stress); };  // above 0: it lies behind
  if (from <= 0.0 && beyond(0) >= 0.0) return beyond(0) <= near ? 0.0 : kNaN;
  for (auto k = static_cast<std::size_t>(from); k + 1 < s.stress.size(); ++k) {
    if (beyond(k + 1) < 0.0) continue;
    const double part = std::clamp(-beyond(k) / (beyond(k + 1) - beyond(k)), 0.0, 1.0);
    if (static_cast<double>(k) + part >= from) return static_cast<double>(k) + part;
  }
  const std::size_t last = s.stress.size() - 1;
  return std::abs(beyond(last)) <= near && static_cast<double>(last) > from ? static_cast<double>(last) : kNaN;
}

double at_place(const std::vector<double>& values, double place) {
  const auto k = std::min(static_cast<std::size_t>(place), values.size() - 2);
  return values[k] + (place - static_cast<double>(k)) * (values[k + 1] - values[k]);
}

void add_secant(Modulus modulus, const StressStrain& s, StageResult& r) {
  const bool given = r.record.modulus_stress[1] > 0.0;
  std::array<double, 2> interval = given ? r.record.modulus_stress : usual_interval(modulus, s);
  if (given && s.falls()) std::swap(interval[0], interval[1]);
  const double from = place_of(s, interval[0], 0.0);
  const double to = std::isfinite(from) ? place_of(s, interval[1], from) : kNaN;
  if (!(to > from)) return;
  const double strain = at_place(s.strain, to) - at_place(s.strain, from);
  const double stress = at_place(s.stress, to) - at_place(s.stress, from);
  if (strain == 0.0 || stress == 0.0) return;
  r.modulus_from = at_place(s.stress, from);
  r.modulus_to = at_place(s.stress, to);
  r.modulus = stress / strain;
}

/// `shear2`: sum of the squares of the three shear stresses.
double q_of(const Vec3& s, double shear2) {
  const Vec3 d{{s[0] - s[1], s[1] - s[2], s[2] - s[0]}};
  return std::sqrt(0.5 * norm2(d) + 3.0 * shear2);
}

/// Whether a recorded point belongs to a stage that slides, with its shear stresses.
bool point_slides(const MacroCurve& c, std::size_t k) {
  if (c.stage.size() != c.strain.size() || c.stress_xz.size() != c.strain.size()) return false;
  const auto stage = static_cast<std::size_t>(c.stage[k]);
  return k > 0 && stage < c.stages.size() && slides(c.stages[stage].way);
}

/// Of tests in which a stage slides; in others they are noise.
double shear_squares(const MacroCurve& c, std::size_t k) {
  if (c.shear_strain.empty() || c.stress_xz.size() != c.strain.size()) return 0.0;
  return c.stress_xy[k] * c.stress_xy[k] + c.stress_xz[k] * c.stress_xz[k] + c.stress_yz[k] * c.stress_yz[k];
}

class Reader {
 public:
  explicit Reader(const MacroCurve& c) : c_(c) {}

  [[nodiscard]] bool complete() const {
    const std::size_t n = c_.strain.size();
    for (const auto* column : {&c_.stage, &c_.strain_x, &c_.strain_y, &c_.strain_z, &c_.stress_x, &c_.stress_y})
      if (column->size() != n) return false;
    return n > 1 && !c_.stages.empty();
  }

  [[nodiscard]] StageResult result(std::size_t stage, std::size_t from, std::size_t last) const {
    StageResult r;
    r.record = c_.stages[stage];
    r.strain_begin = c_.strain_z[from];
    r.strain_end = c_.strain_z[last];
    r.volumetric_begin = volumetric(from);
    r.volumetric_end = volumetric(last);
    r.axial_end = c_.stress_axial[last];
    r.lateral_end = 0.5 * (c_.stress_x[last] + c_.stress_y[last]);
    if (r.record.way == StageKind::oedometric && r.axial_end > 0.0) r.lateral_ratio = r.lateral_end / r.axial_end;
    add_moduli(r, from, last);
    add_strength(r, from, last);
    return r;
  }

 private:
  [[nodiscard]] double log_strain(const std::vector<double>& nominal, std::size_t k) const {
    return -std::log1p(-nominal[k]);
  }
  [[nodiscard]] double volumetric(std::size_t k) const {
    return 1.0 - (1.0 - c_.strain_x[k]) * (1.0 - c_.strain_y[k]) * (1.0 - c_.strain_z[k]);
  }

  void add_moduli(StageResult& r, std::size_t from, std::size_t last) const {
    const Quantity ex = [&](std::size_t k) { return log_strain(c_.strain_x, k); };
    const Quantity ey = [&](std::size_t k) { return log_strain(c_.strain_y, k); };
    const Quantity ez = [&](std::size_t k) { return log_strain(c_.strain_z, k); };
    Quantity x = ez;
    Quantity y = [&](std::size_t k) { return c_.stress_axial[k]; };
    const Modulus modulus = r.record.kind == StageKind::hold ? Modulus::none : modulus_of(r.record.way);
    if (modulus == Modulus::none) return;
    if (modulus == Modulus::bulk) {
      x = [&](std::size_t k) { return ex(k) + ey(k) + ez(k); };
      y = [&](std::size_t k) { return (c_.stress_x[k] + c_.stress_y[k] + c_.stress_axial[k]) / 3.0; };
    } else if (modulus == Modulus::shear) {
      x = [&](std::size_t k) { return ez(k) - ex(k); };
      y = [&](std::size_t k) { return 0.5 * (c_.stress_axial[k] - c_.stress_x[k]); };
    } else if (modulus == Modulus::undrained) {
      y = [&](std::size_t k) { return c_.stress_axial[k] - 0.5 * (c_.stress_x[k] + c_.stress_y[k]); };
    }
    if (slides(r.record.way)) {
      if (!point_slides(c_, last)) return;
      x = [&](std::size_t k) { return c_.shear_strain[k]; };
      y = [&](std::size_t k) { return c_.stress_xz[k]; };
    }
    StressStrain points;
    for (std::size_t k = from; k <= last; ++k) {
      points.strain.push_back(x(k));
      points.stress.push_back(y(k));
    }
    add_secant(modulus, points, r);
    r.modulus_begin = tangent(x, y, from, last, false);
    r.modulus_end = tangent(x, y, from, last, true);
    if (modulus == Modulus::young)
      r.poisson_begin = tangent(
          ez, [&](std::size_t k) { return -0.5 * (ex(k) + ey(k)); }, from, last, false);
  }

  void add_strength(StageResult& r, std::size_t from, std::size_t last) const {
    const std::vector<double> ratio = stress_ratios(c_);
    r.ratio_end = ratio[last];
    for (std::size_t k = from + 1; k <= last; ++k) {
      if (!std::isfinite(ratio[k]) || ratio[k] <= r.ratio_peak) continue;
      r.ratio_peak = ratio[k];
      if (!slides(r.record.way)) r.ratio_peak_strain = c_.strain_z[k];
    }
    if (!slides(r.record.way) || !point_slides(c_, last)) return;
    const auto friction = [&](std::size_t k) {
      return c_.stress_axial[k] > 0.0 ? std::abs(c_.stress_xz[k]) / c_.stress_axial[k] : kNaN;
    };
    r.shear_end = c_.shear_strain[last];
    r.friction_end = friction(last);
    for (std::size_t k = from + 1; k <= last; ++k) {
      const double f = friction(k);
      if (!std::isfinite(f) || f <= r.friction_peak) continue;
      r.friction_peak = f;
      r.friction_peak_shear = c_.shear_strain[k];
    }
  }

  const MacroCurve& c_;
};

}  // namespace

Modulus modulus_of(StageKind way) {
  switch (way) {
    case StageKind::oedometric:
      return Modulus::constrained;
    case StageKind::triaxial:
      return Modulus::young;
    case StageKind::isotropic:
    case StageKind::consolidation:
      return Modulus::bulk;
    case StageKind::shear:
    case StageKind::simple_shear:
    case StageKind::direct_shear:
      return Modulus::shear;
    case StageKind::undrained:
      return Modulus::undrained;
    case StageKind::axes:
      return Modulus::axial;
    default:
      return Modulus::none;
  }
}

const char* stress_of(Modulus modulus) {
  if (modulus == Modulus::bulk) return "mean stress";
  if (modulus == Modulus::undrained) return "deviator";
  return modulus == Modulus::shear ? "shear stress" : "axial stress";
}

std::string modulus_interval(const StageMeans& stage) {
  const StageRecord& record = stage.record;
  const auto [from, to] = record.modulus_stress;
  if (to > 0.0) return pressure_text(from) + " to " + pressure_text(to);
  const bool falls = stage.modulus_from && stage.modulus_from->mean > stage.modulus_to->mean;
  if (falls || record.kind == StageKind::unload) return "whole stage";
  const Modulus modulus = modulus_of(record.way);
  return is_fifty(modulus) ? "first half of the largest stress" : "upper half of the stress";
}

namespace {

/// Where points go through the one stress and, behind it, through the other; nothing where they do not.
std::optional<std::array<double, 2>> places_of(const StressStrain& s, double from, double to) {
  if (s.strain.size() < 2 || s.strain.size() != s.stress.size()) return std::nullopt;
  const double first = place_of(s, from, 0.0);
  const double second = std::isfinite(first) ? place_of(s, to, first) : kNaN;
  if (!(second > first)) return std::nullopt;
  return std::array{first, second};
}

}  // namespace

double secant_modulus(const std::vector<double>& strain, const std::vector<double>& stress, double from, double to) {
  const auto places = places_of({strain, stress}, from, to);
  if (!places) return kNaN;
  const auto [first, second] = *places;
  return (at_place(stress, second) - at_place(stress, first)) / (at_place(strain, second) - at_place(strain, first));
}

double compression_index(const std::vector<double>& void_ratio, const std::vector<double>& stress, double from,
                         double to) {
  const auto places = places_of({void_ratio, stress}, from, to);
  if (!places) return kNaN;
  const auto [first, second] = *places;
  const double ratio = at_place(stress, second) / at_place(stress, first);
  if (!(at_place(stress, first) > 0.0) || !(ratio > 0.0)) return kNaN;
  return (at_place(void_ratio, first) - at_place(void_ratio, second)) / std::log10(ratio);
}

std::string mean_modulus_text(const MeanError& m) {
  if (is_told_from_zero(m.n, m.mean, m.error)) return pressure_text(m);
  return fmt::format("not determined ({}, {})", pressure_text(m), counted(m.n, "sample"));
}

std::string modulus_text(const StageMeans& s) {
  const Modulus modulus = s.record.kind == StageKind::hold ? Modulus::none : modulus_of(s.record.way);
  if (modulus == Modulus::none) return "";
  if (!s.modulus)
    return fmt::format("{} modulus not determined: the {} does not go through its interval ({})", to_string(modulus),
                       stress_of(modulus), modulus_interval(s));
  std::string text =
      fmt::format("{} modulus {} from {} to {} of {}", to_string(modulus), mean_modulus_text(*s.modulus),
                  pressure_text(s.modulus_from->mean, 3), pressure_text(s.modulus_to->mean, 3), stress_of(modulus));
  if (!(s.record.modulus_stress[1] > 0.0)) text += " (" + modulus_interval(s) + ")";
  if (s.axial_end && s.modulus->n < s.axial_end->n)
    text += fmt::format(", {} of {} samples", s.modulus->n, s.axial_end->n);
  return text;
}

std::string negative_tangents_text(const std::vector<NamedTangent>& tangents, const std::string& of) {
  std::string found;
  for (const NamedTangent& t : tangents)
    if (t.value < 0.0)
      append_part(
          found,
          fmt::format("{}{}, {} point: {}", of.empty() ? "" : of + " ", t.stage, t.where, pressure_text(t.value, 3)),
          "; ");
  if (found.empty()) return "";
  return "negative tangent modulus (" + found +
         "): stresses scatter by more than they change between recorded points; take fewer steps in the stage, more "
         "grains or a smaller tolerance";
}

std::vector<NamedTangent> tangents_of(const std::vector<StageMeans>& stages) {
  std::vector<NamedTangent> out;
  for (const StageMeans& s : stages) {
    const Modulus modulus = modulus_of(s.record.way);
    if (s.record.kind == StageKind::hold || modulus == Modulus::none) continue;
    const auto add = [&](const char* where, const std::optional<MeanError>& m) {
      if (m && is_told_from_zero(m->n, m->mean, m->error)) out.push_back({s.record.name, where, m->mean});
    };
    add("first", s.modulus_begin);
    if (modulus == Modulus::constrained || modulus == Modulus::bulk) add("last", s.modulus_end);
  }
  return out;
}

std::vector<double> stress_ratios(const MacroCurve& c, double bearing) {
  std::vector<double> out(c.strain.size(), kNaN);
  if (c.stress_x.size() != out.size() || c.stress_y.size() != out.size()) return out;
  const auto pressure = [&](std::size_t k) { return (c.stress_x[k] + c.stress_y[k] + c.stress_axial[k]) / 3.0; };
  double largest = 0.0;
  for (std::size_t k = 0; k < out.size(); ++k) largest = std::max(largest, pressure(k));
  for (std::size_t k = 0; k < out.size(); ++k)
    if (pressure(k) > bearing * largest)
      out[k] = q_of({{c.stress_x[k], c.stress_y[k], c.stress_axial[k]}}, shear_squares(c, k)) / pressure(k);
  return out;
}

std::vector<StrainPart> strain_parts(MacroTest test) {
  if (test != MacroTest::stages) return {StrainPart::whole};
  return {kPartsOfStages.begin(), kPartsOfStages.end()};
}

const std::vector<double>& strain_of_part(const MacroCurve& c, StrainPart part) {
  if (part == StrainPart::shear) return c.shear_strain;
  return part == StrainPart::axial && !c.strain_z.empty() ? c.strain_z : c.strain;
}

const char* strain_label(StrainPart part, MacroTest test) {
  if (part == StrainPart::whole) return strain_label(test);
  return strain_label(part == StrainPart::shear ? MacroTest::simple_shear : MacroTest::stages);
}

EndStrain strain_at_end(const MacroCurve& c) {
  if (c.strain.empty()) return {};
  const bool sliding = point_slides(c, c.strain.size() - 1) && c.shear_strain.size() == c.strain.size();
  return sliding ? EndStrain{c.shear_strain.back(), "shear strain"} : EndStrain{c.strain.back()};
}

std::vector<std::size_t> points_of_stages(const MacroCurve& c, StrainPart part) {
  std::vector<std::size_t> out(c.strain.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  if (part == StrainPart::whole) return out;
  const bool sliding = part == StrainPart::shear;
  const auto is_in = [&](std::size_t k) { return (slides(c.test) || point_slides(c, k)) == sliding; };
  out.clear();
  for (std::size_t k = 0; k < c.strain.size(); ++k)
    if (is_in(k) || (k + 1 < c.strain.size() && is_in(k + 1))) out.push_back(k);
  return out.size() < 2 ? std::vector<std::size_t>{} : out;
}

std::vector<double> values_at(const std::vector<double>& values, const std::vector<std::size_t>& points) {
  std::vector<double> out;
  for (const std::size_t k : points)
    if (k < values.size()) out.push_back(values[k]);
  return out;
}

std::vector<double> deviators(const MacroCurve& c) {
  std::vector<double> out = c.stress_deviator;
  for (std::size_t k = 0; k < std::min(out.size(), c.strain.size()); ++k)
    if (point_slides(c, k)) out[k] = 2.0 * c.stress_xz[k];
  return out;
}

std::vector<double> deviators(const MacroCurve& c, StrainPart part) {
  if (part != StrainPart::shear || c.stress_xz.size() != c.strain.size()) return deviators(c);
  std::vector<double> out;
  for (const double stress : c.stress_xz) out.push_back(2.0 * stress);
  return out;
}

std::vector<StageResult> stage_results(const MacroCurve& curve) {
  const Reader reader(curve);
  std::vector<StageResult> out;
  if (!reader.complete()) return out;
  std::size_t from = 0;
  for (std::size_t last = 0; last < curve.stage.size(); ++last) {
    const bool ends = last + 1 == curve.stage.size() || curve.stage[last + 1] != curve.stage[last];
    const auto stage = static_cast<std::size_t>(curve.stage[last]);
    if (!ends || last == from || stage >= curve.stages.size()) continue;
    out.push_back(reader.result(stage, from, last));
    from = last;
  }
  return out;
}

std::vector<StageMeans> stage_means(const std::vector<MacroCurve>& curves, const std::string& engine) {
  std::vector<std::vector<StageResult>> samples;
  std::size_t stages = 0;
  for (const MacroCurve& c : curves) {
    if (c.engine != engine || !c.usable) continue;
    samples.push_back(stage_results(c));
    stages = std::max(stages, samples.back().size());
  }
  std::vector<StageMeans> out;
  for (std::size_t k = 0; k < stages; ++k) {
    std::vector<const StageResult*> all;
    for (const auto& sample : samples)
      if (k < sample.size()) all.push_back(&sample[k]);
    StageMeans& means = out.emplace_back();
    means.record = all.front()->record;
    stage_numbers([&](const char*, auto mean, auto result, const Means&) {
      if (const MeanError m = finite_mean(all, result); m.n > 0) means.*mean = m;
    });
  }
  return out;
}

}  // namespace softgrain

#include "pipelines/compare/stage_results.h"

#include <algorithm>
#include <cmath>
#include <functional>

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

double q_of(const Vec3& s) {
  const Vec3 d{{s[0] - s[1], s[1] - s[2], s[2] - s[0]}};
  return std::sqrt(0.5 * norm2(d));
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
      x = [&](std::size_t k) { return 2.0 * (ez(k) - ex(k)); };
      y = [&](std::size_t k) { return c_.stress_axial[k] - c_.stress_x[k]; };
    }
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
      r.ratio_peak_strain = c_.strain_z[k];
    }
  }

  const MacroCurve& c_;
};

std::optional<MeanError> mean_of(const std::vector<const StageResult*>& all, double StageResult::*member) {
  std::vector<double> values;
  for (const StageResult* r : all)
    if (std::isfinite(r->*member)) values.push_back(r->*member);
  return values.empty() ? std::nullopt : std::optional(mean_error(values));
}

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
      return Modulus::shear;
    case StageKind::axes:
      return Modulus::axial;
    default:
      return Modulus::none;
  }
}

std::vector<double> stress_ratios(const MacroCurve& c) {
  constexpr double kBearing = 0.01;
  std::vector<double> out(c.strain.size(), kNaN);
  if (c.stress_x.size() != out.size() || c.stress_y.size() != out.size()) return out;
  const auto pressure = [&](std::size_t k) { return (c.stress_x[k] + c.stress_y[k] + c.stress_axial[k]) / 3.0; };
  double largest = 0.0;
  for (std::size_t k = 0; k < out.size(); ++k) largest = std::max(largest, pressure(k));
  for (std::size_t k = 0; k < out.size(); ++k)
    if (pressure(k) > kBearing * largest)
      out[k] = q_of({{c.stress_x[k], c.stress_y[k], c.stress_axial[k]}}) / pressure(k);
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
    const auto mean = [&](double StageResult::*member) { return mean_of(all, member); };
    out.push_back({all.front()->record, mean(&StageResult::strain_end), mean(&StageResult::volumetric_end),
                   mean(&StageResult::axial_end), mean(&StageResult::lateral_end), mean(&StageResult::modulus_begin),
                   mean(&StageResult::modulus_end), mean(&StageResult::poisson_begin), mean(&StageResult::ratio_peak),
                   mean(&StageResult::ratio_peak_strain), mean(&StageResult::ratio_end)});
  }
  return out;
}

}  // namespace softgrain

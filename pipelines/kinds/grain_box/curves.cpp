#include "pipelines/kinds/grain_box/curves.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace softgrain::report {

namespace {

constexpr double kMegapascal = 1e6;
constexpr double kBinsPerDecade = 20.0;

}  // namespace

int main_axis(const GrainBoxResult& result) {
  if (result.state.points.empty()) return 2;
  const Vec3& e = result.state.points.back().strain;
  int axis = 2;
  for (int k = 0; k < 2; ++k)
    if (e[k] > e[axis] + 1e-9) axis = k;
  return axis;
}

Series over_strain(const GrainBoxResult& result, PointValue y, double unit, const SeriesStyle& style) {
  Series s{.label = result.spec.name, .hover = {}, .x = {}, .y = {}, .style = style};
  const int axis = main_axis(result);
  for (const BoxPoint& p : result.state.points) {
    if (p.phase < BoxPhase::friction) continue;
    s.x.push_back(100.0 * p.strain[axis]);
    s.y.push_back(y(p) * unit);
  }
  return s;
}

Series binned_over_pressure(const GrainBoxResult& result, double BoxPoint::*y, double unit, const SeriesStyle& style) {
  struct Bin {
    double x = 0.0;
    double y = 0.0;
    int count = 0;
  };
  std::map<int, Bin> bins;
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    if (!std::isfinite(p->*y) || !(p->pressure > 0.0)) continue;
    Bin& bin = bins[static_cast<int>(std::floor(kBinsPerDecade * std::log10(p->pressure)))];
    bin.x += p->pressure / kMegapascal;
    bin.y += p->*y * unit;
    ++bin.count;
  }
  Series s{.label = result.spec.name, .hover = {}, .x = {}, .y = {}, .style = style};
  for (const auto& [index, bin] : bins) {
    s.x.push_back(bin.x / bin.count);
    s.y.push_back(bin.y / bin.count);
  }
  return s;
}

Series over_pressure(const GrainBoxResult& result, double BoxPoint::*y, double unit, const SeriesStyle& style) {
  Series s{.label = {}, .hover = {}, .x = {}, .y = {}, .style = style};
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    if (!std::isfinite(p->*y)) continue;
    s.x.push_back(p->pressure / kMegapascal);
    s.y.push_back(p->*y * unit);
  }
  return s;
}

Series fitted_line(const PowerFit& fit, const std::array<double, 2>& range, double unit, const std::string& label,
                   const SeriesStyle& style) {
  Series s{.label = label, .hover = {}, .x = {}, .y = {}, .style = style, .sets_range = false};
  if (!std::isfinite(fit.exponent)) return s;
  for (const double pressure : range) {
    s.x.push_back(pressure / kMegapascal);
    s.y.push_back(unit * fit.prefactor * std::pow(pressure, fit.exponent));
  }
  return s;
}

}  // namespace softgrain::report

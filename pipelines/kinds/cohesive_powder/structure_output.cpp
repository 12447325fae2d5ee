// Structure of powders into HDF5 and the summary.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "pipelines/kinds/cohesive_powder/summary.h"

namespace softgrain {

namespace {

using nlohmann::json;

void write_curve(const h5::Group& group, const ScatteringCurve& curve, const ScatteringFit& fit) {
  group.write("k", curve.k);
  group.attribute_of("k", "unit", "1/a");
  group.write("intensity", curve.intensity);
  group.attribute_of("intensity", "unit", "a^2");
  group.write("modes", curve.modes);
  group.attribute("fit_usable", std::int64_t{fit.usable ? 1 : 0});
  group.attribute("fit_reason", fit.reason);
  group.attribute("fit_k_low", fit.k_low);
  group.attribute("fit_k_high", fit.k_high);
  group.attribute("amplitude", fit.model.amplitude);
  group.attribute("dF", fit.model.dimension);
  group.attribute("xi", fit.model.length);
  group.attribute("c", fit.model.background);
  group.attribute("tie_cost", fit.tie_cost);
  if (!fit.covariance.empty()) group.write("covariance", fit.covariance, {4, 4});
}

void write_holes(const h5::Group& group, const PowderHoles& holes) {
  std::vector<double> area;
  std::vector<double> radius;
  std::vector<double> centre;
  std::vector<std::int64_t> percolates;
  for (const Hole& h : holes.holes) {
    area.push_back(h.area);
    radius.push_back(h.radius);
    centre.insert(centre.end(), {h.centre[0], h.centre[1]});
    percolates.push_back(h.percolates ? 1 : 0);
  }
  group.write("area", area);
  group.write("radius", radius);
  group.write("centre", centre, {area.size(), 2});
  group.write("percolates", percolates);
  group.attribute("mean_radius", holes.mean_radius);
}

/// Adds mean, sample deviation and number of the values that exist.
void add_mean(json& out, const std::string& name, const PowderStructures& all, const std::vector<bool>& usable,
              const std::function<double(const PowderStructure&)>& get) {
  Tally sample;
  for (std::size_t k = 0; k < all.samples.size(); ++k) {
    const double x = usable[k] ? get(all.samples[k]) : kNaN;
    if (std::isfinite(x)) sample.add(x);
  }
  const MeanError m = sample.statistics();
  if (m.n == 0) return;
  out[name] = m.mean;
  out[name + "_deviation"] = m.deviation_or_zero();
  out[name + "_samples"] = static_cast<std::int64_t>(m.n);
}

/// A value of a fit that may be relied on.
double fitted(const PowderStructure& s, double ScatteringModel::*member) {
  return s.fit.usable ? s.fit.model.*member : std::nan("");
}

}  // namespace

void write_structure(const h5::Group& group, const PowderStructure& s) {
  if (s.curve) write_curve(group.create("scattering"), *s.curve, s.fit);
  if (s.holes) write_holes(group.create("holes"), *s.holes);
}

void write_structures(const h5::Group& root, const PowderStructures& s) {
  if (s.mean_curve) write_curve(root.create("scattering"), *s.mean_curve, s.fit);
}

void add_structure(PackSummary& sample, const PowderStructure& s) {
  sample.mesh = {{s.nx, s.ny}};
  if (s.curve) sample.scattering = s.fit;
  sample.holes = s.holes;
}

json structure_means_json(const PowderStructures& all, const std::vector<bool>& usable) {
  json out = json::object();
  add_mean(out, "dF", all, usable, [](const auto& s) { return fitted(s, &ScatteringModel::dimension); });
  add_mean(out, "xi", all, usable, [](const auto& s) { return fitted(s, &ScatteringModel::length); });
  const auto hole = [&](const std::string& name, double (*get)(const PowderHoles&)) {
    add_mean(out, name, all, usable, [&](const auto& s) { return s.holes ? get(*s.holes) : std::nan(""); });
  };
  hole("R_w", [](const PowderHoles& h) { return h.mean_radius; });
  hole("hole_count", [](const PowderHoles& h) { return static_cast<double>(h.count); });
  hole("largest_hole_radius", [](const PowderHoles& h) { return h.largest_radius; });
  return out;
}

std::vector<std::string> structure_remarks(const PowderStructures& all) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < all.samples.size(); ++k) {
    const PowderStructure& s = all.samples[k];
    if (s.curve && !s.fit.usable)
      out.push_back(fmt::format("sample {}: the fit of I(k) is not to be relied on: {}", k, s.fit.reason));
    if (s.holes && s.holes->percolating > 0)
      out.push_back(fmt::format("sample {}: a hole reaches around the cell, so that <R>_w is undefined", k));
  }
  return out;
}

}  // namespace softgrain

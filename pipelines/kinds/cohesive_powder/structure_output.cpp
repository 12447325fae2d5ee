// Structure of powders into HDF5 and the summary.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "pipelines/kinds/cohesive_powder/structure.h"

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

void add_estimate(json& out, const std::string& name, const ScatteringEstimate& e) {
  out[name] = e.value;
  out[name + "_error"] = e.error;
  out[name + "_interval"] = {e.low, e.high};
}

json holes_json(const PowderHoles& holes) {
  return {{"count", holes.count},
          {"fragments", holes.fragments},
          {"mean_radius", holes.mean_radius},
          {"largest_radius", holes.largest_radius},
          {"largest_share", holes.largest_share},
          {"void_fraction", holes.void_fraction},
          {"percolating", holes.percolating}};
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

json fit_json(const ScatteringFit& fit) {
  json out{{"usable", fit.usable}, {"reason", fit.reason}, {"bins", fit.bins}};
  if (fit.covariance.empty()) return out;
  out["k_range"] = {fit.k_low, fit.k_high};
  out["chi2_per_degree"] = fit.chi2_per_degree;
  add_estimate(out, "dF", fit.dimension);
  add_estimate(out, "xi", fit.length);
  add_estimate(out, "amplitude", fit.amplitude);
  add_estimate(out, "c", fit.background);
  return out;
}

json ensemble_fit_json(const PowderStructures& s) {
  json out = fit_json(s.fit);
  out["other_ranges"] = json::array();
  for (const ScatteringFit& fit : s.other_ranges) out["other_ranges"].push_back(fit_json(fit));
  return out;
}

json structure_json(const PowderStructure& s) {
  json out = json::object();
  out["mesh"] = {s.nx, s.ny};
  if (s.curve) out["scattering"] = fit_json(s.fit);
  if (s.holes) out["holes"] = holes_json(*s.holes);
  return out;
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

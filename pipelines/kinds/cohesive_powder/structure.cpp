// Structure of powders: computed, then into HDF5 and the summary.
#include "pipelines/kinds/cohesive_powder/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/dynamics/force_pass.h"
#include "microsim/powder/powder_mesh.h"
#include "microsim/powder/powder_start.h"
#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/kinds/cohesive_powder/summary.h"

namespace softgrain {

namespace {

/// Intensities are kept up to here [1/a], a sixth of the wave number of the mesh.
constexpr double kLastWaveNumber = 100.0;

Vec<2> lengths_of(const System<2>& s) { return {{s.cell.edges[0][0], s.cell.edges[1][1]}}; }

/// Common to all samples, so that their bins can be put together.
std::vector<double> edges_for(const std::vector<const System<2>*>& samples) {
  double longest = 0.0;
  for (const auto* s : samples) longest = std::max({longest, lengths_of(*s)[0], lengths_of(*s)[1]});
  return scattering_bins(2.0 * std::numbers::pi / longest, kLastWaveNumber);
}

/// What a fit may take from the samples: means of solid fraction and of the intensity of independent disks, shortest
/// cell, smallest radius; the largest diameter is the unit.
ScatteringFitOptions fit_options(const PowderStructureOptions& options, const std::vector<PowderStructure>& samples) {
  ScatteringFitOptions o;
  o.k_high = options.fit_k_max;
  double independent = 0.0;
  for (const PowderStructure& s : samples) {
    const double length = std::min(s.lengths[0], s.lengths[1]);
    o.cell_length = o.cell_length > 0.0 ? std::min(o.cell_length, length) : length;
    o.solid_fraction += s.solid_fraction / static_cast<double>(samples.size());
    independent += s.independent / static_cast<double>(samples.size());
    o.lower_length_min = &s == &samples.front() ? s.smallest_radius : std::min(o.lower_length_min, s.smallest_radius);
  }
  o.background_max = independent;
  return o;
}

PowderHoles holes_of(const System<2>& s, PowderMesh& mesh) {
  const std::span<const Sphere<2>> disks(s.particles.sphere.data(), static_cast<std::size_t>(s.particles.grains));
  close_contacts(mesh, disks, contact_records(s));
  double smallest = disks.front().r;
  for (const auto& d : disks) smallest = std::min(smallest, d.r);
  return powder_holes(mesh, 0.5 * smallest_hole_area(smallest));
}

PowderStructure structure_of(const System<2>& s, const std::vector<double>& edges,
                             const PowderStructureOptions& options) {
  PowderStructure out;
  out.lengths = lengths_of(s);
  std::vector<double> diameters;
  for (Slot k = 0; k < s.particles.grains; ++k)
    diameters.push_back(2.0 * s.particles.sphere[static_cast<std::size_t>(k)].r);
  out.solid_fraction = powder_fraction(s);
  out.smallest_radius = 0.5 * *std::min_element(diameters.begin(), diameters.end());
  out.independent = independent_intensity(diameters, out.lengths[0] * out.lengths[1]);
  PowderMesh mesh = powder_mesh(s, options.mesh);
  out.nx = mesh.nx;
  out.ny = mesh.ny;
  if (options.scattering) {
    out.curve = powder_scattering(mesh, edges);
    out.fit = fit_scattering({*out.curve}, fit_options(options, {out}));
  }
  if (options.holes) out.holes = holes_of(s, mesh);
  return out;
}

void fit_ensemble(const std::vector<bool>& usable, const std::vector<double>& edges,
                  const PowderStructureOptions& options, PowderStructures& out) {
  std::vector<ScatteringCurve> curves;
  std::vector<PowderStructure> taken;
  for (std::size_t k = 0; k < out.samples.size(); ++k) {
    if (!usable[k]) continue;
    taken.push_back(out.samples[k]);
    curves.push_back(*out.samples[k].curve);
  }
  if (curves.empty()) {
    out.fit.reason = "no usable sample";
    return;
  }
  out.mean_curve = pooled_curve(curves, edges);
  out.fit = fit_scattering(curves, fit_options(options, taken));
  for (const double share : {2.0 / 3.0, 4.0 / 3.0}) {
    PowderStructureOptions other = options;
    other.fit_k_max *= share;
    out.other_ranges.push_back(fit_scattering(curves, fit_options(other, taken)));
  }
}

}  // namespace

PowderStructures powder_structures(const std::vector<const System<2>*>& samples, const std::vector<bool>& usable,
                                   const PowderStructureOptions& options) {
  PowderStructures out;
  if (samples.empty() || (!options.scattering && !options.holes)) return out;
  const std::vector<double> edges = edges_for(samples);
  for (const auto* s : samples) out.samples.push_back(structure_of(*s, edges, options));
  if (options.scattering) fit_ensemble(usable, edges, options, out);
  return out;
}

namespace {

using nlohmann::json;

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
  if (s.curve) write_scattering(group, {*s.curve, s.fit});
  if (s.holes) write_holes(group.create("holes"), *s.holes);
}

void write_structures(const h5::Group& root, const PowderStructures& s) {
  if (s.mean_curve) write_scattering(root, {*s.mean_curve, s.fit});
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

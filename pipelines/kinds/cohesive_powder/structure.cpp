#include "pipelines/kinds/cohesive_powder/structure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/dynamics/force_pass.h"
#include "microsim/powder/powder_mesh.h"
#include "microsim/powder/powder_start.h"

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

}  // namespace softgrain

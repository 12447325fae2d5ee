// Structure of packed powders beyond their contacts: scattered intensity with its fit, holes; into HDF5 and summary.
#pragma once

#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/scattering_fit.h"
#include "common/data/scattering_curve.h"
#include "common/io/hdf5_file.h"
#include "microsim/powder/powder_holes.h"

namespace softgrain {

/// Table [analysis] of a scene, as far as it concerns the density field.
struct PowderStructureOptions {
  bool scattering = true;
  bool holes = true;
  double mesh = 100.0;                  ///< cells per largest diameter
  double fit_k_max = std::numbers::pi;  ///< upper end of the fitted k [1/a]: distances above two diameters
};

/// What the density field of one sample shows.
struct PowderStructure {
  std::optional<ScatteringCurve> curve;
  ScatteringFit fit;
  std::optional<PowderHoles> holes;
  Vec<2> lengths{};              ///< edge lengths of the cell [a]
  double solid_fraction = 0.0;   ///< solid fraction of the disks
  double independent = 0.0;      ///< independent_intensity of the disks [a^2]
  double smallest_radius = 0.0;  ///< smallest radius of the disks [a]
  std::int64_t nx = 0;
  std::int64_t ny = 0;
};

/// An ensemble: its samples on common bins, and one fit to all that are usable.
struct PowderStructures {
  std::vector<PowderStructure> samples;
  std::optional<ScatteringCurve> mean_curve;
  ScatteringFit fit;                        ///< common parameters of all usable samples
  std::vector<ScatteringFit> other_ranges;  ///< common fits with fit_k_max times 2/3 and 4/3: how much it matters
};

/// One sample after the other (the transform of 1400 disks takes 150 MB). `usable[s]`: whether sample s counts in the
/// mean. Throws InputError, UnusableResult.
PowderStructures powder_structures(const std::vector<const System<2>*>& samples, const std::vector<bool>& usable,
                                   const PowderStructureOptions& options);

/// Group "scattering" (k, intensity, modes; the fit as attributes) and group "holes" (area, radius, x, y, percolates).
void write_structure(const h5::Group& group, const PowderStructure& structure);
/// The mean curve and the common fit: group "scattering".
void write_structures(const h5::Group& root, const PowderStructures& structures);

/// {dF, dF_deviation, xi, xi_deviation, R_w, R_w_deviation, hole_count, ...}: means and sample deviations over usable
/// samples whose value exists, with their number ("dF_samples").
nlohmann::json structure_means_json(const PowderStructures& structures, const std::vector<bool>& usable);

/// Sentences on samples whose fit cannot be relied on, or whose void percolates.
std::vector<std::string> structure_remarks(const PowderStructures& structures);

}  // namespace softgrain

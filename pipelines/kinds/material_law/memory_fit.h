// Shear memory of a cell law, fitted to tests of fines: the mean field of cells (MaterialPoint) is taken through what
// each sample went through.
#pragma once

#include <string>
#include <vector>

#include "common/data/cell_card.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/scene.h"

namespace softgrain {

/// A test of one sample: what its strains were, or its lateral stress where that was held, and what came of it.
struct ShearPath {
  std::size_t sample = 0;
  std::vector<Vec3> strain;           ///< logarithmic strains from the start, compression positive
  std::vector<Vec3> stress;           ///< over E
  std::vector<double> fraction;       ///< solid fraction
  std::vector<bool> sides_by_stress;  ///< whether x and y were held by stress on the way to this point

  /// Nothing where the curve has no solid fraction.
  static ShearPath of(const MacroCurve& curve);
};

/// Numbers that are fitted, without unit; CellMemory names those of the memory, ShearMemory and FaceFriction of
/// macrosim/cell_matter have the equations.
struct ShearNumbers {
  double friction = 0.0;   ///< mu_f: friction coefficient of faces, not negative
  double stiffness = 0.0;  ///< chi: stiffness of the springs of faces over B A/d, above 0
  CellMemory memory;       ///< values of the estimates alone
};

/// What is known before: the equation of state p/E = K x^n (StateForm::porosity), the void ratio of the fines where
/// they jam, and the pressure at which tests start.
struct FinesBase {
  double modulus = 0.0;         ///< K, over E
  double exponent = 0.0;        ///< n
  double void_ratio = 0.0;      ///< e_J
  double start_pressure = 0.0;  ///< over E
};

/// The law along a path: stress over E and solid fraction at its points. The onset at the start is that of the density
/// and pressure of the path there. Empty where the law cannot begin there.
struct ShearPrediction {
  std::vector<Vec3> stress;
  std::vector<double> fraction;
};
ShearPrediction predict(const FinesBase& fines, const ShearNumbers& numbers, const ShearPath& path);

struct ShearMemoryFit {
  bool usable = false;
  std::string message = "not run";
  Estimate friction;
  Estimate stiffness;
  CellMemory memory;
  CellCorrelation correlation;  ///< of the fitted numbers
  double deviation = 0.0;       ///< root mean square of (sigma_z - sigma_x)/p of the law less that of the samples
  std::vector<std::string> undetermined;  ///< pairs of numbers that lean on each other, in words
};

/// Least squares over all paths for mu_f, chi, r_c, m and, with `dense`, A, c and lambda (else 1, 2/3 and 0): ln p and
/// the deviator over p, in units of 8 and 5 %; under constant lateral stress the solid fraction in units of 0.008 in
/// place of p. Every path weighs the same. Errors are Student's over fits to single samples. x_r is where the
/// pressure is kUnloadedPressure of the start pressure. Not usable, with the reason: no convergence, a number at its
/// bound.
ShearMemoryFit fit_shear_memory(const FinesBase& fines, const std::vector<ShearPath>& paths, bool dense);

/// About how long the fit takes [s of one core].
double memory_fit_seconds(const MaterialLawScene& scene);

}  // namespace softgrain

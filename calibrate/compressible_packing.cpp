#include "calibrate/compressible_packing.h"

#include <fmt/format.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "common/core/error.h"
#include "common/core/limits.h"

namespace softgrain {

namespace {

/// Classes with gamma_i, and shares that add up to 1: K(Phi) of the model.
struct VirtualMixture {
  std::vector<PackingClass> classes;
  std::vector<double> gamma;

  [[nodiscard]] double index(double fraction) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < classes.size(); ++i)
      sum += classes[i].share / classes[i].virtual_fraction / (1.0 / fraction - 1.0 / gamma[i]);
    return sum;
  }
};

std::vector<PackingClass> with_unit_sum(std::vector<PackingClass> classes) {
  if (classes.empty()) throw InputError("compressible packing: no class of grains");
  double all = 0.0;
  for (const PackingClass& c : classes) {
    if (!(c.diameter > 0.0 && c.share > 0.0 && c.virtual_fraction > 0.0 && c.virtual_fraction < 1.0))
      throw InputError(fmt::format(
          "compressible packing: diameter {:g}, share {:g}, beta {:g}: the first two must be above 0, beta between 0 "
          "and 1",
          c.diameter, c.share, c.virtual_fraction));
    all += c.share;
  }
  for (PackingClass& c : classes) c.share /= all;
  return classes;
}

}  // namespace

double loosening_effect(double coarse, double fine) { return std::sqrt(1.0 - std::pow(1.0 - fine / coarse, 1.02)); }

double wall_effect(double coarse, double fine) { return 1.0 - std::pow(1.0 - fine / coarse, 1.50); }

std::vector<double> virtual_fractions(const std::vector<PackingClass>& classes) {
  const std::vector<PackingClass> all = with_unit_sum(classes);
  std::vector<double> out;
  for (const PackingClass& i : all) {
    double rest = 1.0;
    for (const PackingClass& j : all) {
      if (j.diameter > i.diameter)
        rest -= (1.0 - i.virtual_fraction +
                 wall_effect(j.diameter, i.diameter) * i.virtual_fraction * (1.0 - 1.0 / j.virtual_fraction)) *
                j.share;
      else
        rest -= (1.0 - loosening_effect(i.diameter, j.diameter) * i.virtual_fraction / j.virtual_fraction) * j.share;
    }
    out.push_back(rest > 0.0 ? i.virtual_fraction / rest : kInfinity);
  }
  return out;
}

double compressible_packing(const std::vector<PackingClass>& classes, double index) {
  if (!(index > 0.0)) throw InputError(fmt::format("compressible packing: K = {:g} must be above 0", index));
  const VirtualMixture mixture{with_unit_sum(classes), virtual_fractions(classes)};
  const double most = *std::min_element(mixture.gamma.begin(), mixture.gamma.end());
  // K(Phi) rises from 0 to infinity below the least gamma: one root. In t = Phi/most, 1/K has no pole.
  struct Equation {
    const VirtualMixture& mixture;
    double most;
    double inverse;
  } equation{mixture, most, 1.0 / index};
  gsl_function function{[](double t, void* p) {
                          const auto& e = *static_cast<const Equation*>(p);
                          return 1.0 / e.mixture.index(t * e.most) - e.inverse;
                        },
                        &equation};
  [[maybe_unused]] static const auto previous = gsl_set_error_handler_off();
  const std::unique_ptr<gsl_root_fsolver, void (*)(gsl_root_fsolver*)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  constexpr double kEnd = 1e-12;
  if (gsl_root_fsolver_set(solver.get(), &function, kEnd, 1.0 - kEnd) != GSL_SUCCESS) return most;
  constexpr int kMost = 200;
  for (int k = 0; k < kMost; ++k) {
    if (gsl_root_fsolver_iterate(solver.get()) != GSL_SUCCESS) break;
    if (gsl_root_fsolver_x_upper(solver.get()) - gsl_root_fsolver_x_lower(solver.get()) < 1e-13) break;
  }
  return most * gsl_root_fsolver_root(solver.get());
}

double virtual_fraction_of(double fraction, double index) { return fraction * (1.0 + 1.0 / index); }

std::vector<PackingClass> packing_classes(const Grading& sizes, double virtual_fraction) {
  constexpr double kPerDecade = 10.0;
  const double low = sizes.smallest();
  const double high = sizes.largest();
  const auto count = std::max(1.0, std::ceil(kPerDecade * std::log10(high / low) - 1e-9));
  std::vector<PackingClass> out;
  for (double k = 0.0; k < count; k += 1.0) {
    const double from = low * std::pow(high / low, k / count);
    const double to = low * std::pow(high / low, (k + 1.0) / count);
    const bool last = k + 1.0 >= count;
    double share = 0.0;  // the largest grains belong to the last class
    for (const SizePiece& p : pieces_between(sizes, k > 0.0 ? from : 0.0, last ? 2.0 * high : to)) share += p.volume;
    if (share > 0.0) out.push_back({2.0 * std::sqrt(from * to), share, virtual_fraction});
  }
  return out;
}

}  // namespace softgrain

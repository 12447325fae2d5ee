#include "macrosim/cell_matter/equation_of_state.h"

#include <fmt/format.h>
#include <gsl/gsl_sf_hyperg.h>

#include <cmath>
#include <limits>

#include "common/core/error.h"

namespace softgrain {

CellResponse PoreForm::at(const CellContent& c, double volume) const {
  const double y = 1.0 - relative_pores(c, volume);
  if (!(y > 0.0)) return {};
  const double p = modulus * std::pow(y, exponent);
  const double stiffness = exponent * p / (y * c.pores);
  return {p, stiffness, c.pores * p * y / (exponent + 1.0), (1.0 - exponent) * stiffness / (y * c.pores)};
}

double PoreForm::fines(double volume, double grain, double excess, double void_ratio, double y) const {
  return (volume - grain - (1.0 - y) * excess) / (1.0 + (1.0 - y) * void_ratio);
}

CellResponse PorosityForm::at(const CellContent& c, double volume) const {
  const double onset = c.solid / (c.solid + c.pores);
  const double phi = c.solid / volume;
  const double t = phi - onset;
  if (!(t > 0.0)) return {};
  const double x = t * (c.solid + c.pores) / c.pores;
  const double p = modulus * std::pow(x, exponent);
  const double stiffness = exponent * p / t * phi / volume;
  // Beyond phi = 1, where the guard refuses the cell, the series is not needed.
  const double series = phi < 1.0 ? gsl_sf_hyperg_2F1(1.0, 2.0, exponent + 2.0, t / phi) : 1.0;
  return {p, stiffness, p * c.solid * t / ((exponent + 1.0) * phi * phi) * series,
          ((1.0 - exponent) * phi / t - 2.0) * stiffness / volume};
}

double PorosityForm::fines(double volume, double grain, double excess, double void_ratio, double x) const {
  const double a = 1.0 + void_ratio;
  const double b = grain * (1.0 + a) + excess - volume * (1.0 + x * void_ratio);
  const double c = grain * (grain + excess) - volume * (grain + x * excess);
  const double root = std::sqrt(b * b - 4.0 * a * c);
  return b < 0.0 ? (-b + root) / (2.0 * a) : -2.0 * c / (b + root);
}

double modulus(const EquationOfState& equation) {
  return std::visit([](const auto& form) { return form.modulus; }, equation);
}

double exponent(const EquationOfState& equation) {
  return std::visit([](const auto& form) { return form.exponent; }, equation);
}

double state_at(const EquationOfState& equation, double pressure) {
  return std::pow(pressure / modulus(equation), 1.0 / exponent(equation));
}

CellResponse PoreGuard::at(const CellContent& c, double volume, double modulus) const {
  const double q = relative_pores(c, volume);
  if (q >= from) return {};
  const double u = from / q;
  return {modulus * (u - 1.0) * (u - 1.0), 2.0 * modulus * (u - 1.0) * u / (q * c.pores),
          modulus * c.pores * from * (u - 1.0 / u - 2.0 * std::log(u)),
          2.0 * modulus * (2.0 - 3.0 * u) * u / (q * q * c.pores * c.pores)};
}

namespace {

CellResponse respond_with_tail(const PorosityForm& form, const CellContent& c, double volume, double tail) {
  const double onset = c.solid / (c.solid + c.pores);
  const double end = c.solid / (onset + tail * (1.0 - onset));
  const CellResponse last = form.at(c, end);
  const double energy = 2.0 * last.pressure * last.pressure / last.stiffness;
  if (volume < end) {
    CellResponse out = form.at(c, volume);
    out.energy += energy - last.energy;
    return out;
  }
  const double rate = last.stiffness / last.pressure;
  const double u = 1.0 / (1.0 + 0.5 * (volume - end) * rate);
  const double stiffness = last.stiffness * u * u * u;
  return {last.pressure * u * u, stiffness, energy * u, -1.5 * stiffness * u * rate};
}

}  // namespace

CellResponse respond(const EquationOfState& equation, const PoreGuard& guard, const CellContent& c, double volume,
                     double tail) {
  if (!(volume > c.solid)) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    return {kNone, kNone, kNone, -kNone};
  }
  const auto* porosity = tail > 0.0 ? std::get_if<PorosityForm>(&equation) : nullptr;
  CellResponse out = porosity != nullptr ? respond_with_tail(*porosity, c, volume, tail)
                                         : std::visit([&](const auto& form) { return form.at(c, volume); }, equation);
  const CellResponse more = guard.at(c, volume, modulus(equation));
  out.pressure += more.pressure;
  out.stiffness += more.stiffness;
  out.energy += more.energy;
  out.hardening += more.hardening;
  return out;
}

void require_valid(const EquationOfState& equation, const PoreGuard& guard) {
  const double a = modulus(equation);
  const double n = exponent(equation);
  if (!(a > 0.0) || !std::isfinite(a))
    throw InputError(fmt::format("equation of state: modulus {} Pa; it must be above 0", a));
  if (!(n > 1.0) || !std::isfinite(n))
    throw InputError(
        fmt::format("equation of state: exponent {}; it must be above 1, or stiffness jumps at the onset", n));
  if (!(guard.from >= 0.0 && guard.from < 1.0))
    throw InputError(
        fmt::format("equation of state: guard from {} of the pores on; it must be within [0, 1)", guard.from));
}

}  // namespace softgrain

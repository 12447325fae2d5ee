#include "macrosim/cell_matter/cell_start.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "common/core/error.h"
#include "common/core/particles.h"

namespace softgrain {

namespace {

double fines_in_cell(const EquationOfState& equation, double volume, double grain, double excess, double void_ratio,
                     double state) {
  return std::visit([&](const auto& form) { return form.fines(volume, grain, excess, void_ratio, state); }, equation);
}

/// Sums over the cells, and each cell's share of the surface.
struct Mixture {
  const FinesLaw& law;
  const CoarseBodies& bodies;
  const std::vector<double>& volume;
  double fines = 0.0;
  double room = 0.0;
  double coarse = 0.0;
  double surface = 0.0;
  double excess = 0.0;  ///< W

  Mixture(const FinesLaw& law_, const CoarseBodies& bodies_, const std::vector<double>& volume_, double fines_)
      : law(law_), bodies(bodies_), volume(volume_), fines(fines_) {
    require_values();
    for (std::size_t i = 0; i < volume.size(); ++i) {
      room += volume[i];
      coarse += bodies.grain(i);
      surface += bodies.surface(i);
    }
    excess = coarse > 0.0 ? law.excess.volume(fines, coarse) : 0.0;
    if (!(room > coarse + fines))
      throw InputError(
          fmt::format("start of cells: coarse grains and fines fill {:.4g} of the room, which leaves no pores",
                      (coarse + fines) / room));
  }

  void require_values() const {
    require_valid(law.equation, {});
    if (!(law.void_ratio > 0.0))
      throw InputError(fmt::format("start of cells: void ratio of the fines {}; it must be above 0", law.void_ratio));
    if (!(law.excess.alone >= 0.0 && law.excess.many >= 0.0 && law.excess.decay > 0.0))
      throw InputError("start of cells: excess pores need void ratios from 0 on and a decay above 0");
    if (!(fines >= 0.0) || !std::isfinite(fines))
      throw InputError(fmt::format("start of cells: {} m^3 of fines; a volume from 0 on is needed", fines));
    if (volume.empty() || volume.size() != bodies.radius.size() ||
        (!bodies.soft.empty() && bodies.soft.size() != volume.size()))
      throw InputError("start of cells: one volume, one radius and one kind for each body are needed");
    for (std::size_t i = 0; i < volume.size(); ++i)
      if (!(volume[i] > bodies.grain(i)) || !std::isfinite(volume[i]))
        throw InputError(fmt::format("start of cells: cell {} has a volume of {:.6g} m^3 and its grain {:.6g} m^3", i,
                                     volume[i], bodies.grain(i)));
  }

  [[nodiscard]] double excess_of(std::size_t i, double s) const {
    return surface > 0.0 ? s * excess * bodies.surface(i) / surface : 0.0;
  }
  [[nodiscard]] double fines_of(std::size_t i, double s, double state) const {
    return fines_in_cell(law.equation, volume[i], bodies.grain(i), excess_of(i, s), law.void_ratio, state);
  }
  [[nodiscard]] bool all_hold_fines(double s, double state) const {
    for (std::size_t i = 0; i < volume.size(); ++i)
      if (!(fines_of(i, s, state) >= 0.0)) return false;
    return true;
  }
  /// Cells too small for any hold none.
  [[nodiscard]] double fines_of_all(double s, double state) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < volume.size(); ++i)
      if (const double v = fines_of(i, s, state); v > 0.0) sum += v;
    return sum;
  }
  /// Pores at the onset of a cell that holds its grain alone and has this state.
  [[nodiscard]] double pores_without_fines(std::size_t i, double state) const {
    const double pores = volume[i] - bodies.grain(i);
    if (std::holds_alternative<PoreForm>(law.equation)) return pores / (1.0 - state);
    const double onset = (bodies.grain(i) / volume[i] - state) / (1.0 - state);
    if (!(onset > 0.0))
      throw InputError(fmt::format("start of cells: cell {} is too wide for a grain without fines", i));
    return bodies.grain(i) * (1.0 - onset) / onset;
  }

  [[nodiscard]] CellStart at(double s, double state) const {
    CellStart out;
    out.excess_share = s;
    out.state = state;
    out.pressure = modulus(law.equation) * std::pow(state, exponent(law.equation));
    for (std::size_t i = 0; i < volume.size(); ++i) {
      const double v = fines_of(i, s, state);
      if (v >= 0.0) {
        out.fines.push_back(v);
        out.content.push_back({bodies.grain(i) + v, law.void_ratio * v + excess_of(i, s),
                               law.critical_pores * (law.void_ratio * v + excess_of(i, law.of_preparation ? s : 1.0))});
        continue;
      }
      ++out.without_fines;
      out.fines.push_back(0.0);
      const double pores = pores_without_fines(i, state);
      out.content.push_back({bodies.grain(i), pores, law.critical_pores * pores});
    }
    constexpr double kMostWithout = 0.25;
    if (out.without_fines > kMostWithout * static_cast<double>(volume.size()))
      throw InputError(fmt::format(
          "start of cells: {} of {} cells are too small for their grain and the excess pores beside it, and "
          "would hold no fines; take a lower pressure, more fines, fewer coarse bodies, or places where "
          "they are less close",
          out.without_fines, volume.size()));
    return out;
  }
};

/// Where a falling function is 0; f(low) >= 0 >= f(high).
template <class F>
double bisect(double low, double high, const F& f) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (f(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double ExcessPores::volume(double fines, double coarse) const {
  return coarse * (many + (alone - many) * std::exp(-fines / coarse / decay));
}

double CoarseBodies::grain(std::size_t i) const { return is_soft(i) ? 0.0 : kSphereVolume * cube(radius[i]); }

double CoarseBodies::surface(std::size_t i) const {
  return is_soft(i) ? 0.0 : 4.0 * std::numbers::pi * radius[i] * radius[i];
}

CellStart start_at_pressure(const FinesLaw& law, const CoarseBodies& bodies, const std::vector<double>& volume,
                            double fines, double pressure) {
  const Mixture mixture(law, bodies, volume, fines);
  const double state = state_at(law.equation, pressure);
  if (!(pressure > 0.0) || !(state < 1.0))
    throw InputError(
        fmt::format("start of cells: start pressure {} Pa; it must be above 0 and below {} Pa, where no pores are left",
                    pressure, modulus(law.equation)));
  if (!(mixture.excess > 0.0))
    throw InputError(
        "start of cells: a start pressure sets the excess pores of coarse grains, and there are none; give the density "
        "alone");
  if (!(mixture.fines_of_all(0.0, state) >= fines))
    throw InputError(fmt::format(
        "start of cells: at {} Pa there is no room for {:.6g} m^3 of fines even without excess pores (at most {:.6g} "
        "m^3): the start pressure is too low, or the fines jam denser than their void ratio says",
        pressure, fines, mixture.fines_of_all(0.0, state)));
  if (std::holds_alternative<PoreForm>(law.equation)) {
    const double left = 1.0 - state;
    const double s = (mixture.room - mixture.coarse - fines * (1.0 + left * law.void_ratio)) / (left * mixture.excess);
    if (mixture.all_hold_fines(s, state)) return mixture.at(s, state);
  }
  const auto too_many = [&](double s) { return mixture.fines_of_all(s, state) - fines; };
  double high = 1.0;
  while (too_many(high) > 0.0 && high < 1e6) high *= 2.0;
  return mixture.at(bisect(0.0, high, too_many), state);
}

double room_at_pressure(const FinesLaw& law, double fines, double coarse, double pressure) {
  const double state = state_at(law.equation, pressure);
  const double solid = coarse + fines;
  if (!(pressure > 0.0) || !(state < 1.0) || !(solid > 0.0))
    throw InputError(fmt::format("start of cells: no room for {} m^3 of solid at {} Pa", solid, pressure));
  const double pores = law.void_ratio * fines + (coarse > 0.0 ? law.excess.volume(fines, coarse) : 0.0);
  if (std::holds_alternative<PoreForm>(law.equation)) return solid + (1.0 - state) * pores;
  const double onset = solid / (solid + pores);
  return solid / (onset + state * (1.0 - onset));
}

CellStart start_at_density(const FinesLaw& law, const CoarseBodies& bodies, const std::vector<double>& volume,
                           double fines) {
  const Mixture mixture(law, bodies, volume, fines);
  const double pores = mixture.room - mixture.coarse - fines;
  const double jammed = mixture.excess + fines * law.void_ratio;
  const auto too_few = [&](double state) { return fines - mixture.fines_of_all(1.0, state); };
  if (!(pores < jammed) || !(too_few(0.0) > 0.0))
    throw InputError(fmt::format(
        "start of cells: the mixture does not jam at this density: its pores are {:.4g} of those at which it would",
        pores / jammed));
  if (std::holds_alternative<PoreForm>(law.equation) && mixture.all_hold_fines(1.0, 1.0 - pores / jammed))
    return mixture.at(1.0, 1.0 - pores / jammed);
  return mixture.at(1.0, bisect(0.0, 1.0, too_few));
}

}  // namespace softgrain

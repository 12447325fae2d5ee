#include "calibrate/state_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr std::size_t kFewestPoints = 4;

void require_curve(const StateCurve& c, std::size_t k) {
  if (c.phi.size() != c.pressure.size() || (!c.weight.empty() && c.weight.size() != c.phi.size()))
    throw InputError(fmt::format("equation of state: curve {} has {} solid fractions, {} pressures and {} weights", k,
                                 c.phi.size(), c.pressure.size(), c.weight.size()));
  if (!(c.span >= 1.0) || !std::isfinite(c.span))
    throw InputError(fmt::format("equation of state: curve {} has a span of {}; it must be 1 or more", k, c.span));
  for (std::size_t i = 0; i < c.phi.size(); ++i) {
    if (!(c.phi[i] > 0.0 && c.phi[i] < 1.0) || !std::isfinite(c.pressure[i]))
      throw InputError(fmt::format(
          "equation of state: curve {}, point {}: solid fraction {} and p/E {}; a fraction between 0 and 1 and a "
          "number are needed",
          k, i, c.phi[i], c.pressure[i]));
    if (!c.weight.empty() && !(c.weight[i] >= 0.0 && std::isfinite(c.weight[i])))
      throw InputError(
          fmt::format("equation of state: curve {}, point {}: weight {}; it must be 0 or more", k, i, c.weight[i]));
  }
}

}  // namespace

StateSamples read_state_curves(const std::vector<StateCurve>& curves) {
  if (curves.empty()) throw InputError("equation of state: no curves");
  StateSamples out;
  std::map<std::pair<double, std::string>, std::size_t> index;
  std::map<std::string, double> span;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    require_curve(curves[k], k);
    const auto [at, fresh] = span.insert({curves[k].group, curves[k].span});
    if (at->second != curves[k].span)
      throw InputError(fmt::format("equation of state: group {} has spans of {} and {}", curves[k].group, at->second,
                                   curves[k].span));
    index[{curves[k].span, curves[k].group}] = 0;
  }
  for (auto& [key, g] : index) {
    g = out.groups.size();
    out.groups.push_back({key.second, key.first, 0, 0});
  }
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const StateCurve& c = curves[k];
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < c.phi.size(); ++i)
      if (c.pressure[i] > 0.0) order.push_back(i);
    out.left_out += static_cast<int>(c.phi.size() - order.size());
    if (order.empty())
      throw InputError(
          fmt::format("equation of state: curve {} (group {}) never bears: no point above the onset", k, c.group));
    if (order.size() < kFewestPoints)
      throw InputError(fmt::format("equation of state: curve {} (group {}) has {} with pressure; {} or more are needed",
                                   k, c.group, counted(order.size(), "point"), kFewestPoints));
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return c.pressure[a] < c.pressure[b]; });
    StateSample s;
    s.group = index[{c.span, c.group}];
    for (const std::size_t i : order) {
      s.pressure.push_back(c.pressure[i]);
      s.log_pressure.push_back(std::log(c.pressure[i]));
      s.phi.push_back(c.phi[i]);
      s.root_weight.push_back(c.weight.empty() ? 1.0 : std::sqrt(c.weight[i]));
    }
    StateSamples::Group& group = out.groups[s.group];
    ++group.samples;
    group.points += static_cast<int>(order.size());
    out.points += order.size();
    out.samples.push_back(std::move(s));
  }
  return out;
}

/// Slopes of phi with u = (p/K)^(1/n): porosity phi = phi_J + (1 - phi_J) u; pores e = e_J (1 - u).
PhiSlopes phi_slopes(StateForm form, double log_modulus, double exponent, double onset, double pressure) {
  const double z = (std::log(pressure) - log_modulus) / exponent;
  const double u = std::exp(z);
  const double by_k = -u / exponent;
  const double by_n = -u * z / exponent;
  if (form == StateForm::porosity)
    return {onset + (1.0 - onset) * u, (1.0 - onset) * by_k, (1.0 - onset) * by_n, 1.0 - u};
  const double jammed = 1.0 / onset - 1.0;
  const double phi = 1.0 / (1.0 + jammed * (1.0 - u));
  return {phi, phi * phi * jammed * by_k, phi * phi * jammed * by_n, phi * phi * (1.0 - u) / (onset * onset)};
}

double state_phi(StateForm form, double modulus, double exponent, double onset, double pressure) {
  return pressure > 0.0 ? phi_slopes(form, std::log(modulus), exponent, onset, pressure).value : onset;
}

double onset_at(StateForm form, double modulus, double exponent, double phi, double pressure) {
  const double state = std::pow(pressure / modulus, 1.0 / exponent);
  if (form == StateForm::porosity) return (phi - state) / (1.0 - state);
  return 1.0 / (1.0 + (1.0 / phi - 1.0) / (1.0 - state));
}

double state_of_phi(StateForm form, double onset, double phi) {
  return form == StateForm::porosity ? (phi - onset) / (1.0 - onset) : 1.0 - (1.0 / phi - 1.0) / (1.0 / onset - 1.0);
}

double phi_of_state(StateForm form, double onset, double state) {
  if (form == StateForm::porosity) return onset + (1.0 - onset) * state;
  return 1.0 / (1.0 + (1.0 / onset - 1.0) * (1.0 - state));
}

double state_pressure(StateForm form, double modulus, double exponent, double onset, double phi) {
  const double state = state_of_phi(form, onset, phi);
  return state > 0.0 ? modulus * std::pow(state, exponent) : 0.0;
}

}  // namespace softgrain

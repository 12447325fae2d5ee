#include "common/data/card_text.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>

namespace softgrain {

std::string real(double value) {
  if (std::isnan(value)) return "\"nan\"";
  if (std::isinf(value)) return value > 0.0 ? "\"inf\"" : "\"-inf\"";
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::optional<Beyond> read_beyond(const SceneTable& table) {
  if (!table.has("beyond")) return std::nullopt;
  const std::string word = table.choice("beyond", {"error", "clamp", "extrapolate"});
  if (word == "error") return Beyond::error;
  return word == "clamp" ? Beyond::clamp : Beyond::extrapolate;
}

std::string spec_text(const SoftParticleSpec& s) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "shell_radius = {}  # Rs [m]\n", real(s.shell_radius));
  fmt::format_to(out, "youngs_modulus = {}  # E [Pa]\n", real(s.youngs_modulus));
  fmt::format_to(out, "poisson_ratio = {}  # nu\n", real(s.poisson_ratio));
  fmt::format_to(out, "friction = {}  # mu\n", real(s.friction));
  fmt::format_to(out, "density = {}  # [kg/m^3]\n", real(s.density));
  fmt::format_to(out, "restitution = {}\n", real(s.restitution));
  fmt::format_to(out, "exponent = {}  # b of P(r) ~ r^-b\n", real(s.exponent));
  fmt::format_to(out, "polydispersity = {}  # rmax/rmin\n", real(s.polydispersity));
  fmt::format_to(out, "rmax_over_shell = {}  # rmax/Rs\n", real(s.rmax_over_shell));
  fmt::format_to(out, "beta = {}  # volume of drawn grains over volume of the shell\n", real(s.beta));
  fmt::format_to(out, "trials = {}  # random positions tried per grain\n", s.trials);
  fmt::format_to(out, "placement = {}  # blind trials, or the same law by looking only where there is room\n",
                 quoted(s.placement == Placement::voids ? "voids" : "trials"));
  return text;
}

std::string estimate_text(const Estimate& e) {
  return fmt::format("{{ value = {}, standard_error = {}, low = {}, high = {} }}", real(e.value),
                     real(e.standard_error), real(e.low), real(e.high));
}

double read_real(const SceneTable& table, const std::string& key, const Range& range) {
  if (!table.is_text(key)) return table.number(key, Unit::none, range);
  const std::string word = table.choice(key, {"nan", "inf", "-inf"});
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  return word == "inf" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
}

SoftParticleSpec read_spec_text(const SceneTable& table) {
  SoftParticleSpec s;
  s.shell_radius = table.number("shell_radius", Unit::length, Range::positive());
  s.youngs_modulus = table.number("youngs_modulus", Unit::pressure, Range::positive());
  s.poisson_ratio = table.number("poisson_ratio", Unit::none, Range{-1.0, 0.5, true, false});
  s.friction = table.number("friction", Unit::none, Range::not_negative());
  s.density = table.number("density", Unit::density, Range::positive());
  s.restitution = table.number("restitution", Unit::none, Range::closed(0.0, 1.0));
  s.exponent = table.number("exponent", Unit::none);
  s.polydispersity =
      table.number("polydispersity", Unit::none, Range{1.0, std::numeric_limits<double>::infinity(), false, false});
  s.rmax_over_shell = table.number("rmax_over_shell", Unit::none, Range{0.0, 1.0, true, false});
  s.beta = table.number("beta", Unit::none, Range::positive());
  s.trials = table.count("trials", 1, std::numeric_limits<std::int64_t>::max());
  s.placement =
      table.choice("placement", {"trials", "voids"}, "trials") == "voids" ? Placement::voids : Placement::trials;
  return s;
}

Estimate read_estimate_text(const SceneTable& table, const Range& range) {
  Estimate e;
  e.value = table.number("value", Unit::none, range);
  e.standard_error = read_real(table, "standard_error", Range::not_negative());
  e.low = read_real(table, "low", Range::any());
  e.high = read_real(table, "high", Range::any());
  return e;
}

}  // namespace softgrain

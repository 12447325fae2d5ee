// A card of the cell law for a terminal, and as JSON.
#include <fmt/format.h>

#include <cmath>

#include "common/contact/rolling_scene.h"
#include "common/core/text.h"
#include "common/data/cell_card.h"
#include "common/data/law_words.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_json.h"
#include "pipelines/law/law_values.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain {
namespace law {

namespace {

std::string state_text(const CellCard& card) {
  return card.form == StateForm::porosity ? "x = (phi - phi_J)/(1 - phi_J)" : "x = 1 - Vp/Vp_J";
}

/// The equation of state over the range of its fit.
std::string plot_of(const CellCard& card, bool utf8) {
  TerminalPlot plot{"x", "p/E of fines", 76, 10, utf8, {}};
  TerminalCurve line;
  constexpr std::size_t kPoints = 240;
  const double end = std::pow(card.pressure_high / card.modulus.value, 1.0 / card.exponent.value);
  for (const double x : even(0.0, end, kPoints)) {
    line.x.push_back(x);
    line.y.push_back(card.modulus.value * std::pow(x, card.exponent.value));
  }
  plot.curves = {line};
  return draw(plot);
}

}  // namespace

std::string show(const CellCard& card, const FittedLaw& file, bool utf8) {
  std::string text = wrapped("cell law " + file.path + ": coarse grains in cells of fines, material without shells", 2);
  if (const std::string origin = origin_text(file.origin); !origin.empty()) text += wrapped(origin, 2);
  text += wrapped(
      fmt::format("measured on {} each, fines {}, largest over smallest {}, split at {} of the largest grain; "
                  "E = {}, density {}, nu = {}, mu = {}{}, prepared '{}' to p/E = {}",
                  counted(card.samples, "sample"), on_one_line(card.fines_sizes), number(card.fines_ratio),
                  number(card.split), is_known(card.youngs_modulus) ? number(card.youngs_modulus) + " Pa" : "not said",
                  is_known(card.density) ? number(card.density) + " kg/m^3" : "not said", number(card.poisson_ratio),
                  number(card.grain_friction), rolling_text(card.grain_rolling), card.preparation,
                  number(card.start_pressure)),
      2);
  text += fmt::format("\n{} form, {}\n", to_string(card.form), state_text(card));
  std::vector<std::vector<std::string>> rows{{"", "", "value", "error", "95 % interval"}};
  for (const CellCardNumber& n : numbers_of(card)) {
    const Estimate& e = n.estimate;
    rows.push_back({n.key, number(e.value), std::isfinite(e.standard_error) ? number(e.standard_error, 2) : "-",
                    ends_text(e.low, e.high, {.number = number, .may_be_equal = true}), n.meaning});
  }
  for (const PreparationFactor& p : card.preparations)
    rows.push_back({p.preparation, number(p.factor.value),
                    std::isfinite(p.factor.standard_error) ? number(p.factor.standard_error, 2) : "-",
                    ends_text(p.factor.low, p.factor.high, {.number = number, .may_be_equal = true}),
                    "factor on e_J, e_c and w_inf of grains prepared so"});
  text += aligned(rows, 2, 2);
  text += wrapped(fmt::format("  holds for p/E = {} to {}, up to {} times as much fines as coarse grains by volume",
                              number(card.pressure_low), number(card.pressure_high), number(card.mixture_high)),
                  4);
  return text + "\n" + plot_of(card, utf8);
}

}  // namespace law

nlohmann::json law_json(const CellCard& card) {
  nlohmann::json out{{"form", to_string(card.form)},
                     {"pressure_range", {card.pressure_low, card.pressure_high}},
                     {"mixture_max", card.mixture_high},
                     {"E", json_of(card.youngs_modulus)},
                     {"density", json_of(card.density)},
                     {"nu", card.poisson_ratio},
                     {"mu", card.grain_friction},
                     {"preparation", card.preparation},
                     {"start_pressure", card.start_pressure},
                     {"split", card.split},
                     {"fines_ratio", card.fines_ratio},
                     {"fines_sizes", card.fines_sizes},
                     {"samples", card.samples}};
  if (card.grain_rolling.friction > 0.0) {
    out["mu_r"] = card.grain_rolling.friction;
    out["kr_ratio"] = card.grain_rolling.stiffness;
  }
  const auto json_of_estimate = [](const Estimate& e) -> nlohmann::json {
    return {{"value", json_of(e.value)},
            {"standard_error", json_of(e.standard_error)},
            {"interval", {json_of(e.low), json_of(e.high)}}};
  };
  for (const CellCardNumber& n : numbers_of(card)) out[n.key] = json_of_estimate(n.estimate);
  for (const PreparationFactor& p : card.preparations)
    out["void_ratio_factors"][p.preparation] = json_of_estimate(p.factor);
  return out;
}

}  // namespace softgrain

#include "pipelines/law/fitted_law.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "common/core/text.h"
#include "common/data/law_card_format.h"
#include "common/data/law_words.h"
#include "pipelines/law/law_values.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain::law {

namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string interval(const Estimate& e) { return ends_text(e.low, e.high, {number}); }

std::string error_text(const Estimate& e) {
  return std::isfinite(e.standard_error) && e.standard_error > 0.0 ? number(e.standard_error, 2) : "-";
}

std::string part_title(const PairLaw& law, LawPart part) {
  if (part == LawPart::normal) return "normal force, F/(E Rs^2)";
  if (part == LawPart::tangential_initial)
    return fmt::format("tangential stiffness kt/(E Rs), initial slope (to {} degrees)", law.initial_angle_deg);
  return fmt::format("tangential stiffness kt/(E Rs), secant at {} degrees", law.secant_angle_deg);
}

/// a and c also in newtons, or newtons per metre, for the soft particle that was measured.
void add_part(Rows& rows, const PairLaw& law, LawPart part, const SoftParticleSpec& spec) {
  const bool normal = part == LawPart::normal;
  const double unit = spec.youngs_modulus * spec.shell_radius * (normal ? spec.shell_radius : 1.0);
  for (const LawParameterName& p : kLawParameters) {
    const Estimate& e = part_of(law, part).*p.estimate;
    std::vector<std::string> row{p.key, number(e.value), error_text(e), interval(e)};
    if (p.has_dimension) row.push_back(number(e.value * unit) + (normal ? " N" : " N/m"));
    rows.push_back(std::move(row));
  }
}

/// All parts in the same columns, each under its title.
std::string parameters_text(const PairLaw& law, const SoftParticleSpec& spec) {
  Rows rows{{"", "value", "error", "95 % interval", "here"}};
  std::vector<std::string> titles;
  for (const LawPart part : kAllLawParts) {
    if (!has_part(law, part)) continue;
    titles.push_back(part_title(law, part));
    add_part(rows, law, part, spec);
  }
  if (titles.empty()) return "  no law was fitted\n";
  std::istringstream lines(aligned(rows, 4));
  std::string text;
  std::string line;
  for (std::size_t k = 0; std::getline(lines, line); ++k) {
    if (k > 0 && (k - 1) % kLawParameters.size() == 0) text += "  " + titles[(k - 1) / kLawParameters.size()] + "\n";
    text += line + "\n";
  }
  return text;
}

std::string range_text(const PairLaw& law) {
  std::string text = fmt::format("  valid for Delta = {} to {}; beyond: {}", number(law.delta_min),
                                 number(law.delta_max), to_string(law.beyond));
  if (law.max_overlap > 0.0)
    text += fmt::format("; grains overlap in that range by up to {} of the smaller radius", number(law.max_overlap, 2));
  return wrapped(text, 4);
}

/// The normal law up to the end of its range, with its 95 % band and the measured means.
std::string plot_of(const PairLaw& law, bool utf8) {
  if (!has_part(law, LawPart::normal) || !(law.delta_max > 0.0)) return "";
  TerminalPlot plot{"Delta", "F/(E Rs^2), " + to_string(law.kind), 76, 10, utf8, {}};
  TerminalCurve low{{}, {}, TerminalCurve::Look::dotted};
  TerminalCurve high = low;
  TerminalCurve line;
  constexpr std::size_t kPoints = 240;
  for (const double d : even(0.0, law.delta_max, kPoints)) {
    line.x.push_back(d);
    line.y.push_back(law.normal.value(d));
    if (const auto band = value_interval(law, LawPart::normal, d)) {
      low.x.push_back(d);
      low.y.push_back(band->low);
      high.x.push_back(d);
      high.y.push_back(band->high);
    }
  }
  const bool band = !low.x.empty();
  const std::string origin = band ? value_interval(law, LawPart::normal, law.delta_max)->origin : "";
  plot.curves = {low, high, line, {law.table.delta, law.table.force_mean, TerminalCurve::Look::marks, 'o'}};
  std::string key = "  line: the law";
  if (band) key += "; dots: 95 %, " + origin;
  if (!law.table.delta.empty()) key += "; o: measured means";
  return draw(plot) + wrapped(key, 4);
}

std::string pair_text(const PairLaw& law, const SoftParticleSpec& spec, bool utf8) {
  std::string text = fmt::format("{}: {}", to_string(law.kind), to_string(law.status));
  if (!law.reason.empty()) text += " (" + law.reason + ")";
  text += fmt::format(", {}, {}", counted(law.packings, "packing"), counted(law.points, "point"));
  if (law.chi2_per_dof > 0.0)
    text += fmt::format(", chi^2 per degree of freedom {} (probability of a larger one {})",
                        number(law.chi2_per_dof, 2), number(law.quality, 3));
  text = wrapped(text, 4) + range_text(law);
  text += parameters_text(law, spec);
  if (law.unloading) text += wrapped("  " + unloading_text(law), 4);
  return text + plot_of(law, utf8);
}

}  // namespace

std::string number(double x, int digits) { return rounded_text(x, {digits}); }

std::string origin_text(const LawOrigin& o) {
  if (o.version.empty() && o.command.empty()) return "";
  std::string text = "made by softgrain " + o.version;
  if (!o.commit.empty()) text += " (" + o.commit + ")";
  if (!o.seed.empty()) text += ", seed " + o.seed;
  return o.command.empty() ? text : text + ": " + o.command;
}

std::string show_spec(const SoftParticleSpec& s) {
  const auto known = [](double x) { return is_known(x) ? number(x) : std::string("?"); };
  std::string text = fmt::format("Rs = {} m, E = {} Pa, nu = {}, mu = {}, {} kg/m^3; ", number(s.shell_radius),
                                 number(s.youngs_modulus), known(s.poisson_ratio), known(s.friction), known(s.density));
  if (!packing_known(s)) return text + "what is inside is not known";
  const std::string sizes = s.sizes ? "sizes: " + s.sizes->name() : fmt::format("radii r^-{}", number(s.exponent));
  return text + fmt::format("{} with rmax/rmin = {}, rmax/Rs = {}, beta = {}, {} trials{}", sizes,
                            number(s.polydispersity), number(s.rmax_over_shell), number(s.beta), s.trials,
                            s.placement == Placement::voids ? " in voids" : "");
}

std::string show(const LawCard& card, const FittedLaw& file, bool utf8) {
  std::string text = wrapped(fmt::format("{}: law card, {}", file.path, measured_text(card)), 2);
  text += wrapped("  " + show_spec(card.spec), 2);
  const std::string origin = origin_text(file.origin);
  if (!origin.empty()) text += wrapped("  " + origin, 2);
  for (const std::string& note : card.notes) text += wrapped("  note: " + note, 4);
  if (const std::string remark = kt_remark(card); !remark.empty()) text += wrapped("  note: " + remark, 4);
  for (const PairLaw& law : card.pairs) text += "\n" + pair_text(law, card.spec, utf8);
  return text + "\n" +
         wrapped(
             "F(Delta) = a Delta^b + c for Delta >= delta, else 0; c = -a delta^b. a, b and delta are nearly "
             "degenerate: judge a law by its values (softgrain law eval). Column \"here\": for the E and Rs above.",
             0);
}

std::string law_text(const FittedLaw& file, bool utf8) {
  return std::visit([&](const auto& law) { return show(law, file, utf8); }, file.content);
}

}  // namespace softgrain::law

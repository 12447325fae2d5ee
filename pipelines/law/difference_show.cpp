// The comparison of two laws for a terminal.
#include <fmt/format.h>

#include <cmath>

#include "common/core/text.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_difference.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain::law {

namespace {

std::string interval(const Quantity& q) {
  return q.interval ? fmt::format("{:.3g} .. {:.3g}", q.interval->low, q.interval->high) : "-";
}

std::string source_text(const FittedLaw& file, double solid_fraction) {
  const LawCard* card = file.card();
  if (card == nullptr) return fmt::format("law table, at solid fraction {:.4f}", solid_fraction);
  return card->from_experiment() ? "law card, from an experiment"
                                 : fmt::format("law card, {} relaxation", card->relaxation);
}

std::string kind_line(const FittedLaw& file, char letter, double solid_fraction) {
  return wrapped(fmt::format("{}: {}: {}", letter, file.path, source_text(file, solid_fraction)), 3);
}

std::string verdict(const DifferenceRow& r) { return !r.known ? "?" : (r.within ? "yes" : "NO"); }

std::string plot_of(const LawDifference& d, bool utf8) {
  TerminalPlot plot{"Delta", d.quantity + ", " + d.pair, 76, 8, utf8, {}};
  TerminalCurve a;
  TerminalCurve b{{}, {}, TerminalCurve::Look::marks, 'B'};
  for (const DifferenceRow& r : d.rows) {
    a.x.push_back(r.delta);
    a.y.push_back(r.a.value);
    b.x.push_back(r.delta);
    b.y.push_back(r.b.value);
  }
  plot.curves = {a, b};
  return draw(plot) + "  line: A; letters: B\n";
}

std::string difference_text(const LawDifference& d, bool utf8) {
  std::string text = fmt::format("\n{}, {}, Delta = {} to {}\n", d.pair, d.quantity, number(d.low), number(d.high));
  std::vector<std::vector<std::string>> rows{{"Delta", "A", "95 %", "B", "95 %", "B/A - 1 [%]", "within"}};
  for (const DifferenceRow& r : d.rows)
    rows.push_back({number(r.delta), number(r.a.value), interval(r.a), number(r.b.value), interval(r.b),
                    rounded_text(100.0 * r.relative, {1, true, true}, "-"), verdict(r)});
  text += aligned(rows, 2, 0);
  text += std::isfinite(d.root_mean_square)
              ? fmt::format("  root mean square {:.1f} % of A; largest {:.1f} % of the largest A\n",
                            100.0 * d.root_mean_square, 100.0 * d.largest)
              : std::string("  root mean square and largest difference: undefined, as A is zero in the whole range\n");
  return d.quantity.starts_with("F") ? text + plot_of(d, utf8) : text;
}

}  // namespace

std::string differences_text(const FittedLaw& a, const FittedLaw& b, const std::vector<LawDifference>& differences,
                             bool utf8) {
  std::string text = kind_line(a, 'A', compared_fraction(a, b)) + kind_line(b, 'B', compared_fraction(b, a));
  if (differences.empty()) return text + "nothing in common: no kind of pair that both know in a common range\n";
  for (const LawDifference& d : differences) text += difference_text(d, utf8);
  return text + "\n" +
         wrapped(
             "within: the difference is inside the 95 % intervals of both together (root of the sum of the "
             "squares of their halves); ?: neither has one",
             0);
}

}  // namespace softgrain::law

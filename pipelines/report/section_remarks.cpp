// What a reader should be careful with, gathered from the data and from the summary.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "pipelines/report/html.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/summary.h"

namespace softgrain::report {
namespace {

using Remarks = std::vector<std::string>;

struct Count {
  std::size_t bad = 0;
  std::size_t all = 0;
};

template <class Points>
void count_points(const Points& points, Count& count) {
  for (const auto& p : points) count.bad += p.converged ? 0 : 1;
  count.all += points.size();
}

void add_convergence(const Measurements& data, Remarks& remarks) {
  for (const PairKind kind : kPairKinds) {
    for (const std::string& relaxation : relaxations_of(data, kind)) {
      Count count;
      for (const PackingRun* run : runs_of(data, kind, relaxation)) {
        count_points(run->normal, count);
        count_points(run->tangential, count);
      }
      if (count.bad == 0) continue;
      remarks.push_back(
          fmt::format("{}, relaxation \"{}\": {} of {} points did not reach their convergence criterion; they are left "
                      "out of means and fits.",
                      to_string(kind), relaxation, count.bad, count.all));
    }
  }
}

void add_packings(const Measurements& data, Remarks& remarks) {
  if (data.packings.size() < 7) {
    remarks.push_back(fmt::format("Only {}: at least seven are needed for a mean, about 32 for a law.",
                                  counted(data.packings.size(), "packing")));
  }
  double largest = 0.0;
  for (const PackingRun& run : data.runs) {
    for (const NormalPoint& p : run.normal) largest = std::max(largest, p.max_overlap);
  }
  if (largest > 0.2) {
    remarks.push_back(
        fmt::format("Grain overlaps reach {:.0f} % of the smaller radius: the contact law is used beyond small strain.",
                    100.0 * largest));
  }
}

void add_laws(const LawCard& card, Remarks& remarks) {
  for (const PairLaw& law : card.pairs) {
    if (law.status == LawStatus::good) continue;
    remarks.push_back("The " + to_string(law.kind) + " law is not usable as it is: " + to_string(law.status) +
                      (law.reason.empty() ? "." : " (" + law.reason + ")."));
  }
}

void add_macro(const std::vector<MacroCurve>& macro, Remarks& remarks) {
  for (const MacroCurve& c : macro) {
    if (c.usable && c.note.empty()) continue;
    remarks.push_back(fmt::format("Macro run \"{}\", {}, sample {}{}: {}", c.engine, to_string(c.test), c.sample,
                                  c.usable ? "" : " is not usable", c.note.empty() ? "no reason given." : c.note));
  }
  if (use_pair_law(macro)) remarks.push_back(pair_law_remark() + ".");
}

/// A run states its own notes in its summary; without such a list they follow from the data.
Remarks notes_of_run(const RunData& run, const AnySummary& summary) {
  Remarks notes = notes_of(summary);
  if (!summary.remarks) {
    if (run.measurements) add_convergence(*run.measurements, notes);
    if (run.card) add_laws(*run.card, notes);
    add_macro(run.macro, notes);
  }
  if (run.measurements) add_packings(*run.measurements, notes);
  return notes;
}

std::string list_of(const Remarks& remarks, std::size_t from = 0) {
  std::string items;
  for (std::size_t k = from; k < remarks.size(); ++k) items += "<li>" + escape(remarks[k]) + "</li>\n";
  return items;
}

}  // namespace

std::string warnings_section(const RunData& run) {
  constexpr std::size_t kMost = 5;
  const auto summary = run.summary_as<AnySummary>();
  Remarks warnings = warnings_of(summary);
  const bool bad = !summary.status.empty() && !is_good(summary.status);
  if (bad) warnings.insert(warnings.begin(), "The status of the run is \"" + summary.status + "\".");
  if (warnings.empty()) return "";
  const Remarks shown(warnings.begin(),
                      warnings.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, warnings.size())));
  std::string html = "<div class=\"remarks\" id=\"warnings\"><h2>Warnings</h2>\n<ul>\n" + list_of(shown) + "</ul>";
  if (warnings.size() > kMost)
    html += "<details><summary>and " + std::to_string(warnings.size() - kMost) + " more</summary><ul>\n" +
            list_of(warnings, kMost) + "</ul></details>";
  return html + "</div>\n";
}

std::string notes_section(const RunData& run) {
  const Remarks notes = notes_of_run(run, run.summary_as<AnySummary>());
  if (notes.empty()) return "";
  return "<details id=\"notes\"><summary>" + std::to_string(notes.size()) + (notes.size() == 1 ? " note" : " notes") +
         "</summary>\n<ul>\n" + list_of(notes) + "</ul></details>\n";
}

}  // namespace softgrain::report

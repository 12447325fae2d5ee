// Soft particles in soft particles: the law from level to level, from the summary of a hierarchy run.
#include <cmath>

#include "pipelines/kinds/hierarchy/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

namespace {

std::string number_of(const std::optional<double>& x, int digits = 3) { return format_number(x.value_or(NAN), digits); }

/// What is in a soft particle of each level.
std::string content_table(const std::vector<LevelSummary>& levels) {
  HtmlTable table({"level (0: grains only)", "own grains [% of the volume]", "soft particles inside",
                   "their volume [%]", "next level over own grains", "all grains [%]", "grains if resolved"});
  for (const LevelSummary& l : levels) {
    const InnerSummary inner = l.inner.value_or(InnerSummary{NAN, NAN, NAN, NAN, NAN});
    table.row({std::to_string(l.level), number_of(l.grain_percent), number_of(inner.mean),
               number_of(inner.volume_percent), number_of(inner.next_volume), number_of(l.solid_percent),
               number_of(l.resolved_grains)});
  }
  return table.html();
}

std::string law_table(const std::vector<LevelSummary>& levels) {
  HtmlTable table({"level", "a", "b", "delta", "standard error of its forces [%]", "of its own packings [%]",
                   "follows the law below by", "distance to it [%]", "noise [%]"});
  for (const LevelSummary& l : levels)
    table.row({std::to_string(l.level), number_of(l.law.parameters[0]), number_of(l.law.parameters[1]),
               number_of(l.law.parameters[2]), number_of(l.error_percent), number_of(l.own_error_percent),
               number_of(l.sensitivity ? l.sensitivity->value : NAN), number_of(l.distance_percent),
               number_of(l.noise_percent)});
  return table.html();
}

std::string change_table(const std::vector<LevelSummary>& levels) {
  HtmlTable table({"level", "configuration", "force over that of the level below", "standard error"});
  for (const LevelSummary& l : levels)
    for (const LevelChange& c : l.changes)
      table.row({std::to_string(l.level), c.configuration, number_of(c.ratio, 4), number_of(c.error, 2)});
  return table.empty() ? "" : table.html();
}

/// One plane alone and six planes, law of every level.
std::string law_figure(const std::vector<LevelSummary>& levels, std::vector<double> LevelCurves::*forces,
                       const char* key, const char* title) {
  Plot plot({std::string("hierarchy-") + key,
             title,
             {"overlap h/Rs", Scale::linear, {}, {}},
             {"force per plane F/(E Rs²)", Scale::logarithmic, {}, {}},
             {}});
  std::size_t color = 0;
  for (const LevelSummary& l : levels) {
    Series s;
    s.label = "level " + std::to_string(l.level);
    s.x = l.curves.overlap;
    s.y = l.curves.*forces;
    if (s.x.empty() || s.x.size() != s.y.size()) continue;
    s.style.color = palette::cycle(color++);
    plot.add(s);
  }
  return plot.empty() ? "" : figure(plot.svg(), "The law of each level; level 0 holds grains only.");
}

std::string check_table(const std::vector<CheckPoint>& points) {
  HtmlTable table({"h/Rs", "by law [F/(E Rs²)]", "standard error", "all grains", "standard error", "law over resolved",
                   "standard error"});
  for (const CheckPoint& p : points)
    table.row({number_of(p.overlap), number_of(p.law, 4), number_of(p.law_error, 2), number_of(p.resolved, 4),
               number_of(p.resolved_error, 2), number_of(p.ratio, 4), number_of(p.ratio_error, 2)});
  return table.html();
}

}  // namespace

std::string hierarchy_section(const RunData& run) {
  const auto summary = run.summary_as<HierarchySummary>();
  if (!summary.fixed_point) return "";
  const std::vector<LevelSummary>& levels = summary.levels;
  std::string body = paragraph(summary.fixed_point->text);
  body += content_table(levels) + law_table(levels);
  body += figure_row({law_figure(levels, &LevelCurves::one, "one", "One plane"),
                      law_figure(levels, &LevelCurves::cube, "cube", "Six planes")});
  body += change_table(levels);
  if (summary.check) body += paragraph(summary.check->text) + check_table(summary.check->result.points);
  return section("hierarchy", "Hierarchy of levels",
                 "Soft particles of each level hold soft particles of the level below. The curves show how the law "
                 "changes from level to level.",
                 body);
}

}  // namespace softgrain::report

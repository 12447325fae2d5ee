// Soft particles in soft particles: the law from level to level, from the summary of a hierarchy run.
#include <fmt/format.h>

#include "common/contact/crowd_from_table.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {
namespace {

using nlohmann::json;

std::string number_of(const json& at, const char* path, int digits = 3) {
  const auto x = find_number(at, path);
  return x ? format_number(*x, digits) : "–";
}

std::string level_table(const json& levels) {
  HtmlTable table({"level (0: grains only)", "soft particles inside", "radii over Rs", "volume share [%]", "a", "b",
                   "delta", "distance to the level below [%]", "noise [%]", "grains if resolved", "contact evaluations",
                   "seconds"});
  for (const json& l : levels)
    table.row({number_of(l, "level"), number_of(l, "inner.mean"),
               number_of(l, "inner.radius_low") + "–" + number_of(l, "inner.radius_high"),
               number_of(l, "inner.volume_percent"), number_of(l, "law.a"), number_of(l, "law.b"),
               number_of(l, "law.delta"), number_of(l, "distance_percent"), number_of(l, "noise_percent"),
               number_of(l, "resolved_grains"), number_of(l, "contact_evaluations"), number_of(l, "seconds")});
  return table.html();
}

std::string change_table(const json& levels) {
  HtmlTable table({"level", "configuration", "force over that of the level below", "standard error"});
  for (const json& l : levels) {
    const json* changes = find_value(l, "changes");
    if (changes == nullptr) continue;
    for (const json& c : *changes)
      table.row(
          {number_of(l, "level"), find_text(c, "configuration"), number_of(c, "ratio", 4), number_of(c, "error", 2)});
  }
  return table.empty() ? "" : table.html();
}

/// One plane alone and six planes, law of every level.
std::string law_figure(const json& levels, const char* key, const char* title) {
  Plot plot({std::string("hierarchy-") + key,
             title,
             {"overlap h/Rs", Scale::linear, {}, {}},
             {"force per plane F/(E Rs²)", Scale::logarithmic, {}, {}},
             {}});
  std::size_t color = 0;
  for (const json& l : levels) {
    const json* x = find_value(l, std::string("curves.overlap"));
    const json* y = find_value(l, std::string("curves.") + key);
    if (x == nullptr || y == nullptr) continue;
    Series s;
    s.label = "level " + number_of(l, "level");
    s.x = x->get<std::vector<double>>();
    s.y = y->get<std::vector<double>>();
    s.style.color = palette::cycle(color++);
    plot.add(s);
  }
  return plot.empty() ? "" : figure(plot.svg(), "The law of each level; level 0 holds grains only.");
}

std::string check_table(const json& check) {
  HtmlTable table({"h/Rs", "by law [F/(E Rs²)]", "standard error", "all grains", "standard error", "law over resolved",
                   "standard error"});
  for (const json& p : check)
    table.row({number_of(p, "overlap"), number_of(p, "law", 4), number_of(p, "law_error", 2),
               number_of(p, "resolved", 4), number_of(p, "resolved_error", 2), number_of(p, "ratio", 4),
               number_of(p, "ratio_error", 2)});
  return table.html();
}

}  // namespace

std::string hierarchy_section(const RunData& run) {
  const json* levels = find_value(run.summary, "levels");
  if (levels == nullptr || !levels->is_array() || find_value(run.summary, "fixed_point") == nullptr) return "";
  std::string body = paragraph(find_text(run.summary, "fixed_point.text"));
  body += level_table(*levels);
  body += figure_row({law_figure(*levels, "one", "One plane"), law_figure(*levels, "cube", "Six planes")});
  body += change_table(*levels);
  if (const json* check = find_value(run.summary, "check.points"); check != nullptr)
    body += paragraph(find_text(run.summary, "check.text")) + check_table(*check);
  return section("hierarchy", "Level upon level", body);
}

}  // namespace softgrain::report

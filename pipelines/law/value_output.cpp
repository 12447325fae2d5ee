#include "pipelines/law/value_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/io/json_record.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain::law {

namespace {

using nlohmann::json;
using Row = std::vector<std::string>;

std::string exact(double x) { return fmt::format("{}", x); }

std::string interval_text(const std::optional<Quantity>& q, double unit) {
  if (!q || !q->interval) return "-";
  const auto [low, high] = std::pair{q->interval->low * unit, q->interval->high * unit};
  const int digits = q->interval->low < q->interval->high ? digits_to_differ(low, high, 3, 9) : 3;
  return rounded_text(low, {digits}) + ".." + rounded_text(high, {digits});
}

/// The tangential stiffness that runs would use.
const std::optional<Quantity>& tangential(const LawPoint& p, bool use_secant) {
  const bool secant = p.tangential_secant && (use_secant || !p.tangential_initial);
  return secant ? p.tangential_secant : p.tangential_initial;
}

std::string mark(const LawPoint& p) {
  switch (p.where) {
    case Where::no_contact:
      return "-";
    case Where::below:
      return "<";
    case Where::inside:
      return "";
    default:
      return p.refused ? "!" : ">";
  }
}

Row console_row(const LawPoint& p, const ValueTable& t, const ValueUnits& u) {
  if (p.refused) return {rounded_text(p.delta), "refused", "", "", "", "", mark(p)};
  const auto& kt = tangential(p, t.use_secant);
  return {rounded_text(p.delta),
          fmt::format("{:.3g}", p.force.value * u.force()),
          interval_text(p.force, u.force()),
          fmt::format("{:.3g}", p.stiffness.value * u.stiffness()),
          kt ? fmt::format("{:.3g}", kt->value * u.stiffness()) : "-",
          interval_text(kt, u.stiffness()),
          mark(p)};
}

std::string legend(const ValueTable& t) {
  std::set<std::string> seen;
  for (const LawPoint& p : t.points)
    if (!mark(p).empty()) seen.insert(mark(p) + "  " + where_text(p));
  std::string text;
  for (const std::string& line : seen) text += "  " + line + "\n";
  return text;
}

/// Whether any of the overlaps has a force to be sure of.
bool any_contact(const ValueTable& t) {
  return std::ranges::any_of(t.points, [](const LawPoint& p) { return p.where != Where::no_contact && !p.refused; });
}

std::string origin_of(const ValueTable& t) {
  for (const LawPoint& p : t.points)
    if (p.force.interval && p.where != Where::no_contact) return p.force.interval->origin;
  return "";
}

void put(json& out, const std::string& name, const std::optional<Quantity>& q, double unit) {
  out[name] = q ? json_of(q->value * unit) : json(nullptr);
  out[name + "_interval"] =
      q && q->interval ? json{json_of(q->interval->low * unit), json_of(q->interval->high * unit)} : json(nullptr);
}

void add_cells(std::string& line, const std::optional<Quantity>& q, double unit) {
  const bool known = q && q->interval;
  line += "," + (q ? exact(q->value * unit) : "");
  line += "," + (known ? exact(q->interval->low * unit) : "") + "," + (known ? exact(q->interval->high * unit) : "");
}

}  // namespace

std::string force_unit(const ValueUnits& units) { return units.si ? "N" : "E R^2"; }
std::string stiffness_unit(const ValueUnits& units) { return units.si ? "N/m" : "E R"; }

std::string values_text(const ValueTable& t, const ValueUnits& u) {
  std::string head = t.law + ": " + to_string(t.status);
  if (!t.remark.empty()) head += "; " + t.remark;
  std::string text = wrapped(head, 4);
  std::vector<Row> rows{
      {"Delta", "F", "95 %", "dF/dh", "kt", "95 %", ""},
      {"", "[" + force_unit(u) + "]", "", "[" + stiffness_unit(u) + "]", "[" + stiffness_unit(u) + "]", "", ""}};
  for (const LawPoint& p : t.points) rows.push_back(console_row(p, t, u));
  text += aligned(rows, 0, 0) + legend(t);
  const std::string origin = origin_of(t);
  if (!any_contact(t)) return text;
  const bool beyond =
      std::ranges::any_of(t.points, [](const LawPoint& p) { return p.where == Where::beyond && !p.refused; });
  const bool inside = std::ranges::any_of(
      t.points, [](const LawPoint& p) { return p.where == Where::inside || p.where == Where::below; });
  if (!origin.empty()) text += "  intervals: " + origin + "\n";
  if (origin.empty() && inside) text += "  no intervals: none are stored with this law, or none are determined\n";
  if (beyond) text += "  no interval beyond the measured range: nothing says how far off the law is\n";
  return text;
}

std::string values_csv(const std::vector<ValueTable>& tables, const ValueUnits& u) {
  const std::string f = "[" + force_unit(u) + "]";
  const std::string k = "[" + stiffness_unit(u) + "]";
  std::string text = "law,delta,overlap [" + std::string(u.si ? "m" : "R") + "]";
  const auto columns = [&](const char* name, const std::string& unit) {
    text += fmt::format(",{0} {1},{0}_low {1},{0}_high {1}", name, unit);
  };
  columns("force", f);
  for (const char* name : {"stiffness", "kt_initial", "kt_secant"}) columns(name, k);
  text += ",where\n";
  for (const ValueTable& t : tables)
    for (const LawPoint& p : t.points) {
      std::string line = t.law.find(',') == std::string::npos ? t.law : "\"" + t.law + "\"";
      line += "," + exact(p.delta) + "," + exact(p.delta * (u.si ? u.radius : 1.0));
      const auto given = [&](const std::optional<Quantity>& q) { return p.refused ? std::nullopt : q; };
      add_cells(line, given(p.force), u.force());
      add_cells(line, given(p.stiffness), u.stiffness());
      add_cells(line, given(p.tangential_initial), u.stiffness());
      add_cells(line, given(p.tangential_secant), u.stiffness());
      text += line + "," + where_text(p) + "\n";
    }
  return text;
}

json values_json(const ValueTable& t, const ValueUnits& u) {
  json out{{"law", t.law}, {"status", to_string(t.status)}, {"beyond", to_string(t.beyond)}, {"remark", t.remark}};
  const std::string origin = origin_of(t);
  out["intervals"] = origin.empty() ? json(nullptr) : json("95 %, " + origin);
  out["units"] = {{"force", force_unit(u)}, {"stiffness", stiffness_unit(u)}};
  out["values"] = json::array();
  for (const LawPoint& p : t.points) {
    json one{{"delta", p.delta}, {"where", p.where == Where::inside ? "inside" : where_text(p)}};
    const auto given = [&](const std::optional<Quantity>& q) { return p.refused ? std::nullopt : q; };
    put(one, "force", given(p.force), u.force());
    put(one, "stiffness", given(p.stiffness), u.stiffness());
    put(one, "kt_initial", given(p.tangential_initial), u.stiffness());
    put(one, "kt_secant", given(p.tangential_secant), u.stiffness());
    if (!p.forces.empty() && !p.refused) {
      one["forces"] = json::array();
      for (const double force : p.forces) one["forces"].push_back(force * u.force());
      one["equivalent_volume"] = p.volume;
      one["friction_limit"] = p.friction_limit * u.force();
    }
    out["values"].push_back(std::move(one));
  }
  return out;
}

}  // namespace softgrain::law

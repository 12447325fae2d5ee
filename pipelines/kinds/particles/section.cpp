// Final states and contacts of a scene of explicit particles, from the summary.
#include <algorithm>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

constexpr std::size_t kRows = 50;

std::string value_text(const nlohmann::json& value) {
  if (value.is_number_integer()) return std::to_string(value.get<long long>());
  if (value.is_number()) return format_number(value.get<double>(), 6);
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return "–";
  std::string out;
  for (const auto& one : value) out += (out.empty() ? "" : ", ") + value_text(one);
  return "(" + out + ")";
}

std::string table_of(const nlohmann::json& summary, const std::string& name, const std::vector<std::string>& keys,
                     const std::vector<std::string>& header) {
  const auto* list = find_value(summary, name);
  if (list == nullptr || !list->is_array() || list->empty()) return "";
  HtmlTable table(header);
  for (std::size_t i = 0; i < std::min(kRows, list->size()); ++i) {
    std::vector<std::string> cells;
    for (const std::string& key : keys) {
      const auto* value = find_value((*list)[i], key);
      cells.push_back(value != nullptr ? value_text(*value) : "–");
    }
    table.row(std::move(cells));
  }
  const std::string more =
      list->size() > kRows
          ? paragraph("The first " + std::to_string(kRows) + " of " + std::to_string(list->size()) + ".")
          : "";
  return table.html() + more;
}

}  // namespace

std::string particles_section(const RunData& run) {
  const std::string states = table_of(run.summary, "particles", {"id", "position", "velocity", "spin"},
                                      {"particle", "position [m]", "velocity [m/s]", "spin [rad/s]"});
  const std::string contacts = table_of(run.summary, "contacts", {"pair", "duration", "max_force", "max_overlap"},
                                        {"pair", "duration [s]", "largest force [N]", "largest overlap [m]"});
  return section("particles", "Particles at the end", states) + section("contacts", "Contacts", contacts);
}

}  // namespace softgrain::report

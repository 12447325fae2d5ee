// Final states and contacts of a scene of explicit particles, from the summary.
#include <fmt/format.h>

#include <algorithm>

#include "common/core/text.h"
#include "pipelines/kinds/particles/scene.h"
#include "pipelines/kinds/particles/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"

namespace softgrain::report {
namespace {

constexpr std::size_t kRows = 50;

std::string vector_text(const std::vector<double>& v) {
  return "(" + join_text(v, ", ", [](double x) { return format_number(x, 6); }) + ")";
}

/// The id of a grain, the name of a wall.
std::string body_text(const nlohmann::json& body) { return body.is_string() ? body.get<std::string>() : body.dump(); }

/// The first rows, and how many more there are.
template <class Row>
std::string table_of(const std::vector<Row>& list, const std::vector<std::string>& header,
                     std::vector<std::string> (*cells)(const Row&)) {
  if (list.empty()) return "";
  HtmlTable table(header);
  for (std::size_t i = 0; i < std::min(kRows, list.size()); ++i) table.row(cells(list[i]));
  if (list.size() <= kRows) return table.html();
  return table.html() + paragraph(fmt::format("The first {} of {}.", kRows, list.size()));
}

std::vector<std::string> grain_row(const GrainState& s) {
  return {std::to_string(s.id), vector_text(s.position), vector_text(s.velocity), vector_text(s.spin)};
}

std::vector<std::string> pair_row(const PairSummary& s) {
  return {"(" + body_text(s.pair[0]) + ", " + body_text(s.pair[1]) + ")", format_number(s.duration, 6),
          format_number(s.max_force, 6), format_number(s.max_overlap, 6)};
}

}  // namespace

std::string particles_section(const RunData& run) {
  const auto summary = run.summary_as<ParticlesSummary>();
  const std::string states =
      table_of(summary.particles, {"particle", "position [m]", "velocity [m/s]", "spin [rad/s]"}, grain_row);
  const std::string contacts = table_of(summary.contacts.value_or(std::vector<PairSummary>{}),
                                        {"pair", "duration [s]", "largest force [N]", "largest overlap [m]"}, pair_row);
  return section("particles", "Particles at the end",
                 "Position, velocity and spin of every particle at the end of the run.", states) +
         section("contacts", "Contacts", "How long every contact lasted, with its largest force and overlap.",
                 contacts);
}

}  // namespace softgrain::report

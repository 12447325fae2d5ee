// Explicit particles in the report: final states and contacts, from the summary. Then the frames that run.h5 holds, and
// what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/columns.h"
#include "common/data/snapshot_frames.h"
#include "pipelines/kinds/particles/scene.h"
#include "pipelines/kinds/particles/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/run/findings.h"

namespace softgrain::report {

namespace {

constexpr std::size_t kRows = 50;

std::string vector_text(const std::vector<double>& v) {
  return "(" + join_text(v, ", ", [](double x) { return format_number(x, 6); }) + ")";
}

/// The id of a grain, the name of a wall.
std::string body_text(const nlohmann::json& body) { return body.is_string() ? body.get<std::string>() : body.dump(); }

/// The first rows, and how many there are in all; the list may have the first of them alone.
template <class Row>
std::string table_of(const std::vector<Row>& list, std::size_t all, const std::vector<std::string>& header,
                     std::vector<std::string> (*cells)(const Row&)) {
  if (list.empty()) return "";
  HtmlTable table(header);
  for (std::size_t i = 0; i < std::min(kRows, list.size()); ++i) table.row(cells(list[i]));
  if (all <= kRows) return table.html();
  return table.html() + paragraph(fmt::format("The first {} of {}.", kRows, all));
}

std::vector<std::string> grain_row(const GrainState& s) {
  return {std::to_string(s.id), vector_text(s.position), vector_text(s.velocity), vector_text(s.spin)};
}

std::vector<std::string> pair_row(const PairSummary& s) {
  return {"(" + body_text(s.pair[0]) + ", " + body_text(s.pair[1]) + ")", format_number(s.duration, 6),
          format_number(s.max_force, 6), format_number(s.max_overlap, 6)};
}

/// Numbers of the recorded frames of run.h5.
struct FrameNumbers {
  Trajectory of;       ///< times, energies, and what a cell that is periodic along all axes has of stresses
  bool plane = false;  ///< stresses are those of disks
};

FrameNumbers load_numbers(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  using T = Trajectory;
  return {read_columns(root.open("trajectory"), {&T::translational_energy, &T::rotational_energy,
                                                 &T::gravitational_energy, &T::stress, &T::inertial_number}),
          root.has_attribute("dimension") && root.integer("dimension") == 2};
}

/// Stress and inertial number of the recorded frames of a cell that is periodic along all axes.
struct FrameStresses {
  std::vector<double> time;
  std::vector<double> pressure;  ///< compression positive [Pa; of disks N/m]
  std::vector<double> shear;     ///< xy [the same]
  std::vector<double> inertial_number;
};

FrameStresses stresses_of(const FrameNumbers& frames) {
  FrameStresses s;
  const Trajectory& all = frames.of;
  if (all.stress.empty() || all.inertial_number.empty()) return s;
  for (std::size_t k = 0; k < all.time.size(); ++k) {
    const double* t = &all.stress[9 * k];
    if (!std::isfinite(t[0])) continue;  // a frame without its contacts
    s.time.push_back(all.time[k]);
    s.inertial_number.push_back(all.inertial_number[k]);
    s.pressure.push_back(frames.plane ? -(t[0] + t[4]) / 2.0 : -(t[0] + t[4] + t[8]) / 3.0);
    s.shear.push_back(0.5 * (t[1] + t[3]));
  }
  return s;
}

std::string stress_figure(const FrameStresses& s) {
  double largest = 0.0;
  for (const auto* values : {&s.pressure, &s.shear})
    for (const double v : *values)
      if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  if (s.time.size() < 2 || largest == 0.0) return "";
  const SiPrefix prefix = si_prefix(largest);
  Plot plot({.id = "particles-stress",
             .title = "Stress over time",
             .x = {.label = "time [s]"},
             .y = {.label = "stress [" + prefix.symbol + "Pa]"}});
  std::size_t color = 0;
  for (const auto& [label, values] : {std::pair{"pressure", &s.pressure}, {"shear stress xy", &s.shear}}) {
    Series line{.label = label, .hover = "", .x = s.time, .y = *values, .style = {.color = palette::cycle(color++)}};
    for (double& v : line.y) v /= prefix.factor;
    plot.add(std::move(line));
  }
  return figure(plot.svg(),
                "From the contacts of the periodic cell; of disks N/m instead of Pa. Pressure is positive in "
                "compression, shear stress along the shear.");
}

std::string inertial_figure(const FrameStresses& s) {
  if (s.time.size() < 2 || std::ranges::none_of(s.inertial_number, [](double i) { return i > 0.0; })) return "";
  Plot plot({.id = "particles-inertial-number",
             .title = "Inertial number over time",
             .x = {.label = "time [s]"},
             .y = {.label = "I = rate d √(density/p)", .scale = Scale::logarithmic}});
  plot.add({.label = "",
            .hover = "inertial number",
            .x = s.time,
            .y = s.inertial_number,
            .style = {.color = palette::blue}});
  return figure(plot.svg(), "d: mean diameter by number; below 1e-3 a flow counts as quasi-static.");
}

std::string energy_figure(const Trajectory& e) {
  double largest = 0.0;
  for (const auto* values : {&e.translational_energy, &e.rotational_energy, &e.gravitational_energy})
    for (const double v : *values)
      if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  if (e.time.size() < 2 || largest == 0.0) return "";
  const SiPrefix prefix = si_prefix(largest);
  Plot plot({.id = "particles-energy",
             .title = "Energy over time",
             .x = {.label = "time [s]"},
             .y = {.label = "energy [" + prefix.symbol + "J]"}});
  std::size_t color = 0;
  for (const auto& [label, values] : {std::pair{"translational", &e.translational_energy},
                                      {"rotational", &e.rotational_energy},
                                      {"gravitational", &e.gravitational_energy}}) {
    Series s{.label = label, .hover = "", .x = e.time, .y = *values, .style = {.color = palette::cycle(color++)}};
    for (double& v : s.y) v /= prefix.factor;
    if (std::ranges::any_of(s.y, [](double v) { return v != 0.0; })) plot.add(std::move(s));
  }
  return figure(plot.svg(), "Of all particles, without the energy of springs; gravitational: zero at the origin.");
}

}  // namespace

std::string energies_section(const RunData& run) {
  const FrameNumbers* frames = run.file("run.h5", load_numbers);
  const std::string drawn = frames == nullptr ? "" : energy_figure(frames->of);
  return drawn.empty() ? "" : section("energy", "Energies", "Energies of the recorded frames.", figure_row({drawn}));
}

std::string stresses_section(const RunData& run) {
  const FrameNumbers* frames = run.file("run.h5", load_numbers);
  if (frames == nullptr) return "";
  const FrameStresses stresses = stresses_of(*frames);
  const std::string stress = stress_figure(stresses);
  return stress.empty() ? ""
                        : section("stress", "Stress", "Stress of the contacts in the recorded frames.",
                                  figure_row({stress, inertial_figure(stresses)}));
}

std::string particles_section(const RunData& run) {
  const auto summary = run.summary_as<ParticlesSummary>();
  const std::string states = table_of(summary.particles, static_cast<std::size_t>(particle_count(summary)),
                                      {"particle", "position [m]", "velocity [m/s]", "spin [rad/s]"}, grain_row);
  const std::vector<PairSummary> pairs = summary.contacts.value_or(std::vector<PairSummary>{});
  const std::string contacts =
      table_of(pairs, pairs.size(), {"pair", "duration [s]", "largest force [N]", "largest overlap [m]"}, pair_row);
  return section("particles", "Particles at the end",
                 "Position, velocity and spin of every particle at the end of the run.", states) +
         section("contacts", "Contacts", "How long every contact lasted, with its largest force and overlap.",
                 contacts);
}

}  // namespace softgrain::report

namespace softgrain {

void visit_particles(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit) {
  const h5::Group root = h5::open_file(path);
  if (!root.has_attribute("kind") || parse_enum<SnapshotKind>(root.text("kind")) != SnapshotKind::particles)
    throw IoError(path + ": holds no particles");
  Snapshot form = moving_frames();
  form.series = "particles";
  const SnapshotSeries frames = read_series(root, "final", std::move(form));
  for (std::size_t k = choice == SnapshotChoice::last && frames.size() > 0 ? frames.size() - 1 : 0; k < frames.size();
       ++k) {
    std::optional<Snapshot> s = frames.at(k);
    if (!s) continue;
    s->label = fmt::format("particles at {:.4g} s", s->time);
    visit(*s);
  }
}

namespace {

void check_particles_file(const std::string& path, Findings& out) {
  std::size_t frames = 0;
  h5::naming_file(path, [&] {
    visit_particles(path, SnapshotChoice::all, [&](const Snapshot&) { ++frames; });
    // A run that lost a particle ends in numbers that are none, and says that it is not usable.
    const h5::Group root = h5::open_file(path);
    if (root.has_attribute("status") && is_good(root.text("status")) && root.has("final"))
      require_finite_content(root.open("final"));
  });
  out.add("kind", "particles", fmt::format("particles: {} recorded frames", frames));
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto scene = run.summary_as<ParticlesSummary>();
  if (scene.particles.empty()) return {};
  const std::int64_t count = particle_count(scene);
  return {{"Scene", count == 1 ? "1 explicit particle." : fmt::format("{} explicit particles.", count)}};
}

std::vector<RunValue> values_of(const report::RunData& run) {
  const auto scene = run.summary_as<ParticlesSummary>();
  std::vector<RunValue> out;
  if (scene.particles.empty()) return out;
  out.push_back({"kinetic energy at the end", "J", scene.kinetic_energy});
  for (const auto& [key, name, unit] : {std::tuple{"coordination_number", "coordination number at the end", ""},
                                        {"inertial_number", "inertial number at the end", ""},
                                        {"pressure", "pressure", scene.dimension == 2 ? "N/m" : "Pa"}})
    if (const auto at = scene.contact_state.find(key); at != scene.contact_state.end() && at->is_number())
      out.push_back({name, unit, at->get<double>()});
  if (!scene.contacts || scene.contacts->empty()) return out;
  double force = 0.0;
  for (const PairSummary& pair : *scene.contacts) force = std::max(force, pair.max_force);
  out.push_back({"largest force of a contact", "N", force});
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {
      "Every recorded state for ParaView, OVITO or a spreadsheet: `softgrain export " + run.directory +
          " --to vtp` (or `lammps-dump`, `lammps-data`, `csv`).",
      "Whether the result depends on the time step: `softgrain sweep SCENE.toml --over time.step=A,B,C`, with A the "
      "step of this run, B and C a half and a quarter of it."};
}

}  // namespace

KindResults particles_results() {
  return {.files = {{.names = "run\\.h5",
                     .is = [](const h5::Group& root) { return root.has("trajectory"); },
                     .check = check_particles_file,
                     .visit = visit_particles},
                    {.names = "run(_contacts)?\\.xdmf"}},
          .sections = {{Part::states, report::energies_section},
                       {Part::states, report::stresses_section},
                       {Part::states, report::particles_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain

// Explicit particles in the report: final states and contacts, from the summary. Then the frames that run.h5 holds, and
// what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "microsim/particles/trajectory.h"
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

/// Energies of the recorded frames [J] over time [s].
struct FrameEnergies {
  std::vector<double> time;
  std::vector<double> translational;
  std::vector<double> rotational;
  std::vector<double> gravitational;
};

FrameEnergies load_energies(const std::string& path) {
  const h5::Group frames = h5::open_file(path).open("trajectory");
  FrameEnergies e{frames.doubles("time"), frames.doubles("translational_energy"), frames.doubles("rotational_energy"),
                  frames.doubles("gravitational_energy")};
  for (const auto* values : {&e.translational, &e.rotational, &e.gravitational})
    if (values->size() != e.time.size()) throw IoError(path + ": as many energies as times are needed");
  return e;
}

/// Stress and inertial number of the recorded frames of a cell that is periodic along all axes.
struct FrameStresses {
  std::vector<double> time;
  std::vector<double> pressure;  ///< compression positive [Pa; of disks N/m]
  std::vector<double> shear;     ///< xy [the same]
  std::vector<double> inertial_number;
};

FrameStresses load_stresses(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  const h5::Group frames = root.open("trajectory");
  FrameStresses s;
  if (!frames.has("stress") || !frames.has("inertial_number")) return s;
  const std::vector<double> time = frames.doubles("time");
  const std::vector<double> stress = frames.doubles("stress");
  const std::vector<double> inertial = frames.doubles("inertial_number");
  if (stress.size() != 9 * time.size() || inertial.size() != time.size())
    throw IoError(path + ": as many stresses as times are needed");
  const bool plane = root.has_attribute("dimension") && root.integer("dimension") == 2;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double* t = &stress[9 * k];
    if (!std::isfinite(t[0])) continue;  // a frame without its contacts
    s.time.push_back(time[k]);
    s.inertial_number.push_back(inertial[k]);
    s.pressure.push_back(plane ? -(t[0] + t[4]) / 2.0 : -(t[0] + t[4] + t[8]) / 3.0);
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

std::string energy_figure(const FrameEnergies& e) {
  double largest = 0.0;
  for (const auto* values : {&e.translational, &e.rotational, &e.gravitational})
    for (const double v : *values)
      if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  if (e.time.size() < 2 || largest == 0.0) return "";
  const SiPrefix prefix = si_prefix(largest);
  Plot plot({.id = "particles-energy",
             .title = "Energy over time",
             .x = {.label = "time [s]"},
             .y = {.label = "energy [" + prefix.symbol + "J]"}});
  std::size_t color = 0;
  for (const auto& [label, values] : {std::pair{"translational", &e.translational},
                                      {"rotational", &e.rotational},
                                      {"gravitational", &e.gravitational}}) {
    Series s{.label = label, .hover = "", .x = e.time, .y = *values, .style = {.color = palette::cycle(color++)}};
    for (double& v : s.y) v /= prefix.factor;
    if (std::ranges::any_of(s.y, [](double v) { return v != 0.0; })) plot.add(std::move(s));
  }
  return figure(plot.svg(), "Of all particles, without the energy of springs; gravitational: zero at the origin.");
}

}  // namespace

std::string energies_section(const RunData& run) {
  const FrameEnergies* energies = run.file<FrameEnergies>("run.h5", load_energies);
  const std::string drawn = energies == nullptr ? "" : energy_figure(*energies);
  return drawn.empty() ? "" : section("energy", "Energies", "Energies of the recorded frames.", figure_row({drawn}));
}

std::string stresses_section(const RunData& run) {
  const FrameStresses* stresses = run.file<FrameStresses>("run.h5", load_stresses);
  if (stresses == nullptr) return "";
  const std::string stress = stress_figure(*stresses);
  return stress.empty() ? ""
                        : section("stress", "Stress", "Stress of the contacts in the recorded frames.",
                                  figure_row({stress, inertial_figure(*stresses)}));
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

namespace {

/// All that run.h5 says of bodies; positions come with every frame.
struct Bodies {
  std::vector<SnapshotParticle> particles;
  std::vector<SnapshotWall> walls;
  std::array<bool, 3> periodic{};
  int dimension = 3;
};

void require(bool fits, const char* what) {
  if (!fits) throw IoError(fmt::format("data set '{}' does not fit the rest of the file", what));
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

std::vector<SnapshotParticle> read_particles(const h5::Group& bodies) {
  const std::vector<double> radius = bodies.doubles("radius");
  const std::vector<std::int64_t> material = bodies.integers("material");
  require(material.size() == radius.size(), "material");
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  require(std::ranges::all_of(radius, positive), "radius");
  std::vector<double> mass(radius.size(), kNaN);
  if (bodies.has("mass")) mass = bodies.doubles("mass");
  require(mass.size() == radius.size(), "mass");
  require(!bodies.has("mass") || std::ranges::all_of(mass, positive), "mass");
  std::vector<std::int64_t> soft;
  if (bodies.has("material_is_soft")) soft = bodies.integers("material_is_soft");
  std::vector<SnapshotParticle> particles(radius.size());
  for (std::size_t k = 0; k < particles.size(); ++k) {
    SnapshotParticle& p = particles[k];
    p.radius = radius[k];
    p.mass = mass[k];
    p.material = material[k];
    p.id = p.body = static_cast<std::int64_t>(k);
    const auto m = static_cast<std::size_t>(material[k]);
    if (material[k] >= 0 && m < soft.size() && soft[m] != 0) p.role = ParticleRole::soft;
  }
  return particles;
}

/// Walls of the full state that ends the file. They have as many coordinates as the run has dimensions.
std::vector<SnapshotWall> read_walls(const h5::Group& bodies, std::size_t particles, std::size_t dimension) {
  const std::vector<std::int64_t> counts = bodies.integers("counts");
  const std::vector<double> spheres = bodies.doubles("sphere");
  const std::vector<double> normals = bodies.doubles("plane_normal");
  require(counts.size() == 3 && counts[0] == static_cast<std::int64_t>(particles) && counts[1] >= 0 && counts[2] >= 0,
          "counts");
  const auto shells = static_cast<std::size_t>(counts[1]);
  const auto planes = static_cast<std::size_t>(counts[2]);
  require(spheres.size() == (dimension + 1) * (particles + shells + planes), "sphere");
  require(normals.size() == dimension * planes && all_finite(normals), "plane_normal");
  std::vector<SnapshotWall> walls(shells + planes);
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (k < shells) {
      walls[k].shape = WallShape::sphere_inside;
      walls[k].radius = spheres[(dimension + 1) * (particles + k) + dimension];
      require(std::isfinite(walls[k].radius), "sphere");
    } else {
      for (std::size_t c = 0; c < dimension; ++c) walls[k].normal.v[c] = normals[dimension * (k - shells) + c];
    }
  }
  return walls;
}

Bodies read_bodies(const h5::Group& root) {
  Bodies out;
  out.particles = read_particles(root.open("bodies"));
  const h5::Group last = root.open("final");
  if (root.has_attribute("dimension")) out.dimension = static_cast<int>(root.integer("dimension"));
  require(out.dimension == 2 || out.dimension == 3, "dimension");
  const auto dimension = static_cast<std::size_t>(out.dimension);
  out.walls = read_walls(last.open("bodies"), out.particles.size(), dimension);
  const std::vector<std::int64_t> periodic = last.open("cell").integers("periodic");
  require(periodic.size() == dimension, "periodic");
  for (std::size_t k = 0; k < dimension; ++k) out.periodic[k] = periodic[k] != 0;
  return out;
}

Vec3 vector_at(const std::vector<double>& flat, std::size_t row) {
  return {{flat[3 * row], flat[3 * row + 1], flat[3 * row + 2]}};
}

void require_fits(const Trajectory& t, const Bodies& bodies) {
  const std::size_t frames = t.time.size();
  require(t.position.size() == 3 * frames * bodies.particles.size(), "position");
  require(t.velocity.size() == t.position.size(), "velocity");
  require(t.spin.size() == t.position.size(), "spin");
  require(t.wall_position.size() == 3 * frames * bodies.walls.size(), "wall_position");
  require(t.cell_edges.size() == 9 * frames && all_finite(t.cell_edges), "cell_edges");
  require(all_finite(t.wall_position), "wall_position");
  require(all_finite(t.time), "time");
}

Snapshot frame_of(const Trajectory& t, const Bodies& bodies, std::size_t frame) {
  Snapshot s;
  s.series = "particles";
  s.frame = static_cast<std::int64_t>(frame);
  s.time = t.time[frame];
  s.label = fmt::format("particles at {:.4g} s", s.time);
  s.has_velocity = true;
  s.dimension = bodies.dimension;
  s.particles = bodies.particles;
  s.walls = bodies.walls;
  s.periodic = bodies.periodic;
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    s.particles[k].position = vector_at(t.position, frame * s.particles.size() + k);
    s.particles[k].velocity = vector_at(t.velocity, frame * s.particles.size() + k);
    s.particles[k].spin = vector_at(t.spin, frame * s.particles.size() + k);
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    s.walls[k].point = vector_at(t.wall_position, frame * s.walls.size() + k);
  // The file has the matrix row by row; an edge is a column.
  for (std::size_t edge = 0; edge < 3; ++edge)
    for (std::size_t row = 0; row < 3; ++row) s.cell_edges[edge].v[row] = t.cell_edges[9 * frame + 3 * row + edge];
  return s;
}

bool is_valid(const Snapshot& s) {
  return std::all_of(s.particles.begin(), s.particles.end(), [](const SnapshotParticle& p) {
    return std::isfinite(norm2(p.position)) && std::isfinite(norm2(p.velocity)) && std::isfinite(norm2(p.spin));
  });
}

/// First contact of every recorded frame.
std::vector<std::size_t> starts_of(const FrameContacts& contacts) {
  std::vector<std::size_t> starts{0};
  for (const std::int64_t n : contacts.count) starts.push_back(starts.back() + static_cast<std::size_t>(n));
  return starts;
}

void add_contacts(Snapshot& s, const FrameContacts& all, const std::vector<std::size_t>& starts) {
  const auto at = std::lower_bound(all.frame.begin(), all.frame.end(), s.frame);
  if (at == all.frame.end() || *at != s.frame) return;
  const auto k = static_cast<std::size_t>(at - all.frame.begin());
  s.has_contacts = true;
  s.contacts.assign(all.contacts.begin() + static_cast<std::ptrdiff_t>(starts[k]),
                    all.contacts.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]));
}

}  // namespace

void visit_particles(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit) {
  const h5::Group root = h5::open_file(path);
  if (!root.has_attribute("kind") || parse_enum<SnapshotKind>(root.text("kind")) != SnapshotKind::particles)
    throw IoError(path + ": holds no particles");
  const Bodies bodies = read_bodies(root);
  const Trajectory t = read_trajectory(root.open("trajectory"));
  require_fits(t, bodies);
  FrameContacts contacts;
  if (root.has("frame_contacts"))
    contacts = read_frame_contacts(root.open("frame_contacts"), bodies.particles.size(),
                                   bodies.particles.size() + bodies.walls.size());
  const std::vector<std::size_t> starts = starts_of(contacts);
  const std::size_t frames = t.time.size();
  for (std::size_t k = choice == SnapshotChoice::last && frames > 0 ? frames - 1 : 0; k < frames; ++k) {
    Snapshot s = frame_of(t, bodies, k);
    if (!is_valid(s)) continue;
    add_contacts(s, contacts, starts);
    visit(s);
  }
}

namespace {

void check_particles_file(const std::string& path, Findings& out) {
  std::size_t frames = 0;
  try {
    visit_particles(path, SnapshotChoice::all, [&](const Snapshot&) { ++frames; });
  } catch (const IoError& e) {
    const std::string text = e.what();
    throw IoError(text.starts_with(path) ? text : path + ": " + text);
  }
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

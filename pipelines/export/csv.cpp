// CSV tables of particles, contacts and walls; units in the header.
#include <fmt/format.h>

#include "pipelines/export/export.h"

namespace softgrain {

namespace {

/// "x [m],y [m],z [m]" of a name with axes.
std::string axes(const char* name, const std::string& unit) {
  return fmt::format("{0}x [{1}],{0}y [{1}],{0}z [{1}]", name, unit);
}

void append_csv(std::string& text, const Vec3& a) {
  fmt::format_to(std::back_inserter(text), ",{},{},{}", a[0], a[1], a[2]);
}

std::string particles_csv(const Snapshot& s) {
  std::string text = fmt::format("id,role,body,material,{},radius [{}]", axes("", s.length_unit), s.length_unit);
  if (s.has_velocity) text += "," + axes("v", s.length_unit + "/" + s.time_unit);
  text += '\n';
  for (const SnapshotParticle& p : s.particles) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{}", p.id, to_string(p.role), p.body, p.material);
    append_csv(text, p.position);
    fmt::format_to(std::back_inserter(text), ",{}", p.radius);
    if (s.has_velocity) append_csv(text, p.velocity);
    text += '\n';
  }
  return text;
}

/// `second` is the id of a particle, or empty beside the number of a wall.
std::string contacts_csv(const Snapshot& s) {
  const std::string& length = s.length_unit;
  std::string text =
      fmt::format("first,second,wall,normal_force [{}],{},{},{},{},{}\n", s.force_unit, axes("f", s.force_unit),
                  axes("point_", length), axes("from_", length), axes("to_", length), axes("shift_", length));
  const std::size_t n = s.particles.size();
  for (const SnapshotContact& c : s.contacts) {
    const auto j = static_cast<std::size_t>(c.j);
    fmt::format_to(std::back_inserter(text), "{},{},{},{}", s.particles[static_cast<std::size_t>(c.i)].id,
                   j < n ? std::to_string(s.particles[j].id) : "", j < n ? "" : std::to_string(j - n), c.normal_force);
    for (const Vec3& a : {c.force, c.point, c.from, c.to, c.shift}) append_csv(text, a);
    text += '\n';
  }
  return text;
}

std::string walls_csv(const Snapshot& s) {
  std::string text =
      fmt::format("wall,shape,body,{},{},radius [{}]\n", axes("", s.length_unit), axes("normal_", "1"), s.length_unit);
  for (std::size_t k = 0; k < s.walls.size(); ++k) {
    const SnapshotWall& w = s.walls[k];
    fmt::format_to(std::back_inserter(text), "{},{},{}", k, to_string(w.shape), w.body);
    append_csv(text, w.point);
    append_csv(text, w.normal);
    fmt::format_to(std::back_inserter(text), ",{}\n", w.radius);
  }
  return text;
}

}  // namespace

std::vector<ExportFile> csv_files(const Snapshot& s, std::int64_t number) {
  std::vector<ExportFile> files{
      {StateContent::particles, state_file_name(s, StateContent::particles, number, "csv"), particles_csv(s)}};
  if (s.has_contacts)
    files.push_back(
        {StateContent::contacts, state_file_name(s, StateContent::contacts, number, "csv"), contacts_csv(s)});
  if (!s.walls.empty())
    files.push_back({StateContent::walls, state_file_name(s, StateContent::walls, number, "csv"), walls_csv(s)});
  return files;
}

}  // namespace softgrain

// VTK PolyData in text: what ParaView and OVITO both read. OVITO wants particles as vertices and nothing else,
// "LittleEndian", no compressor, no appended data; it takes "id", "radius" and "v" for what they are.
#include <fmt/format.h>

#include <functional>

#include "pipelines/export/export.h"

namespace softgrain {

namespace {

/// "x y z" or one number of row k, appended.
using Row = std::function<void(std::string&, std::size_t)>;

void append(std::string& text, double x) { fmt::format_to(std::back_inserter(text), "{} ", x); }
void append(std::string& text, std::int64_t n) { fmt::format_to(std::back_inserter(text), "{} ", n); }
void append(std::string& text, const Vec3& a) {
  fmt::format_to(std::back_inserter(text), "{} {} {} ", a[0], a[1], a[2]);
}

std::string data_array(const char* type, const char* name, int components, std::size_t rows, const Row& row) {
  std::string text =
      fmt::format("        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type,
                  name, components);
  for (std::size_t k = 0; k < rows; ++k) {
    row(text, k);
    text.back() = '\n';
  }
  return text + "        </DataArray>\n";
}

std::string vectors(const char* name, std::size_t rows, const std::function<Vec3(std::size_t)>& value) {
  return data_array("Float64", name, 3, rows, [&](std::string& t, std::size_t k) { append(t, value(k)); });
}
std::string numbers(const char* name, std::size_t rows, const std::function<double(std::size_t)>& value) {
  return data_array("Float64", name, 1, rows, [&](std::string& t, std::size_t k) { append(t, value(k)); });
}
std::string counts(const char* name, std::size_t rows, const std::function<std::int64_t(std::size_t)>& value) {
  return data_array("Int64", name, 1, rows, [&](std::string& t, std::size_t k) { append(t, value(k)); });
}

std::string section(const char* name, const std::string& content) {
  return fmt::format("      <{}>\n{}      </{}>\n", name, content, name);
}

/// Cells of `nodes` points each, one after the other.
std::string cells(const char* name, std::size_t number, std::size_t nodes) {
  const auto at = [](std::size_t k) { return static_cast<std::int64_t>(k); };
  return section(name, counts("connectivity", number * nodes, at) +
                           counts("offsets", number, [&](std::size_t k) { return at((k + 1) * nodes); }));
}

std::string document(const std::string& label, std::size_t points, std::size_t vertices, std::size_t lines,
                     const std::string& content) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- {} -->\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <PolyData>\n"
      "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n{}    </Piece>\n  </PolyData>\n</VTKFile>\n",
      label, points, vertices, lines, content);
}

/// Two hyphens would end a comment of XML.
std::string in_comment(std::string label) {
  for (std::size_t at = label.find("--"); at != std::string::npos; at = label.find("--")) label.erase(at, 1);
  return label;
}

std::string units_of(const Snapshot& s) {
  return fmt::format("{}; lengths in {}, forces in {}", in_comment(s.label), s.length_unit, s.force_unit);
}

std::string particles_vtp(const Snapshot& s) {
  const auto& p = s.particles;
  std::string data = counts("id", p.size(), [&](std::size_t k) { return p[k].id; }) +
                     numbers("radius", p.size(), [&](std::size_t k) { return p[k].radius; }) +
                     counts("role", p.size(), [&](std::size_t k) { return static_cast<std::int64_t>(p[k].role); }) +
                     counts("body", p.size(), [&](std::size_t k) { return p[k].body; }) +
                     counts("type", p.size(), [&](std::size_t k) { return p[k].material; });
  if (s.has_velocity) data += vectors("v", p.size(), [&](std::size_t k) { return p[k].velocity; });
  return document(units_of(s), p.size(), p.size(), 0,
                  section("PointData", data) +
                      section("Points", vectors("Points", p.size(), [&](std::size_t k) { return p[k].position; })) +
                      cells("Verts", p.size(), 1));
}

/// Id of the particle, or -1, -2, ... of a wall.
std::int64_t partner_id(const Snapshot& s, std::int32_t j) {
  const auto u = static_cast<std::size_t>(j);
  if (u < s.particles.size()) return s.particles[u].id;
  return -1 - static_cast<std::int64_t>(u - s.particles.size());
}

std::string contacts_vtp(const Snapshot& s) {
  const auto& c = s.contacts;
  const auto tangential = [&](std::size_t k) {
    return std::sqrt(std::max(0.0, norm2(c[k].force) - c[k].normal_force * c[k].normal_force));
  };
  const std::string of_lines = counts("id1", c.size(), [&](std::size_t k) { return partner_id(s, c[k].i); }) +
                               counts("id2", c.size(), [&](std::size_t k) { return partner_id(s, c[k].j); }) +
                               vectors("force", c.size(), [&](std::size_t k) { return c[k].force; }) +
                               numbers("normal_force", c.size(), [&](std::size_t k) { return c[k].normal_force; }) +
                               numbers("tangential_force", c.size(), tangential);
  // At both ends again: tubes are as thick as what their points say.
  const std::string of_ends =
      numbers("normal_force", 2 * c.size(), [&](std::size_t k) { return c[k / 2].normal_force; });
  return document(
      units_of(s), 2 * c.size(), 0, c.size(),
      section("PointData", of_ends) + section("CellData", of_lines) +
          section("Points", vectors("Points", 2 * c.size(),
                                    [&](std::size_t k) { return k % 2 == 0 ? c[k / 2].from : c[k / 2].to; })) +
          cells("Lines", c.size(), 2));
}

}  // namespace

std::vector<ExportFile> vtp_files(const Snapshot& s, std::int64_t number) {
  std::vector<ExportFile> files{
      {StateContent::particles, state_file_name(s, StateContent::particles, number, "vtp"), particles_vtp(s)}};
  if (s.has_contacts)
    files.push_back(
        {StateContent::contacts, state_file_name(s, StateContent::contacts, number, "vtp"), contacts_vtp(s)});
  return files;
}

}  // namespace softgrain

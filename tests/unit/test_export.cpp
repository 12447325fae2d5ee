// Exported files, read back: what OVITO and ParaView ask of VTP, dumps as LAMMPS writes them, tables.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "common/core/error.h"
#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "pipelines/export/export.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;

/// Three grains in a cell that is periodic and sheared; 0 and 1 touch inside, 0 and 2 across the boundary, 1 a wall.
Snapshot a_state() {
  Snapshot s;
  s.series = "scene/free-0";
  s.label = "a -- label";
  s.frame = 12;
  s.time = 0.25;
  s.has_velocity = s.has_contacts = true;
  s.cell_edges = {Vec3{{1.0, 0.0, 0.0}}, Vec3{{0.25, 1.0, 0.0}}, Vec3{{0.0, 0.0, 1.0}}};
  s.periodic = {true, true, false};
  const Vec3 places[] = {{{0.05, 0.5, 0.1}}, {{0.24, 0.5, 0.1}}, {{0.86, 0.5, 0.125}}};
  for (std::int64_t k = 0; k < 3; ++k) {
    SnapshotParticle p;
    p.position = places[k];
    p.radius = 0.1 + 0.01 * static_cast<double>(k);
    p.velocity = {{1.0 / 3.0, 0.0, -1e-300}};
    p.id = k;
    p.body = 5;
    p.role = ParticleRole::inner;
    s.particles.push_back(p);
  }
  s.walls.resize(1);
  s.walls[0].normal = {{0.0, 0.0, 1.0}};
  const auto contact = [&](std::int32_t i, std::int32_t j, const Vec3& to, const Vec3& force, double normal) {
    SnapshotContact c;
    c.i = i;
    c.j = j;
    c.from = s.particles[static_cast<std::size_t>(i)].position;
    c.to = to;
    c.point = (c.from + to) * 0.5;
    c.force = force;
    c.normal_force = normal;
    s.contacts.push_back(c);
  };
  contact(0, 1, places[1], {{-3.0, 4.0, 0.0}}, 3.0);
  contact(0, 2, places[2] - Vec3{{1.0, 0.0, 0.0}}, {{2.0, 0.0, 0.0}}, 2.0);
  s.contacts.back().shift = {{-1.0, 0.0, 0.0}};
  contact(1, 3, {{0.24, 0.5, 0.0}}, {{0.0, 0.0, 1.5}}, 1.5);
  return s;
}

std::string text_between(const std::string& text, const std::string& from, const std::string& to, std::size_t at = 0) {
  const std::size_t begin = text.find(from, at);
  if (begin == std::string::npos) return "";
  const std::size_t first = begin + from.size();
  return text.substr(first, text.find(to, first) - first);
}

/// The numbers of a DataArray within a section.
std::vector<double> array_of(const std::string& vtp, const std::string& section, const std::string& name) {
  const std::string part = text_between(vtp, "<" + section + ">", "</" + section + ">");
  const std::size_t at = part.find("Name=\"" + name + "\"");
  if (at == std::string::npos) return {};
  std::istringstream in(text_between(part, ">", "<", at));
  std::vector<double> out;
  for (std::string word; in >> word;) out.push_back(std::stod(word));
  return out;
}

const ExportFile& file_of(const std::vector<ExportFile>& files, StateContent holds) {
  for (const ExportFile& f : files)
    if (f.content == holds) return f;
  throw std::runtime_error("no file of " + to_string(holds));
}

TEST(ExportFiles, ParticlesOfVtpAreVerticesAlone) {
  const auto files = vtp_files(a_state(), 3);
  ASSERT_EQ(files.size(), 2U);
  const ExportFile& f = file_of(files, StateContent::particles);
  EXPECT_EQ(f.name, "scene_free-0_particles_000003.vtp");
  for (const char* needed :
       {"type=\"PolyData\"", "byte_order=\"LittleEndian\"", "NumberOfPoints=\"3\"", "NumberOfVerts=\"3\"",
        "NumberOfLines=\"0\"", "NumberOfStrips=\"0\"", "NumberOfPolys=\"0\""})
    EXPECT_NE(f.text.find(needed), std::string::npos) << needed;
  for (const char* refused : {"compressor", "appended", "a -- label"})
    EXPECT_EQ(f.text.find(refused), std::string::npos) << refused;
  EXPECT_EQ(array_of(f.text, "PointData", "radius"),
            (std::vector<double>{0.1, 0.1 + 0.01, 0.1 + 0.01 * 2.0}));  // to the last bit
  EXPECT_EQ(array_of(f.text, "PointData", "id"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(array_of(f.text, "PointData", "role"), (std::vector<double>{2, 2, 2}));
  const auto v = array_of(f.text, "PointData", "v");
  ASSERT_EQ(v.size(), 9U);
  EXPECT_EQ(v[0], 1.0 / 3.0);  // to the last bit
  EXPECT_EQ(v[2], -1e-300);
  EXPECT_EQ(array_of(f.text, "Points", "Points"),
            (std::vector<double>{0.05, 0.5, 0.1, 0.24, 0.5, 0.1, 0.86, 0.5, 0.125}));
  EXPECT_EQ(array_of(f.text, "Verts", "connectivity"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(array_of(f.text, "Verts", "offsets"), (std::vector<double>{1, 2, 3}));
}

TEST(ExportFiles, ContactsOfVtpAreLinesThatDoNotSpanTheCell) {
  const auto files = vtp_files(a_state(), 0);
  const std::string& text = file_of(files, StateContent::contacts).text;
  EXPECT_NE(text.find("NumberOfPoints=\"6\" NumberOfVerts=\"0\" NumberOfLines=\"3\""), std::string::npos);
  const auto points = array_of(text, "Points", "Points");
  ASSERT_EQ(points.size(), 18U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(points[6 * k] - points[6 * k + 3]), 0.2) << k;
  EXPECT_EQ(array_of(text, "Lines", "connectivity"), (std::vector<double>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(array_of(text, "Lines", "offsets"), (std::vector<double>{2, 4, 6}));
  EXPECT_EQ(array_of(text, "CellData", "normal_force"), (std::vector<double>{3.0, 2.0, 1.5}));
  EXPECT_EQ(array_of(text, "CellData", "tangential_force"), (std::vector<double>{4.0, 0.0, 0.0}));
  EXPECT_EQ(array_of(text, "PointData", "normal_force"), (std::vector<double>{3.0, 3.0, 2.0, 2.0, 1.5, 1.5}));
  EXPECT_EQ(array_of(text, "CellData", "id2"), (std::vector<double>{1, 2, -1}));
}

TEST(ExportFiles, StatesThatKeptNoContactsHaveNoFileOfThem) {
  Snapshot s = a_state();
  s.has_contacts = false;
  s.contacts.clear();
  EXPECT_EQ(vtp_files(s, 0).size(), 1U);
  EXPECT_EQ(dump_files(s, 0).size(), 1U);
  EXPECT_THROW((void)file_of(csv_files(s, 0), StateContent::contacts), std::runtime_error);
}

/// Sections "ITEM: NAME rest" to their lines.
std::map<std::string, std::vector<std::string>> items_of(const std::string& dump) {
  std::map<std::string, std::vector<std::string>> out;
  std::istringstream lines(dump);
  std::string at;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("ITEM: "))
      out[at = line.substr(6)];
    else
      out[at].push_back(line);
  }
  return out;
}

TEST(ExportFiles, DumpsAreAsLammpsWritesThem) {
  const auto files = dump_files(a_state(), 0);
  ASSERT_EQ(files.size(), 3U);
  auto atoms = items_of(file_of(files, StateContent::particles).text);
  EXPECT_EQ(atoms["TIMESTEP"], std::vector<std::string>{"12"});
  EXPECT_EQ(atoms["TIME"], std::vector<std::string>{"0.25"});
  EXPECT_EQ(atoms["NUMBER OF ATOMS"], std::vector<std::string>{"3"});
  const auto rows = atoms["ATOMS id type mol x y z radius vx vy vz"];
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_TRUE(rows[1].starts_with("2 3 6 0.24 0.5 0.1 0.11 ")) << rows[1];
  const auto box = atoms["BOX BOUNDS xy xz yz pp pp ff"];
  ASSERT_EQ(box.size(), 3U);
  EXPECT_EQ(box[0], "0 1.25 0.25");  // the box around the sheared cell
  EXPECT_EQ(box[1], "0 1 0");
  auto contacts = items_of(file_of(files, StateContent::contacts).text);
  EXPECT_EQ(contacts["NUMBER OF ENTRIES"], std::vector<std::string>{"2"});
  const auto bonds = contacts["ENTRIES index batom1 batom2 normal_force fx fy fz px py pz"];
  ASSERT_EQ(bonds.size(), 2U);
  EXPECT_TRUE(bonds[0].starts_with("1 1 2 3 -3 4 0 ")) << bonds[0];
  EXPECT_TRUE(bonds[1].starts_with("2 1 3 2 2 0 0 ")) << bonds[1];
  auto walls = items_of(file_of(files, StateContent::wall_contacts).text);
  const auto on_walls = walls["ENTRIES index id wall normal_force fx fy fz px py pz"];
  ASSERT_EQ(on_walls.size(), 1U);
  EXPECT_TRUE(on_walls[0].starts_with("1 2 1 1.5 ")) << on_walls[0];
}

/// The lines of a section of a data file, without those that are empty.
std::vector<std::vector<double>> section_of(const std::string& data, const std::string& name) {
  std::istringstream lines(data);
  std::vector<std::vector<double>> out;
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    if (std::isalpha(static_cast<unsigned char>(line[0])) != 0) {
      inside = line == name;
      continue;
    }
    if (!inside) continue;
    std::istringstream in(line);
    out.emplace_back();
    for (std::string word; in >> word;) out.back().push_back(std::stod(word));
  }
  return out;
}

TEST(ExportFiles, DataFilesAreAsLammpsReadsThem) {
  Snapshot s = a_state();
  for (SnapshotParticle& p : s.particles) p.mass = 2.5;
  s.particles[1].role = ParticleRole::solid;
  s.particles[2].material = 4;
  s.particles[2].spin = {{0.0, 0.0, 7.0}};
  const auto files = data_files(s, 0);
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "scene_free-0_particles_000000.data");
  const std::string& text = files[0].text;
  EXPECT_TRUE(text.starts_with("scene/free-0: a -- label, units m, N, s\n\n3 atoms\n3 atom types\n")) << text;
  for (const char* needed : {"# type 1: solid, material 0\n", "# type 2: inner, material 0\n",
                             "# type 3: inner, material 4\n", "\n0 1 xlo xhi\n0 1 ylo yhi\n", "\n0.25 0 0 xy xz yz\n"})
    EXPECT_NE(text.find(needed), std::string::npos) << needed << text;
  const auto atoms = section_of(text, "Atoms # sphere");
  const auto velocities = section_of(text, "Velocities");
  ASSERT_EQ(atoms.size(), 3U);
  ASSERT_EQ(velocities.size(), 3U);
  const std::vector<double> types{2, 1, 3};
  for (std::size_t k = 0; k < 3; ++k) {
    const SnapshotParticle& p = s.particles[k];
    ASSERT_EQ(atoms[k].size(), 7U);
    EXPECT_EQ(atoms[k][0], static_cast<double>(k + 1));
    EXPECT_EQ(atoms[k][1], types[k]);
    EXPECT_EQ(atoms[k][2], 2.0 * p.radius);  // to the last bit
    EXPECT_NEAR(atoms[k][3] * std::numbers::pi / 6.0 * std::pow(atoms[k][2], 3.0), p.mass, 1e-14);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(atoms[k][static_cast<std::size_t>(4 + c)], p.position[c]);
    EXPECT_EQ(velocities[k],
              (std::vector<double>{static_cast<double>(k + 1), 1.0 / 3.0, 0.0, -1e-300, 0.0, 0.0, p.spin[2]}));
  }
}

TEST(ExportFiles, DataFilesSayWhatIsNotRecorded) {
  Snapshot s = a_state();
  s.has_velocity = false;
  s.label = "two\nlines";
  s.cell_edges[1] = {{0.0, 1.0, 0.0}};
  const std::string text = data_files(s, 0)[0].text;
  EXPECT_FALSE(has_masses(s));
  EXPECT_TRUE(text.starts_with("scene/free-0: two lines, units m, N, s; masses not recorded, density 1\n\n")) << text;
  EXPECT_EQ(section_of(text, "Atoms # sphere")[0][3], 1.0);
  EXPECT_TRUE(section_of(text, "Velocities").empty());
  EXPECT_EQ(text.find("xy xz yz"), std::string::npos);
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> out;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    out.emplace_back();
    std::istringstream in(line + ",");
    for (std::string cell; std::getline(in, cell, ',');) out.back().push_back(cell);
  }
  return out;
}

TEST(ExportFiles, TablesHaveUnitsAndAsManyCellsAsTheirHeader) {
  const auto files = csv_files(a_state(), 0);
  ASSERT_EQ(files.size(), 3U);
  for (const ExportFile& f : files) {
    const auto rows = cells_of(f.text);
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size()) << f.name;
  }
  const auto particles = cells_of(file_of(files, StateContent::particles).text);
  ASSERT_EQ(particles.size(), 4U);
  EXPECT_EQ(particles[0][4], "x [m]");
  EXPECT_EQ(particles[0][8], "vx [m/s]");
  EXPECT_EQ(particles[3][4], "0.86");
  const auto contacts = cells_of(file_of(files, StateContent::contacts).text);
  ASSERT_EQ(contacts.size(), 4U);
  EXPECT_EQ(contacts[0][3], "normal_force [N]");
  EXPECT_EQ(contacts[1][1], "1");
  EXPECT_EQ(contacts[3][1], "");
  EXPECT_EQ(contacts[3][2], "0");
}

/// Strains of unloading and of a hold: programs that sort by time would mix such states.
TEST(ExportFiles, TimesGrowFromStateToState) {
  const std::vector<double> grow{0.0, 0.25, 1.0};
  EXPECT_EQ(times_of(grow), grow);
  EXPECT_EQ(times_of({0.0, 0.04, 0.03, 0.04, 0.04}), (std::vector<double>{0, 1, 2, 3, 4}));
  EXPECT_EQ(times_of({0.5, 0.5}), (std::vector<double>{0, 1}));
  EXPECT_EQ(times_of({0.5}), std::vector<double>{0.5});
}

/// States of a file, as an index and as XDMF name them.
TEST(ExportFiles, IndicesSayUnitsAndNumberWhatGoesBack) {
  const test::TemporaryDirectory directory;
  Snapshot s = a_state();
  s.series = "free-0";
  s.time = Snapshot::kNone;
  std::vector<Snapshot> states;
  for (const double strain : {0.0, 0.02, 0.01}) {
    s.strain = strain;
    states.push_back(s);
  }
  const std::string file = directory.file("states_macro.h5");
  save_snapshots(states, file, {});
  (void)export_states(file, ExportFormat::csv, directory.file("csv"));
  EXPECT_EQ(cells_of(read_text(directory.file("csv/free-0.csv")))[0][2], "strain [1]");
  EXPECT_EQ(cells_of(read_text(directory.file("csv/free-0.csv")))[3][2], "0.01");
  (void)export_states(file, ExportFormat::vtp, directory.file("vtp"));
  const std::string index = read_text(directory.file("vtp/free-0_particles.pvd"));
  EXPECT_NE(index.find("timestep=\"2\" part=\"0\" file=\"free-0_particles_000002.vtp\""), std::string::npos) << index;
  write_states_xdmf(file);
  const std::string xdmf = read_text(directory.file("states_macro.xdmf"));
  EXPECT_NE(xdmf.find("<Time Value=\"2\"/>"), std::string::npos) << xdmf;
  EXPECT_EQ(xdmf.find("<Time Value=\"0.01\"/>"), std::string::npos) << xdmf;
}

TEST(ExportFiles, UnknownFormsAreRefused) {
  EXPECT_EQ(export_format("lammps-dump"), ExportFormat::lammps_dump);
  EXPECT_EQ(export_format("lammps-data"), ExportFormat::lammps_data);
  EXPECT_THROW((void)export_format(""), InputError);
  try {
    (void)export_format("vpt");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("nearest is vtp"), std::string::npos) << e.what();
  }
}

}  // namespace

// softgrain export: the files are there and hold what the run holds; XDMF files name what is in the HDF5 file beside
// them; ParaView's own readers read both (when its Python is there).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>

#include "common/io/hdf5_file.h"
#include "pipelines/snapshots/snapshots.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;
using nlohmann::json;

const KindScene kParticles{"particles", "microsim", tiny_particles("0.2"), 0};

std::string quoted(const std::string& path) { return "'" + path + "'"; }

std::size_t files_with(const std::string& directory, const std::string& ending) {
  std::size_t n = 0;
  for (const auto& entry : fs::directory_iterator(directory))
    n += entry.path().filename().string().ends_with(ending) ? 1U : 0U;
  return n;
}

TEST(Export, WritesEveryFormAndLeavesTheRunAlone) {
  const KindRuns runs(kParticles);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a", {"--set", "output.snapshots=5"}))), 0));
  const std::string run = runs.out("a");
  const std::string before = read_text(run + "/summary.json");
  for (const std::string form : {"vtp", "csv", "lammps-dump"}) {
    const ProgramOutcome done = run_the_program("export " + quoted(run) + " --json --to " + form);
    ASSERT_EQ(done.status, 0) << done.output;
    const json told = json::parse(done.output);
    EXPECT_EQ(told["series"][0]["states"], 21);
    EXPECT_EQ(told["series"][0]["with_contacts"], 5);
    for (const json& file : told["series"][0]["open"])
      EXPECT_TRUE(fs::exists(told["directory"].get<std::string>() + "/" + file.get<std::string>())) << file;
  }
  EXPECT_EQ(files_with(run + "/export-vtp", ".vtp"), 26U);
  EXPECT_EQ(files_with(run + "/export-vtp", ".pvd"), 2U);
  EXPECT_EQ(files_with(run + "/export-lammps-dump", ".dump"), 31U);
  EXPECT_EQ(files_with(run + "/export-csv", ".csv"), 21U + 5U + 21U + 1U);
  EXPECT_EQ(read_text(run + "/summary.json"), before);
}

/// What the last recorded frame holds, as a program that knows nothing of LAMMPS reads it.
TEST(Export, DataFilesOfLammpsHoldTheLastState) {
  const KindRuns runs(kParticles);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const ProgramOutcome done = run_the_program("export " + quoted(runs.out("a")) + " --json --to lammps-data");
  ASSERT_EQ(done.status, 0) << done.output;
  const json told = json::parse(done.output)["series"][0];
  EXPECT_EQ(told["states"], 1);
  EXPECT_FALSE(told.contains("remark")) << "run.h5 has masses";
  const std::string file = runs.out("a") + "/export-lammps-data/" + told["open"][0].get<std::string>();
  const Snapshot last = read_snapshots(runs.out("a")).back();
  std::istringstream in(read_text(file));
  std::string line;
  while (std::getline(in, line) && line != "Atoms # sphere") {
  }
  for (const SnapshotParticle& p : last.particles) {
    std::int64_t id = 0;
    std::int64_t type = 0;
    double diameter = 0.0;
    double density = 0.0;
    Vec3 x;
    in >> id >> type >> diameter >> density >> x[0] >> x[1] >> x[2];
    EXPECT_EQ(id, p.id + 1);
    EXPECT_GE(type, 1);
    EXPECT_EQ(diameter, 2.0 * p.radius);
    EXPECT_NEAR(density * std::numbers::pi / 6.0 * std::pow(diameter, 3.0), p.mass, 1e-12 * p.mass);
    EXPECT_EQ(x, p.position);
  }
  in >> line;
  EXPECT_EQ(line, "Velocities");
}

TEST(Export, LammpsReadsDataFiles) {
  if (std::system("lmp -h >/dev/null 2>&1") != 0) GTEST_SKIP() << "no lmp (Debian: lammps)";
  const KindRuns runs(kParticles);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  ASSERT_EQ(run_the_program("export " + quoted(runs.out("a")) + " --to lammps-data").status, 0);
  const std::string data = runs.out("a") + "/export-lammps-data/particles_particles_000000.data";
  const Snapshot last = read_snapshots(runs.out("a")).back();
  std::string boundary;
  for (const bool p : last.periodic) boundary += p ? " p" : " f";
  write_text_atomic(runs.out("in.lmp"), "units si\natom_style sphere\nboundary" + boundary + "\nread_data " + data +
                                            "\nvariable m equal mass(all)\nvariable v equal vcm(all,z)\n"
                                            "print \"SEEN $(atoms) ${m} ${v}\"\n");
  const std::string seen = runs.out("seen.txt");
  ASSERT_EQ(std::system(("lmp -log none -in " + quoted(runs.out("in.lmp")) + " >" + quoted(seen) + " 2>&1").c_str()), 0)
      << read_text(seen);
  double mass = 0.0;
  double momentum = 0.0;
  for (const SnapshotParticle& p : last.particles) {
    mass += p.mass;
    momentum += p.mass * p.velocity[2];
  }
  const std::string text = read_text(seen);
  const std::size_t at = text.find("\nSEEN ");
  ASSERT_NE(at, std::string::npos) << text;
  std::istringstream in(text.substr(at + 6));
  std::size_t atoms = 0;
  double mass_seen = 0.0;
  double velocity_seen = 0.0;
  in >> atoms >> mass_seen >> velocity_seen;
  EXPECT_EQ(atoms, last.particles.size());
  EXPECT_NEAR(mass_seen, mass, 1e-9 * mass);
  EXPECT_NEAR(velocity_seen, momentum / mass, 1e-9 * std::abs(momentum / mass) + 1e-300);
}

TEST(Export, LeavesNothingOfAnEarlierExportAndEverythingElse) {
  const KindRuns runs(kParticles);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("long", {"--set", "output.snapshots=5"}))), 0));
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("short", {"--set", "output.every=0.05"}))), 0));
  write_text_atomic(runs.out("soft.toml"), kTinySoftParticle);
  ASSERT_TRUE(ended_with(
      wait_for(start_program({"microsim", runs.out("soft.toml"), "--out", runs.out("other"), "--quiet"})), 0));
  const auto names = [](const std::string& directory) {
    std::set<std::string> out;
    for (const auto& entry : fs::directory_iterator(directory)) out.insert(entry.path().filename().string());
    return out;
  };
  for (const std::string form : {"vtp", "csv", "lammps-dump"}) {
    const auto exported = [&](const std::string& run, const std::string& to) {
      const ProgramOutcome done = run_the_program("export " + quoted(run) + " --to " + form + " --out " + quoted(to));
      EXPECT_EQ(done.status, 0) << done.output;
      return names(to);
    };
    const std::string to = runs.out("to-" + form);
    const std::set<std::string> alone = exported(runs.out("short"), runs.out("alone-" + form));
    const std::size_t many = exported(runs.out("long"), to).size();
    EXPECT_GT(many, alone.size());
    const std::string extension = form == "lammps-dump" ? "dump" : form;
    const std::set<std::string> mine{"notes.txt", "mine_particles_000001." + extension, "mine.csv"};
    for (const std::string& name : mine) write_text_atomic(to + "/" + name, "mine");
    std::set<std::string> expected = alone;
    expected.insert(mine.begin(), mine.end());
    EXPECT_EQ(exported(runs.out("short"), to), expected) << form;
    // Of another run with other series too.
    exported(runs.out("other"), to);
    EXPECT_EQ(exported(runs.out("short"), to), expected) << form;
    // What no export listed is of somebody else, ...
    exported(runs.out("long"), to);
    fs::remove(to + "/.export-" + form);
    const std::set<std::string> before = names(to);
    const ProgramOutcome refused =
        run_the_program("export " + quoted(runs.out("short")) + " --to " + form + " --out " + quoted(to));
    EXPECT_EQ(refused.status, 2) << refused.output;
    EXPECT_NE(refused.output.find("is there already"), std::string::npos) << refused.output;
    EXPECT_EQ(names(to), before);
    // ... but for states of the same series where a version without lists has named the directory.
    const std::string named = runs.out("of-" + form) + "/export-" + form;
    fs::create_directory(runs.out("of-" + form));
    fs::rename(to, named);
    EXPECT_EQ(exported(runs.out("short"), named), expected) << form;
    for (const std::string& name : mine) EXPECT_EQ(read_text(named + "/" + name), "mine");
    // An index may have the name of somebody's table.
    if (form != "csv") continue;
    fs::create_directory(to);
    write_text_atomic(to + "/particles.csv", "mine");
    EXPECT_EQ(run_the_program("export " + quoted(runs.out("short")) + " --to csv --out " + quoted(to)).status, 2);
    EXPECT_EQ(names(to), std::set<std::string>{"particles.csv"});
    EXPECT_EQ(read_text(to + "/particles.csv"), "mine");
  }
}

TEST(Export, KnowsRunsOfManySeries) {
  const KindRuns runs({"soft-particle", "microsim", kTinySoftParticle, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const std::string to = runs.out("elsewhere");
  const ProgramOutcome done = run_the_program("export " + quoted(runs.out("a")) + " --to vtp --out " + quoted(to));
  ASSERT_EQ(done.status, 0) << done.output;
  EXPECT_NE(done.output.find("soft-solid-least-work-0 (soft-particle): 2 states, 2 with contacts"), std::string::npos)
      << done.output;
  EXPECT_EQ(files_with(to, ".pvd"), 6U);
  EXPECT_EQ(files_with(to, ".vtp"), 10U);
}

TEST(Export, BadInputIsTold) {
  const TemporaryDirectory directory;
  const auto outcome = [&](const std::string& words) { return run_the_program("export " + words); };
  const std::string empty = quoted(directory.path());
  EXPECT_EQ(outcome(empty).status, 2);
  const ProgramOutcome misspelt = outcome(empty + " --to vpt");
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_NE(misspelt.output.find("nearest is vtp"), std::string::npos) << misspelt.output;
  const ProgramOutcome nothing = outcome(empty + " --to vtp");
  EXPECT_EQ(nothing.status, 2);
  EXPECT_NE(nothing.output.find("holds no states"), std::string::npos) << nothing.output;
  EXPECT_FALSE(fs::exists(directory.file("export-vtp")));
  EXPECT_EQ(outcome(quoted(directory.file("missing")) + " --to vtp").status, 4);
  write_text_atomic(directory.file("states_macro.h5"), "damaged");
  EXPECT_EQ(outcome(empty + " --to csv").status, 4);
  EXPECT_EQ(outcome("--to vtp").status, 2);
}

/// Every "file.h5:/path" of an XDMF file with the dimensions that stand beside it.
std::size_t expect_sound_xdmf(const std::string& path) {
  const std::string text = read_text(path);
  const std::regex item("Format=\"HDF\"[^>]*Dimensions=\"([0-9 ]*)\">([^:<]*):/([^<]*)<");
  std::size_t found = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), item); it != std::sregex_iterator(); ++it) {
    const fs::path file = fs::path(path).parent_path() / (*it)[2].str();
    const fs::path inside((*it)[3].str());
    h5::Group group = h5::open_file(file.string());
    for (const auto& part : inside.parent_path()) group = group.open(part.string());
    std::string shape;
    for (const std::size_t n : group.shape(inside.filename().string()))
      shape += (shape.empty() ? "" : " ") + std::to_string(n);
    EXPECT_EQ(shape, (*it)[1].str()) << path << ": " << inside;
    ++found;
  }
  return found;
}

TEST(Xdmf, NamesWhatIsBesideIt) {
  const KindRuns particles(kParticles);
  ASSERT_TRUE(ended_with(wait_for(start_program(particles.arguments("a", {"--set", "output.every=0.05"}))), 0));
  // Per frame: numbers of the vertices, positions and five attributes.
  EXPECT_EQ(expect_sound_xdmf(particles.out("a") + "/run.xdmf"), 5U * 7U);
  EXPECT_GT(expect_sound_xdmf(particles.out("a") + "/run_contacts.xdmf"), 0U);
  const KindRuns soft({"soft-particle", "microsim", kTinySoftParticle, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(soft.arguments("a"))), 0));
  EXPECT_GT(expect_sound_xdmf(soft.out("a") + "/states_measurements.xdmf"), 0U);
  EXPECT_GT(expect_sound_xdmf(soft.out("a") + "/states_measurements_contacts.xdmf"), 0U);
}

/// A Python that has ParaView: the packages of Debian belong to the system's own.
std::string paraview_python() {
  for (const char* python : {"pvpython", "/usr/bin/python3", "python3"})
    if (std::system((std::string(python) + " -c 'import paraview.simple' >/dev/null 2>&1").c_str()) == 0) return python;
  return "";
}

json read_with_paraview(const std::string& python, const std::vector<std::string>& files) {
  std::string line = python + " '" SOFTGRAIN_SOURCE_DIR "/tests/support/read_with_paraview.py'";
  for (const std::string& f : files) line += " " + quoted(f);
  FILE* pipe = ::popen((line + " 2>/dev/null").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), n);
  EXPECT_EQ(::pclose(pipe), 0) << line;
  const std::size_t at = output.find("RESULT ");
  return at == std::string::npos ? json::object() : json::parse(output.substr(at + 7));
}

double sum_of(const std::vector<SnapshotContact>& contacts) {
  double sum = 0.0;
  for (const SnapshotContact& c : contacts) sum += c.normal_force;
  return sum;
}

void expect_particles(const json& seen, const Snapshot& s) {
  double radii = 0.0;
  for (const SnapshotParticle& p : s.particles) radii += p.radius;
  EXPECT_EQ(seen["points"], s.particles.size());
  EXPECT_EQ(seen["cells"], s.particles.size());
  EXPECT_NEAR(seen["time"].get<double>(), s.moment(), 1e-12);
  EXPECT_NEAR(seen["point_data"]["radius"]["sum"].get<double>(), radii, 1e-5 * radii);
}

void expect_contacts(const json& seen, const Snapshot& s) {
  EXPECT_EQ(seen["points"], 2 * s.contacts.size());
  EXPECT_EQ(seen["cells"], s.contacts.size());
  EXPECT_NEAR(seen["time"].get<double>(), s.moment(), 1e-12);
  const double sum = sum_of(s.contacts);
  EXPECT_NEAR(seen["cell_data"]["normal_force"]["sum"].get<double>(), sum, 1e-5 * std::abs(sum));
  double longest = 0.0;
  for (const SnapshotContact& c : s.contacts) longest = std::max(longest, norm(c.to - c.from));
  EXPECT_NEAR(seen["longest_line"].get<double>(), longest, 1e-5 * longest);
}

/// States of a run, and those of them that have contacts.
struct Expected {
  std::vector<Snapshot> all;
  std::vector<Snapshot> with_contacts;

  explicit Expected(const std::string& run) : all(read_snapshots(run)) {
    for (const Snapshot& s : all)
      if (!s.contacts.empty()) with_contacts.push_back(s);
  }
};

void expect_in(const json& particles, const json& contacts, const Expected& expected) {
  ASSERT_EQ(particles.size(), expected.all.size());
  for (std::size_t k = 0; k < particles.size(); ++k) expect_particles(particles[k], expected.all[k]);
  std::vector<json> kept;
  for (const json& c : contacts)
    if (c["cells"] > 0) kept.push_back(c);
  ASSERT_EQ(kept.size(), expected.with_contacts.size());
  for (std::size_t k = 0; k < kept.size(); ++k) expect_contacts(kept[k], expected.with_contacts[k]);
}

TEST(Export, SlowParaViewReadsParticles) {
  const std::string python = paraview_python();
  if (python.empty()) GTEST_SKIP() << "no Python with ParaView (Debian: python3-paraview)";
  const KindRuns runs(kParticles);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a", {"--set", "output.snapshots=5"}))), 0));
  const std::string run = runs.out("a");
  ASSERT_EQ(run_the_program("export " + quoted(run) + " --to vtp").status, 0);
  const std::vector<std::string> files{run + "/run.xdmf", run + "/run_contacts.xdmf",
                                       run + "/export-vtp/particles_particles.pvd",
                                       run + "/export-vtp/particles_contacts.pvd"};
  const json seen = read_with_paraview(python, files);
  const Expected expected(run);
  ASSERT_EQ(expected.all.size(), 21U);
  ASSERT_GT(expected.with_contacts.size(), 1U);
  expect_in(seen[files[0]], seen[files[1]], expected);
  expect_in(seen[files[2]], seen[files[3]], expected);
}

TEST(Export, SlowParaViewReadsSoftParticles) {
  const std::string python = paraview_python();
  if (python.empty()) GTEST_SKIP() << "no Python with ParaView (Debian: python3-paraview)";
  const KindRuns runs({"soft-particle", "microsim", kTinySoftParticle, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const std::string run = runs.out("a");
  ASSERT_EQ(run_the_program("export " + quoted(run) + " --to vtp").status, 0);
  const std::string series = "soft-solid-least-work-0";
  const std::vector<std::string> files{run + "/export-vtp/" + series + "_particles.pvd",
                                       run + "/export-vtp/" + series + "_contacts.pvd",
                                       run + "/states_measurements.xdmf", run + "/states_measurements_contacts.xdmf"};
  const json seen = read_with_paraview(python, files);
  Expected expected(run);
  const std::size_t most = expected.all[0].particles.size();
  std::erase_if(expected.all, [&](const Snapshot& s) { return s.series != series; });
  std::erase_if(expected.with_contacts, [&](const Snapshot& s) { return s.series != series; });
  ASSERT_EQ(expected.all.size(), 2U);
  expect_in(seen[files[0]], seen[files[1]], expected);
  // Several series in one file are a block each; the first is this one.
  ASSERT_GT(seen[files[2]].size(), 0U);
  EXPECT_EQ(seen[files[2]][0]["points"], most);
  ASSERT_GT(seen[files[3]].size(), 0U);
  // A state without contacts has no lines there.
  EXPECT_EQ(seen[files[3]][0]["cells"], expected.with_contacts.at(0).contacts.size());
}

}  // namespace

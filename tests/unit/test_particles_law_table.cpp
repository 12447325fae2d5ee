// Scenes of explicit particles whose soft particles follow a law table: forces of several contacts at once against the
// model that the fits predict with, the choice of the entry, what cannot be combined, restart and threads.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "common/io/hdf5_file.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "microsim/particles/particles_run.h"
#include "tests/support/small_packing.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRadius = 0.02;
constexpr double kModulus = 0.5e6;

std::string vector_text(const Vec3& v) {
  char text[100];
  std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g]", v[0], v[1], v[2]);
  return text;
}

std::string ball(const char* material, double r, const Vec3& x) {
  return std::string("[[particle]]\nmaterial = \"") + material + "\"\nradius = " + std::to_string(r) +
         "\nposition = " + vector_text(x) + "\n";
}

std::string plane(const Vec3& point, const Vec3& normal) {
  return "[[wall]]\nshape = \"plane\"\npoint = " + vector_text(point) + "\nnormal = " + vector_text(normal) +
         "\nmaterial = \"rigid\"\n";
}

class ParticlesLawTable : public ::testing::Test {
 protected:
  void SetUp() override {
    LawTable table;
    table.entries = {synthetic::law_entry(0.66), synthetic::law_entry(0.72, 0.03)};
    save_law_table(table, directory_.file("table.toml"));
    table.entries.pop_back();
    save_law_table(table, directory_.file("one.toml"));
  }
  /// `choice` goes into every contact of soft particles.
  static std::string contacts(const std::string& choice) {
    std::string text = "kind = \"particles\"\n[material.soft]\ndensity = 1500.0\n[material.stone]\ndensity = 2500.0\n";
    for (const char* pair : {"\"stone\", \"stone\"", "\"stone\", \"rigid\""})
      text += "[[contact]]\npair = [" + std::string(pair) +
              "]\nlaw = \"linear-spring\"\nmu = 0.3\nrestitution = 0.5\nnormal_stiffness = 1e4\n"
              "tangential_stiffness = 1e4\n";
    const auto soft = [&](const char* pair, const char* kind) {
      text += "[[contact]]\npair = [" + std::string(pair) + "]\nlaw = \"law-card\"\nE = \"0.5 MPa\"\nkind = " + kind +
              "\n" + choice;
    };
    soft("\"soft\", \"stone\"", "\"soft-solid\"\nwhich_soft = \"soft\"");
    soft("\"rigid\", \"soft\"", "\"soft-wall\"\nwhich_soft = \"soft\"");
    soft("\"soft\", \"soft\"", "\"soft-soft\"");
    return text;
  }
  ParticlesScene read(const std::string& text) {
    return read_particles_scene(Scene::parse(text, directory_.file("scene.toml")));
  }
  /// One soft particle between planes, solid and soft neighbours.
  static std::string squeezed(bool soft_first) {
    std::string text = plane({{-0.9 * kRadius, 0.0, 0.0}}, {{1.0, 0.0, 0.0}}) +
                       plane({{0.85 * kRadius, 0.0, 0.0}}, {{-1.0, 0.0, 0.0}});
    const std::string soft = ball("soft", kRadius, {});
    const std::string others = ball("stone", kRadius, {{0.0, 1.9 * kRadius, 0.0}}) +
                               ball("stone", 0.5 * kRadius, {{0.0, 0.0, -1.42 * kRadius}}) +
                               ball("soft", 0.8 * kRadius, {{0.0, -1.68 * kRadius, 0.0}});
    return text + (soft_first ? soft + others : others + soft) + "[time]\nend = 1e-4\n";
  }
  /// Forces on the neighbours in the order of squeezed(), over E R^2, as the fits predict them.
  static std::vector<double> predicted(const LawTableEntry& entry, LawForm form) {
    const std::vector<MultiContactPartner> partners{{PartnerKind::plane, 0.0, {{-1.0, 0.0, 0.0}}},
                                                    {PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}},
                                                    {PartnerKind::solid, 1.0, {{0.0, 1.0, 0.0}}},
                                                    {PartnerKind::solid, 0.5, {{0.0, 0.0, -1.0}}},
                                                    {PartnerKind::soft, 0.8, {{0.0, -1.0, 0.0}}}};
    return multi_contact_forces(multi_contact_model(*entry.find(form)), partners, {0.1, 0.15, 0.1, 0.08, 0.12});
  }
  static void expect_forces(ParticlesScene scene, const std::vector<double>& wanted, double factor) {
    force_pass(scene.system, 0.0);
    const double scale = factor * kModulus * kRadius * kRadius;
    const auto records = contact_records(scene.system);
    std::vector<double> found;
    const auto& p = scene.system.particles;
    for (const auto& r : records) {
      const auto centre = [&](Slot s) { return s < p.grains && norm(p.sphere[static_cast<std::size_t>(s)].x) == 0.0; };
      if (centre(r.i) || centre(r.j)) found.push_back(r.normal_force / scale);
    }
    std::vector<double> sorted = wanted;
    std::erase(sorted, 0.0);  // below the threshold there is no contact to record
    ASSERT_EQ(found.size(), sorted.size());
    ASSERT_GE(found.size(), 2U);
    std::sort(sorted.begin(), sorted.end());
    std::sort(found.begin(), found.end());
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], sorted[k], 1e-9 * sorted[k]) << k;
  }
  void expect_refused(const std::string& text, const std::vector<std::string>& words) {
    try {
      (void)read(text);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& e) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " not in: " << e.what();
    }
  }
  static std::string with(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  TemporaryDirectory directory_;
};

/// The soft neighbour is too small for the planes: it touches the particle in the middle alone, as the model has it.
TEST_F(ParticlesLawTable, SeveralContactsAtOnceHaveTheForcesOfTheModel) {
  for (const auto& [form, name] : enum_names<LawForm>)
    for (const bool soft_first : {true, false}) {
      const std::string text =
          contacts("file = \"one.toml\"\nform = \"" + std::string(name) + "\"\n") + squeezed(soft_first);
      expect_forces(read(text), predicted(synthetic::law_entry(0.66), form), 1.0);
    }
}

TEST_F(ParticlesLawTable, TheEntryIsThatOfTheSolidFraction) {
  const LawTable table = load_law_table(directory_.file("table.toml"));
  std::string remark;
  const LawTableEntry between = entry_at(table, 0.69, RangePolicy::reject, remark);
  const auto at = [&](const std::string& choice) {
    return read(contacts("file = \"table.toml\"\nform = \"isotropic\"\n" + choice) + squeezed(true));
  };
  expect_forces(at("solid_fraction = 0.69\n"), predicted(between, LawForm::isotropic), 1.0);
  expect_forces(at("solid_fraction = 0.72\n"), predicted(table.entries[1], LawForm::isotropic), 1.0);
  expect_forces(at("solid_fraction = 0.9\nrange = \"clamp\"\n"), predicted(table.entries[1], LawForm::isotropic), 1.0);
  EXPECT_TRUE(at("solid_fraction = 0.69\n").remarks.empty());
  const auto remarks = at("solid_fraction = 0.9\nrange = \"clamp\"\n").remarks;
  ASSERT_FALSE(remarks.empty());
  EXPECT_NE(remarks[0].find("outside the law table"), std::string::npos) << remarks[0];
  expect_refused(contacts("file = \"table.toml\"\n") + squeezed(true), {"file", "solid_fraction", "0.66", "0.72"});
  expect_refused(contacts("file = \"table.toml\"\nsolid_fraction = 0.9\n") + squeezed(true),
                 {"solid_fraction", "0.900", "clamp"});
}

/// Planes, solid and soft neighbours slide differently, unless the contact says its own friction.
TEST_F(ParticlesLawTable, FrictionIsThatOfTheKindOfNeighbour) {
  const ParticlesScene scene = read(contacts("file = \"one.toml\"\nform = \"isotropic\"\n") + squeezed(true));
  const auto law = [](const ParticlesScene& of, std::int32_t a, std::int32_t b) {
    return std::get<SoftMultiContact<LawForm::isotropic, false>>(of.system.laws.law(of.system.laws.index(a, b)));
  };
  constexpr std::int32_t kBag = 0, kStone = 1, kRigid = 2;
  EXPECT_DOUBLE_EQ(law(scene, kBag, kRigid).friction, 0.25);
  EXPECT_DOUBLE_EQ(law(scene, kBag, kStone).friction, 0.35);
  EXPECT_DOUBLE_EQ(law(scene, kStone, kBag).friction, 0.35);
  EXPECT_DOUBLE_EQ(law(scene, kBag, kBag).friction, 0.45);
  EXPECT_DOUBLE_EQ(law(scene, kBag, kRigid).kt_ratio, 0.3);
  EXPECT_TRUE(law(scene, kStone, kBag).j_is_soft);
  EXPECT_FALSE(law(scene, kStone, kBag).i_is_soft);
  const ParticlesScene own = read(contacts("file = \"one.toml\"\nform = \"isotropic\"\nmu = 0.1\n") + squeezed(true));
  EXPECT_DOUBLE_EQ(law(own, kBag, kRigid).friction, 0.1);
  EXPECT_DOUBLE_EQ(law(own, kBag, kBag).friction, 0.1);
}

TEST_F(ParticlesLawTable, WhatDoesNotAddUpIsRefused) {
  const std::string good = contacts("file = \"one.toml\"\n") + squeezed(true);
  EXPECT_NO_THROW((void)read(good));
  const auto last = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.rfind(from);
    return text.replace(at, from.size(), to);
  };
  expect_refused(last("file = \"one.toml\"\n", "file = \"one.toml\"\nform = \"isotropic\"\n"),
                 {"add up", "'soft'", "form isotropic"});
  expect_refused(last("E = \"0.5 MPa\"", "E = \"0.6 MPa\""), {"add up", "E = 600000"});
  expect_refused(last("file = \"one.toml\"\n", "file = \"one.toml\"\nunloading = true\n"),
                 {"add up", "with unloading"});
  expect_refused(last("file = \"one.toml\"\n", "file = \"one.toml\"\nunloading_ratio = 1.3\n"),
                 {"unloading_ratio", "goes with macro scenes"});
  expect_refused(with(good, "kind = \"soft-wall\"", "kind = \"soft-solid\""), {"wall", "soft-wall"});
  expect_refused(with(good, "kind = \"soft-solid\"", "kind = \"soft-wall\""), {"walls", "soft-solid"});
  expect_refused(with(good, "which_soft = \"soft\"", "which_soft = \"rigid\""), {"which_soft", "one of the pair"});
  expect_refused(with(good, "which_soft = \"soft\"\n", "which_soft = \"soft\"\ndamping = 0.1\n"),
                 {"damping", "law card"});
  expect_refused(with(good, "which_soft = \"soft\"\n", "which_soft = \"soft\"\nkt = \"secant\"\n"), {"kt", "law card"});
  const auto at = good.find("[[contact]]\npair = [\"rigid\", \"soft\"]");
  const auto end = good.find("[[contact]]", at + 1);
  expect_refused(good.substr(0, at) +
                     "[[contact]]\npair = [\"rigid\", \"soft\"]\nlaw = \"linear-spring\"\nmu = 0.3\nrestitution = 0.5\n"
                     "normal_stiffness = 1e4\ntangential_stiffness = 1e4\n" +
                     good.substr(end),
                 {"adds up all contacts", "linear-spring of rigid and soft"});
  // Friction may differ from contact to contact.
  EXPECT_NO_THROW((void)read(last("file = \"one.toml\"\n", "file = \"one.toml\"\nmu = 0.0\n")));
}

TEST_F(ParticlesLawTable, UseBeyondTheMeasurementIsCountedOrRefused) {
  const auto outcome = [&](const std::string& beyond) {
    const std::string text = contacts("file = \"one.toml\"\nform = \"isotropic\"\nbeyond = \"" + beyond + "\"\n") +
                             plane({{-0.6 * kRadius, 0.0, 0.0}}, {{1.0, 0.0, 0.0}}) +
                             plane({{0.6 * kRadius, 0.0, 0.0}}, {{-1.0, 0.0, 0.0}}) + ball("soft", kRadius, {}) +
                             "[time]\nend = 1e-4\n";
    return run_particles(read(text), {});
  };
  const ParticlesResult on = outcome("extrapolate");
  EXPECT_TRUE(on.usable) << on.reason;
  EXPECT_GT(on.guards.laws.beyond, 0);
  EXPECT_GT(outcome("clamp").guards.laws.clamped, 0);
  const ParticlesResult refused = outcome("error");
  EXPECT_FALSE(refused.usable);
  EXPECT_NE(refused.reason.find("does not allow"), std::string::npos) << refused.reason;
}

/// A lattice of soft and solid particles, so many that they are put into spatial order.
std::string crowded_lattice() {
  std::string text;
  for (int n = 0; n < 3375; ++n) {
    const Vec3 x{{static_cast<double>(n % 15), static_cast<double>(n / 15 % 15), static_cast<double>(n / 225)}};
    const double shake = 0.02 * std::sin(12.9898 * n);
    text += ball(n % 3 == 0 ? "stone" : "soft", kRadius, (x * 1.86 + Vec3{{shake, -shake, 0.5 * shake}}) * kRadius);
  }
  return text +
         "[cell]\nsize = [0.558, 0.558, 0.558]\nperiodic = [true, true, true]\n"
         "[time]\nsteps = 130\n[checkpoint]\nevery_steps = 50\n";
}

TEST_F(ParticlesLawTable, ThreadsAndRestartsKeepTheBits) {
  const ParticlesScene scene =
      read(contacts("file = \"one.toml\"\nform = \"directional\"\nunloading = true\n") + crowded_lattice());
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const ParticlesResult whole = run_particles(scene, {});
  omp_set_num_threads(3);
  const ParticlesResult parallel = run_particles(scene, {});
  omp_set_num_threads(threads);
  ASSERT_TRUE(whole.usable) << whole.reason;
  ASSERT_GT(whole.system.contacts.size(), 8000) << "too small for the parallel path";
  expect_same_state(whole.system, parallel.system);
  ParticlesControl control;
  control.checkpoint = directory_.file("checkpoint.h5");
  control.progress = [](std::int64_t step) {
    if (step >= 64) request_interrupt();
  };
  EXPECT_THROW((void)run_particles(scene, control), Interrupted);
  clear_interrupt();
  control.resume = true;
  control.progress = nullptr;
  expect_same_state(whole.system, run_particles(scene, control).system);
  EXPECT_GT(kinetic_energy(whole.system.particles), 0.0);
}

/// Another law in the same file is another run.
TEST_F(ParticlesLawTable, ACheckpointBelongsToTheNumbersOfItsLaw) {
  const std::string text = contacts("file = \"one.toml\"\n") + squeezed(true);
  ParticlesControl control;
  control.checkpoint = directory_.file("checkpoint.h5");
  control.progress = [](std::int64_t) { request_interrupt(); };
  ParticlesScene scene = read(with(text, "end = 1e-4", "steps = 5000"));
  EXPECT_THROW((void)run_particles(scene, control), Interrupted);
  clear_interrupt();
  LawTable other;
  other.entries = {synthetic::law_entry(0.66, 0.01)};
  save_law_table(other, directory_.file("one.toml"));
  std::string said;
  control.resume = true;
  control.progress = nullptr;
  control.say = [&](const std::string& line) { said += line; };
  scene = read(with(text, "end = 1e-4", "steps = 5000"));
  try {
    (void)run_particles(scene, control);
    EXPECT_EQ(said.find("continuing"), std::string::npos) << said;
  } catch (const InputError&) {
  }
}

TEST_F(ParticlesLawTable, TheFileSaysWhichParticlesAreSoft) {
  const ParticlesScene scene = read(contacts("file = \"one.toml\"\n") + squeezed(true));
  const ParticlesResult result = run_particles(scene, {});
  save_particles_run(directory_.file("run.h5"), scene, result, build_provenance());
  const h5::Group root = h5::open_file(directory_.file("run.h5"));
  const auto soft = root.open("bodies").integers("material_is_soft");
  ASSERT_EQ(soft.size(), 3U);
  EXPECT_EQ(soft, (std::vector<std::int64_t>{1, 0, 0})) << "soft, stone, rigid";
}

}  // namespace

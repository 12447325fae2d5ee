// Result files that are damaged in many ways: one line a mistake that names the file, the status that says whose fault
// it is, nothing written, no signal.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>

#include "common/data/multi_contact_replicates.h"
#include "common/io/text_file.h"
#include "macrosim/macro_packing.h"
#include "tests/support/hdf5_contents.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/refused_files.h"
#include "tests/support/tiny_files.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

/// A file that is good before it is edited.
class BadResults : public RefusedFiles {
 protected:
  using Writer = void (*)(const std::string&);
  using Edit = std::function<void(Hdf5Edit&)>;

  void expect_refused(Writer write, const Edit& edit, const std::vector<std::string>& words) {
    const std::string path = directory_.file("case.h5");
    write(path);
    {
      Hdf5Edit file(path);
      ASSERT_TRUE(file.good());
      edit(file);
    }
    std::vector<std::string> all = words;
    all.push_back("case.h5");
    expect("check '" + path + "'", 4, all, words.front());
  }
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
};

TEST_F(BadResults, TheGoodOnesAreGood) {
  for (const Writer write :
       {tiny_measurements, tiny_multi_contact, tiny_macro, tiny_grain_boxes, tiny_states, tiny_particles_run}) {
    write(directory_.file("good.h5"));
    EXPECT_EQ(run_the_program("check '" + directory_.file("good.h5") + "'").status, 0);
  }
}

TEST_F(BadResults, Measurements) {
  const auto bad = [&](const Edit& edit, const std::vector<std::string>& words) {
    expect_refused(tiny_measurements, edit, words);
  };
  bad([](Hdf5Edit& f) { f.remove("runs/packing"); }, {"packing: missing or damaged data set"});
  bad([](Hdf5Edit& f) { f.remove("spec"); }, {"spec: missing or damaged group"});
  bad([](Hdf5Edit& f) { f.remove("normal"); }, {"normal: missing or damaged group"});
  bad([](Hdf5Edit& f) { f.resize("normal/force", 2); }, {"'force' has a wrong length"});
  bad([](Hdf5Edit& f) { f.set("normal/force", 1, kNan); }, {"'force' holds a number that is not finite, in row 1"});
  bad([](Hdf5Edit& f) { f.set("tangential/angle", 0, HUGE_VAL); }, {"'angle' holds a number that is not finite"});
  bad([](Hdf5Edit& f) { f.set("runs/kind", 0, 7); }, {"kind of a run out of range"});
  bad([](Hdf5Edit& f) { f.set("runs/packing", 1, 99); }, {"packing of a run out of range"});
  bad([](Hdf5Edit& f) { f.set("runs/relaxation", 0, -1); }, {"relaxation of a run out of range"});
  bad([](Hdf5Edit& f) { f.set("runs/normal_points", 0, 1e6); }, {"counts do not fit the data"});
  bad([](Hdf5Edit& f) { f.set("packings/radius_count", 0, 0); }, {"counts do not fit the data"});
  bad([](Hdf5Edit& f) { f.replace("normal/converged", std::vector<double>(9, 1.0)); }, {"another type than expected"});
  bad([](Hdf5Edit& f) { f.set_attribute("/", "schema_version", 99LL); },
      {"schema version 99, this program reads version 1"});
  bad([](Hdf5Edit& f) { f.set_attribute("/", "format", std::string("macro curves")); },
      {"holds no soft-particle measurements"});
  bad([](Hdf5Edit& f) { f.remove_attribute("/", "approach_speed"); }, {"approach_speed: missing attribute"});
  bad([](Hdf5Edit& f) { f.set_attribute("spec", "friction", std::string("0.3")); }, {"friction: attribute of another"});
  bad([](Hdf5Edit& f) { f.set_attribute("runs", "relaxations", 5LL); }, {"relaxation_1: missing attribute"});
}

TEST_F(BadResults, MultiContacts) {
  const auto bad = [&](const Edit& edit, const std::vector<std::string>& words) {
    expect_refused(tiny_multi_contact, edit, words);
  };
  bad([](Hdf5Edit& f) { f.set("configurations/partners/kind", 0, 5); }, {"kind of a neighbour out of range"});
  bad([](Hdf5Edit& f) { f.set("configurations/partner_count", 0, 2); }, {"counts do not fit the data"});
  bad([](Hdf5Edit& f) { f.set("configurations/stages/overlaps", 0, -1); }, {"counts do not fit the data"});
  bad([](Hdf5Edit& f) { f.remove_attribute("configurations", "name_1"); }, {"name_1: missing attribute"});
  bad([](Hdf5Edit& f) { f.set("runs/configuration", 0, 9); }, {"configuration of a run out of range"});
  bad([](Hdf5Edit& f) { f.set("runs/packing", 0, -3); }, {"packing of a run out of range"});
  bad([](Hdf5Edit& f) { f.set("runs/points/stage", 0, 4); }, {"stage of a point out of range"});
  bad([](Hdf5Edit& f) { f.set("runs/neighbours/normal", 2, kNan); }, {"'normal' holds a number that is not finite"});
  bad([](Hdf5Edit& f) { f.resize("runs/neighbours/overlap", 1); }, {"wrong length"});
  bad([](Hdf5Edit& f) { f.remove("runs"); }, {"runs: missing or damaged group"});
  bad([](Hdf5Edit& f) { f.set("runs/neighbours/overlap", 1, -0.2); }, {"an overlap of -0.2", "none is below 0"});
  bad([](Hdf5Edit& f) { f.set("runs/neighbours/overlap", 1, 7.0); }, {"'overlap' holds 7 in row 1; allowed: -2 to 2"});
  bad([](Hdf5Edit& f) { f.set_attribute("runs/neighbours/overlap", "unit", std::string("mm")); },
      {"'overlap' is in 'mm', 'Rs' is expected"});
  bad([](Hdf5Edit& f) { f.remove_attribute("runs/neighbours/normal", "unit"); }, {"'normal' says no unit"});
  bad([](Hdf5Edit& f) { f.set("configurations/partners/direction_x", 0, 3.0); }, {"no unit vector"});
  bad([](Hdf5Edit& f) { f.set("configurations/partners/ratio", 0, 2.0); }, {"kind and ratio do not fit"});
  bad([](Hdf5Edit& f) { f.set("configurations/stages/overlap", 0, -0.1); }, {"'overlap' holds -0.1 in row 0"});
  bad([](Hdf5Edit& f) { f.set("packings/solid_fraction", 0, 1.5); }, {"'solid_fraction' holds 1.5 in row 0"});
  bad([](Hdf5Edit& f) { f.set_attribute("spec", "friction", -0.1); }, {"'friction' is -0.1; allowed: 0 to"});
  bad([](Hdf5Edit& f) { f.set_attribute("spec", "units", std::string("shell_radius mm")); },
      {"units 'shell_radius mm'"});
  bad([](Hdf5Edit& f) { f.set("runs/points/converged", 0, 5); }, {"'converged' holds 5 in row 0"});
  // A configuration without path, which fits everywhere else.
  bad(
      [](Hdf5Edit& f) {
        f.set("configurations/stage_count", 0, 0);
        f.set("configurations/stage_count", 1, 3);
      },
      {"has no neighbours, or no stages"});
}

TEST_F(BadResults, MacroCurvesAndGrainBoxes) {
  const auto macro = [&](const Edit& edit, const std::vector<std::string>& words) {
    expect_refused(tiny_macro, edit, words);
  };
  macro([](Hdf5Edit& f) { f.resize("curves/curve_000001/stress_axial", 3); }, {"'stress_axial' has a wrong length"});
  macro([](Hdf5Edit& f) { f.set("curves/curve_000000/strain", 2, kNan); },
        {"curve_000000", "'strain' holds a number that is not finite"});
  macro([](Hdf5Edit& f) { f.set("curves/curve_000000/stress_y", 1, kNan); }, {"'stress_y' holds a number that is not"});
  macro([](Hdf5Edit& f) { f.set("curves/curve_000000/body_forces", 0, HUGE_VAL); }, {"'body_forces' holds a number"});
  macro([](Hdf5Edit& f) { f.set_attribute("curves/curve_000001/stress_axial", "unit", std::string("kPa")); },
        {"'stress_axial' is in 'kPa', 'Pa' is expected"});
  macro([](Hdf5Edit& f) { f.remove_attribute("curves/curve_000000/stress_y", "unit"); }, {"'stress_y' says no unit"});
  macro([](Hdf5Edit& f) { f.set("curves/curve_000000/coordination", 0, -1.0); }, {"'coordination' holds -1 in row 0"});
  macro([](Hdf5Edit& f) { f.set_attribute("curves/curve_000000", "soft_volume_share", 3.0); },
        {"'soft_volume_share' is 3; allowed: 0 to 1"});
  macro([](Hdf5Edit& f) { f.set_attribute("curves/curve_000000", "bodies", -3LL); }, {"'bodies' is -3"});
  macro([](Hdf5Edit& f) { f.remove_attribute("curves/curve_000000", "usable"); }, {"usable: missing attribute"});
  macro([](Hdf5Edit& f) { f.replace("curves/odd", std::vector<double>{1.0}); }, {"odd: missing or damaged group"});
  const auto boxes = [&](const Edit& edit, const std::vector<std::string>& words) {
    expect_refused(tiny_grain_boxes, edit, words);
  };
  boxes([](Hdf5Edit& f) { f.set("packs/pack_000/points/phase", 0, 9); }, {"a phase that is not known"});
  boxes([](Hdf5Edit& f) { f.set("packs/pack_000/pack/contact_pair_sliding", 1, 99); }, {"a body that is not there"});
  boxes([](Hdf5Edit& f) { f.resize("packs/pack_000/pack/wall_E_nu_mu", 9); }, {"'wall_point' has a wrong shape"});
  boxes([](Hdf5Edit& f) { f.resize("packs/pack_000/fits/ranges", 3); }, {"'ranges' has a wrong length"});
  boxes([](Hdf5Edit& f) { f.set_attribute("packs/pack_000", "phase", -1LL); }, {"a phase that is not known"});
  for (const std::string name : {"solid_fraction", "residual", "stress", "pressure"})
    boxes([&](Hdf5Edit& f) { f.set("packs/pack_000/points/" + name, 1, kNan); },
          {"'" + name + "' holds a number that is not finite"});
}

/// What is not defined for a loading, or was not probed, is no damage.
TEST_F(BadResults, ModuliOfGrainBoxesMayBeUnknown) {
  const std::string path = directory_.file("grain_box.h5");
  tiny_grain_boxes(path);
  {
    Hdf5Edit file(path);
    file.set("packs/pack_000/points/bulk_modulus", 0, kNan);
    file.set("packs/pack_000/points/sliding_share", 1, kNan);
  }
  EXPECT_EQ(run_the_program("check '" + path + "'").status, 0);
}

TEST_F(BadResults, TheEndOfAParticlesRun) {
  for (const std::string name : {"bodies/inverse_inertia", "bodies/force", "neighbours/skin"})
    expect_refused(tiny_particles_run, [&](Hdf5Edit& f) { f.set("final/" + name, 0, kNan); },
                   {"/final/" + name + ": holds a number that is not finite, number 1 of"});
}

void tiny_packings(const std::string& path) {
  MacroPacking packing;
  packing.high = {{1.0, 1.0, 1.0}};
  packing.bodies = {{{{0.3, 0.5, 0.5}}, 0.1, false}, {{{0.7, 0.5, 0.5}}, 0.1, true}};
  h5::AtomicFile file(path);
  for (const char* sample : {"sample_0", "sample_1"}) write_macro_packing(file.root().create(sample), packing);
  file.commit();
}

TEST_F(BadResults, Packings) {
  tiny_packings(directory_.file("good.h5"));
  const ProgramOutcome good = run_the_program("check '" + directory_.file("good.h5") + "'");
  EXPECT_EQ(good.status, 0) << good.output;
  EXPECT_NE(good.output.find("packings: 2, with 4 bodies in all"), std::string::npos) << good.output;
  const auto bad = [&](const Edit& edit, const std::vector<std::string>& words) {
    expect_refused(tiny_packings, edit, words);
  };
  bad([](Hdf5Edit& f) { f.set("sample_0/bodies", 1, kNan); }, {"'bodies' holds a place that is not finite"});
  bad([](Hdf5Edit& f) { f.set("sample_1/bodies", 3, 0.0); }, {"a radius that is not above 0"});
  bad([](Hdf5Edit& f) { f.set("sample_0/box", 4, HUGE_VAL); }, {"'box' holds a number that is not finite"});
  bad([](Hdf5Edit& f) { f.remove("sample_0/bodies"); }, {"/sample_0/bodies: missing or damaged data set"});
}

/// The files beside law cards and law tables.
TEST_F(BadResults, ValuesOfLaws) {
  const auto card = [](const std::string& path) {
    save_card(synthetic::card(), fs::path(path).replace_extension(".toml").string());
  };
  const auto table = [](const std::string& path) {
    LawTable all{1, {synthetic::law_entry()}};
    for (MultiContactLaw& law : all.entries[0].laws) law.replicates.assign(2, multi_contact_numbers(law));
    save_law_table(all, fs::path(path).replace_extension(".toml").string());
  };
  for (const Writer write : {Writer(card), Writer(table)}) {
    write(directory_.file("case.h5"));
    EXPECT_EQ(run_the_program("check '" + directory_.file("case.h5") + "'").status, 0);
  }
  expect_refused(card, [](Hdf5Edit& f) { f.set("soft-solid/normal/a", 0, kNan); },
                 {"/soft-solid/normal/a: must hold a finite number"});
  expect_refused(card, [](Hdf5Edit& f) { f.remove("soft-soft/table"); }, {"table: missing or damaged group"});
  expect_refused(table, [](Hdf5Edit& f) { f.set("entry_0/directional/parameters", 4, kNan); },
                 {"/entry_0/directional/parameters: row 1 begins with a number that is not finite"});
  expect_refused(table, [](Hdf5Edit& f) { f.set("entry_0/pair/replicates", 1, kNan); },
                 {"/entry_0/pair/replicates: holds a number that is not finite, number 2 of"});
  expect_refused(table, [](Hdf5Edit& f) { f.resize("entry_0/pair/numbers", 5); }, {"must have a column for each"});
}

/// Exports and the report read the states that runs keep.
TEST_F(BadResults, SnapshotRecorder) {
  const auto bad = [&](const Edit& edit, const std::vector<std::string>& words) {
    const std::string path = directory_.file("states_tiny.h5");
    tiny_states(path);
    {
      Hdf5Edit file(path);
      ASSERT_TRUE(file.good());
      edit(file);
    }
    expect("export '" + path + "' --to csv --out '" + out() + "'", 4, words, words.front());
    expect("check '" + path + "'", 4, words, words.front());
  };
  const std::string state = "states/000000/";
  bad([&](Hdf5Edit& f) { f.resize(state + "contacts/segment", 1); }, {"'segment' has a wrong shape"});
  bad([&](Hdf5Edit& f) { f.set(state + "contacts/segment", 1, 40); }, {"'segment' holds 40 in row 0, where 1 belongs"});
  bad([&](Hdf5Edit& f) { f.set(state + "contacts/pair", 1, 40); }, {"a body that is not there"});
  bad([&](Hdf5Edit& f) { f.set(state + "contacts/ends", 2, kNan); }, {"'ends' holds a number that is not finite"});
  bad([&](Hdf5Edit& f) { f.resize(state + "particles/position", 8); }, {"'position' has a wrong shape: 8, 3 x 3"});
  bad([&](Hdf5Edit& f) { f.set(state + "particles/radius", 0, -1.0); }, {"'radius' holds -1 in row 0"});
  bad([&](Hdf5Edit& f) { f.set_attribute(state + "contacts/force", "unit", std::string("kN")); },
      {"'force' is in 'kN', 'N' is expected"});
  bad([&](Hdf5Edit& f) { f.set_attribute("states/000000", "dimension", 4LL); }, {"4 dimensions"});
}

/// What is worked out from a number that is none is none either, or worse, looks like one.
TEST_F(BadResults, MacroCurvesWithNumbersThatAreNotFinite) {
  std::filesystem::create_directories(directory_.file("good"));
  tiny_macro(directory_.file("good") + "/macro.h5");
  EXPECT_EQ(run_the_program("report '" + directory_.file("good") + "'").status, 0);
  const std::string run = directory_.file("bad");
  std::filesystem::create_directories(run);
  const auto bad = [&](const Edit& edit, const std::string& word) {
    tiny_macro(run + "/macro.h5");
    {
      Hdf5Edit file(run + "/macro.h5");
      edit(file);
    }
    const std::vector<std::string> words{"macro.h5", word};
    expect("report '" + run + "'", 4, words, word);
    expect("compare '" + directory_.file("good") + "' '" + run + "'", 4, words, word);
    expect("compare '" + run + "' '" + directory_.file("good") + "'", 4, words, word);
    expect("check '" + run + "/macro.h5'", 4, words, word);
  };
  const double infinite = std::numeric_limits<double>::infinity();
  const std::string curve = "curves/curve_000001/";
  bad([&](Hdf5Edit& f) { f.set(curve + "coordination", 1, kNan); }, "'coordination' holds a number that is not finite");
  bad([&](Hdf5Edit& f) { f.set(curve + "residual", 3, kNan); }, "'residual' holds a number that is not finite");
  bad([&](Hdf5Edit& f) { f.set(curve + "stress_axial_contacts", 0, infinite); },
      "'stress_axial_contacts' holds a number that is not finite");
  bad(
      [&](Hdf5Edit& f) {
        f.replace(curve + "body_forces", std::vector<double>{1.0, kNan});
      },
      "'body_forces' holds a number that is not finite");
  bad(
      [&](Hdf5Edit& f) {
        f.replace(curve + "fabric", std::vector<double>{1.0, 0.0, kNan, 0.0});
        f.set_attribute(curve + "fabric", "unit", std::string("1"));
      },
      "'fabric' holds a number that is not finite");
  bad([&](Hdf5Edit& f) { f.set_attribute("curves/curve_000001", "solid_fraction", kNan); }, "solid_fraction");
  bad([&](Hdf5Edit& f) { f.set_attribute("curves/curve_000001", "seconds", infinite); }, "seconds");
}

/// The report draws contacts of stored states.
TEST_F(BadResults, PowdersOfAReport) {
  const auto bad = [&](const Edit& edit, const std::vector<std::string>& words) {
    const std::string path = directory_.file("powder.h5");
    tiny_powder(path);
    {
      Hdf5Edit file(path);
      edit(file);
    }
    expect("report '" + directory_.path() + "'", 4, words, words.front());
  };
  const std::string system = "sample_0/system/";
  bad([&](Hdf5Edit& f) { f.resize(system + "bodies/sphere", 10); }, {"'sphere' does not fit"});
  // Found by fuzzing: the neighbour search went out of bounds.
  bad([&](Hdf5Edit& f) { f.set(system + "bodies/sphere", 4, kNan); }, {"'sphere' holds a number that is not finite"});
  bad([&](Hdf5Edit& f) { f.set(system + "bodies/sphere", 5, -1.0); }, {"'sphere' does not fit"});
  bad([&](Hdf5Edit& f) { f.set(system + "cell/edges", 0, 0.0); }, {"'edges' does not fit"});
  bad([&](Hdf5Edit& f) { f.set(system + "neighbours/skin", 2, kNan); }, {"'skin' holds a number that is not finite"});
  bad([&](Hdf5Edit& f) { f.set(system + "neighbours/skin", 2, -1.0); }, {"'skin' does not fit"});
  bad([&](Hdf5Edit& f) { f.set(system + "bodies/spin", 3, kNan); }, {"'spin' holds a number that is not finite"});
  bad([&](Hdf5Edit& f) { f.resize(system + "neighbours/reference", 4); },
      {"powder.h5: /sample_0/system/neighbours/reference: saved state: 'reference' does not fit"});
  bad([&](Hdf5Edit& f) { f.set("sample_0/course", 2, kNan); },
      {"powder.h5: /sample_0/course: holds a number that is not finite"});
  bad([&](Hdf5Edit& f) { f.resize("sample_0/course", 3); }, {"powder.h5"});
  bad([&](Hdf5Edit& f) { f.set("sample_0/stages", 3, kNan); },
      {"powder.h5: /sample_0/stages: holds a number that is not finite"});
  bad([&](Hdf5Edit& f) { f.set_attribute("sample_0/system", "time", kNan); }, {"'time' is not finite"});
  bad([&](Hdf5Edit& f) { f.set(system + "bodies/material", 3, 4); }, {"'material' does not fit"});
  bad([&](Hdf5Edit& f) { f.set(system + "bodies/counts", 0, 1e9); }, {"'counts' does not fit"});
  bad([&](Hdf5Edit& f) { f.set_attribute("sample_0/system", "dimension", 3LL); }, {"'dimension' does not fit"});
  bad([&](Hdf5Edit& f) { f.resize("sample_0/trajectory/position", 3); }, {"'position' has a wrong shape"});
}

TEST_F(BadResults, CutAnywhere) {
  const std::string path = directory_.file("case.h5");
  RandomStream random(11, RandomPurpose::test, 0);
  for (const Writer write : {tiny_measurements, tiny_multi_contact, tiny_macro, tiny_grain_boxes}) {
    write(path);
    const auto whole = fs::file_size(path);
    for (int k = 0; k < 4; ++k) {
      write(path);
      fs::resize_file(path, random.below(whole));
      expect("check '" + path + "'", 4, {"case.h5"}, "cut to " + std::to_string(fs::file_size(path)));
    }
  }
}

/// Everything but the words about the origin, which nobody reads back.
Hdf5Contents data_of(const std::string& path) {
  Hdf5Contents out;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t root = H5Gopen2(file, "/", H5P_DEFAULT);
  hdf5::add_attributes(root, "", out);
  for (const std::string& name : h5::open_file(path).children()) {
    if (name == "provenance") continue;
    const hid_t object = H5Oopen(root, name.c_str(), H5P_DEFAULT);
    hdf5::add_object(object, "/" + name, out);
    H5Oclose(object);
  }
  H5Gclose(root);
  H5Fclose(file);
  return out;
}

/// Wrong bytes in what every reader needs are found. Elsewhere a number may have become another one that is as good,
/// which nobody can know; but the program never breaks, and does not say anything else when no data changed.
TEST_F(BadResults, WrongBytes) {
  const std::string path = directory_.file("case.h5");
  RandomStream random(12, RandomPurpose::test, 0);
  for (const Writer write : {tiny_measurements, tiny_multi_contact, tiny_macro, tiny_grain_boxes}) {
    write(path);
    const std::string good = read_text(path);
    const Hdf5Contents contents = data_of(path);
    const std::string said = run_the_program("check '" + path + "'").output;
    const auto with_wrong_byte = [&](std::size_t place) {
      std::string text = good;
      text[place] ^= static_cast<char>(1 + random.below(255));
      write_text_atomic(path, text);
      return run_the_program("check '" + path + "'");
    };
    // Signatures of the file and of its root group, whose header comes first.
    for (const char* signature : {"HDF\r\n", "OHDR"}) {
      const std::size_t place = good.find(signature);
      ASSERT_NE(place, std::string::npos) << signature;
      const ProgramOutcome outcome = with_wrong_byte(place + random.below(4));
      EXPECT_EQ(outcome.status, 4) << signature << ": " << outcome.output;
      EXPECT_NE(outcome.output.find("case.h5"), std::string::npos) << outcome.output;
    }
    for (int k = 0; k < 6; ++k) {
      const std::size_t place = random.below(good.size());
      const ProgramOutcome outcome = with_wrong_byte(place);
      if (outcome.status == 0) {
        if (data_of(path) == contents) {
          EXPECT_EQ(outcome.output, said) << "byte " << place;
        }
        continue;
      }
      EXPECT_EQ(outcome.status, 4) << "byte " << place << ": " << outcome.output;
      EXPECT_NE(outcome.output.find("case.h5"), std::string::npos) << outcome.output;
    }
  }
}

}  // namespace

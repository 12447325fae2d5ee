// Poisson's ratio has one range, above -1 and up to 1/2: every reader of scenes, cards, tables and files takes all of
// it and nothing else, and what was written is read back.
#include "common/core/material.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/data/cell_card.h"
#include "common/data/force_curves.h"
#include "common/io/key_record.h"
#include "microsim/grain_box/grain_box_run.h"
#include "tests/support/every_kind.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kInside[] = {kPoissonLowest, -0.999, -0.4, 0.0, 0.3, 0.4999, 0.5};
constexpr double kOutside[] = {-1.0, -1.5, 0.5000001, 0.7};

TEST(PoissonRatio, TheSmallestNumberIsJustAboveMinusOne) {
  EXPECT_EQ(kPoissonLowest, std::nextafter(-1.0, 0.0));
  EXPECT_TRUE(is_poisson_ratio(kPoissonLowest));
  EXPECT_FALSE(is_poisson_ratio(-1.0));
  EXPECT_FALSE(is_poisson_ratio(std::nan("")));
}

/// What is said of a scene with this value; empty: nothing.
std::string refused(const KindScene& kind, const std::string& key, const std::string& value) {
  const KindRuns files(kind);
  try {
    const Scene scene = Scene::load(files.out("scene.toml"), {key + "=" + value});
    kind_of(scene).read(scene);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// Paths of the keys of a scene that take one Poisson's ratio.
std::vector<std::string> keys_of_scene(const KindScene& kind) {
  const KindRuns files(kind);
  const std::string file = files.out("scene.toml");
  KeyRecord record;
  const Scene scene = Scene::load(file);
  kind_of(scene).read(scene);
  std::vector<std::string> out;
  for (const auto& [path, asked] : record.keys(file))
    if (path.ends_with(".nu") && asked.form == KeyForm::number) out.push_back(path);
  return out;
}

TEST(PoissonRatio, OfEveryKindOfScene) {
  std::size_t tried = 0;
  for (const KindScene& kind : every_kind())
    for (const std::string& key : keys_of_scene(kind)) {
      ++tried;
      for (const double nu : kInside) {
        const std::string said = refused(kind, key, fmt::format("{:.17g}", nu));
        EXPECT_EQ(said.find("nu = "), std::string::npos) << kind.name << " " << key << ": " << said;
      }
      for (const double nu : kOutside) {
        const std::string said = refused(kind, key, fmt::format("{:.17g}", nu));
        EXPECT_NE(said.find("nu = "), std::string::npos) << kind.name << " " << key << " takes " << nu;
        EXPECT_NE(said.find("0.5"), std::string::npos) << said;
      }
    }
  EXPECT_GE(tried, 12U);
}

TEST(PoissonRatio, OfTheSearchForContents) {
  for (const KindScene& kind : every_kind()) {
    if (kind.name != "inverse") continue;
    // Two numbers to search want more points than this scene has: nothing is wrong with the range.
    EXPECT_EQ(refused(kind, "search.nu", "[-0.999, 0.5]").find("nu = "), std::string::npos);
    EXPECT_NE(refused(kind, "search.nu", "[-1.0, 0.5]").find("nu = "), std::string::npos);
    EXPECT_NE(refused(kind, "search.nu", "[-0.5, 0.51]").find("nu = "), std::string::npos);
  }
}

TEST(PoissonRatio, OfCardsAndTables) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("file");
  const auto reads = [&](const std::function<void()>& read) {
    try {
      read();
    } catch (const Error& e) {
      EXPECT_TRUE(std::string(e.what()).find("nu") != std::string::npos ||
                  std::string(e.what()).find("poisson_ratio") != std::string::npos)
          << e.what();
      return false;
    }
    return true;
  };
  const auto card_with = [&](double nu) {
    LawCard card = synthetic::card();
    card.spec.poisson_ratio = nu;
    save_card(card, directory.file("law.toml"));
    return reads([&] { EXPECT_EQ(load_card(directory.file("law.toml")).spec.poisson_ratio, nu); });
  };
  const auto table_with = [&](double nu) {
    write_text_atomic(path, fmt::format("# kind = soft-solid\n# Rs = 16 mm\n# E = 0.5 MPa\n# nu = {:.17g}\n"
                                        "hn [mm],Fn [N]\n1,0\n2,1\n3,2\n4,3\n5,4\n6,5\n",
                                        nu));
    return reads([&] { EXPECT_EQ(read_force_curves(path, {}).spec.poisson_ratio, nu); });
  };
  for (const double nu : kInside) {
    EXPECT_TRUE(card_with(nu)) << nu;
    EXPECT_TRUE(table_with(nu)) << nu;
  }
  for (const double nu : kOutside) {
    EXPECT_FALSE(card_with(nu)) << nu;
    EXPECT_FALSE(table_with(nu)) << nu;
  }
}

TEST(PoissonRatio, OfFilesOfResults) {
  const TemporaryDirectory directory;
  for (const double nu : kInside) {
    MacroCurve curve = synthetic::macro_curve("law", 0, 1.0);
    curve.start.bodies = "some";
    curve.start.poisson_ratio = nu;
    curve.law.hash = "some";
    curve.law.poisson_ratio = nu;
    save_macro({curve}, directory.file("macro.h5"), {});
    const MacroCurve back = load_macro(directory.file("macro.h5")).at(0);
    EXPECT_EQ(back.start.poisson_ratio, nu);
    EXPECT_EQ(back.law.poisson_ratio, nu);
    Measurements data = synthetic::measurements(2);
    data.spec.poisson_ratio = nu;
    save(data, directory.file("measurements.h5"));
    EXPECT_EQ(load_measurements(directory.file("measurements.h5")).spec.poisson_ratio, nu);
  }
}

TEST(PoissonRatio, OfGrainsWithoutScatterIsWhatWasAskedFor) {
  for (const double nu : {-0.999, -0.95, 0.5}) {
    GrainBoxSpec spec;
    spec.grains = 20;
    spec.material.poisson_ratio = nu;
    spec.material.poisson_ratio_scatter = 0.0;
    for (const double of_grain : make_loose_pack(spec, 1).poisson_ratio) EXPECT_EQ(of_grain, nu);
    spec.material.poisson_ratio_scatter = 0.3;
    for (const double of_grain : make_loose_pack(spec, 1).poisson_ratio) EXPECT_TRUE(is_poisson_ratio(of_grain));
  }
}

}  // namespace

// Variants of a powder through the built program: a table of all, variants that ended are not run again, those that
// cannot be are refused before any work, one that does not rest does not stop the others.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/io/text_file.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kVariants = R"(kind = "cohesive-powder"
samples = 2
[disks]
count = 80
solid_fraction = 0.36
[contact]
cohesive = false
kappa = 1e3
mu = 0.5
[analysis]
scattering = false
holes = false
[[variant]]
name = "rough"
published = { Phi = 0.81, Phi_error = 0.01, z = 2.6, z_plus = 2.5, mean_repulsive = 1.1 }
[[variant]]
name = "smooth"
title = "Without friction"
samples = 3
contact = { mu = 0.0 }
)";

/// Line of the last key of kVariants.
constexpr int kLastLine = 20;

class PowderVariants : public ::testing::Test {
 protected:
  PowderVariants() { write(kVariants); }
  void write(const std::string& text) const { write_text_atomic(scene(), text); }
  [[nodiscard]] std::string scene() const { return directory_.file("scene.toml"); }
  [[nodiscard]] std::string out(const std::string& name) const { return directory_.file("out/" + name); }
  std::string run(const std::string& more, int status) const {
    const ProgramOutcome outcome = run_the_program("microsim '" + scene() + "' --quiet --threads 2 --out '" +
                                                   directory_.file("out") + "' " + more);
    EXPECT_EQ(outcome.status, status) << outcome.output;
    return outcome.output;
  }
  [[nodiscard]] json summary(const std::string& of = ".") const {
    return json::parse(read_text(out(of + "/summary.json")));
  }
  /// `added` stands below the scene; refused with all words, and nothing was run.
  void expect_refused(const std::string& added, const std::vector<std::string>& words, const std::string& more = "") {
    write(kVariants + added);
    const std::string output = run(more, 2);
    for (const std::string& word : words) EXPECT_NE(output.find(word), std::string::npos) << word << " in " << output;
    EXPECT_FALSE(fs::exists(out("rough"))) << added;
  }

  TemporaryDirectory directory_;
};

TEST_F(PowderVariants, TableOfAll) {
  const std::string shown = run("--json", 0);
  const json s = summary();
  EXPECT_EQ(json::parse(shown), s) << "one object on standard output, not one per variant";
  ASSERT_EQ(s["variants"].size(), 2U);
  const json& rough = s["variants"][0];
  EXPECT_EQ(rough["name"], "rough");
  EXPECT_EQ(rough["status"], "good");
  const double phi = rough["values"]["Phi"]["mean"];
  EXPECT_NEAR(phi, summary("rough")["mean"]["Phi"].get<double>(), 1e-14);
  const double error = rough["values"]["Phi"]["error"];
  EXPECT_NEAR(error, rough["values"]["Phi"]["deviation"].get<double>() / std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(rough["difference"]["Phi"]["value"].get<double>(), phi - 0.81, 1e-14);
  EXPECT_NEAR(rough["difference"]["Phi"]["in_errors"].get<double>(), (phi - 0.81) / std::hypot(error, 0.01), 1e-12);
  EXPECT_TRUE(rough["difference"]["z"]["in_errors"].is_null()) << "published without an error";
  for (const char* name : {"z_star", "x_0", "x_6", "mean_normal", "rumpf_ratio", "F_perc", "h_backbone", "seconds"})
    EXPECT_TRUE(rough["values"].contains(name)) << name;
  const double plus = rough["values"]["z_plus"]["mean"];
  EXPECT_NEAR(plus + rough["values"]["z_zero"]["mean"].get<double>(), rough["values"]["z"]["mean"].get<double>(),
              1e-12);
  EXPECT_NEAR(rough["difference"]["z_plus"]["value"].get<double>(), plus - 2.5, 1e-14);
  EXPECT_EQ(rough["published"]["mean_repulsive"]["value"], 1.1);
  EXPECT_EQ(s["variants"][1]["usable_samples"], 3);
  EXPECT_EQ(s["variants"][1]["title"], "Without friction");
  EXPECT_TRUE(s["variants"][1]["published"].empty());
  std::istringstream csv(read_text(out("table.csv")));
  std::string line;
  for (const char* start : {"name,status", "rough,good", "smooth,good"})
    EXPECT_TRUE(std::getline(csv, line) && line.starts_with(start)) << line;
  EXPECT_NE(read_text(out("table.md")).find("| smooth |"), std::string::npos);
  for (const char* column : {",z_plus_published,", ",mean_repulsive_difference,"})
    EXPECT_NE(read_text(out("table.csv")).find(column), std::string::npos) << column;
  EXPECT_FALSE(fs::exists(out("rough/work")));
}

TEST_F(PowderVariants, AVariantIsASceneOfItsOwn) {
  run("--set 'only=[\"smooth\"]'", 0);
  const std::string plain =
      "kind = \"cohesive-powder\"\nsamples = 3\n[disks]\ncount = 80\nsolid_fraction = 0.36\n"
      "[contact]\ncohesive = false\nkappa = 1e3\nmu = 0.0\n"
      "[analysis]\nscattering = false\nholes = false\n";
  write_text_atomic(directory_.file("plain.toml"), plain);
  EXPECT_EQ(run_scene(directory_.file("plain.toml"), directory_.file("plain"))["samples"],
            summary("smooth")["samples"]);
}

/// A kill between the summary of a variant and its report.
TEST_F(PowderVariants, AReportThatAKillLeftOutIsMadeUpFor) {
  run("", 0);
  const std::string report = read_text(out("smooth/report.html"));
  fs::remove(out("smooth/report.html"));
  fs::remove_all(out("smooth/figures"));
  fs::create_directories(out("smooth/work"));
  run("--resume", 0);
  EXPECT_EQ(read_text(out("smooth/report.html")), report);
  EXPECT_TRUE(fs::exists(out("smooth/figures/solid-fraction.svg")));
  EXPECT_FALSE(fs::exists(out("smooth/work")));
}

TEST_F(PowderVariants, WhatHasEndedIsNotRunAgain) {
  run("", 0);
  const json first = summary();
  const auto written = fs::last_write_time(out("smooth/powder.h5"));
  fs::remove(out("rough/summary.json"));
  json of_another_build = summary("smooth");
  of_another_build["commit"] = "abc";
  write_text_atomic(out("smooth/summary.json"), of_another_build.dump());
  run("--resume", 0);
  const json again = summary();
  EXPECT_EQ(fs::last_write_time(out("smooth/powder.h5")), written);
  EXPECT_EQ(again["variants"][1]["values"], first["variants"][1]["values"]);
  EXPECT_NE(again["remarks"][0].get<std::string>().find("smooth: was run by another build"), std::string::npos);
  json values = first["variants"][0]["values"];
  json values_again = again["variants"][0]["values"];
  for (json* one : {&values, &values_again}) one->erase("seconds");
  EXPECT_EQ(values_again, values) << "what was lost comes back in the same bits";
  run("--resume --seed 2", 0);
  EXPECT_NE(fs::last_write_time(out("smooth/powder.h5")), written) << "of another seed";
  EXPECT_NE(summary()["variants"][1]["values"]["Phi"], first["variants"][1]["values"]["Phi"]);
}

TEST_F(PowderVariants, AStoppedOneGoesOnFromItsCheckpoint) {
  const std::string longer = "--set disks.count=300 --set contact.kappa=1e4 --set samples=1 --set only=rough";
  run(longer, 0);
  const json whole = summary("rough");
  fs::remove_all(directory_.file("out"));
  const pid_t child =
      start_program({"microsim", scene(), "--quiet", "--threads", "1", "--out", directory_.file("out"), "--set",
                     "disks.count=300", "--set", "contact.kappa=1e4", "--set", "samples=1", "--set", "only=rough"});
  const int status = signal_when(
      child, [&] { return fs::exists(fs::path(out("rough")) / "work" / "powder-0.h5.previous"); }, SIGINT);
  ASSERT_TRUE(ended_with(status, 130)) << status;
  EXPECT_FALSE(fs::exists(out("rough/summary.json")));
  run("--resume " + longer, 0);
  EXPECT_EQ(summary("rough")["samples"], whole["samples"]);
}

TEST_F(PowderVariants, SomeOfThem) {
  run("--set only=smooth", 0);
  EXPECT_FALSE(fs::exists(out("rough")));
  EXPECT_EQ(summary()["variants"][0]["status"], "not run");
  const json smooth = summary()["variants"][1];
  run("--set 'only=[\"rough\"]'", 0);
  EXPECT_EQ(summary()["variants"][0]["status"], "good");
  EXPECT_EQ(summary()["variants"][1], smooth) << "what another run left stays in the table";
}

TEST_F(PowderVariants, OneThatDoesNotRestDoesNotStopTheOthers) {
  write(std::string(kVariants) + "[[variant]]\nname = \"hasty\"\nassembly = { time_max = 3 }\n");
  run("--set variant.0.assembly.time_max=3", 3);
  const json s = summary();
  EXPECT_EQ(s["status"], "not usable");
  EXPECT_EQ(s["variants"][0]["status"], "not usable");
  EXPECT_NE(s["variants"][0]["reason"].get<std::string>().find("phase compaction"), std::string::npos);
  EXPECT_TRUE(s["variants"][0]["values"].empty());
  EXPECT_EQ(s["variants"][1]["status"], "good");
  EXPECT_EQ(s["variants"][2]["status"], "not usable");
  EXPECT_NE(s["remarks"][0].get<std::string>().find("rough"), std::string::npos);
  run("--resume --set variant.0.assembly.time_max=3 --set only=smooth", 0);
}

TEST_F(PowderVariants, BadOnesAreRefusedBeforeAnyWork) {
  const auto line = [](int below) { return "scene.toml:" + std::to_string(kLastLine + below) + ":"; };
  expect_refused("[[variant]]\nname = \"a\"\ncontact = { kapa = 1e4 }\n", {line(3), "kapa", "'kappa'", "\"a\""});
  expect_refused("[[variant]]\nname = \"a\"\n[variant.contact]\nmu = -1\n", {line(4), "mu", "from 0 to 1000"});
  expect_refused("[[variant]]\nname = \"a\"\ncontct = { mu = 1 }\n", {line(3), "contct", "'contact'"});
  expect_refused("[[variant]]\nname = \"a\"\npublished = { Psi = 1 }\n", {line(3), "Psi", "'Phi'"});
  expect_refused("[[variant]]\nname = \"a\"\npublished = { z_error = 1 }\n", {line(3), "z_error", "without"});
  expect_refused("[[variant]]\nname = \"a\"\nassembly = { method = 2 }\n", {line(3), "do not aggregate"});
  expect_refused("[[variant]]\nname = \"a\"\ncontact = 3\n", {line(3), "must be a table"});
  expect_refused("[[variant]]\nname = \"rough\"\n", {line(2), "used twice"});
  expect_refused("[[variant]]\nname = \"../a\"\n", {line(2), "letters"});
  expect_refused("[[variant]]\nname = \"work\"\n", {line(2), "beside"});
  expect_refused("[[variant]]\ncontact = { mu = 1 }\n", {line(1), "name"});
  expect_refused("", {"--set contact.mu", "from 0 to 1000", "\"smooth\""}, "--set variant.1.contact.mu=-1");
  expect_refused("", {"smoth", "nearest is \"smooth\""}, "--set only=smoth");
  expect_refused("", {"only", "at least one"}, "--set only=[]");
  expect_refused("", {"unknown key 'dsks'"}, "--set dsks.count=3");
}

TEST_F(PowderVariants, CheckAndReport) {
  const ProgramOutcome check = run_the_program("check '" + scene() + "' --set only=smooth");
  EXPECT_EQ(check.status, 0);
  for (const char* words : {"rough (left out): 2 samples of 80 disks", "smooth: 3 samples of 80 disks"})
    EXPECT_NE(check.output.find(words), std::string::npos) << check.output;
  run("", 0);
  for (const std::string which : {"", "/rough"})
    EXPECT_EQ(run_the_program("report '" + directory_.file("out") + which + "'").status, 0);
  const std::string html = read_text(out("report.html"));
  for (const char* words : {"powder-published-Phi", "powder-published-z", "smooth", "0.810 ± 0.010", "mean_repulsive"})
    EXPECT_NE(html.find(words), std::string::npos) << words;
  const std::string rough = read_text(out("rough/report.html"));
  for (const char* words : {"positive definite", "mean ± standard error", "standard deviation"})
    EXPECT_NE(rough.find(words), std::string::npos) << words;
}

/// The scenes that are handed out.
TEST(PowderScenes, AreSound) {
  for (const char* name : {"powder_method1", "powder_method2", "powder_series_b", "powder_table", "powder_variants",
                           "powder_method2_variants", "powder_consolidation"}) {
    const std::string path = std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/" + name + ".toml";
    const ProgramOutcome outcome = run_the_program("check '" + path + "'");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
  }
}

}  // namespace

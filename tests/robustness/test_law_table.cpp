// Law tables as a whole: other threads, a stop on the way and a cache end with the same bits; wrong scenes are refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "common/data/multi_contact_measurements.h"
#include "common/io/text_file.h"
#include "tests/support/multi_contact.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_law_table.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

class LawTable : public ::testing::Test {
 protected:
  LawTable() { write_text_atomic(scene(), std::string(kTinyLawTable) + kTinyLawFit); }

  [[nodiscard]] std::string scene() const { return directory_.file("scene.toml"); }
  MultiContactMeasurements run(const std::string& name, const std::string& more, int status = 0) {
    const std::string out = directory_.file(name);
    outcome_ = run_the_program("run '" + scene() + "' --out '" + out + "' " + more);
    EXPECT_EQ(outcome_.status, status) << outcome_.output;
    return load_multi_contact(out + "/multi_contact.h5");
  }
  static void expect_same(const MultiContactMeasurements& a, const MultiContactMeasurements& b) {
    ASSERT_EQ(a.runs.size(), b.runs.size());
    for (std::size_t k = 0; k < a.runs.size(); ++k) {
      EXPECT_EQ(a.runs[k].configuration, b.runs[k].configuration);
      EXPECT_EQ(a.runs[k].packing, b.runs[k].packing);
      EXPECT_EQ(a.runs[k].cost.loop_passes, b.runs[k].cost.loop_passes);
      expect_equal(a.runs[k].points, b.runs[k].points);
    }
  }
  /// When the files of a directory were last written.
  [[nodiscard]] std::map<std::string, fs::file_time_type> times(const std::string& name) const {
    std::map<std::string, fs::file_time_type> out;
    for (const auto& entry : fs::directory_iterator(directory_.file(name)))
      out[entry.path().filename().string()] = entry.last_write_time();
    return out;
  }

  TemporaryDirectory directory_;
  ProgramOutcome outcome_;
};

TEST_F(LawTable, ThreadsDoNotMatter) {
  const MultiContactMeasurements one = run("one", "--threads 1");
  const MultiContactMeasurements three = run("three", "--threads 3");
  ASSERT_GE(one.runs.size(), 6U);
  EXPECT_EQ(one.configurations.size(), 3U);
  EXPECT_GT(one.runs[0].points.back().normal[0], 1e-3);
  expect_same(one, three);
  const auto summary = nlohmann::json::parse(read_text(directory_.file("one") + "/summary.json"));
  EXPECT_EQ(summary["status"], "good");
  EXPECT_EQ(summary["multi_contact"]["configurations"].size(), 3U);
  EXPECT_EQ(summary["multi_contact"]["runs"], one.runs.size());
  EXPECT_GT(summary["multi_contact"]["configurations"][0]["force"].get<double>(), 1e-3);
  EXPECT_FALSE(fs::exists(directory_.file("one") + "/work"));
}

TEST_F(LawTable, WhatTheCacheKnowsIsNotMeasuredAgain) {
  const std::string cache = " --law-cache '" + directory_.file("cache") + "'";
  const MultiContactMeasurements plain = run("plain", "");
  const MultiContactMeasurements first = run("first", cache);
  const auto files = times("cache");
  EXPECT_GT(files.size(), first.runs.size());  // and the pilots
  const MultiContactMeasurements second = run("second", cache);
  expect_same(plain, first);
  expect_same(first, second);
  for (std::size_t k = 0; k < first.runs.size(); ++k)
    EXPECT_EQ(first.runs[k].cost.seconds, second.runs[k].cost.seconds);
  EXPECT_TRUE(files == times("cache"));
}

TEST_F(LawTable, ADamagedCacheFileIsMeasuredAgain) {
  const std::string cache = " --law-cache '" + directory_.file("cache") + "'";
  const MultiContactMeasurements first = run("first", cache);
  const std::string victim = directory_.file("cache") + "/" + times("cache").begin()->first;
  fs::resize_file(victim, 100);
  const MultiContactMeasurements second = run("second", cache);
  EXPECT_NE(outcome_.output.find("measured again"), std::string::npos) << outcome_.output;
  EXPECT_GT(fs::file_size(victim), 1000U);
  expect_same(first, second);
}

TEST_F(LawTable, AStoppedRunGoesOnWithTheSameBits) {
  const std::string out = directory_.file("stopped");
  const std::string work = out + "/work";
  const auto begin = [&] { return start_program({"run", scene(), "--out", out, "--threads", "1", "--quiet"}); };
  // More than the nine pilots are there: it stops among the runs that count.
  const auto begun = [&] {
    return fs::exists(work) && std::distance(fs::directory_iterator(work), fs::directory_iterator()) > 10;
  };
  ASSERT_TRUE(interrupted_in_the_middle(begin, begun, out));
  EXPECT_TRUE(begun());
  EXPECT_FALSE(fs::exists(out + "/multi_contact.h5"));
  const MultiContactMeasurements resumed = run("stopped", "--resume --threads 1");
  expect_same(run("whole", "--threads 1"), resumed);
  EXPECT_FALSE(fs::exists(work));
}

TEST_F(LawTable, CheckSaysWhatFollows) {
  const ProgramOutcome outcome = run_the_program("check '" + scene() + "'");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.output.find("3 configurations on 2 to 3 packings: 6 to 9 runs"), std::string::npos)
      << outcome.output;
  (void)run("one", "");
  const ProgramOutcome data = run_the_program("check '" + directory_.file("one") + "/multi_contact.h5'");
  EXPECT_NE(data.output.find("multi-contact measurements: 3 configurations"), std::string::npos) << data.output;
}

TEST_F(LawTable, WrongScenesAndCachesAreRefused) {
  const std::string out = " --out '" + directory_.file("out") + "'";
  EXPECT_EQ(run_the_program("run '" + scene() + "' --set multi_contact.target=2" + out).status, 2);
  EXPECT_EQ(run_the_program("run '" + scene() + "' --law-cache /proc/softgrain" + out).status, 4);
  EXPECT_EQ(run_the_program("microsim '" + scene() + "'" + out).status, 2);
}

}  // namespace

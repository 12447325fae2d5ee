// What is said is said, or status 4; pipes and devices are refused as files; check ends at a signal, whatever it is at.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <filesystem>

#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

const std::string kCard = SOFTGRAIN_SOURCE_DIR "/results/published/law.toml";
const std::string kScene = SOFTGRAIN_SOURCE_DIR "/pipelines/quickstart.toml";

std::function<void()> output_to(const std::string& path, const std::string& errors) {
  return [=] {
    errors_to(errors)();
    const int file = ::open(path.c_str(), O_WRONLY);
    ::dup2(file, STDOUT_FILENO);
  };
}

/// Every way in which the program speaks on standard output, but for the summaries of runs.
std::vector<std::vector<std::string>> everything_said(const std::string& run) {
  return {{"law", "show", kCard},
          {"law", "show", kCard, "--json"},
          {"law", "show", kCard, kCard},
          {"law", "eval", kCard},
          {"law", "eval", kCard, "--json"},
          {"law", "export", kCard, "--to", "csv"},
          {"law", "export", kCard, "--to", "lammps-table"},
          {"law", "export", kCard, "--to", "csv", "--json"},
          {"check", kScene},
          {"check", kScene, "--json"},
          {"check", run},
          {"export", run, "--to", "csv"},
          {"export", run, "--to", "csv", "--json"},
          {"report", run},
          {"report", run, "--json"},
          {"--help"},
          {"law", "--help"},
          {"--version"}};
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += word + " ";
  return text;
}

TEST(OutputStreams, AFullStandardOutputIsTrouble) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  const std::string errors = runs.out("errors.txt");
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("run"))), 0));
  for (const auto& words : everything_said(runs.out("run"))) {
    EXPECT_TRUE(ended_with(wait_for(start_program(words)), 0)) << joined(words);
    const int status = wait_for(start_program(words, output_to("/dev/full", errors)));
    EXPECT_TRUE(ended_with(status, 4)) << joined(words) << status;
    EXPECT_NE(read_text(errors).find("standard output: cannot be written"), std::string::npos) << joined(words);
  }
  for (const std::string json : {"--json", "--quiet"}) {
    const int status = wait_for(start_program(runs.arguments("again" + json, {json}), output_to("/dev/full", errors)));
    EXPECT_TRUE(ended_with(status, 4)) << json << status;
    EXPECT_TRUE(fs::exists(runs.out("again" + json) + "/summary.json"));
  }
}

TEST(OutputStreams, AClosedStandardOutputReachesNoFile) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  const int status = wait_for(start_program(runs.arguments("run", {"--json"}), [] { ::close(STDOUT_FILENO); }));
  EXPECT_TRUE(ended_with(status, 4)) << status;
  for (const auto& entry : fs::directory_iterator(runs.out("run"))) {
    const std::string text = read_text(entry.path().string());
    if (entry.path().filename() == "summary.json") {
      EXPECT_TRUE(nlohmann::json::parse(text).is_object());
    } else {
      EXPECT_EQ(text.find("\"provenance\": {"), std::string::npos) << entry.path();
      EXPECT_EQ(text.find("\"status\": \"good\""), std::string::npos) << entry.path();
    }
  }
}

TEST(OutputStreams, WhatIsNoFileIsRefused) {
  const TemporaryDirectory directory;
  const std::string pipe = directory.path() + "/pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink(pipe, directory.path() + "/pipe.h5");
  fs::create_symlink(pipe, directory.path() + "/pipe.json");
  fs::create_symlink(pipe, directory.path() + "/pipe.csv");
  fs::create_symlink(pipe, directory.path() + "/states_pipe.h5");
  const std::vector<std::vector<std::string>> asked{{"check", pipe},
                                                    {"check", pipe + ".h5"},
                                                    {"check", pipe + ".json"},
                                                    {"law", "show", pipe},
                                                    {"calibrate", pipe + ".csv", "--kind", "soft-solid", "--radius",
                                                     "1", "--modulus", "1", "--out", directory.path() + "/a"},
                                                    {"calibrate", pipe + ".h5", "--out", directory.path() + "/b"},
                                                    {"export", directory.path() + "/states_pipe.h5", "--to", "csv"},
                                                    {"microsim", pipe, "--out", directory.path() + "/c"}};
  const std::string errors = directory.path() + "/errors.txt";
  for (const auto& words : asked) {
    const int status = signal_after(start_program(words, errors_to(errors)), 20.0, SIGKILL);
    EXPECT_TRUE(ended_with(status, 4)) << joined(words) << status;
    EXPECT_NE(read_text(errors).find("is a pipe, not a file"), std::string::npos) << joined(words) << read_text(errors);
  }
  const ProgramOutcome device = run_the_program("check /dev/zero");
  EXPECT_EQ(device.status, 4);
  EXPECT_NE(device.output.find("/dev/zero: is a device, not a file"), std::string::npos) << device.output;
}

/// A file that opens and cannot be read is not one that is damaged.
TEST(OutputStreams, ExportSaysWhatCannotBeRead) {
  const TemporaryDirectory directory;
  const std::string unreadable = directory.path() + "/states_unreadable.h5";
  fs::create_symlink("/proc/self/mem", unreadable);
  const ProgramOutcome read = run_the_program("export '" + unreadable + "' --to csv");
  EXPECT_EQ(read.status, 4);
  EXPECT_NE(read.output.find("states_unreadable.h5: cannot be read: "), std::string::npos) << read.output;
  EXPECT_EQ(read.output.find("damaged"), std::string::npos) << read.output;
}

/// Neither is one whose export finds no room.
TEST(OutputStreams, ExportSaysWhatCannotBeWritten) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("run"))), 0));
  const std::string errors = runs.out("errors.txt");
  for (const std::string form : {"csv", "vtp", "lammps-dump", "lammps-data"}) {
    const int status = wait_for(start_program({"export", runs.out("run"), "--to", form}, [&] {
      errors_to(errors)();
      const rlimit limit{300, RLIM_INFINITY};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }));
    EXPECT_TRUE(ended_with(status, 4)) << form << status;
    EXPECT_NE(read_text(errors).find("cannot be written"), std::string::npos) << read_text(errors);
    EXPECT_EQ(read_text(errors).find("damaged"), std::string::npos) << read_text(errors);
  }
}

/// The packing of this scene takes minutes.
TEST(OutputStreams, CheckEndsAtASignal) {
  const pid_t child = start_program({"check", kScene, "--set", "packing.trials=1000000", "--set", "packing.beta=50",
                                     "--set", "packing.rmax_over_shell=0.1"});
  const Signalled ended = signalled_after(child, 0.4, SIGTERM);
  EXPECT_TRUE(ended_with(ended.status, 130)) << ended.status;
  EXPECT_LT(ended.after, 1.0);
}

}  // namespace

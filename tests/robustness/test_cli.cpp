// The built program from outside: exit statuses and messages of everything that can be asked wrongly.
#include <gtest/gtest.h>
#include <omp.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "common/io/text_file.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int status = -1;
  std::string output;  ///< standard output and standard error together
};

Outcome program(const std::string& arguments) {
  const std::string line = std::string("'") + SOFTGRAIN_PROGRAM + "' " + arguments + " 2>&1 </dev/null";
  FILE* pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) return {};
  Outcome outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

void expect(const std::string& arguments, int status, const std::string& words) {
  const Outcome outcome = program(arguments);
  EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.output;
  EXPECT_NE(outcome.output.find(words), std::string::npos) << arguments << "\n" << outcome.output;
}

TEST(CommandLine, HelpAndVersionAreGood) {
  expect("--help", 0, "macrosim");
  expect("--version", 0, "softgrain 0.");
  for (const char* command : {"run", "microsim", "calibrate", "macrosim", "sweep", "compare", "report", "check"})
    expect(std::string(command) + " --help", 0, "--threads");
  for (const char* command : {"run", "microsim", "macrosim", "sweep"})
    expect(std::string(command) + " --help", 0, "--resume");
  for (const char* command : {"run", "macrosim"}) expect(std::string(command) + " --help", 0, "--law");
}

TEST(CommandLine, HelpAndVersionAreCommandsToo) {
  EXPECT_EQ(program("help").output, program("--help").output);
  EXPECT_EQ(program("help sweep").output, program("sweep --help").output);
  EXPECT_EQ(program("help law eval").output, program("law eval --help").output);
  EXPECT_EQ(program("version").output, program("--version").output);
  expect("version", 0, "softgrain 0.");
  expect("help", 0, "The scenes that come with the program");
  expect("help mircosim", 2, "nearest is 'microsim'");
  expect("help --help", 0, "command to explain");
}

TEST(CommandLine, HelpShowsTheOptionsOfTheCommandAlone) {
  const auto lacks = [](const std::string& command, const std::vector<std::string>& options) {
    const std::string help = program(command + " --help").output;
    for (const std::string& option : options)
      EXPECT_EQ(help.find("\n  " + option + " "), std::string::npos) << command << option;
  };
  lacks("check", {"--out", "--resume", "--checkpoint-every", "--over"});
  lacks("report", {"--out", "--seed", "--set", "--resume"});
  lacks("compare", {"--seed", "--set", "--resume", "--law"});
  lacks("microsim", {"--law", "--engine", "--over"});
}

TEST(CommandLine, NoCommandShowsTheHelp) { expect("", 2, "Subcommands:"); }

TEST(CommandLine, UnknownCommandNamesTheNearest) {
  expect("mircosim x.toml", 2, "nearest is 'microsim'");
  expect("law shwo x.toml", 2, "unknown command 'law shwo'; nearest is 'show'");
}

TEST(CommandLine, UnknownOptionNamesTheNearestOfTheCommand) {
  expect("run x.toml --thread 2", 2,
         "--thread: run has no such option; nearest is '--threads' (see softgrain run --help)");
  expect("run x.toml --pakcing-cache=d", 2, "--pakcing-cache: run has no such option; nearest is '--packing-cache'");
  expect("law eval l.toml --detla 0.1", 2, "--detla: law eval has no such option; nearest is '--delta'");
  expect("run x.toml --over a=1", 2, "--over: run has no such option; commands with it are sweep");
  expect("--verison", 2, "--verison: softgrain has no such option; nearest is '--version' (see softgrain --help)");
}

/// Only the first word is a command.
TEST(CommandLine, AFileMayHaveTheNameOfACommand) {
  expect("check absent_a check", 2, "check needs 1 FILE, 2 given");
  expect("compare absent_a report", 4, "absent_a: no such file or directory");
}

TEST(CommandLine, BadOptionsAreBadInput) {
  expect("run x.toml --threads 0", 2, "softgrain: --threads 0: must be a whole number, from 1 to");
  expect("run x.toml --threads -1", 2, "--threads");
  expect("run x.toml --threads two", 2, "--threads two");
  expect("run x.toml --threads 1.5", 2, "--threads 1.5");
  expect("run x.toml --seed -1", 2, "--seed -1: must be a whole number, at least 0");
  expect("run x.toml --bogus", 2, "--bogus");
  expect("run x.toml y.toml", 2, "run needs 1 SCENE.toml, 2 given");
  expect("run", 2, "run needs 1 SCENE.toml, 0 given");
  expect("compare", 2, "compare needs at least 1 RUN, 0 given");
  expect("run x.toml --set material.mu 0.5", 2, "--set material.mu: must be of the form key=value, without blanks");
  expect("run x.toml --set material.mu= 0.5", 2, "--set material.mu=: must be of the form key=value, without blanks");
  expect("compare absent_a absent_b absent_c", 4, "absent_a: no such file or directory");
  expect("sweep x.toml y.toml --over a=1", 2, "sweep needs 1 SCENE.toml, 2 given");
  expect("calibrate x.csv --seeds 1..2", 2, "--seeds");
  expect("calibrate x.csv --resume", 2, "--resume: calibrate has no such option; commands with it are run,");
  expect("compare a b --set macro.bodies=3", 2, "--set: compare has no such option");
  expect("report a --seed 3", 2, "--seed: report has no such option");
  expect("check a --out b", 2, "--out: check has no such option");
  expect("report a --out b", 2, "--out: report has no such option");
  expect("check absent.csv --law law.toml", 2, "--law: absent.csv is no scene");
  expect("check absent.csv --bands 50", 2, "--bands: absent.csv is no scene");
  expect("check absent.csv --set unloading=drop", 2, "--set: absent.csv is no scene");
  expect("microsim x.toml --law l.toml", 2, "--law: microsim has no such option; commands with it are run,");
  expect("law eval l.toml --delta 0,1", 2, "softgrain: --delta = 0,1: not a value that this option takes");
}

TEST(CommandLine, AnOptionWithoutItsValueSaysWhatItTakes) {
  expect("law get --press-test", 2,
         "--press-test: nothing follows it; give --press-test TABLE: Press test of one soft particle");
  expect("law get --mu 0.3 --own --out a.toml", 2, "--own: nothing follows it; give --own TABLE: Law table");
  expect("run x.toml --threads", 2, "--threads: nothing follows it; give --threads N: Threads to use");
  expect("run x.toml --set", 2, "--set: nothing follows it; give --set KEY=VALUE: ");
  expect("law eval l.toml --delta", 2, "--delta: nothing follows it; give --delta D1 D2 ...: ");
}

/// Options of a command that take a value, as its help has them: a flag has two spaces or more behind its name.
std::vector<std::string> options_with_values(const std::string& command) {
  const std::regex option("\\n +(?:-\\w, *)?(--[a-zA-Z][a-zA-Z-]*) [^ \\n]");
  const std::string help = program(command + " --help").output;
  std::vector<std::string> out;
  for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at) out.push_back((*at)[1]);
  return out;
}

/// Last in the line, or with another option of the command behind it.
TEST(CommandLine, EveryOptionThatTakesAValueSaysSoWithoutOne) {
  std::size_t options = 0;
  for (const char* command :
       {"run", "microsim", "macrosim", "sweep", "calibrate", "compare", "report", "check", "export", "schema", "new",
        "examples", "law show", "law eval", "law export", "law plan", "law get", "law library"})
    for (const std::string& option : options_with_values(command)) {
      ++options;
      const std::string line = std::string(command) + " " + option;
      expect(line, 2, option + ": nothing follows it; give " + option + " ");
      expect(line + " " + option, 2, option);
      EXPECT_FALSE(fs::exists(option)) << line;
    }
  EXPECT_GT(options, 80U);
  expect("run x.toml --out --quiet", 2, "softgrain: --out: nothing follows it; give --out DIR: ");
  expect("law get --mu 0.3 --own --out", 2, "--own: nothing follows it; give --own TABLE: Law table");
}

/// A copy of a scene that comes with the program looks for its law beside it.
TEST(CommandLine, AFileThatACopiedSceneLacksIsTheOneOfTheProgram) {
  const test::TemporaryDirectory directory;
  const std::string scene = directory.file("press_test_macro.toml");
  const std::string shipped = std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/";
  write_text_atomic(scene, read_text(shipped + "press_test_macro.toml"));
  const std::string missing = directory.file("press_test_unloading.csv") + ": no such file";
  for (const char* words :
       {": no such file; one of this name comes with the program: ", "/pipelines/press_test_unloading.csv; ",
        "paths in a scene are relative to its own folder", "softgrain examples NAME --out FILE"})
    expect("check '" + scene + "'", 4, words);
  expect("check '" + scene + "'", 4, missing);
  // --set is relative to the scene too; a file that lies in the working directory is named by its full path.
  const std::string beside = "beside_" + std::to_string(::getpid()) + ".csv";
  write_text_atomic(beside, "opening [mm],passing [%]\n1,0\n2,100\n");
  expect("check '" + shipped + "sand_modulus.toml' --set 'grains.sizes={form=\"sieve-curve\",file=\"" + beside + "\"}'",
         4, ", also with --set; the file in the working directory is " + fs::absolute(beside).string());
  fs::remove(beside);
  // What the command line names itself is not that of a scene.
  expect("check nowhere/quickstart.toml", 4,
         "/pipelines/quickstart.toml (softgrain examples quickstart --out FILE copies it)");
  expect("check quickstart", 4, "/pipelines/quickstart.toml (softgrain examples quickstart");
  const Outcome absent = program("check absent_scene.toml");
  EXPECT_EQ(absent.output.find("relative"), std::string::npos) << absent.output;
}

TEST(CommandLine, MissingSceneIsFileTroubleAndMakesNothing) {
  const std::string name = "absent_" + std::to_string(::getpid());
  for (const char* command : {"run", "macrosim"}) {
    expect(std::string(command) + " " + name + ".toml", 4, name + ".toml: no such file");
    EXPECT_FALSE(fs::exists("results/" + name));
  }
  const test::TemporaryDirectory directory;
  const std::string out = directory.file("new/out");
  expect("run " + name + ".toml --out '" + out + "'", 4, name + ".toml: no such file");
  EXPECT_FALSE(fs::exists(directory.file("new")));
}

TEST(CommandLine, UnwritableRunDirectoryIsFoundBeforeAnyWork) {
  const std::string scene = (fs::temp_directory_path() / ("scene_" + std::to_string(::getpid()) + ".toml")).string();
  write_text_atomic(scene, "nonsense = 1\n");
  expect("run " + scene + " --out /dev/null/x", 4, "/dev/null/x");
  expect("run " + scene + " --out /proc/softgrain", 4, "/proc/softgrain");
  expect("run " + scene + " --out " + scene, 4, scene);
  fs::remove(scene);
}

constexpr const char* kOneGrain =
    "kind = \"particles\"\n[material.a]\ndensity = 1.0\nE = 1.0\nnu = 0.2\n[[particle]]\nmaterial = \"a\"\n"
    "radius = 1.0\nposition = [0.0, 0.0, 0.0]\n[time]\nstep = 0.1\nend = 0.2\n";

TEST(CommandLine, MoreThreadsThanCoresAreSaid) {
  const test::TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene, kOneGrain);
  const std::string more = std::to_string(omp_get_num_procs() + 1);
  expect("microsim " + scene + " --out " + directory.file("run") + " --threads " + more, 0,
         "warning: --threads " + more + ": ");
}

/// Folders of kept results, which have a page, are not written into unless asked for.
TEST(CommandLine, RunsDoNotWriteAmongKeptResults) {
  const test::TemporaryDirectory directory;
  const fs::path here = fs::current_path();
  fs::current_path(directory.path());
  fs::create_directories("results/kept");
  write_text_atomic("results/kept/README.md", "# Kept\n");
  for (const char* name : {"kept", "new"}) {
    write_text_atomic(std::string(name) + ".toml", kOneGrain);
    expect("microsim " + std::string(name) + ".toml --quiet", 0, "");
  }
  EXPECT_TRUE(fs::exists("results/new/summary.json"));
  EXPECT_TRUE(fs::exists("results/kept_run/summary.json"));
  EXPECT_EQ(std::distance(fs::directory_iterator("results/kept"), fs::directory_iterator()), 1);
  fs::current_path(here);
}

TEST(CommandLine, BadSceneIsNamedWithFileAndLine) {
  const fs::path directory = fs::temp_directory_path() / ("softgrain_cli_" + std::to_string(::getpid()));
  fs::create_directories(directory);
  const std::string scene = (directory / "scene.toml").string();
  write_text_atomic(scene, "a = 1\nb = = 2\n");
  expect("run " + scene + " --out " + (directory / "out").string(), 2, "scene.toml:2: not valid TOML");
  expect("run " + scene + " --set =3 --out " + (directory / "out").string(), 2, "scene.toml:2");
  const std::string table = (directory / "table.csv").string();
  write_text_atomic(table, "opening [mm],passing [%]\n4,100\n2,0\n");
  expect("run " + table + " --out " + (directory / "out").string(), 2, "a scene is a TOML file: softgrain check");
  // A folder of scenes is no run, whatever they are called.
  write_text_atomic((directory / "law_table.toml").string(), "kind = \"law-table\"\n");
  expect("check " + directory.string(), 2, "no run directory: neither summary.json nor a file of results is in it");
  write_text_atomic(scene, "a = 1\n");
  expect("run " + scene + " --set novalue --out " + (directory / "out").string(), 2,
         "--set novalue: must be of the form key=value");
  fs::remove_all(directory);
}

}  // namespace
}  // namespace softgrain

// Other programs as children: what they say, how they end, and that they end with us.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>

#include "common/core/error.h"
#include "common/io/child_process.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

class Child : public ::testing::Test {
 protected:
  ~Child() override { clear_interrupt(); }
  ChildEnd run(
      const std::vector<std::string>& words, const std::function<void()>& watch = [] {}) {
    return run_child(words, directory_.path(), log(), watch);
  }
  [[nodiscard]] std::string log() const { return directory_.file("log"); }
  [[nodiscard]] static std::string program(const std::string& name) { return find_in_path(name); }

  test::TemporaryDirectory directory_;
};

TEST_F(Child, SpeaksToTheEndOfTheLogAndGetsItsWordsUnchanged) {
  EXPECT_EQ(run({program("echo"), "one $HOME; 'x'"}).status, 0);
  EXPECT_EQ(run({program("pwd")}).status, 0);
  EXPECT_EQ(read_text(log()), "one $HOME; 'x'\n" + std::filesystem::canonical(directory_.path()).string() + "\n");
}

TEST_F(Child, HowItEndedIsTold) {
  EXPECT_EQ(run({program("false")}).status, 1);
  const ChildEnd end = run({program("sh"), "-c", "kill -SEGV $$"});
  EXPECT_EQ(end.signal, SIGSEGV);
  EXPECT_FALSE(end.interrupted);
}

TEST_F(Child, ThatCannotBeStartedIsAnError) {
  EXPECT_THROW((void)run({"/nowhere/program"}), IoError);
  EXPECT_THROW((void)run_child({program("true")}, directory_.file("nowhere"), log(), [] {}), IoError);
}

TEST_F(Child, EndsWhenWeAreAskedToStop) {
  const auto start = std::chrono::steady_clock::now();
  const ChildEnd end = run({program("sh"), "-c", "sleep 1000 & wait"}, [] { request_interrupt(); });
  EXPECT_TRUE(end.interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(600)) << "it was waited for";
}

TEST_F(Child, ThatDoesNotListenIsEndedAllTheSame) {
  const ChildEnd end =
      run({program("sh"), "-c", "trap '' TERM; while :; do sleep 1; done"}, [] { request_interrupt(); });
  EXPECT_EQ(end.signal, SIGKILL);
}

}  // namespace
}  // namespace softgrain

#include <gtest/gtest.h>

#include <chrono>
#include <regex>
#include <string>
#include <thread>

#include "common/io/progress.h"

namespace {

using softgrain::Progress;

/// What it says of work that goes from `found` to `done` of ten in a little more than two seconds, or in more where the
/// machine has other work.
std::string said(double found, double done) {
  ::testing::internal::CaptureStderr();
  Progress progress("working", 10.0, false);
  progress.set(found);
  std::this_thread::sleep_for(std::chrono::milliseconds(2050));
  progress.set(done);
  std::string text = ::testing::internal::GetCapturedStderr();
  ::testing::internal::CaptureStderr();
  progress.finish();
  (void)::testing::internal::GetCapturedStderr();
  return text;
}

/// Whether four times as much is left as has passed, in whole seconds.
void expect_four_times(const std::string& text, const std::string& begin) {
  static const std::regex form("(working: [0-9]+ %), ([0-9]+) s so far, about ([0-9]+) s left\n");
  std::smatch parts;
  ASSERT_TRUE(std::regex_match(text, parts, form)) << text;
  EXPECT_EQ(parts[1], begin);
  const double passed = std::stod(parts[2]);
  EXPECT_GE(passed, 2.0);
  EXPECT_NEAR(std::stod(parts[3]), 4.0 * passed, 4.0 * 0.5 + 0.5);
}

TEST(Progress, TimeLeftFollowsFromWhatWasDone) { expect_four_times(said(0.0, 2.0), "working: 20 %"); }

// A run that goes on has done half of it before.
TEST(Progress, WhatWasThereAtTheBeginningIsNoSpeed) {
  expect_four_times(said(5.0, 6.0), "working: 60 %");
  const std::string text = said(5.0, 5.0);
  EXPECT_TRUE(std::regex_match(text, std::regex("working: 50 %, [0-9]+ s so far\n"))) << text;
}

}  // namespace

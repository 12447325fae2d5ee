#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "common/io/progress.h"

namespace {

using softgrain::Progress;

/// What it says of work that goes from `found` to `done` of ten in a little more than two seconds.
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

TEST(Progress, TimeLeftFollowsFromWhatWasDone) {
  EXPECT_EQ(said(0.0, 2.0), "working: 20 %, 2 s so far, about 8 s left\n");
}

// A run that goes on has done half of it before.
TEST(Progress, WhatWasThereAtTheBeginningIsNoSpeed) {
  EXPECT_EQ(said(5.0, 6.0), "working: 60 %, 2 s so far, about 8 s left\n");
  EXPECT_EQ(said(5.0, 5.0), "working: 50 %, 2 s so far\n");
}

}  // namespace

// Properties are tried with the same inputs every time, unless RC_PARAMS says otherwise ("seed=7 max_success=1000").
#include <gtest/gtest.h>

#include <cstdlib>

int main(int argc, char** argv) {
  ::setenv("RC_PARAMS", "seed=20240701", 0);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}

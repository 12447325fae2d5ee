// What is refused is refused by its message.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace softgrain::test {

/// That `make` throws E with these words.
template <class E, class F>
void expect_refused(F&& make, const std::string& words) {
  try {
    make();
    ADD_FAILURE() << "not refused: " << words;
  } catch (const E& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

}  // namespace softgrain::test

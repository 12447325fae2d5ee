// A macro scene of a moment: six bodies, with a law card beside it and without a twin.
#pragma once

namespace softgrain::test {

inline constexpr const char* kMacroOfAMoment = R"(kind = "macro"
title = "a macro scene"
law = "law.toml"
[macro]
bodies = 6
steps = 2
strain = 0.15
resolved = false
)";

}  // namespace softgrain::test

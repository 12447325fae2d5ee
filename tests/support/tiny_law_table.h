// A law table that takes a second: few coarse grains, three packings, short paths.
#pragma once

namespace softgrain::test {

inline constexpr const char* kTinyLawTable = R"(kind = "law-table"
title = "tiny"
seed = 1
[packing]
trials = 1000
polydispersity = 4.0
beta = 8.0
placement = "voids"
[multi_contact]
increment = 0.02
packings_min = 2
packings_max = 3
target = 0.2
points = 4
[[configuration]]
arrangement = "one"
partner = "plane"
overlap = 0.3
[[configuration]]
arrangement = "opposite"
partner = "plane"
overlap = 0.2
path = "unload"
[[configuration]]
arrangement = "one"
partner = "soft"
ratio = 1.0
overlap = 0.6
held_out = true
)";

/// Goes at its end, for runs that fit: three packings and no replicates are enough here, and how far the law is off on
/// the soft neighbour that was held out, which hardly presses, does not matter.
inline constexpr const char* kTinyLawFit = R"([calibrate]
min_packings = 2
replicates = 0
largest_error = 1e3
)";

}  // namespace softgrain::test

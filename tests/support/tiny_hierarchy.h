// Soft particles inside soft particles in some seconds: a dozen coarse grains, four packings, two levels.
#pragma once

namespace softgrain::test {

/// So few packings leave its law underdetermined: the run ends with status 3, everything written.
inline constexpr const char* kTinyHierarchy = R"(kind = "hierarchy"
title = "tiny"
seed = 1
[packing]
trials = 50
polydispersity = 3.0
rmax_over_shell = 0.5
beta = 8.0
placement = "voids"
[multi_contact]
increment = 0.025
packings_min = 4
packings_max = 4
target = 0.5
points = 4
[[configuration]]
arrangement = "one"
partner = "plane"
overlap = 0.4
[[configuration]]
arrangement = "one"
partner = "solid"
ratio = 1.0
overlap = 0.5
[[configuration]]
arrangement = "one"
partner = "soft"
ratio = 1.0
overlap = 0.6
[hierarchy]
levels = 2
form = "isotropic"
fill = "masses"
inner_radius = 0.3
replicates = 4
[fixed_point]
iterations = 2
tolerance = 0.9
[check]
packings = 2
overlaps = [0.2, 0.3]
)";

}  // namespace softgrain::test

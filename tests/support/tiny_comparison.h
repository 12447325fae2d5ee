// A comparison of laws with twins that takes seconds: a dozen solid grains, soft particles of a few grains.
#pragma once

namespace softgrain::test {

/// Its law card is "law.toml" beside the scene.
inline constexpr const char* kTinyComparison = R"(kind = "macro-comparison"
title = "tiny"
seed = 1
[packing]
polydispersity = 3.0
trials = 200
count = 2
[law]
card = "law.toml"
[macro]
construction = "voids"
bodies = 10
soft_share = 0.35
soft_radius_max = "12 mm"
soft_polydispersity = 2.0
increments_per_step = 1
steps = 3
strain = 0.15
[[scene]]
samples = 2
[[scene]]
test = "shear"
preload = 0.05
preload_steps = 2
strain = 0.05
)";

}  // namespace softgrain::test

// A whole pipeline that takes about a second: few coarse grains, four packings, eight bodies.
#pragma once

namespace softgrain::test {

/// Its soft-soft law is underdetermined on so few points: the run ends with status 3, everything written.
inline constexpr const char* kTinyPipeline = R"(kind = "pipeline"
title = "tiny"
seed = 1
[material]
E = "0.5 MPa"
mu = 0.3
[packing]
shell_radius = "16 mm"
trials = 100
polydispersity = 5.0
rmax_over_shell = 0.5
beta = 8.0
count = 4
[measure]
relaxation = "damped"
[measure.damped]
increment = 0.02
[measure.soft_solid]
deltas = [0.1, 0.2, 0.3, 0.35, 0.4, 0.45]
tangential_deltas = [0.35, 0.4, 0.45]
angles_deg = [-0.05, 0.05]
[measure.soft_soft]
deltas = [0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6]
[calibrate]
min_packings = 2
replicates = 20
[macro]
bodies = 8
steps = 4
strain = 0.3
)";

}  // namespace softgrain::test

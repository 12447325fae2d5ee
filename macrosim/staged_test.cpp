#include "macrosim/staged_test.h"

#include <algorithm>

#include "common/io/text_file.h"

namespace softgrain {

namespace {

/// Hash of box and bodies, bit by bit.
std::string hash_of(const MacroPacking& packing) {
  std::string bytes;
  const auto add = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const Vec3& corner : {packing.low, packing.high})
    for (int a = 0; a < 3; ++a) add(corner[a]);
  for (const MacroBody& body : packing.bodies) {
    for (int a = 0; a < 3; ++a) add(body.x[a]);
    add(body.r);
    add(body.soft);
    if (body.material != 0) add(body.material);
  }
  return short_hash(bytes);
}

MacroStart start_of(const MacroSpec& spec, const MacroPacking& packing) {
  const auto [least, most] = std::minmax_element(packing.bodies.begin(), packing.bodies.end(),
                                                 [](const MacroBody& a, const MacroBody& b) { return a.r < b.r; });
  const bool any = !packing.bodies.empty();
  const Vec3 size = packing.size();
  return {any ? least->r : 0.0,
          any ? most->r : 0.0,
          spec.youngs_modulus,
          spec.poisson_ratio,
          spec.friction,
          spec.wall_friction,
          size[0],
          size[1],
          size[2],
          hash_of(packing),
          spec.rolling};
}

}  // namespace

BoxControl box_control(const MacroSpec& spec, const MacroStage& stage, const Vec3& stress) {
  BoxControl control;
  for (std::size_t k = 0; k < 3; ++k) control.by_stress[k] = stage.axis[k].by_stress;
  control.stress = stress;
  control.isotropic = stage.isotropic;
  control.tolerance = stress_tolerance(stage);
  control.least_stress = least_stress(spec);
  control.farthest = kFarthestStrain;
  return control;
}

std::optional<BoxControl> mean_first(const MacroSpec& spec, const MacroStage& stage, const Vec3& stress) {
  if (stage.isotropic || !stage.axis[0].by_stress || !stage.axis[1].by_stress || !stage.axis[2].by_stress)
    return std::nullopt;
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  BoxControl control = box_control(spec, stage, {{mean, mean, mean}});
  control.isotropic = true;
  control.tolerance *= kRoughly;
  return control;
}

MacroCurve blank_curve(const MacroSpec& spec, const MacroPacking& packing, const std::string& engine,
                       std::int64_t sample) {
  MacroCurve curve;
  curve.engine = engine;
  curve.test = spec.test;
  curve.boundary = spec.boundary;
  for (const MacroStage& stage : stages_of(spec)) {
    curve.stages.push_back(stage.record);
    curve.stages.back().by_stress = {stage.axis[0].by_stress, stage.axis[1].by_stress, stage.axis[2].by_stress};
  }
  curve.sample = sample;
  curve.bodies = static_cast<std::int64_t>(packing.bodies.size());
  curve.soft = packing.soft_count();
  curve.start = start_of(spec, packing);
  curve.preload = preload_points(spec) > 0 ? spec.preload : 0.0;
  curve.soft_volume_share = packing.soft_volume_share();
  curve.solid_fraction = packing.solid_fraction();
  curve.preparation = packing.cost;
  curve.density = packing.density;
  return curve;
}

void record_stress_strain(MacroCurve& c, const MacroSpec& spec, std::int64_t stage, const Vec3& size,
                          const Vec3& stress) {
  c.strain_x.push_back(1.0 - size[0] / c.start.size_x);
  c.strain_y.push_back(1.0 - size[1] / c.start.size_y);
  c.strain_z.push_back(1.0 - size[2] / c.start.size_z);
  c.stage.push_back(static_cast<double>(stage));
  const auto stages = stages_of(spec);
  if (any_slides(stages)) c.shear_strain.push_back(shear_at(stages, static_cast<std::int64_t>(c.strain.size())));
  const bool staged = spec.test == MacroTest::stages;
  c.strain.push_back(staged ? c.strain_z.back() : strain_at(spec, static_cast<std::int64_t>(c.strain.size())));
  c.stress_axial.push_back(stress[2]);
  c.stress_lateral.push_back(0.5 * (stress[0] + stress[1]));
  c.stress_x.push_back(stress[0]);
  c.stress_y.push_back(stress[1]);
  c.stress_deviator.push_back(stress[2] - stress[0]);
}

}  // namespace softgrain

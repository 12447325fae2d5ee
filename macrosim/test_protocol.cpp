#include "macrosim/test_protocol.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// Step k of `total` equal ones to the nominal strain `end`, as a share of the length before it.
double nominal_step(double end, std::int64_t k, std::int64_t total) {
  const auto at = [&](std::int64_t n) { return end * static_cast<double>(n) / static_cast<double>(total); };
  return 1.0 - (1.0 - at(k)) / (1.0 - at(k - 1));
}

StageKind shear_kind(MacroTest test) {
  switch (test) {
    case MacroTest::undrained:
      return StageKind::undrained;
    case MacroTest::simple_shear:
      return StageKind::simple_shear;
    case MacroTest::direct_shear:
      return StageKind::direct_shear;
    default:
      return StageKind::shear;
  }
}

double target(const AxisDrive& drive, int axis, const std::vector<Vec3>& starts) {
  return drive.as_at < 0 ? drive.value : starts[static_cast<std::size_t>(drive.as_at)][axis];
}

}  // namespace

void drive_by_strain(MacroStage& stage, StageKind way, double strain) {
  if (slides(way)) {
    stage.shear = strain;
    return;
  }
  stage.axis[2].value = strain;
  if (way == StageKind::isotropic) stage.axis[0].value = stage.axis[1].value = strain;
  if (way == StageKind::shear) stage.axis[0].value = -strain;
  if (way == StageKind::undrained) stage.axis[0].value = stage.axis[1].value = -0.5 * strain;
  stage.logarithmic = way == StageKind::shear || way == StageKind::undrained;
}

MacroStage short_stage(const MacroSpec& spec, StageKind kind, double strain, std::int64_t steps) {
  MacroStage stage;
  stage.record = {to_string(kind), kind, kind, spec.modulus_stress};
  stage.steps = steps;
  stage.increments_per_step = spec.increments_per_step;
  stage.tolerance = spec.tolerance;
  drive_by_strain(stage, kind, strain);
  return stage;
}

std::vector<MacroStage> stages_of(const MacroSpec& spec) {
  switch (spec.test) {
    case MacroTest::stages:
      return spec.stages;
    case MacroTest::oedometric:
      return {short_stage(spec, StageKind::oedometric, spec.strain_end, spec.steps)};
    case MacroTest::isotropic:
      return {short_stage(spec, StageKind::isotropic, spec.strain_end, spec.steps)};
    default:
      break;
  }
  std::vector<MacroStage> stages;
  if (preload_points(spec) > 0) {
    stages.push_back(short_stage(spec, StageKind::isotropic, spec.preload, spec.preload_steps));
    stages.back().record.name = "preload";
    stages.back().record.modulus_stress = {};
  }
  stages.push_back(short_stage(spec, shear_kind(spec.test), spec.strain_end, spec.steps));
  if (spec.test == MacroTest::direct_shear)
    stages.back().axis[2] = {true, 0.0, static_cast<std::int64_t>(stages.size()) - 1};
  return stages;
}

std::int64_t recorded_points(const MacroSpec& spec) {
  const auto stages = stages_of(spec);
  return first_point(stages, static_cast<std::int64_t>(stages.size())) + 1;
}

std::int64_t preload_points(const MacroSpec& spec) {
  return is_shear(spec.test) && spec.preload > 0.0 ? spec.preload_steps : 0;
}

StagePoint stage_point(const std::vector<MacroStage>& stages, std::int64_t point) {
  StagePoint at{0, point};
  while (at.number > stages[static_cast<std::size_t>(at.stage)].steps)
    at.number -= stages[static_cast<std::size_t>(at.stage++)].steps;
  return at;
}

std::int64_t first_point(const std::vector<MacroStage>& stages, std::int64_t stage) {
  std::int64_t point = 0;
  for (std::int64_t k = 0; k < stage; ++k) point += stages[static_cast<std::size_t>(k)].steps;
  return point;
}

double way_sign(const std::vector<MacroStage>& stages, std::int64_t stage) {
  while (stage > 0 &&
         stages[static_cast<std::size_t>(stage)].record.kind != stages[static_cast<std::size_t>(stage)].record.way)
    --stage;
  if (const double shear = stages[static_cast<std::size_t>(stage)].shear; shear != 0.0) return shear < 0.0 ? -1.0 : 1.0;
  const AxisDrive& z = stages[static_cast<std::size_t>(stage)].axis[2];
  return !z.by_stress && z.value < 0.0 ? -1.0 : 1.0;
}

double strain_at(const MacroSpec& spec, std::int64_t point) {
  const std::int64_t before = preload_points(spec);
  if (point < before) return -spec.preload * static_cast<double>(before - point) / static_cast<double>(before);
  return spec.strain_end * static_cast<double>(point - before) / static_cast<double>(spec.steps);
}

Vec3 strain_increment(const MacroStage& stage, std::int64_t n) {
  const std::int64_t total = stage.steps * stage.increments_per_step;
  Vec3 strain{};
  for (int k = 0; k < 3; ++k) {
    const AxisDrive& drive = stage.axis[static_cast<std::size_t>(k)];
    if (drive.by_stress || drive.value == 0.0) continue;
    strain[k] = stage.logarithmic ? -std::expm1(-drive.value / static_cast<double>(total))
                                  : nominal_step(drive.value, n, total);
  }
  return strain;
}

double shear_increment(const MacroStage& stage) {
  return stage.shear / static_cast<double>(stage.steps * stage.increments_per_step);
}

double shear_at(const std::vector<MacroStage>& stages, std::int64_t point) {
  double sum = 0.0;
  for (const MacroStage& stage : stages) {
    const std::int64_t here = std::min(point, stage.steps);
    sum += stage.shear * static_cast<double>(here) / static_cast<double>(stage.steps);
    point -= here;
  }
  return sum;
}

bool any_slides(const std::vector<MacroStage>& stages) {
  return std::any_of(stages.begin(), stages.end(), [](const MacroStage& s) { return slides(s.record.way); });
}

Vec3 stress_at(const MacroStage& stage, std::int64_t n, const std::vector<Vec3>& starts) {
  const double way = static_cast<double>(n) / static_cast<double>(stage.steps * stage.increments_per_step);
  Vec3 stress{};
  for (int k = 0; k < 3; ++k) {
    const AxisDrive& drive = stage.axis[static_cast<std::size_t>(k)];
    if (drive.by_stress) stress[k] = (1.0 - way) * starts.back()[k] + way * target(drive, k, starts);
  }
  return stress;
}

std::vector<Vec3> stage_starts(const std::vector<MacroStage>& stages, const MacroCurve& curve, std::int64_t point) {
  std::vector<Vec3> starts;
  for (std::int64_t k = 0; k <= stage_point(stages, point).stage; ++k) {
    const auto first = static_cast<std::size_t>(first_point(stages, k));
    starts.push_back({{curve.stress_x[first], curve.stress_y[first], curve.stress_axial[first]}});
  }
  return starts;
}

double test_force_floor(const MacroSpec& spec, double largest_radius) {
  return spec.force_floor * spec.youngs_modulus * largest_radius * largest_radius;
}

MacroSpec slightly_changed(MacroSpec spec) {
  constexpr double kSlightly = 1.0 + 1e-12;
  spec.strain_end *= kSlightly;
  spec.preload *= kSlightly;
  for (MacroStage& stage : spec.stages) {
    stage.shear *= kSlightly;
    for (AxisDrive& axis : stage.axis)
      if (!axis.by_stress || axis.to_stress()) axis.value *= kSlightly;
  }
  return spec;
}

}  // namespace softgrain

#include "microsim/powder/powder_spec_io.h"

#include "common/data/columns.h"
#include "common/io/attribute_members.h"

namespace softgrain {

namespace {

void fields(auto&& item, Of<PowderSpec> auto& s) {
  item("disks", s.disks);
  item("diameter_min", s.diameter_min);
  item("solid_fraction", s.solid_fraction);
  item("stiffness", s.stiffness);
  item("stiffness_ratio", s.stiffness_ratio);
  item("friction", s.friction);
  item("damping", s.damping);
  item("cohesive", s.cohesive);
  item("range", s.range);
  item("rolling", s.rolling);
  item("rolling_stiffness", s.rolling_stiffness);
  item("rolling_friction", s.rolling_friction);
  item("pressure", s.pressure);
  item("start_speed", s.start_speed);
}

}  // namespace

void write_powder_spec(const h5::Group& group, const PowderSpec& spec) { fields(AttributeWriter{group}, spec); }

PowderSpec read_powder_spec(const h5::Group& group) {
  PowderSpec spec;
  fields(AttributeReader{group}, spec);
  return spec;
}

}  // namespace softgrain

#include "microsim/powder/powder_spec_io.h"

namespace softgrain {

namespace {

/// Calls item(name, member) for each member, the same list for both directions.
template <class Spec, class Item>
void for_members(Spec& s, const Item& item) {
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

struct Writer {
  const h5::Group& group;
  void operator()(const char* name, double value) const { group.attribute(name, value); }
  void operator()(const char* name, std::int64_t value) const { group.attribute(name, value); }
  void operator()(const char* name, bool value) const { group.attribute(name, std::int64_t{value ? 1 : 0}); }
};

struct Reader {
  const h5::Group& group;
  void operator()(const char* name, double& value) const { value = group.number(name); }
  void operator()(const char* name, std::int64_t& value) const { value = group.integer(name); }
  void operator()(const char* name, bool& value) const { value = group.integer(name) != 0; }
};

}  // namespace

void write_powder_spec(const h5::Group& group, const PowderSpec& spec) { for_members(spec, Writer{group}); }

PowderSpec read_powder_spec(const h5::Group& group) {
  PowderSpec spec;
  for_members(spec, Reader{group});
  return spec;
}

}  // namespace softgrain

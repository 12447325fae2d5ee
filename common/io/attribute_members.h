// Members of a struct as attributes of a group, by one list of names for both directions.
#pragma once

#include "common/io/hdf5_file.h"

namespace softgrain {

/// item(name, member) writes the member.
struct AttributeWriter {
  const h5::Group& group;
  void operator()(const char* name, double value) const { group.attribute(name, value); }
  void operator()(const char* name, std::int64_t value) const { group.attribute(name, value); }
  void operator()(const char* name, bool value) const { group.attribute(name, std::int64_t{value ? 1 : 0}); }
};

/// item(name, member) reads it. Throws IoError when it is missing.
struct AttributeReader {
  const h5::Group& group;
  void operator()(const char* name, double& value) const { value = group.number(name); }
  void operator()(const char* name, std::int64_t& value) const { value = group.integer(name); }
  void operator()(const char* name, bool& value) const { value = group.integer(name) != 0; }
};

}  // namespace softgrain

// Attributes: text, numbers, integers.
#include "common/io/hdf5_handle.h"

namespace softgrain::h5 {

namespace {

/// Longer texts go to the global heap of the file; shorter ones sit, with a checksum, in the header of their group.
constexpr std::size_t kLongestInHeader = 60000;

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), size);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

/// Writes one value under `name` at the group or data set `place`, replacing an attribute of that name.
void write_one(const Group::Impl& group, hid_t place, const std::string& name, hid_t stored, hid_t native,
               const void* value) {
  if (H5Aexists(place, name.c_str()) > 0) H5Adelete(place, name.c_str());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute = group.checked(H5Acreate2(place, name.c_str(), stored, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                                         H5Aclose, name, "attribute cannot be created");
  if (H5Awrite(attribute.id(), native, value) < 0) group.fail(name, "attribute cannot be written");
}

void write_text(const Group::Impl& group, hid_t place, const std::string& name, const std::string& value) {
  if (value.size() < kLongestInHeader) {
    const Handle type = text_type(value.size() + 1);
    write_one(group, place, name, type.id(), type.id(), value.c_str());
    return;
  }
  const Handle type = text_type(H5T_VARIABLE);
  const char* text = value.c_str();
  write_one(group, place, name, type.id(), type.id(), static_cast<const void*>(&text));
}

Handle open_attribute(const Group::Impl& group, hid_t place, const std::string& name) {
  return group.checked(H5Aopen(place, name.c_str(), H5P_DEFAULT), H5Aclose, name, "missing attribute");
}

/// A scalar of integer or floating type, converted to `native`.
void read_number(const Group::Impl& group, const std::string& name, hid_t native, bool integer_only, void* value) {
  const Handle attribute = open_attribute(group, group.handle.id(), name);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind != H5T_INTEGER && (integer_only || kind != H5T_FLOAT))
    group.fail(name, "attribute of another type than expected");
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.id()) != 1) group.fail(name, "attribute holds more than one value");
  if (H5Aread(attribute.id(), native, value) < 0) group.fail(name, "damaged attribute");
}

std::string read_variable_text(const Group::Impl& group, const Handle& attribute, const Handle& type,
                               const std::string& name) {
  char* text = nullptr;
  if (H5Aread(attribute.id(), type.id(), static_cast<void*>(&text)) < 0) group.fail(name, "damaged attribute");
  std::string value = text == nullptr ? "" : text;
  H5free_memory(text);
  return value;
}

std::string read_text(const Group::Impl& group, hid_t place, const std::string& name) {
  const Handle attribute = open_attribute(group, place, name);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  if (H5Tget_class(type.id()) != H5T_STRING) group.fail(name, "attribute is not text");
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.id()) != 1) group.fail(name, "attribute holds more than one value");
  if (H5Tis_variable_str(type.id()) > 0) return read_variable_text(group, attribute, type, name);
  std::string value(H5Tget_size(type.id()), '\0');
  if (H5Aread(attribute.id(), type.id(), value.data()) < 0) group.fail(name, "damaged attribute");
  return value.c_str();
}

Handle open_set(const Group::Impl& group, const std::string& name) {
  return group.checked(H5Dopen2(group.handle.id(), name.c_str(), H5P_DEFAULT), H5Dclose, name, "missing data set");
}

}  // namespace

void Group::attribute(const std::string& name, const std::string& value) const {
  write_text(*impl_, impl_->handle.id(), name, value);
}

void Group::attribute(const std::string& name, double value) const {
  write_one(*impl_, impl_->handle.id(), name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Group::attribute(const std::string& name, std::int64_t value) const {
  write_one(*impl_, impl_->handle.id(), name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

void Group::attribute_of(const std::string& data_set, const std::string& name, const std::string& value) const {
  const Handle set = open_set(*impl_, data_set);
  write_text(*impl_, set.id(), name, value);
}

bool Group::has_attribute(const std::string& name) const { return H5Aexists(impl_->handle.id(), name.c_str()) > 0; }

std::string Group::text(const std::string& name) const { return read_text(*impl_, impl_->handle.id(), name); }

std::string Group::text_of(const std::string& data_set, const std::string& name) const {
  const Handle set = open_set(*impl_, data_set);
  return H5Aexists(set.id(), name.c_str()) > 0 ? read_text(*impl_, set.id(), name) : "";
}

double Group::number(const std::string& name) const {
  double value = 0.0;
  read_number(*impl_, name, H5T_NATIVE_DOUBLE, false, &value);
  return value;
}

std::int64_t Group::integer(const std::string& name) const {
  std::int64_t value = 0;
  read_number(*impl_, name, H5T_NATIVE_INT64, true, &value);
  return value;
}

}  // namespace softgrain::h5

// Groups and data sets.
#include <algorithm>
#include <functional>
#include <numeric>

#include "common/io/hdf5_handle.h"

namespace softgrain::h5 {

namespace {

/// Elements per chunk at most: 512 KiB, half of HDF5's chunk cache.
constexpr hsize_t kChunkElements = 65536;

/// Halves the leading extents until a chunk is small enough.
std::vector<hsize_t> chunk_of(std::vector<hsize_t> extents) {
  const auto elements = [&] {
    return std::accumulate(extents.begin(), extents.end(), hsize_t{1}, std::multiplies<>());
  };
  for (hsize_t& extent : extents)
    while (extent > 1 && elements() > kChunkElements) extent = (extent + 1) / 2;
  return extents;
}

/// Chunked with Fletcher-32; an empty set has nothing to check and cannot be chunked.
Handle data_set_properties(const std::vector<hsize_t>& extents) {
  Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (std::find(extents.begin(), extents.end(), hsize_t{0}) != extents.end()) return list;
  const std::vector<hsize_t> chunk = chunk_of(extents);
  H5Pset_chunk(list.id(), static_cast<int>(chunk.size()), chunk.data());
  H5Pset_fletcher32(list.id());
  return list;
}

template <class T>
void write_data(const Group::Impl& group, const std::string& name, std::span<const T> values, const Shape& shape,
                hid_t stored, hid_t native) {
  std::vector<hsize_t> extents(shape.begin(), shape.end());
  if (extents.empty()) extents.push_back(values.size());
  const hsize_t elements = std::accumulate(extents.begin(), extents.end(), hsize_t{1}, std::multiplies<>());
  if (elements != values.size()) group.fail(name, "shape and number of values disagree");
  const Handle space(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), H5Sclose);
  const Handle properties = data_set_properties(extents);
  const Handle set = group.checked(
      H5Dcreate2(group.handle.id(), name.c_str(), stored, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
      H5Dclose, name, "cannot be created");
  if (!values.empty() && H5Dwrite(set.id(), native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    group.fail(name, "cannot be written");
}

Handle open_data(const Group::Impl& group, const std::string& name) {
  return group.checked(H5Dopen2(group.handle.id(), name.c_str(), H5P_DEFAULT), H5Dclose, name,
                       "missing or damaged data set");
}

/// Number of values; a header that promises more than the file stores is damaged.
std::size_t checked_size(const Group::Impl& group, const Handle& set, const std::string& name) {
  const Handle space(H5Dget_space(set.id()), H5Sclose);
  const hssize_t elements = H5Sget_simple_extent_npoints(space.id());
  if (elements < 0 || static_cast<hsize_t>(elements) > H5Dget_storage_size(set.id()))
    group.fail(name, "damaged data set");
  return static_cast<std::size_t>(elements);
}

template <class T>
std::vector<T> read_data(const Group::Impl& group, const std::string& name, hid_t native) {
  const Handle set = open_data(group, name);
  const Handle type(H5Dget_type(set.id()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.id());
  const bool integers = kind == H5T_INTEGER;
  if (!integers && (std::is_integral_v<T> || kind != H5T_FLOAT)) group.fail(name, "holds another type than expected");
  std::vector<T> values(checked_size(group, set, name));
  if (!values.empty() && H5Dread(set.id(), native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    group.fail(name, "damaged data set");
  return values;
}

Group child(const std::shared_ptr<Group::Impl>& parent, const std::string& name, Handle handle) {
  return Group(std::make_shared<Group::Impl>(Group::Impl{parent->file, std::move(handle), parent->name + "/" + name}));
}

}  // namespace

Group Group::create(const std::string& name) const {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_link_creation_order(properties.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const hid_t id = H5Gcreate2(impl_->handle.id(), name.c_str(), H5P_DEFAULT, properties.id(), H5P_DEFAULT);
  return child(impl_, name, impl_->checked(id, H5Gclose, name, "group cannot be created"));
}

Group Group::open(const std::string& name) const {
  const hid_t id = H5Gopen2(impl_->handle.id(), name.c_str(), H5P_DEFAULT);
  return child(impl_, name, impl_->checked(id, H5Gclose, name, "missing or damaged group"));
}

bool Group::has(const std::string& name) const {
  const htri_t found = H5Lexists(impl_->handle.id(), name.c_str(), H5P_DEFAULT);
  H5Eclear2(H5E_DEFAULT);
  return found > 0;
}

bool Group::has_group(const std::string& name) const {
  if (!has(name)) return false;
  const Handle object(H5Oopen(impl_->handle.id(), name.c_str(), H5P_DEFAULT), H5Oclose);
  H5Eclear2(H5E_DEFAULT);  // a link may lead nowhere
  return object.id() >= 0 && H5Iget_type(object.id()) == H5I_GROUP;
}

void Group::refuse(const std::string& name, const std::string& problem) const {
  H5Eclear2(H5E_DEFAULT);
  impl_->fail(name, problem);
}

std::vector<std::string> Group::children() const {
  H5G_info_t info;
  if (H5Gget_info(impl_->handle.id(), &info) < 0) impl_->fail("", "damaged group");
  std::vector<std::string> names;
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    H5_index_t order = H5_INDEX_CRT_ORDER;  // files of other programs may not track it
    const auto fetch = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(impl_->handle.id(), ".", order, H5_ITER_INC, k, text, size, H5P_DEFAULT);
    };
    if (fetch(nullptr, 0) < 0) order = H5_INDEX_NAME;
    const ssize_t length = fetch(nullptr, 0);
    if (length < 0) impl_->fail("", "damaged group");
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    if (fetch(name.data(), name.size()) < 0) impl_->fail("", "damaged group");
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

void Group::write(const std::string& name, std::span<const double> values, const Shape& shape) const {
  write_data(*impl_, name, values, shape, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE);
}

void Group::write(const std::string& name, std::span<const std::int64_t> values, const Shape& shape) const {
  write_data(*impl_, name, values, shape, H5T_STD_I64LE, H5T_NATIVE_INT64);
}

std::vector<double> Group::doubles(const std::string& name) const {
  return read_data<double>(*impl_, name, H5T_NATIVE_DOUBLE);
}

std::vector<std::int64_t> Group::integers(const std::string& name) const {
  return read_data<std::int64_t>(*impl_, name, H5T_NATIVE_INT64);
}

Shape Group::shape(const std::string& name) const {
  const Handle set = open_data(*impl_, name);
  const Handle space(H5Dget_space(set.id()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.id());
  if (rank < 0) impl_->fail(name, "damaged data set");
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr);
  return {extents.begin(), extents.end()};
}

}  // namespace softgrain::h5

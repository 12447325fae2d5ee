// Everything an HDF5 file holds, attributes included, as bytes by name: for comparing two files.
#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace softgrain::test {

/// "/group/set" or "/group@attribute" to type, shape and bytes as they are stored.
using Hdf5Contents = std::map<std::string, std::string>;

namespace hdf5 {

inline std::string shape_of(hid_t space) {
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
  H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  std::string text = "[";
  for (const hsize_t n : extents) text += std::to_string(n) + " ";
  return text + "] ";
}

/// `read(type, buffer)` of a data set or an attribute.
template <class Read>
std::string value_of(hid_t type, hid_t space, const Read& read) {
  const std::string head = std::to_string(H5Tget_class(type)) + " " + shape_of(space);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count < 0) return head + "unreadable";
  const auto elements = static_cast<std::size_t>(count);
  if (elements == 0) return head;
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    if (read(type, &text) < 0) return head + "unreadable";
    const std::string value = text == nullptr ? "" : text;
    H5free_memory(text);
    return head + value;
  }
  constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // more than any file of the tests holds: damaged
  if (elements > kMostBytes / std::max<std::size_t>(H5Tget_size(type), 1)) return head + "unreadable";
  std::string bytes(elements * H5Tget_size(type), '\0');
  return read(type, bytes.data()) < 0 ? head + "unreadable" : head + bytes;
}

inline void add_attributes(hid_t object, const std::string& name, Hdf5Contents& out) {
  H5O_info_t info;
  H5Oget_info(object, &info);
  for (hsize_t k = 0; k < info.num_attrs; ++k) {
    const hid_t a = H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, k, H5P_DEFAULT, H5P_DEFAULT);
    const ssize_t length = H5Aget_name(a, 0, nullptr);
    if (length < 0) {
      out[name + "@" + std::to_string(k)] = "unreadable";
      continue;
    }
    std::string key(static_cast<std::size_t>(length) + 1, '\0');
    H5Aget_name(a, key.size(), key.data());
    key.pop_back();
    const hid_t type = H5Aget_type(a);
    const hid_t space = H5Aget_space(a);
    out[name + "@" + key] = value_of(type, space, [a](hid_t t, void* to) { return H5Aread(a, t, to); });
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(a);
  }
}

inline void add_group(hid_t group, const std::string& name, Hdf5Contents& out);

inline void add_object(hid_t object, const std::string& name, Hdf5Contents& out) {
  add_attributes(object, name, out);
  if (H5Iget_type(object) == H5I_GROUP) return add_group(object, name, out);
  const hid_t type = H5Dget_type(object);
  const hid_t space = H5Dget_space(object);
  out[name] = value_of(type, space,
                       [object](hid_t t, void* to) { return H5Dread(object, t, H5S_ALL, H5S_ALL, H5P_DEFAULT, to); });
  H5Sclose(space);
  H5Tclose(type);
}

inline void add_group(hid_t group, const std::string& name, Hdf5Contents& out) {
  H5G_info_t info;
  H5Gget_info(group, &info);
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    const auto fetch = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, k, text, size, H5P_DEFAULT);
    };
    std::string child(static_cast<std::size_t>(fetch(nullptr, 0)) + 1, '\0');
    fetch(child.data(), child.size());
    child.pop_back();
    const hid_t object = H5Oopen(group, child.c_str(), H5P_DEFAULT);
    add_object(object, name + "/" + child, out);
    H5Oclose(object);
  }
}

}  // namespace hdf5

/// Fails the running test when the file cannot be opened.
inline Hdf5Contents hdf5_contents(const std::string& path) {
  Hdf5Contents out;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(file, 0) << path << " cannot be opened";
  if (file < 0) return out;
  const hid_t root = H5Gopen2(file, "/", H5P_DEFAULT);
  hdf5::add_object(root, "", out);
  H5Gclose(root);
  H5Fclose(file);
  return out;
}

}  // namespace softgrain::test

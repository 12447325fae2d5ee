// Changes to finished HDF5 files that leave every checksum right: what a broken writer, or a person with h5py, makes.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <string>
#include <vector>

namespace softgrain::test {

/// An HDF5 file open for changes; wrong names are ignored, so that edits may be tried blindly. Attributes of a data set
/// that is changed stay; shapes stay where the number of values does.
class Hdf5Edit {
 public:
  explicit Hdf5Edit(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    file_ = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
    H5Pclose(access);
  }
  ~Hdf5Edit() { H5Fclose(file_); }
  Hdf5Edit(const Hdf5Edit&) = delete;
  Hdf5Edit& operator=(const Hdf5Edit&) = delete;

  [[nodiscard]] bool good() const { return file_ >= 0; }

  /// Paths of all groups and data sets below the root, by name.
  [[nodiscard]] std::vector<std::string> items() const {
    std::vector<std::string> out;
    H5Ovisit2(file_, H5_INDEX_NAME, H5_ITER_INC, note_name, &out, H5O_INFO_BASIC);
    std::erase(out, ".");
    return out;
  }
  /// Names of the attributes of a group or data set ("/" the root).
  [[nodiscard]] std::vector<std::string> attributes(const std::string& item) const {
    std::vector<std::string> out;
    hsize_t at = 0;
    const hid_t object = H5Oopen(file_, item.c_str(), H5P_DEFAULT);
    H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &at, note_attribute, &out);
    H5Oclose(object);
    return out;
  }

  void remove(const std::string& item) { H5Ldelete(file_, item.c_str(), H5P_DEFAULT); }

  /// A data set instead of what was there.
  void replace(const std::string& item, const std::vector<double>& values) {
    write(item, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), values.size());
  }
  void replace(const std::string& item, const std::vector<long long>& values) {
    write(item, H5T_STD_I64LE, H5T_NATIVE_LLONG, values.data(), values.size());
  }
  /// The numbers of a data set; empty when it is none.
  [[nodiscard]] std::vector<double> numbers(const std::string& item) const {
    const hid_t set = H5Dopen2(file_, item.c_str(), H5P_DEFAULT);
    if (set < 0) return {};
    const hid_t space = H5Dget_space(set);
    std::vector<double> out(static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0)));
    if (!out.empty()) H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
    H5Sclose(space);
    H5Dclose(set);
    return out;
  }
  [[nodiscard]] bool holds_integers(const std::string& item) const {
    const hid_t set = H5Dopen2(file_, item.c_str(), H5P_DEFAULT);
    if (set < 0) return false;
    const hid_t type = H5Dget_type(set);
    const bool integers = H5Tget_class(type) == H5T_INTEGER;
    H5Tclose(type);
    H5Dclose(set);
    return integers;
  }
  /// Another number at one place of a data set, whose type stays.
  void set(const std::string& item, std::size_t place, double value) {
    const bool integers = holds_integers(item);
    std::vector<double> all = numbers(item);
    if (place >= all.size()) return;
    const double whole = value > -9e18 && value < 9e18 ? value : 0.0;
    all[place] = integers ? whole : value;
    if (!integers) return replace(item, all);
    std::vector<long long> counts;
    for (const double x : all) counts.push_back(static_cast<long long>(x));
    replace(item, counts);
  }
  /// The first `length` numbers of a data set, zeros behind its end.
  void resize(const std::string& item, std::size_t length) {
    const bool integers = holds_integers(item);
    std::vector<double> all = numbers(item);
    all.resize(length);
    if (integers)
      replace(item, std::vector<long long>(all.begin(), all.end()));
    else
      replace(item, all);
  }

  void remove_attribute(const std::string& item, const std::string& name) {
    H5Adelete_by_name(file_, item.c_str(), name.c_str(), H5P_DEFAULT);
  }
  void set_attribute(const std::string& item, const std::string& name, double value) {
    attribute(item, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
  }
  void set_attribute(const std::string& item, const std::string& name, long long value) {
    attribute(item, name, H5T_STD_I64LE, H5T_NATIVE_LLONG, &value);
  }
  void set_attribute(const std::string& item, const std::string& name, const std::string& value) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, value.size() + 1);
    attribute(item, name, type, type, value.c_str());
    H5Tclose(type);
  }

 private:
  static herr_t note_name(hid_t, const char* name, const H5O_info_t*, void* out) {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  }
  static herr_t note_attribute(hid_t, const char* name, const H5A_info_t*, void* out) {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  }
  struct Attribute {
    std::string name;
    hid_t type = -1;
    hid_t space = -1;
    std::vector<char> bytes;
  };
  /// Attributes of fixed size of a data set; empty when it is none.
  [[nodiscard]] std::vector<Attribute> kept_attributes(const std::string& item) const {
    std::vector<Attribute> out;
    const hid_t set = H5Dopen2(file_, item.c_str(), H5P_DEFAULT);
    if (set < 0) return out;
    for (const std::string& name : attributes(item)) {
      const hid_t a = H5Aopen(set, name.c_str(), H5P_DEFAULT);
      Attribute one{name, H5Aget_type(a), H5Aget_space(a), std::vector<char>(H5Aget_storage_size(a))};
      H5Aread(a, one.type, one.bytes.data());
      H5Aclose(a);
      out.push_back(std::move(one));
    }
    H5Dclose(set);
    return out;
  }
  [[nodiscard]] std::vector<hsize_t> shape_of(const std::string& item) const {
    const hid_t set = H5Dopen2(file_, item.c_str(), H5P_DEFAULT);
    if (set < 0) return {};
    const hid_t space = H5Dget_space(set);
    std::vector<hsize_t> out(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
    H5Sget_simple_extent_dims(space, out.data(), nullptr);
    H5Sclose(space);
    H5Dclose(set);
    return out;
  }
  void write(const std::string& item, hid_t stored, hid_t native, const void* values, hsize_t count) {
    std::vector<hsize_t> shape = shape_of(item);
    hsize_t there = 1;
    for (const hsize_t n : shape) there *= n;
    if (shape.empty() || there != count) shape = {count};
    const std::vector<Attribute> kept = kept_attributes(item);
    remove(item);
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t set = H5Dcreate2(file_, item.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (set >= 0 && count > 0) H5Dwrite(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    for (const Attribute& a : kept) {
      const hid_t made = H5Acreate2(set, a.name.c_str(), a.type, a.space, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(made, a.type, a.bytes.data());
      H5Aclose(made);
      H5Tclose(a.type);
      H5Sclose(a.space);
    }
    H5Dclose(set);
    H5Sclose(space);
  }
  void attribute(const std::string& item, const std::string& name, hid_t stored, hid_t native, const void* value) {
    remove_attribute(item, name);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t made =
        H5Acreate_by_name(file_, item.c_str(), name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(made, native, value);
    H5Aclose(made);
    H5Sclose(space);
  }

  hid_t file_ = -1;
};

}  // namespace softgrain::test

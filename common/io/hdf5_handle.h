// Inner side of hdf5_file.h: handles that close themselves and errors as exceptions. For the sources of common/io only.
// The HDF5 library is not safe for several threads at once; neither is anything here.
#pragma once

#include <hdf5.h>

#include <memory>
#include <string>
#include <utility>

#include "common/io/hdf5_file.h"

namespace softgrain::h5 {

/// Closes an HDF5 identifier with the function that belongs to its kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  [[nodiscard]] hid_t id() const { return id_; }
  /// Closes now; false when HDF5 reports trouble (data may not have reached the disk).
  bool close() { return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }

 private:
  hid_t id_;
  Close close_;
};

/// An open file; groups hold it so that it outlives them.
struct File {
  Handle handle;
  std::string path;  ///< file path as shown in messages
};

struct Group::Impl {
  std::shared_ptr<File> file;
  Handle handle;
  std::string name;  ///< "/a/b", for messages; empty for the root

  /// Throws IoError: "path: /group/item: problem (what HDF5 says)".
  [[noreturn]] void fail(const std::string& item, const std::string& problem) const;
  /// Returns a valid identifier as a handle, else fails.
  [[nodiscard]] Handle checked(hid_t id, Handle::Close close, const std::string& item,
                               const std::string& problem) const;
};

/// The innermost message on the error stack of HDF5, in brackets; empty without one. Clears the stack.
std::string library_message();

/// Keeps HDF5 from printing to standard error; called before the first use of the library.
void silence_library();

/// The root group of an open file.
Group root_of(std::shared_ptr<File> file);

}  // namespace softgrain::h5

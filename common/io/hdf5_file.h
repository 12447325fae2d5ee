// The HDF5 C API behind one small RAII surface: groups, arrays of double/int64, attributes. Errors are IoError with
// the path.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "common/core/error.h"

namespace softgrain::h5 {

using Shape = std::vector<std::size_t>;

/// The library serves one thread at a time: tasks that run side by side hold this lock around all use of it.
std::mutex& library_mutex();

/// A group inside an open file. Cheap to copy; keeps the file open.
class Group {
 public:
  struct Impl;
  explicit Group(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

  [[nodiscard]] Group create(const std::string& name) const;    ///< new child group
  [[nodiscard]] Group open(const std::string& name) const;      ///< existing child group
  [[nodiscard]] bool has(const std::string& name) const;        ///< child group or data set
  [[nodiscard]] bool has_group(const std::string& name) const;  ///< child group, not a data set
  [[nodiscard]] std::vector<std::string> children() const;      ///< names of the children in order of creation

  /// Data sets; an empty shape means one-dimensional. Stored with a Fletcher-32 checksum so that damage is found.
  void write(const std::string& name, std::span<const double> values, const Shape& shape = {}) const;
  void write(const std::string& name, std::span<const std::int64_t> values, const Shape& shape = {}) const;
  [[nodiscard]] std::vector<double> doubles(const std::string& name) const;
  [[nodiscard]] std::vector<std::int64_t> integers(const std::string& name) const;
  [[nodiscard]] Shape shape(const std::string& name) const;

  /// Attributes of this group.
  void attribute(const std::string& name, const std::string& value) const;
  void attribute(const std::string& name, const char* value) const { attribute(name, std::string(value)); }
  void attribute(const std::string& name, double value) const;
  void attribute(const std::string& name, std::int64_t value) const;
  /// Attribute of a data set of this group (units mostly).
  void attribute_of(const std::string& data_set, const std::string& name, const std::string& value) const;
  /// Reads it back; empty when the data set has no such attribute.
  [[nodiscard]] std::string text_of(const std::string& data_set, const std::string& name) const;
  [[nodiscard]] bool has_attribute(const std::string& name) const;
  [[nodiscard]] std::string text(const std::string& name) const;
  [[nodiscard]] double number(const std::string& name) const;
  [[nodiscard]] std::int64_t integer(const std::string& name) const;

  /// Throws IoError for a child or attribute that is not what it must be: "path: /group/name: problem".
  [[noreturn]] void refuse(const std::string& name, const std::string& problem) const;

 private:
  std::shared_ptr<Impl> impl_;
};

/// Opens an existing file for reading. Throws IoError (missing, not HDF5, truncated).
Group open_file(const std::string& path);

/// What `read()` returns; every IoError of it names the file.
template <class Read>
decltype(auto) naming_file(const std::string& path, const Read& read) {
  try {
    return read();
  } catch (const IoError& e) {
    const std::string said = e.what();
    if (said.find(path) != std::string::npos) throw;
    throw IoError(path + ": " + said);
  }
}

/// A file that appears under its name only when complete: written to `path + ".tmp"`, flushed to disk, renamed by
/// commit(). Destruction without commit() removes the temporary file.
class AtomicFile {
 public:
  /// keep_previous: the old file stays as path + ".previous"; sealed: with a checksum over all of it (file_safety.h).
  explicit AtomicFile(const std::string& path, bool keep_previous = false, bool sealed = false);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] Group root() const;
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softgrain::h5

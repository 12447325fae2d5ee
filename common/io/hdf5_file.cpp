// Files: opening, and the atomic file.
#include "common/io/hdf5_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "common/core/error.h"
#include "common/io/file_safety.h"
#include "common/io/hdf5_handle.h"
#include "common/io/text_file.h"

namespace softgrain::h5 {

namespace {

namespace fs = std::filesystem;

extern "C" herr_t softgrain_note_error(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

constexpr const char* kHeldElsewhere =
    ": another program holds this file open (a viewer, a notebook, a run that is still going): close it there, or "
    "wait, and try again";

/// Whether another program has locked a file against reading, as the library does while it writes.
bool is_held_elsewhere(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool held = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return held;
}

/// Locks are taken where the file system knows them. The format of HDF5 1.10: small, checksummed headers, and no index
/// of 2 kB for every data set of one chunk.
Handle access_list() {
  Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(list.id(), true, true);
  H5Pset_libver_bounds(list.id(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  return list;
}

/// Creates a file for writing. Closing it closes every group that is still around, so that the file is complete on
/// disk.
Handle create_file(const std::string& path) {
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const Handle access = access_list();
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose);
  if (file.id() < 0) {
    const std::string reason = library_message();
    throw IoError(path + (is_held_elsewhere(path) ? kHeldElsewhere : ": cannot be created") + reason);
  }
  return file;
}

}  // namespace

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::string library_message() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, softgrain_note_error, &text);
  H5Eclear2(H5E_DEFAULT);
  // Of the system's errors HDF5 tells time, addresses and sizes over several lines; what matters is the system's word.
  const std::string key = "error message = '";
  if (const std::size_t begin = text.find(key); begin != std::string::npos) {
    const std::size_t end = text.find('\'', begin + key.size());
    text = text.substr(begin + key.size(), end == std::string::npos ? end : end - begin - key.size());
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? text : " (" + text + ")";
}

void silence_library() {
  // A file that could not be closed for want of room stays open in the library, which trips over it when it closes all
  // at the end of the process. There is nothing left to close then: what is committed has been closed.
  static const bool left_alone = H5dont_atexit() >= 0;
  (void)left_alone;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

void Group::Impl::fail(const std::string& item, const std::string& problem) const {
  throw IoError(file->path + ": " + name + "/" + item + ": " + problem + library_message());
}

Handle Group::Impl::checked(hid_t id, Handle::Close close, const std::string& item, const std::string& problem) const {
  if (id < 0) fail(item, problem);
  return {id, close};
}

Group root_of(std::shared_ptr<File> file) {
  Handle root(H5Gopen2(file->handle.id(), "/", H5P_DEFAULT), H5Gclose);
  if (root.id() < 0) throw IoError(file->path + ": damaged, no root group" + library_message());
  return Group(std::make_shared<Group::Impl>(Group::Impl{std::move(file), std::move(root), ""}));
}

Group open_file(const std::string& path) {
  silence_library();
  require_readable_file(path);
  const Handle access = access_list();
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (file.id() < 0) {
    const std::string reason = library_message();
    throw IoError(path +
                  (is_held_elsewhere(path) ? kHeldElsewhere : ": cannot be read as HDF5, is it damaged or cut short?") +
                  reason);
  }
  return root_of(std::make_shared<File>(File{std::move(file), path}));
}

struct AtomicFile::Impl {
  std::string path;
  bool keep_previous;
  bool sealed;
  bool committed = false;
  std::shared_ptr<File> file;
};

AtomicFile::AtomicFile(const std::string& path, bool keep_previous, bool sealed)
    : impl_(std::make_unique<Impl>(Impl{path, keep_previous, sealed, false, nullptr})) {
  silence_library();
  require_folder_of(path);
  impl_->file = std::make_shared<File>(File{create_file(temporary_name(path)), path});
}

AtomicFile::~AtomicFile() {
  if (impl_->committed) return;
  if (impl_->file->handle.id() >= 0) impl_->file->handle.close();
  std::error_code ignored;
  fs::remove(temporary_name(impl_->path), ignored);
}

Group AtomicFile::root() const { return root_of(impl_->file); }

void AtomicFile::commit() {
  if (impl_->committed) throw IoError(impl_->path + ": already committed");
  Handle& handle = impl_->file->handle;
  const bool flushed = H5Fflush(handle.id(), H5F_SCOPE_GLOBAL) >= 0;
  std::string reason = library_message();
  const bool closed = handle.close();
  if (reason.empty()) reason = library_message();
  if (!flushed || !closed) throw IoError(impl_->path + ": cannot be written" + reason);
  if (impl_->sealed) seal_file(temporary_name(impl_->path));
  rename_into_place(impl_->path, impl_->keep_previous);
  impl_->committed = true;
}

}  // namespace softgrain::h5

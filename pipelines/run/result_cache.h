// Results that later runs need not compute again: one small file each, named by a hash of what determines it.
#pragma once

#include <functional>
#include <string>

#include "common/io/hdf5_file.h"

namespace softgrain {

class ResultCache {
 public:
  /// `directory` empty: nothing is ever found or kept. `format` of the files, whose names begin with `prefix`; `again`:
  /// what is said to happen in place of a file that is ignored ("measured again"). `say` takes remarks.
  ResultCache(std::string directory, std::string format, std::string prefix, std::string again,
              std::function<void(const std::string&)> say)
      : directory_(std::move(directory)),
        format_(std::move(format)),
        prefix_(std::move(prefix)),
        again_(std::move(again)),
        say_(std::move(say)) {}

  /// Calls `read` with what is kept of this key, the whole text of what determines the result. A file that is damaged
  /// or belongs to another key is ignored, with a remark. Returns whether it was read.
  bool find(const std::string& key, const std::function<void(const h5::Group&)>& read) const;
  /// Atomic, also among several processes. Throws IoError.
  void keep(const std::string& key, const std::function<void(const h5::Group&)>& write) const;

  /// `prefix`, "-" and 16 hexadecimal digits (FNV-1a, 64 bits) of a key.
  static std::string name(const std::string& prefix, const std::string& key);

 private:
  [[nodiscard]] std::string file(const std::string& key) const { return directory_ + "/" + name(prefix_, key) + ".h5"; }

  std::string directory_, format_, prefix_, again_;
  std::function<void(const std::string&)> say_;
};

}  // namespace softgrain

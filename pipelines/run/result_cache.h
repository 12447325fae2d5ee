// Results that later runs need not compute again: one small file each, named by a hash of what determines it. Their
// keys are the text of every member of all that determines a result: a member that is added to such a record is part of
// the key, or does not compile, until somebody says that it changes nothing.
#pragma once

#include <fmt/format.h>

#include <array>
#include <concepts>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/material.h"
#include "common/core/vec.h"
#include "common/io/hdf5_file.h"
#include "common/packing/grading.h"

/// every_member(value): references to all members of TYPE, which are named in their order. The list is bound to the
/// whole of the record: with a member more or less it does not compile.
#define SOFTGRAIN_EVERY_MEMBER(TYPE, ...)   \
  auto every_member(Of<TYPE> auto& whole) { \
    auto& [__VA_ARGS__] = whole;            \
    return std::tie(__VA_ARGS__);           \
  }

namespace softgrain {

/// How results of one kind are kept, in a file of their own or among the tasks of a run.
template <class T>
struct KeptForm {
  std::string format;                       ///< of shared files
  std::string prefix;                       ///< their names begin with it
  std::string again;                        ///< said to happen in place of a file that is ignored
  std::function<T(const h5::Group&)> read;  ///< throws IoError for what is none
  std::function<void(const h5::Group&, const T&)> write;
  bool (*worth)(const T&) = [](const T&) { return true; };  ///< whether it is kept for later runs
};

/// Files in a directory that runs share; none where it is empty: nothing is ever found or kept. `say` takes remarks.
class SharedResults {
 public:
  SharedResults(std::string directory, std::function<void(const std::string&)> say)
      : directory_(std::move(directory)), say_(std::move(say)) {}

  /// What is kept of this key, the whole text of what determines the result. A file that is damaged or belongs to
  /// another key is ignored, with a remark.
  template <class T>
  [[nodiscard]] std::optional<T> find(const KeptForm<T>& form, const std::string& key) const {
    std::optional<T> found;
    read(form.format, name(form.prefix, key), key, form.again, [&](const h5::Group& g) { found = form.read(g); });
    return found;
  }
  /// Atomic, also among several processes; what is not worth it is not kept. Throws IoError.
  template <class T>
  void keep(const KeptForm<T>& form, const std::string& key, const T& result) const {
    if (!form.worth(result)) return;
    write(form.format, name(form.prefix, key), key, [&](const h5::Group& g) { form.write(g, result); });
  }

  /// `prefix`, "-" and 16 hexadecimal digits (FNV-1a, 64 bits) of a key.
  static std::string name(const std::string& prefix, const std::string& key);

 private:
  void read(const std::string& format, const std::string& file, const std::string& key, const std::string& again,
            const std::function<void(const h5::Group&)>& content) const;
  void write(const std::string& format, const std::string& file, const std::string& key,
             const std::function<void(const h5::Group&)>& content) const;

  std::string directory_;
  std::function<void(const std::string&)> say_;
};

SOFTGRAIN_EVERY_MEMBER(GrainMaterial, name, youngs_modulus, poisson_ratio, friction, density)
SOFTGRAIN_EVERY_MEMBER(GrainMaterials, each)

template <class T>
concept HasEveryMember = requires(const T& value) {
  every_member(value);
};

/// Texts of different values are different, numbers to the last bit; long texts up to a 64-bit hash.
class KeyText {
 public:
  template <class... T>
  explicit KeyText(const T&... values) {
    (add(values), ...);
  }

  KeyText& add(const std::string& value);
  KeyText& add(const char* value) { return add(std::string(value)); }
  KeyText& add(const Grading& value) { return add(value.text()); }
  /// Nothing where all grains are alike: keys are what they were when grains were always so.
  KeyText& add(const GrainMaterials& value) { return value.empty() ? *this : add(value.each); }

  template <class T>
  requires std::is_arithmetic_v<T> KeyText& add(T value) {
    if constexpr (std::is_floating_point_v<T>)
      return append(fmt::format("{:.17g}", value));
    else
      return append(fmt::format("{}", value));
  }
  template <class T>
  requires std::is_enum_v<T> KeyText& add(T value) {
    if constexpr (NamedEnum<T>)
      return append(to_string(value));
    else
      return add(static_cast<std::underlying_type_t<T>>(value));
  }
  template <class T>
  KeyText& add(const std::optional<T>& value) {
    return value ? append("some").add(*value) : append("none");
  }
  template <class T>
  KeyText& add(const std::vector<T>& values) {
    append(fmt::format("[{}", values.size()));
    for (const T& value : values) add(value);
    return append("]");
  }
  template <class T, std::size_t kCount>
  KeyText& add(const std::array<T, kCount>& values) {
    for (const T& value : values) add(value);
    return *this;
  }
  template <int D>
  KeyText& add(const Vec<D>& value) {
    return add(value.v);
  }
  template <HasEveryMember T>
  KeyText& add(const T& record) {
    append("{");
    std::apply([this](const auto&... members) { (add(members), ...); }, every_member(record));
    return append("}\n");
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  KeyText& append(const std::string& word) {
    text_ += word;
    text_ += ' ';
    return *this;
  }

  std::string text_;
};

}  // namespace softgrain

// The members of a record as summaries have them, with meaning and unit, for people: what its fields() says (Means).
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/io/json_record.h"

namespace softgrain {

struct RecordMember {
  std::string path;     ///< "levels[].law.status"; NAME: key of a map
  std::string meaning;  ///< empty: its binding says none
  std::string unit;     ///< empty: a text, a choice, an object
  bool number = false;  ///< a number, or a list of numbers
};

namespace record_members {

/// What a member holds below lists, maps and optionals.
template <class T>
struct Inner {
  using type = T;
  static constexpr const char* path = "";
};
template <class T>
requires is_optional<T>
struct Inner<T> : Inner<typename T::value_type> {
};
template <class T>
requires(json_record::is_list<T> || json_record::is_array<T>) struct Inner<T> {
  using type = typename Inner<typename T::value_type>::type;
  static constexpr const char* path = "[]";
};
template <class T>
requires json_record::is_map<T>
struct Inner<T> {
  using type = typename Inner<typename T::mapped_type>::type;
  static constexpr const char* path = json_record::is_list<typename T::mapped_type> ? ".NAME[]" : ".NAME";
};

template <class Record>
void collect(const std::string& before, std::vector<RecordMember>& out);

/// For fields(): adds the members of one record and, below them, those of records in them.
struct Collector {
  static constexpr bool kDescribes = true;
  const std::string& before;
  std::vector<RecordMember>& out;

  void take(RecordMember& m, const Means& means) const {
    m.meaning = means.text;
    if (*means.unit != '\0') m.unit = means.unit;
  }
  void take(RecordMember& m, const char* unit) const { m.unit = unit; }
  void take(RecordMember&, const auto&) const {}

  template <class Member>
  void operator()(const std::string& name, Member&&, const auto&... options) const {
    using In = Inner<std::remove_cvref_t<Member>>;
    using Value = typename In::type;
    RecordMember m{before + name, "", "", std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>};
    (take(m, options), ...);
    if (std::ranges::find(out, m.path, &RecordMember::path) != out.end()) return;
    const std::string path = m.path + In::path;
    out.push_back(std::move(m));
    if constexpr (Fielded<const Value> || Fielded<Value>) collect<Value>(path + ".", out);
  }
};

template <class Record>
void collect(const std::string& before, std::vector<RecordMember>& out) {
  const Collector collector{before, out};
  Record record{};
  if constexpr (Fielded<const Record>) fields(collector, std::as_const(record));
  if constexpr (Fielded<Record>) fields(collector, record);  // what is read alone
}

}  // namespace record_members

/// All members, records within records after the member that holds them.
template <class Record>
std::vector<RecordMember> members_of() {
  std::vector<RecordMember> out;
  record_members::collect<Record>("", out);
  return out;
}

}  // namespace softgrain

// All members of a value as text, whatever struct it is: equal texts, equal values. Members are found by the compiler,
// so that a new one takes part by itself.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "common/core/monotone_curve.h"
#include "common/packing/grading.h"
#include "common/system.h"

namespace softgrain::test {

namespace fingerprint {

struct Anything {
  template <class T>
  operator T() const noexcept {  // NOLINT(google-explicit-constructor): never called
    std::abort();
  }
};

template <class T, std::size_t... kIndex>
constexpr bool made_of(std::index_sequence<kIndex...>) {
  return requires { T{((void)kIndex, Anything{})...}; };
}

constexpr std::size_t kMostMembers = 56;

/// Number of members of a struct without constructors.
template <class T, std::size_t kMost = kMostMembers>
constexpr std::size_t members() {
  if constexpr (made_of<T>(std::make_index_sequence<kMost>{}))
    return kMost;
  else if constexpr (kMost == 0)
    return 0;
  else
    return members<T, kMost - 1>();
}

#define SOFTGRAIN_MEMBERS_1 a1
#define SOFTGRAIN_MEMBERS_2 SOFTGRAIN_MEMBERS_1, a2
#define SOFTGRAIN_MEMBERS_3 SOFTGRAIN_MEMBERS_2, a3
#define SOFTGRAIN_MEMBERS_4 SOFTGRAIN_MEMBERS_3, a4
#define SOFTGRAIN_MEMBERS_5 SOFTGRAIN_MEMBERS_4, a5
#define SOFTGRAIN_MEMBERS_6 SOFTGRAIN_MEMBERS_5, a6
#define SOFTGRAIN_MEMBERS_7 SOFTGRAIN_MEMBERS_6, a7
#define SOFTGRAIN_MEMBERS_8 SOFTGRAIN_MEMBERS_7, a8
#define SOFTGRAIN_MEMBERS_9 SOFTGRAIN_MEMBERS_8, a9
#define SOFTGRAIN_MEMBERS_10 SOFTGRAIN_MEMBERS_9, a10
#define SOFTGRAIN_MEMBERS_11 SOFTGRAIN_MEMBERS_10, a11
#define SOFTGRAIN_MEMBERS_12 SOFTGRAIN_MEMBERS_11, a12
#define SOFTGRAIN_MEMBERS_13 SOFTGRAIN_MEMBERS_12, a13
#define SOFTGRAIN_MEMBERS_14 SOFTGRAIN_MEMBERS_13, a14
#define SOFTGRAIN_MEMBERS_15 SOFTGRAIN_MEMBERS_14, a15
#define SOFTGRAIN_MEMBERS_16 SOFTGRAIN_MEMBERS_15, a16
#define SOFTGRAIN_MEMBERS_17 SOFTGRAIN_MEMBERS_16, a17
#define SOFTGRAIN_MEMBERS_18 SOFTGRAIN_MEMBERS_17, a18
#define SOFTGRAIN_MEMBERS_19 SOFTGRAIN_MEMBERS_18, a19
#define SOFTGRAIN_MEMBERS_20 SOFTGRAIN_MEMBERS_19, a20
#define SOFTGRAIN_MEMBERS_21 SOFTGRAIN_MEMBERS_20, a21
#define SOFTGRAIN_MEMBERS_22 SOFTGRAIN_MEMBERS_21, a22
#define SOFTGRAIN_MEMBERS_23 SOFTGRAIN_MEMBERS_22, a23
#define SOFTGRAIN_MEMBERS_24 SOFTGRAIN_MEMBERS_23, a24
#define SOFTGRAIN_MEMBERS_25 SOFTGRAIN_MEMBERS_24, a25
#define SOFTGRAIN_MEMBERS_26 SOFTGRAIN_MEMBERS_25, a26
#define SOFTGRAIN_MEMBERS_27 SOFTGRAIN_MEMBERS_26, a27
#define SOFTGRAIN_MEMBERS_28 SOFTGRAIN_MEMBERS_27, a28
#define SOFTGRAIN_MEMBERS_29 SOFTGRAIN_MEMBERS_28, a29
#define SOFTGRAIN_MEMBERS_30 SOFTGRAIN_MEMBERS_29, a30
#define SOFTGRAIN_MEMBERS_31 SOFTGRAIN_MEMBERS_30, a31
#define SOFTGRAIN_MEMBERS_32 SOFTGRAIN_MEMBERS_31, a32
#define SOFTGRAIN_MEMBERS_33 SOFTGRAIN_MEMBERS_32, a33
#define SOFTGRAIN_MEMBERS_34 SOFTGRAIN_MEMBERS_33, a34
#define SOFTGRAIN_MEMBERS_35 SOFTGRAIN_MEMBERS_34, a35
#define SOFTGRAIN_MEMBERS_36 SOFTGRAIN_MEMBERS_35, a36
#define SOFTGRAIN_MEMBERS_37 SOFTGRAIN_MEMBERS_36, a37
#define SOFTGRAIN_MEMBERS_38 SOFTGRAIN_MEMBERS_37, a38
#define SOFTGRAIN_MEMBERS_39 SOFTGRAIN_MEMBERS_38, a39
#define SOFTGRAIN_MEMBERS_40 SOFTGRAIN_MEMBERS_39, a40
#define SOFTGRAIN_MEMBERS_41 SOFTGRAIN_MEMBERS_40, a41
#define SOFTGRAIN_MEMBERS_42 SOFTGRAIN_MEMBERS_41, a42
#define SOFTGRAIN_MEMBERS_43 SOFTGRAIN_MEMBERS_42, a43
#define SOFTGRAIN_MEMBERS_44 SOFTGRAIN_MEMBERS_43, a44
#define SOFTGRAIN_MEMBERS_45 SOFTGRAIN_MEMBERS_44, a45
#define SOFTGRAIN_MEMBERS_46 SOFTGRAIN_MEMBERS_45, a46
#define SOFTGRAIN_MEMBERS_47 SOFTGRAIN_MEMBERS_46, a47
#define SOFTGRAIN_MEMBERS_48 SOFTGRAIN_MEMBERS_47, a48
#define SOFTGRAIN_MEMBERS_49 SOFTGRAIN_MEMBERS_48, a49
#define SOFTGRAIN_MEMBERS_50 SOFTGRAIN_MEMBERS_49, a50
#define SOFTGRAIN_MEMBERS_51 SOFTGRAIN_MEMBERS_50, a51
#define SOFTGRAIN_MEMBERS_52 SOFTGRAIN_MEMBERS_51, a52
#define SOFTGRAIN_MEMBERS_53 SOFTGRAIN_MEMBERS_52, a53
#define SOFTGRAIN_MEMBERS_54 SOFTGRAIN_MEMBERS_53, a54
#define SOFTGRAIN_MEMBERS_55 SOFTGRAIN_MEMBERS_54, a55
#define SOFTGRAIN_MEMBERS_56 SOFTGRAIN_MEMBERS_55, a56

/// Calls `visit` with all members of a struct.
template <class T, class Visit>
void for_members(const T& value, Visit& visit) {
  constexpr std::size_t kMembers = members<T>();
  static_assert(kMembers < kMostMembers, "a struct with more members than are told apart: raise kMostMembers");
#define SOFTGRAIN_MEMBERS_CASE(n)                                          \
  if constexpr (kMembers == (n)) {                                         \
    const auto& [SOFTGRAIN_MEMBERS_##n] = value;                           \
    [&](const auto&... one) { (visit(one), ...); }(SOFTGRAIN_MEMBERS_##n); \
  }
  // clang-format off
    SOFTGRAIN_MEMBERS_CASE(1)
    SOFTGRAIN_MEMBERS_CASE(2)
    SOFTGRAIN_MEMBERS_CASE(3)
    SOFTGRAIN_MEMBERS_CASE(4)
    SOFTGRAIN_MEMBERS_CASE(5)
    SOFTGRAIN_MEMBERS_CASE(6)
    SOFTGRAIN_MEMBERS_CASE(7)
    SOFTGRAIN_MEMBERS_CASE(8)
    SOFTGRAIN_MEMBERS_CASE(9)
    SOFTGRAIN_MEMBERS_CASE(10)
    SOFTGRAIN_MEMBERS_CASE(11)
    SOFTGRAIN_MEMBERS_CASE(12)
    SOFTGRAIN_MEMBERS_CASE(13)
    SOFTGRAIN_MEMBERS_CASE(14)
    SOFTGRAIN_MEMBERS_CASE(15)
    SOFTGRAIN_MEMBERS_CASE(16)
    SOFTGRAIN_MEMBERS_CASE(17)
    SOFTGRAIN_MEMBERS_CASE(18)
    SOFTGRAIN_MEMBERS_CASE(19)
    SOFTGRAIN_MEMBERS_CASE(20)
    SOFTGRAIN_MEMBERS_CASE(21)
    SOFTGRAIN_MEMBERS_CASE(22)
    SOFTGRAIN_MEMBERS_CASE(23)
    SOFTGRAIN_MEMBERS_CASE(24)
    SOFTGRAIN_MEMBERS_CASE(25)
    SOFTGRAIN_MEMBERS_CASE(26)
    SOFTGRAIN_MEMBERS_CASE(27)
    SOFTGRAIN_MEMBERS_CASE(28)
    SOFTGRAIN_MEMBERS_CASE(29)
    SOFTGRAIN_MEMBERS_CASE(30)
    SOFTGRAIN_MEMBERS_CASE(31)
    SOFTGRAIN_MEMBERS_CASE(32)
    SOFTGRAIN_MEMBERS_CASE(33)
    SOFTGRAIN_MEMBERS_CASE(34)
    SOFTGRAIN_MEMBERS_CASE(35)
    SOFTGRAIN_MEMBERS_CASE(36)
    SOFTGRAIN_MEMBERS_CASE(37)
    SOFTGRAIN_MEMBERS_CASE(38)
    SOFTGRAIN_MEMBERS_CASE(39)
    SOFTGRAIN_MEMBERS_CASE(40)
    SOFTGRAIN_MEMBERS_CASE(41)
    SOFTGRAIN_MEMBERS_CASE(42)
    SOFTGRAIN_MEMBERS_CASE(43)
    SOFTGRAIN_MEMBERS_CASE(44)
    SOFTGRAIN_MEMBERS_CASE(45)
    SOFTGRAIN_MEMBERS_CASE(46)
    SOFTGRAIN_MEMBERS_CASE(47)
    SOFTGRAIN_MEMBERS_CASE(48)
    SOFTGRAIN_MEMBERS_CASE(49)
    SOFTGRAIN_MEMBERS_CASE(50)
    SOFTGRAIN_MEMBERS_CASE(51)
    SOFTGRAIN_MEMBERS_CASE(52)
    SOFTGRAIN_MEMBERS_CASE(53)
    SOFTGRAIN_MEMBERS_CASE(54)
    SOFTGRAIN_MEMBERS_CASE(55)
    SOFTGRAIN_MEMBERS_CASE(56)
  // clang-format on
#undef SOFTGRAIN_MEMBERS_CASE
}

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_variant = false;
template <class... T>
inline constexpr bool is_variant<std::variant<T...>> = true;
template <class T>
inline constexpr bool is_pair = false;
template <class A, class B>
inline constexpr bool is_pair<std::pair<A, B>> = true;
template <class T>
inline constexpr bool is_shared = false;
template <class T>
inline constexpr bool is_shared<std::shared_ptr<T>> = true;

template <class T>
concept Listed = requires(const T& t) {
  t.begin();
  t.end();
};

}  // namespace fingerprint

/// Writes a fingerprint. A type whose members say more than what is run has an overload of `tell` beside its test.
class Fingerprint {
 public:
  [[nodiscard]] const std::string& text() const { return text_; }

  template <class T>
  void operator()(const T& value) {
    using namespace fingerprint;
    if constexpr (requires { tell(*this, value); })
      tell(*this, value);
    else
      plain(value);
  }

  /// Whatever `tell` is there for the type itself.
  template <class T>
  void plain(const T& value) {
    using namespace fingerprint;
    if constexpr (std::is_enum_v<T>) {
      text_ += fmt::format("{},", static_cast<long long>(value));
    } else if constexpr (std::is_floating_point_v<T>) {
      text_ += fmt::format("{:a},", value);
    } else if constexpr (std::is_arithmetic_v<T>) {
      text_ += fmt::format("{},", value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      text_ += '"' + value + "\",";
    } else if constexpr (std::is_same_v<T, Grading>) {
      text_ += '"' + value.text() + "\",";
    } else if constexpr (std::is_same_v<T, MonotoneCurve>) {
      (*this)(value.points());
      (*this)(value.values());
    } else if constexpr (std::is_same_v<T, LawSet>) {
      for (std::int32_t a = 0; a < value.materials(); ++a)
        for (std::int32_t b = 0; b < value.materials(); ++b)
          if (value.index(a, b) != LawSet::kNoContact) (*this)(value.law(value.index(a, b)));
    } else if constexpr (std::is_same_v<T, SoftUnloading>) {  // no binding goes to members of a base
      (*this)(static_cast<const SoftContact&>(value));
      (*this)(value.branch);
    } else if constexpr (is_optional<T> || is_shared<T>) {
      text_ += value ? "+" : "-";
      if (value) (*this)(*value);
    } else if constexpr (is_variant<T>) {
      text_ += fmt::format("{}:", value.index());
      std::visit([&](const auto& one) { (*this)(one); }, value);
    } else if constexpr (is_pair<T>) {
      (*this)(value.first);
      (*this)(value.second);
    } else if constexpr (Listed<T>) {
      text_ += "[";
      for (const auto& one : value) (*this)(std::remove_cvref_t<decltype(one)>(one));
      text_ += "]";
    } else {
      static_assert(std::is_aggregate_v<T>, "a class whose members cannot be seen: give it an overload of tell()");
      text_ += "{";
      if constexpr (!std::is_empty_v<T>) for_members(value, *this);
      text_ += "}";
    }
  }

 private:
  std::string text_;
};

template <int D>
void tell(Fingerprint& f, const Stored<D>& v) {
  f(Vec<D>(v));
}

}  // namespace softgrain::test

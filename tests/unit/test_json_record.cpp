// Records as JSON objects and back.
#include <gtest/gtest.h>

#include <cmath>

#include "common/io/json_record.h"

namespace softgrain::json_record_test {

enum class Colour { red, green };

struct Inner {
  double value = 1.0;
  std::vector<double> list;
};

struct Outer {
  Colour colour = Colour::red;
  bool flag = false;
  std::int64_t whole = 7;
  std::string text = "as it was";
  std::optional<Inner> inner;
  std::optional<double> number;
  std::vector<Inner> several;
  std::map<std::string, double> named;
  std::array<double, 2> pair{};
};

void fields(auto&& visit, Of<Inner> auto& r) {
  visit("value", r.value);
  visit("list", r.list, kLeftOut);
}

void fields(auto&& visit, Of<Outer> auto& r) {
  visit("colour", r.colour);
  visit("flag", r.flag);
  visit("whole", r.whole);
  visit("text", r.text, kLeftOut);
  visit("inner", r.inner, kLeftOut);
  visit("number", r.number);
  visit("several", r.several);
  visit("named", r.named);
  visit("pair", r.pair);
}

}  // namespace softgrain::json_record_test

template <>
inline constexpr auto softgrain::enum_names<softgrain::json_record_test::Colour> =
    softgrain::enum_name_list<softgrain::json_record_test::Colour>(
        {{softgrain::json_record_test::Colour::red, "red"}, {softgrain::json_record_test::Colour::green, "green"}});

namespace softgrain::json_record_test {

using nlohmann::json;

Outer example() {
  Outer o{Colour::green, true, -3, "text", Inner{2.5, {1.0, 2.0}}, 0.5, {{3.0, {}}, {NAN, {4.0}}}, {{"a", 1.0}}, {}};
  o.pair = {5.0, 6.0};
  return o;
}

TEST(JsonRecord, EveryMemberComesBack) {
  const json written = json_of(example());
  EXPECT_EQ(written, json::parse(R"({"colour": "green", "flag": true, "whole": -3, "text": "text",
                                     "inner": {"value": 2.5, "list": [1.0, 2.0]}, "number": 0.5,
                                     "several": [{"value": 3.0}, {"value": null, "list": [4.0]}],
                                     "named": {"a": 1.0}, "pair": [5.0, 6.0]})"));
  const auto back = record_of<Outer>(written);
  EXPECT_EQ(json_of(back), written);
  EXPECT_TRUE(std::isnan(back.several.at(1).value));
  EXPECT_EQ(back.colour, Colour::green);
}

TEST(JsonRecord, WhatIsEmptyIsNullOrLeftOutAsAskedFor) {
  Outer o;
  o.text.clear();
  const json written = json_of(o);
  EXPECT_TRUE(written.at("number").is_null());
  EXPECT_TRUE(written.at("several").empty());
  for (const char* name : {"text", "inner"}) EXPECT_FALSE(written.contains(name)) << name;
}

TEST(JsonRecord, OtherKindsOfValuesLeaveWhatThereIs) {
  const auto o = record_of<Outer>(json::parse(R"({"colour": "blue", "flag": 1, "whole": 2.5, "text": [],
      "inner": 3, "number": "1", "several": [1, {"value": 4}], "named": {"a": "b"}, "pair": [1.0]})"));
  const Outer blank;
  EXPECT_EQ(o.colour, blank.colour);
  EXPECT_EQ(o.flag, blank.flag);
  EXPECT_EQ(o.whole, blank.whole);
  EXPECT_EQ(o.text, blank.text);
  EXPECT_FALSE(o.inner);
  EXPECT_FALSE(o.number);
  ASSERT_EQ(o.several.size(), 2U);
  EXPECT_EQ(o.several[0].value, Inner{}.value);
  EXPECT_EQ(o.several[1].value, 4.0);
  EXPECT_EQ(o.pair, blank.pair);
  EXPECT_EQ(json_of(record_of<Outer>(json::parse("[1]"))), json_of(blank));
}

}  // namespace softgrain::json_record_test

// Cards of the cell law: exact round trips, and nothing wrong is taken.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "common/core/error.h"
#include "common/data/cell_card.h"
#include "common/io/text_file.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::TemporaryDirectory;

constexpr double kInf = std::numeric_limits<double>::infinity();

CellCard sample_card() {
  CellCard c;
  c.form = StateForm::pores;
  c.modulus = {0.1 / 3.0, 1e-3 / 7.0, 0.03, 0.04};
  c.exponent = {2.03, 0.1 / 3.0, 1.9, 2.2};
  c.void_ratio = {0.567, kInf, -kInf, kInf};
  c.excess_alone = {0.6155, 0.01, 0.59, 0.64};
  c.excess_many = {0.3075, 0.02, 0.27, 0.35};
  c.excess_decay = {0.355, 0.1, 0.2, 0.6};
  c.friction = {0.6, 0.05, 0.5, 0.7};
  c.stiffness = {1.0, 0.2, 0.6, 1.7};
  c.lateral_ratio = {0.477, 0.003, 0.46, 0.49};
  c.pressure_low = 1e-4 / 3.0;
  c.pressure_high = 8e-3;
  c.mixture_high = 4.0;
  c.youngs_modulus = 5e10 / 3.0;
  c.density = 2650.5;
  c.poisson_ratio = 0.3;
  c.grain_friction = 0.3;
  c.preparation = "fast";
  c.start_pressure = 1e-4;
  c.split = 1.0 / 3.0;
  c.fines_ratio = 2.0;
  c.fines_sizes = "power law with \"quotes\"\nand lines";
  c.samples = 3;
  return c;
}

CellCard card_with_memory() {
  CellCard c = sample_card();
  c.form = StateForm::porosity;
  c.grain_rolling = {0.2, 0.7, 1.0};
  c.preparations = {{"slow", {0.9753, 0.02 / 7.0, 0.97, 0.98}}, {"dense", {0.73, kInf, -kInf, kInf}}};
  c.correlation = {{"K", "n", "A"}, {1.0, 0.9 / 7.0, -0.25, 0.9 / 7.0, 1.0, 0.1, -0.25, 0.1, 1.0}};
  c.memory = CellMemory{{1.18, 0.1 / 3.0, 1.1, 1.3}, {0.9496, 0.01, 0.93, 0.97},     {35.0, 5.0, 20.0, 50.0},
                        {0.666, kInf, 0.0, 1.0},     {-0.24, 0.05 / 7.0, -0.4, 0.0}, {1.6e-3, kInf, 0.0, 1.0}};
  return c;
}

void expect_same_estimate(const Estimate& a, const Estimate& b) {
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.standard_error, b.standard_error);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
}

TEST(CellCardFile, RoundTripIsExact) {
  const TemporaryDirectory directory;
  const CellCard a = card_with_memory();
  write_cell_card(a, directory.file("card.toml"));
  const CellCard b = read_cell_card(directory.file("card.toml"));
  EXPECT_EQ(a.form, b.form);
  const auto numbers = numbers_of(a);
  const auto read = numbers_of(b);
  ASSERT_EQ(numbers.size(), 15U);
  ASSERT_EQ(read.size(), numbers.size());
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    EXPECT_EQ(numbers[k].key, read[k].key);
    expect_same_estimate(numbers[k].estimate, read[k].estimate);
  }
  for (const auto number :
       {&CellCard::youngs_modulus, &CellCard::density, &CellCard::pressure_low, &CellCard::pressure_high,
        &CellCard::mixture_high, &CellCard::poisson_ratio, &CellCard::grain_friction, &CellCard::start_pressure,
        &CellCard::split, &CellCard::fines_ratio})
    EXPECT_EQ(a.*number, b.*number);
  EXPECT_EQ(a.grain_rolling, b.grain_rolling);
  EXPECT_EQ(a.preparation, b.preparation);
  EXPECT_EQ(a.fines_sizes, b.fines_sizes);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.correlation.numbers, b.correlation.numbers);
  EXPECT_EQ(a.correlation.matrix, b.correlation.matrix);
  ASSERT_EQ(b.preparations.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(a.preparations[k].preparation, b.preparations[k].preparation);
    expect_same_estimate(a.preparations[k].factor, b.preparations[k].factor);
  }
  write_cell_card(b, directory.file("again.toml"));
  EXPECT_EQ(read_text(directory.file("card.toml")), read_text(directory.file("again.toml")));
}

/// Cards of earlier versions say neither E nor density.
TEST(CellCardFile, MayNotSayTheModulusOfItsGrains) {
  const TemporaryDirectory directory;
  CellCard card = sample_card();
  card.youngs_modulus = card.density = std::numeric_limits<double>::quiet_NaN();
  write_cell_card(card, directory.file("card.toml"));
  const std::string text = read_text(directory.file("card.toml"));
  EXPECT_EQ(text.find("\nE = "), std::string::npos) << text;
  EXPECT_EQ(text.find("mu_r"), std::string::npos) << "its grains roll freely";
  const CellCard read = read_cell_card(directory.file("card.toml"));
  EXPECT_TRUE(std::isnan(read.youngs_modulus));
  EXPECT_TRUE(std::isnan(read.density));
}

/// Cards of earlier versions, and of laws that forget, have no [memory].
TEST(CellCardFile, MayHaveNoMemory) {
  const TemporaryDirectory directory;
  write_cell_card(sample_card(), directory.file("card.toml"));
  EXPECT_EQ(read_text(directory.file("card.toml")).find("[memory]"), std::string::npos);
  EXPECT_FALSE(read_cell_card(directory.file("card.toml")).memory);
  EXPECT_EQ(numbers_of(sample_card()).size(), 9U);
}

/// Cards of earlier versions have no factors for other preparations.
TEST(CellCardFile, KnowsTheFactorsOfThePreparationsThatItNames) {
  const TemporaryDirectory directory;
  write_cell_card(sample_card(), directory.file("card.toml"));
  EXPECT_EQ(read_text(directory.file("card.toml")).find("[[preparation]]"), std::string::npos);
  const CellCard old = read_cell_card(directory.file("card.toml"));
  EXPECT_TRUE(old.preparations.empty());
  EXPECT_EQ(void_ratio_factor(old, "fast"), 1.0);
  EXPECT_EQ(void_ratio_factor(old, ""), 1.0);
  EXPECT_EQ(void_ratio_factor(old, "slow"), std::nullopt);
  const CellCard card = card_with_memory();
  EXPECT_EQ(void_ratio_factor(card, "slow"), 0.9753);
  EXPECT_EQ(void_ratio_factor(card, "rodded"), std::nullopt);
  const std::string text = missing_factor_text(card, "rodded");
  EXPECT_NE(missing_factor_text(old, "slow").find("'fast' and has no factor on void ratios for 'slow'"),
            std::string::npos);
  for (const char* word : {"'fast', has a factor for 'slow', 'dense' and none for 'rodded'", "[law] preparations"})
    EXPECT_NE(text.find(word), std::string::npos) << text;
}

TEST(CellCardFile, FactorsOfPreparationsAreOneEachAndAboveNone) {
  const auto factor_of = [](const char* name, double value, const char* more = "") {
    return fmt::format(
        "[[preparation]]\nname = \"{}\"\n{}factor = {{ value = {}, standard_error = 0.1, low = 0, high = 9 }}\n", name,
        more, value);
  };
  const auto complaint = [](const std::string& tables) -> std::string {
    const TemporaryDirectory directory;
    const std::string path = directory.file("card.toml");
    write_cell_card(sample_card(), path);
    write_text_atomic(path, read_text(path) + tables);
    try {
      (void)read_cell_card(path);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto expect_words = [&](const std::string& tables, const char* words) {
    EXPECT_NE(complaint(tables).find(words), std::string::npos) << complaint(tables);
  };
  EXPECT_EQ(complaint(factor_of("slow", 0.97) + factor_of("dense", 0.73)), "");
  expect_words(factor_of("slow", 0.97) + factor_of("slow", 0.96), "is used twice");
  expect_words(factor_of("fast", 0.97), "whose factor is 1");
  expect_words(factor_of("slow", 0.0), "value = ");
  expect_words(factor_of("slow", 1e30), "factor: value = 1e+30 must be from 0.01 to 100");
  expect_words(factor_of("", 0.97), "must not be empty");
  expect_words(factor_of("slow", 0.97, "mu = 0.3\n"), "unknown key 'mu'");
  expect_words("[[preparation]]\nname = \"slow\"\n", "factor");
}

TEST(CellCardFile, CorrelationsAreThoseOfNumbersOfTheCard) {
  const TemporaryDirectory directory;
  const auto complaint = [&](const std::string& numbers, const std::string& matrix) -> std::string {
    const std::string table = "[correlation]\nnumbers = " + numbers + "\nmatrix = " + matrix + "\n";
    write_cell_card(sample_card(), directory.file("card.toml"));
    write_text_atomic(directory.file("card.toml"), read_text(directory.file("card.toml")) + table);
    try {
      (void)read_cell_card(directory.file("card.toml"));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto expect_words = [&](const char* numbers, const char* matrix, const char* words) {
    EXPECT_NE(complaint(numbers, matrix).find(words), std::string::npos) << complaint(numbers, matrix);
  };
  const char* const two = R"(["K", "n"])";
  EXPECT_EQ(complaint(two, "[1, 0.5, 0.5, 1]"), "");
  expect_words(R"(["K", "A"])", "[1, 0.5, 0.5, 1]", "\"A\" is no number of this card");  // it has no [memory]
  expect_words(R"(["K", "K"])", "[1, 0.5, 0.5, 1]", "twice");
  expect_words(two, "[1, 0.5, 0.5]", "must be 4 numbers");
  expect_words(two, "[1, 0.5, 0.4, 1]", "the same across it");
  expect_words(two, "[0.9, 0.5, 0.5, 1]", "1 on its diagonal");
  expect_words(two, "[1, 1.5, 1.5, 1]", "matrix");
}

/// Draws of such a card ended a run after its packings were made, and no message named the card.
TEST(CellCardFile, CorrelationsThatNoErrorsHaveAreRefused) {
  const TemporaryDirectory directory;
  const auto is_read = [&](const std::string& matrix) {
    write_cell_card(sample_card(), directory.file("card.toml"));
    write_text_atomic(directory.file("card.toml"),
                      read_text(directory.file("card.toml")) +
                          "[correlation]\nnumbers = [\"K\", \"n\", \"e_J\"]\nmatrix = " + matrix + "\n");
    try {
      (void)read_cell_card(directory.file("card.toml"));
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("matrix"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("no errors have these correlations"), std::string::npos) << e.what();
      return false;
    }
    return true;
  };
  EXPECT_FALSE(is_read("[1, 0.9, 0.9, 0.9, 1, -0.9, 0.9, -0.9, 1]"));
  EXPECT_FALSE(is_read("[1, 1, 0.5, 1, 1, 0, 0.5, 0, 1]"));  // K and n are one, but go with e_J in two ways
  EXPECT_TRUE(is_read("[1, 0.5, -0.5, 0.5, 1, 0.4, -0.5, 0.4, 1]"));
  EXPECT_TRUE(is_read("[1, 1, 0.5, 1, 1, 0.5, 0.5, 0.5, 1]"));
  EXPECT_TRUE(is_read("[1, 1, -1, 1, 1, -1, -1, -1, 1]"));  // two samples
}

TEST(CellCardFile, NumbersAreSetByTheirKeysWithinTheirRanges) {
  CellCard card = card_with_memory();
  set_number(card, "n", 0.5);
  EXPECT_GT(card.exponent.value, 1.0);
  EXPECT_LT(card.exponent.value, 1.001);
  set_number(card, "c", 0.25);
  EXPECT_EQ(card.memory->strength_range.value, 0.25);
  set_number(card, "w_inf", -1.0);
  EXPECT_EQ(card.excess_many.value, 0.0);
  EXPECT_THROW(set_number(card, "k", 1.0), InputError);
}

TEST(CellCardFile, SlipThatGivesEnergyBackIsRefused) {
  const TemporaryDirectory directory;
  CellCard card = card_with_memory();
  card.memory->dilatancy = {2.6, 0.05, 2.5, 2.7};  // (1 + c)/c = 2.502
  write_cell_card(card, directory.file("card.toml"));
  try {
    (void)read_cell_card(directory.file("card.toml"));
    ADD_FAILURE() << "not refused";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("A: must be at most (1 + c)/c = 2.502"), std::string::npos) << e.what();
  }
}

/// The card of sample_card() with the line that begins so replaced; empty: taken out.
std::string complaint_of(const std::string& begin, const std::string& line) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("card.toml");
  write_cell_card(sample_card(), path);
  std::string text = read_text(path);
  const auto at = text.find("\n" + begin);
  EXPECT_NE(at, std::string::npos) << begin;
  const auto end = text.find('\n', at + 1);
  text.replace(at + 1, end - at - (line.empty() ? 0 : 1), line);
  write_text_atomic(path, text);
  try {
    (void)read_cell_card(path);
  } catch (const InputError& e) {
    return std::string(e.what()).substr(directory.file("").size());
  }
  return "";
}

/// What complains of a card with the number `key` of its [cell] or [memory] set to `value`, whatever its errors.
std::string complaint_of_number(const std::string& key, double value) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("card.toml");
  CellCard card = card_with_memory();
  write_cell_card(card, path);
  std::string text = read_text(path);
  const auto at = text.find("\n" + key + " = {");
  EXPECT_NE(at, std::string::npos) << key;
  text.replace(
      at + 1, text.find('\n', at + 1) - at - 1,
      fmt::format("{} = {{ value = {}, standard_error = \"inf\", low = \"-inf\", high = \"inf\" }}", key, value));
  write_text_atomic(path, text);
  try {
    (void)read_cell_card(path);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// A card with K = 1e30 was read, and the run failed after its packings were made.
TEST(CellCardFile, NumbersBeyondReasonAreRefusedWithTheirKeyAndRange) {
  struct Wrong {
    const char* key;
    double value;
    const char* words;
  };
  const std::vector<Wrong> wrong{{"K", 1e30, "K: value = 1e+30 must be from 1e-06 to 1"},
                                 {"K", 1e-30, "K: value = 1e-30 must be from 1e-06 to 1"},
                                 {"n", 21.0, "n: value = 21.0 must be above 1 and at most 20"},
                                 {"e_J", 1e-9, "e_J: value = 1e-09 must be from 0.0001 to 100"},
                                 {"e_c", 1e30, "e_c: value = 1e+30 must be from 0.0001 to 100"},
                                 {"w_inf", 1e30, "w_inf: value = 1e+30 must be from 0 to 100"},
                                 {"xi", 1e30, "xi: value = 1e+30 must be from 1e-06 to 1"},
                                 {"mu_f", 1e30, "mu_f: value = 1e+30 must be from 0 to 1000"},
                                 {"chi", 1e30, "chi: value = 1e+30 must be from 1e-06 to 1"},
                                 {"K0", 2.0, "K0: value = 2.0 must be above 0 and at most 1"},
                                 {"A", 1e30, "A: value = 1e+30 must be from 0 to 1000"},
                                 {"r_c", 1e30, "r_c: value = 1e+30 must be from 0.01 to 100"},
                                 {"m", 1e30, "m: value = 1e+30 must be from 0 to 1"},
                                 {"c", 1e-30, "c: value = 1e-30 must be at least 0.001 and below 1"},
                                 {"lambda", -1e30, "lambda: value = -1e+30 must be from -50 to 50"},
                                 {"x_r", 1.0, "x_r: value = 1.0 must be above 0 and below 1"}};
  for (const Wrong& w : wrong) {
    const std::string text = complaint_of_number(w.key, w.value);
    EXPECT_NE(text.find("card.toml:"), std::string::npos) << w.key << ": " << text;
    EXPECT_NE(text.find(w.words), std::string::npos) << w.key << ": " << text;
  }
  for (const auto& [key, value] :
       {std::pair{"K", 1e5}, {"K", 1e-5}, {"n", 19.0}, {"e_J", 0.002}, {"chi", 1e-3}, {"mu_f", 500.0}, {"m", 1e5}})
    EXPECT_EQ(complaint_of_number(key, value), "") << key << " = " << value;
}

/// Fits end within the ranges of the numbers, so every card that was written is read.
TEST(CellCardFile, AllCardsOfTheRepositoryAreRead) {
  int cards = 0;
  for (const char* folder : {"/results/material_law", "/results/recipes", "/tests/reference/earlier"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::string(SOFTGRAIN_SOURCE_DIR) + folder)) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with("cell_law") || !name.ends_with(".toml")) continue;
      EXPECT_NO_THROW((void)read_cell_card(entry.path().string())) << entry.path();
      ++cards;
    }
  EXPECT_GE(cards, 14);
}

TEST(CellCardFile, NothingWrongIsTaken) {
  const auto estimate = [](double v) {
    return fmt::format("{{ value = {}, standard_error = 0.1, low = 0.0, high = 9.0 }}", v);
  };
  const std::vector<std::pair<std::string, double>> wrong{
      {"K", 0.0},       {"K", -1.0},     {"n", 1.0},   {"n", 51.0},  {"e_J", 0.0},
      {"e_c", -0.1},    {"w_inf", -0.1}, {"xi", 0.0},  {"e_J", 1e9}, {"e_c", 101.0},
      {"w_inf", 101.0}, {"mu_f", -0.1},  {"chi", 0.0}, {"K0", 0.0},  {"K0", 1.1}};
  for (const auto& [key, value] : wrong) {
    const std::string text = complaint_of(key + " = {", key + " = " + estimate(value));
    EXPECT_NE(text.find(":"), std::string::npos) << key << " " << value;
    EXPECT_NE(text.find("value = "), std::string::npos) << text;
  }
  EXPECT_NE(complaint_of("K = ", "K = { value = 1.0, standard_error = 0.1, low = 2.0, high = 1.0 }").find("high end"),
            std::string::npos);
  EXPECT_NE(
      complaint_of("K = ", R"(K = { value = 1.0, standard_error = 0.1, low = "nan", high = 1.0 })").find("high end"),
      std::string::npos);
  EXPECT_NE(
      complaint_of("K = ", "K = { value = 1.0, standard_error = 0.1, low = 0.0, high = 0.9 }").find("below value"),
      std::string::npos);
  EXPECT_NE(complaint_of("K = ", "K = { value = 1.0, standard_error = -0.1, low = 0.0, high = 1.0 }").find("error"),
            std::string::npos);
  EXPECT_NE(complaint_of("K = ", R"(K = { value = "inf", standard_error = 0.1, low = 0.0, high = 1.0 })"), "");
  EXPECT_NE(complaint_of("K = ", "").find("missing table [cell.K]"), std::string::npos) << complaint_of("K = ", "");
  EXPECT_NE(complaint_of("K = ", "KK = 3"), "");
  EXPECT_NE(complaint_of("form", "form = \"poors\"").find("nearest is \"pores\""), std::string::npos);
  for (const char* line :
       {"pressure = [2e-3, 1e-3]", "pressure = [0.0, 1e-3]", "pressure = [1e-3]", "pressure = [1e-4, 1e30]"})
    EXPECT_NE(complaint_of("pressure", line).find("pressure"), std::string::npos) << line;
  const std::vector<std::pair<std::string, std::string>> others{
      {"mixture_max", "0"},    {"mixture_max", "1e30"}, {"mu", "1e30"},         {"start_pressure", "1e30"},
      {"fines_ratio", "1e30"}, {"nu", "0.6"},           {"mu", "-1"},           {"preparation", "\"\""},
      {"start_pressure", "0"}, {"split", "1.0"},        {"fines_ratio", "0.9"}, {"fines_sizes", "3"},
      {"samples", "0"},        {"schema", "2"}};
  for (const auto& [key, value] : others)
    EXPECT_NE(complaint_of(key, key + " = " + value).find(key), std::string::npos) << key;
  EXPECT_NE(complaint_of("samples", "samples = 3\nsplitt = 1").find("unknown key 'splitt'"), std::string::npos);
}

TEST(CellCardFile, TheLineIsNamedAndAMissingFileIsTrouble) {
  EXPECT_NE(complaint_of("split = ", "split = 2").find("card.toml:"), std::string::npos);
  EXPECT_THROW((void)read_cell_card("/nowhere/card.toml"), IoError);
}

}  // namespace
}  // namespace softgrain

// The general fitter against the certified answers of NIST's StRD sets: all 27, each from both starts, all by the same
// means.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "calibrate/least_squares.h"
#include "tests/support/curve_problem.h"

namespace {

using namespace softgrain;

struct NistSet {
  Observations data;
  std::vector<std::vector<double>> starts{{}, {}};
  std::vector<double> certified;
  std::vector<double> deviations;
  double residual_sum = 0.0;
  double residual_deviation = 0.0;
};

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> out;
  std::string word;
  while (in >> word) {
    char* end = nullptr;
    const double x = std::strtod(word.c_str(), &end);
    // One file writes an exponent as "E-0"; strtod reads it. Anything else than a number ends the line.
    if (end == word.c_str() || *end != '\0') return {};
    out.push_back(x);
  }
  return out;
}

std::string after(const std::string& line, char mark) { return line.substr(line.find(mark) + 1); }

NistSet read_set(const std::string& name) {
  std::ifstream file(std::string(SOFTGRAIN_REFERENCE_DIR) + "/nist/" + name + ".dat");
  NistSet set;
  std::string line;
  int data_headers = 0;
  while (std::getline(file, line)) {
    if (line.rfind("Data:", 0) == 0) ++data_headers;
    const auto equals = line.find('=');
    if (line.rfind("  b", 0) == 0 && equals != std::string::npos) {
      const auto v = numbers_of(after(line, '='));
      if (v.size() != 4) continue;
      set.starts[0].push_back(v[0]);
      set.starts[1].push_back(v[1]);
      set.certified.push_back(v[2]);
      set.deviations.push_back(v[3]);
    } else if (line.rfind("Residual Sum of Squares:", 0) == 0) {
      set.residual_sum = numbers_of(after(line, ':')).at(0);
    } else if (line.rfind("Residual Standard Deviation:", 0) == 0) {
      set.residual_deviation = numbers_of(after(line, ':')).at(0);
    } else if (data_headers == 2) {
      const auto v = numbers_of(line);
      if (v.size() < 2) continue;
      set.data.y.push_back(v[0]);
      set.data.x.insert(set.data.x.end(), v.begin() + 1, v.end());
      set.data.predictors = v.size() - 1;
    }
  }
  return set;
}

/// Digits that agree with the certified value.
double digits(double value, double certified) {
  return value == certified ? 16.0 : -std::log10(std::abs(value - certified) / std::abs(certified));
}

// Models. p: parameters (double or dual numbers), x: predictors. `using std::...` lets plain numbers and duals share a
// formula.
using std::atan;
using std::cos;
using std::exp;
using std::pow;
using std::sin;

constexpr auto kBennett5 = [](const auto* p, const double* x) { return p[0] * pow(p[1] + x[0], -1.0 / p[2]); };
constexpr auto kSaturation = [](const auto* p, const double* x) {
  return p[0] * (1.0 - exp(-p[1] * x[0]));
};  // BoxBOD, Misra1a
constexpr auto kChwirut = [](const auto* p, const double* x) { return exp(-p[0] * x[0]) / (p[1] + p[2] * x[0]); };
constexpr auto kDanWood = [](const auto* p, const double* x) {
  using T = std::decay_t<decltype(p[0])>;
  return p[0] * pow(T(x[0]), p[1]);
};
constexpr auto kEnso = [](const auto* p, const double* x) {
  const double year = 2.0 * std::numbers::pi * x[0] / 12.0;
  const auto u = 2.0 * std::numbers::pi * x[0] / p[3];
  const auto w = 2.0 * std::numbers::pi * x[0] / p[6];
  return p[0] + p[1] * std::cos(year) + p[2] * std::sin(year) + p[4] * cos(u) + p[5] * sin(u) + p[7] * cos(w) +
         p[8] * sin(w);
};
constexpr auto kEckerle4 = [](const auto* p, const double* x) {
  const auto z = (x[0] - p[2]) / p[1];
  return p[0] / p[1] * exp(-0.5 * z * z);
};
constexpr auto kGauss = [](const auto* p, const double* x) {
  const auto u = (x[0] - p[3]) / p[4];
  const auto w = (x[0] - p[6]) / p[7];
  return p[0] * exp(-p[1] * x[0]) + p[2] * exp(-u * u) + p[5] * exp(-w * w);
};
constexpr auto kCubicOverCubic = [](const auto* p, const double* x) {  // Hahn1, Thurber
  return (p[0] + x[0] * (p[1] + x[0] * (p[2] + x[0] * p[3]))) / (1.0 + x[0] * (p[4] + x[0] * (p[5] + x[0] * p[6])));
};
constexpr auto kKirby2 = [](const auto* p, const double* x) {
  return (p[0] + x[0] * (p[1] + x[0] * p[2])) / (1.0 + x[0] * (p[3] + x[0] * p[4]));
};
constexpr auto kLanczos = [](const auto* p, const double* x) {
  return p[0] * exp(-p[1] * x[0]) + p[2] * exp(-p[3] * x[0]) + p[4] * exp(-p[5] * x[0]);
};
constexpr auto kMgh09 = [](const auto* p, const double* x) {
  return p[0] * (x[0] * x[0] + x[0] * p[1]) / (x[0] * x[0] + x[0] * p[2] + p[3]);
};
constexpr auto kMgh10 = [](const auto* p, const double* x) { return p[0] * exp(p[1] / (x[0] + p[2])); };
constexpr auto kMgh17 = [](const auto* p, const double* x) {
  return p[0] + p[1] * exp(-x[0] * p[3]) + p[2] * exp(-x[0] * p[4]);
};
constexpr auto kMisra1b = [](const auto* p, const double* x) {
  const auto base = 1.0 + p[1] * x[0] / 2.0;
  return p[0] * (1.0 - 1.0 / (base * base));
};
constexpr auto kMisra1c = [](const auto* p, const double* x) {
  using T = std::decay_t<decltype(p[0])>;
  return p[0] * (1.0 - pow(1.0 + 2.0 * p[1] * x[0], T(-0.5)));
};
constexpr auto kMisra1d = [](const auto* p, const double* x) { return p[0] * p[1] * x[0] / (1.0 + p[1] * x[0]); };
constexpr auto kNelson = [](const auto* p, const double* x) { return p[0] - p[1] * x[0] * exp(-p[2] * x[1]); };
constexpr auto kRat42 = [](const auto* p, const double* x) { return p[0] / (1.0 + exp(p[1] - p[2] * x[0])); };
constexpr auto kRat43 = [](const auto* p, const double* x) {
  return p[0] / pow(1.0 + exp(p[1] - p[2] * x[0]), 1.0 / p[3]);
};
constexpr auto kRoszman1 = [](const auto* p, const double* x) {
  auto angle = atan(p[2] / (x[0] - p[3]));
  if (angle < 0.0) angle = angle + std::numbers::pi;  // the certified answer takes the arctangent in [0, pi)
  return p[0] - p[1] * x[0] - angle / std::numbers::pi;
};

/// A sum of three exponentials does not know their order: sorts (amplitude, rate) pairs by rate, as the certified ones
/// are.
void sort_exponentials(LeastSquaresFit& fit) {
  std::vector<std::size_t> order{0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return fit.parameters[2 * a + 1] < fit.parameters[2 * b + 1]; });
  const LeastSquaresFit old = fit;
  for (std::size_t k = 0; k < 6; ++k) {
    fit.parameters[k] = old.parameters[2 * order[k / 2] + k % 2];
    fit.standard_deviations[k] = old.standard_deviations[2 * order[k / 2] + k % 2];
  }
}

template <int N, class Model>
void expect_certified(const std::string& name, Model model, bool logarithm = false) {
  NistSet set = read_set(name);
  ASSERT_EQ(set.certified.size(), N) << name;
  if (logarithm)
    for (double& y : set.data.y) y = std::log(y);
  const auto problem = curve_problem<N>(set.data, model);
  for (std::size_t start = 0; start < 2; ++start) {
    LeastSquaresFit fit = fit_least_squares(problem, {set.starts[start]});
    if (name.rfind("Lanczos", 0) == 0) sort_exponentials(fit);
    SCOPED_TRACE(name + " start " + std::to_string(start + 1) + ": " + fit.message + " by " + fit.strategy);
    EXPECT_EQ(fit.end, FitEnd::converged);
    EXPECT_FALSE(fit.rank_deficient);
    double fewest = 16.0;
    double fewest_sd = 16.0;
    for (std::size_t j = 0; j < N; ++j) {
      fewest = std::min(fewest, digits(fit.parameters[j], set.certified[j]));
      fewest_sd = std::min(fewest_sd, digits(fit.standard_deviations[j], set.deviations[j]));
    }
    // Lanczos1 has residuals of 1e-13 beside data of order 1: its sums carry the rounding of the data, not of the fit.
    const bool exact_data = set.residual_deviation < 1e-10;
    EXPECT_GE(fewest, 8.0);
    EXPECT_GE(fewest_sd, exact_data ? 2.0 : 8.0);
    EXPECT_GE(digits(fit.residual_sum_of_squares, set.residual_sum), exact_data ? 2.0 : 9.0);
    ::testing::Test::RecordProperty(name + "_digits_start" + std::to_string(start + 1), std::to_string(fewest));
    if (std::getenv("SOFTGRAIN_PRINT_DIGITS") != nullptr)
      std::printf("%-9s start %zu: parameters %.1f digits, deviations %.1f, S %.1f (%s)\n", name.c_str(), start + 1,
                  fewest, fewest_sd, digits(fit.residual_sum_of_squares, set.residual_sum), fit.strategy.c_str());
  }
}

TEST(Nist, Misra1a) { expect_certified<2>("Misra1a", kSaturation); }
TEST(Nist, Misra1b) { expect_certified<2>("Misra1b", kMisra1b); }
TEST(Nist, Misra1c) { expect_certified<2>("Misra1c", kMisra1c); }
TEST(Nist, Misra1d) { expect_certified<2>("Misra1d", kMisra1d); }
TEST(Nist, Chwirut1) { expect_certified<3>("Chwirut1", kChwirut); }
TEST(Nist, Chwirut2) { expect_certified<3>("Chwirut2", kChwirut); }
TEST(Nist, DanWood) { expect_certified<2>("DanWood", kDanWood); }
TEST(Nist, Lanczos1) { expect_certified<6>("Lanczos1", kLanczos); }
TEST(Nist, Lanczos2) { expect_certified<6>("Lanczos2", kLanczos); }
TEST(Nist, Lanczos3) { expect_certified<6>("Lanczos3", kLanczos); }
TEST(Nist, Gauss1) { expect_certified<8>("Gauss1", kGauss); }
TEST(Nist, Gauss2) { expect_certified<8>("Gauss2", kGauss); }
TEST(Nist, Gauss3) { expect_certified<8>("Gauss3", kGauss); }
TEST(Nist, Kirby2) { expect_certified<5>("Kirby2", kKirby2); }
TEST(Nist, Hahn1) { expect_certified<7>("Hahn1", kCubicOverCubic); }
TEST(Nist, Nelson) { expect_certified<3>("Nelson", kNelson, true); }
TEST(Nist, MGH09) { expect_certified<4>("MGH09", kMgh09); }
TEST(Nist, MGH10) { expect_certified<3>("MGH10", kMgh10); }
TEST(Nist, MGH17) { expect_certified<5>("MGH17", kMgh17); }
TEST(Nist, Roszman1) { expect_certified<4>("Roszman1", kRoszman1); }
TEST(Nist, ENSO) { expect_certified<9>("ENSO", kEnso); }
TEST(Nist, Thurber) { expect_certified<7>("Thurber", kCubicOverCubic); }
TEST(Nist, BoxBOD) { expect_certified<2>("BoxBOD", kSaturation); }
TEST(Nist, Rat42) { expect_certified<3>("Rat42", kRat42); }
TEST(Nist, Rat43) { expect_certified<4>("Rat43", kRat43); }
TEST(Nist, Eckerle4) { expect_certified<3>("Eckerle4", kEckerle4); }
TEST(Nist, Bennett5) { expect_certified<3>("Bennett5", kBennett5); }

}  // namespace

// The pictures of the guide's page on laws: drawn from the laws themselves, which are held here to closed forms, and
// compared with the committed files. SOFTGRAIN_WRITE_PICTURES=1 writes the files again.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

#include "common/contact/laws.h"
#include "common/contact/make_laws.h"
#include "common/data/multi_contact_law.h"
#include "pipelines/report/figure_table.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain {
namespace {

using report::Plot;
using report::Series;

constexpr double kRadius = 0.016;
constexpr double kModulus = 0.5e6;

std::string source(const std::string& name) { return std::string(SOFTGRAIN_SOURCE_DIR) + "/" + name; }

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Curves of a picture as numbers, in a comment of the file: drawings change with the plotter, what they show must not.
std::string data_of(const std::vector<Series>& curves) {
  std::ostringstream out;
  out.precision(6);
  for (const Series& s : curves) {
    out << s.label << "\n";
    for (std::size_t k = 0; k < s.x.size(); ++k) out << s.x[k] << " " << s.y[k] << "\n";
  }
  return out.str();
}

/// The same text around numbers that differ by rounding at most.
::testing::AssertionResult same_data(const std::string& a, const std::string& b) {
  static const std::regex number(R"(-?\d+(\.\d+)?(e[-+]\d+)?)");
  if (std::regex_replace(a, number, "#") != std::regex_replace(b, number, "#"))
    return ::testing::AssertionFailure() << "other curves";
  auto ia = std::sregex_iterator(a.begin(), a.end(), number);
  auto ib = std::sregex_iterator(b.begin(), b.end(), number);
  for (; ia != std::sregex_iterator(); ++ia, ++ib) {
    const double x = std::stod(ia->str());
    if (std::abs(x - std::stod(ib->str())) > 1e-9 + 1e-4 * std::abs(x))
      return ::testing::AssertionFailure() << ia->str() << " instead of " << ib->str();
  }
  return ::testing::AssertionSuccess();
}

void expect_picture(const report::PlotOptions& options, const std::vector<Series>& curves, const std::string& name) {
  const std::string path = source("pipelines/guide/" + name);
  const std::string data = data_of(curves);
  if (std::getenv("SOFTGRAIN_WRITE_PICTURES") != nullptr) {
    Plot plot(options);
    for (const Series& s : curves) plot.add(s);
    std::ofstream(path) << report::without_table(plot.svg()).svg << "\n<!-- data\n" << data << "-->\n";
  }
  const std::string file = content(path);
  const std::size_t from = file.find("<!-- data\n") + 10;
  ASSERT_LT(from, file.size()) << name;
  EXPECT_TRUE(same_data(data, file.substr(from, file.find("-->", from) - from)))
      << name << " is not what the law gives; SOFTGRAIN_WRITE_PICTURES=1 writes it again";
}

Series curve(const std::string& label, const char* color, const std::string& dash = "") {
  return {.label = label, .hover = "", .x = {}, .y = {}, .style = {.color = color, .dash = dash}};
}

/// Force over overlap as two equal spheres of mass m collide at `speed`, by small steps; returns the final speed.
template <class Law>
double impact(const Law& law, double radius, double mass, double speed, Series& out) {
  ContactState<3> s;
  s.normal = {{0.0, 0.0, 1.0}};
  s.constants = law.pair_constants({radius, radius, 1.0 / mass, 1.0 / mass});
  const double dt = 1e-4 * radius / speed * 0.02;
  double v = -speed;  // of separation
  double h = 0.0;
  for (int k = 0; k < 10000000; ++k) {
    s.overlap = h;
    s.normal_speed = v;
    const double force = law.evaluate(s).normal_force;
    if (k % 20 == 0) {
      out.x.push_back(1e6 * h);
      out.y.push_back(force);
    }
    v += 2.0 * force / mass * dt;
    h -= v * dt;
    if (h <= 0.0) break;
  }
  out.x.push_back(0.0);
  out.y.push_back(0.0);
  return v;
}

TEST(LawPictures, Impacts) {
  const double radius = 1e-3;
  const double mass = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * 2500.0;
  const Material glass{.name = "glass", .density = 2500.0, .youngs_modulus = 70e9, .poisson_ratio = 0.2};
  const auto hertz = [&](double e) {
    return HertzMindlin<Tangential::none, true>{HertzCoefficients::of(glass, glass, 0.0, e)};
  };
  const double stiffness = 3.0e6;
  const LinearSpring elastic{.normal = stiffness, .damping = LinearSpring::zeta(1.0)};
  const LinearSpring damped{.normal = stiffness, .damping = LinearSpring::zeta(0.5)};
  Series h1 = curve("Hertz, e = 1", report::palette::blue);
  Series h5 = curve("Hertz and Tsuji, e = 0.5", report::palette::blue, "6 3");
  Series l1 = curve("linear spring, e = 1", report::palette::vermillion);
  Series l5 = curve("linear spring, e = 0.5", report::palette::vermillion, "6 3");
  EXPECT_NEAR(impact(hertz(1.0), radius, mass, 1.0, h1), 1.0, 1e-3);
  EXPECT_NEAR(impact(hertz(0.5), radius, mass, 1.0, h5), 0.5, 2e-3);
  EXPECT_NEAR(impact(elastic, radius, mass, 1.0, l1), 1.0, 1e-3);
  // Its contact ends at zero overlap, where the dashpot pulls: the restitution is the one asked for.
  EXPECT_NEAR(impact(damped, radius, mass, 1.0, l5), 0.5, 2e-3);
  const double closed = 4.0 / 3.0 * 70e9 / (2.0 * 0.96) * std::sqrt(0.5 * radius) * std::pow(1e-6 * h1.x[20], 1.5);
  EXPECT_NEAR(h1.y[20], closed, 1e-9 * closed);
  expect_picture({.id = "impact",
                  .title = "Two glass beads of 1 mm meet at 1 m/s",
                  .x = {.label = "overlap h [\u00b5m]"},
                  .y = {.label = "normal force [N]"}},
                 {h1, h5, l1, l5}, "law_impact.svg");
}

/// Tangential force at constant overlap as the contact is moved to and fro.
template <class Law>
void to_and_fro(const Law& law, double overlap, double reach, Series& out) {
  ContactState<3> s;
  s.normal = {{0.0, 0.0, 1.0}};
  s.overlap = overlap;
  s.constants = law.pair_constants({1e-3, 1e-3});
  s.dt = 1.0;
  double way = 0.0;
  for (const double end : {reach, -reach, reach}) {
    const double step = (end - way) / 60.0;
    for (int k = 0; k < 60; ++k) {
      s.sliding = {{step, 0.0, 0.0}};
      const ContactResponse<3> r = law.evaluate(s);
      s.spring = r.spring;
      s.memory = r.memory;
      way += step;
      out.x.push_back(1e6 * way);
      out.y.push_back(r.tangential_force[0]);
    }
  }
}

TEST(LawPictures, Tangential) {
  const Material glass{.name = "glass", .density = 2500.0, .youngs_modulus = 70e9, .poisson_ratio = 0.2};
  const HertzMindlin<Tangential::mindlin, false> law{HertzCoefficients::of(glass, glass, 0.3, 1.0)};
  Series loop = curve("Mindlin spring, \u00b5 = 0.3, h = 1 \u00b5m", report::palette::blue);
  to_and_fro(law, 1e-6, 1e-6, loop);
  const double normal = 4.0 / 3.0 * 70e9 / (2.0 * 0.96) * std::sqrt(0.5e-3) * 1e-9;
  EXPECT_NEAR(*std::max_element(loop.y.begin(), loop.y.end()), 0.3 * normal, 1e-12);
  EXPECT_NEAR(*std::min_element(loop.y.begin(), loop.y.end()), -0.3 * normal, 1e-12);
  // kt = 8 G* sqrt(R* h), 1/G* = 2 (2 - nu)/G.
  const double shear = 70e9 / 2.4 / (2.0 * 1.8);
  EXPECT_NEAR(-loop.y[0] / (1e-6 * loop.x[0]), 8.0 * shear * std::sqrt(0.5e-3 * 1e-6), 1e-3);
  Series bound = curve("\u00b1 \u00b5 Fn", report::palette::grey, "3 3");
  bound.x = {-1.0, 1.0};
  bound.y = {0.3 * normal, 0.3 * normal};
  Series lower = bound;
  lower.label = "";
  lower.y = {-0.3 * normal, -0.3 * normal};
  expect_picture({.id = "tangential",
                  .title = "Two glass beads are pushed to and fro",
                  .x = {.label = "tangential way ht [\u00b5m]"},
                  .y = {.label = "tangential force [N]"}},
                 {loop, bound, lower}, "law_tangential.svg");
}

Series soft_curve(SoftContact law, const std::string& label, const char* color, double from, double to,
                  const std::string& dash) {
  Series out = curve(label, color, dash);
  const PairBodies bodies{kRadius, law.partner_is_soft ? kRadius : 0.0};
  ContactState<3> s;
  s.normal = {{0.0, 0.0, 1.0}};
  s.constants = law.pair_constants(bodies);
  for (int k = 0; k <= 60; ++k) {
    const double ratio = from + (to - from) * k / 60.0;
    s.overlap = ratio * kRadius;
    out.x.push_back(ratio);
    out.y.push_back(law.evaluate(s).normal_force);
  }
  return out;
}

TEST(LawPictures, SoftContacts) {
  const LawCard card = load_card(source("results/published/law.toml"));
  std::vector<Series> curves;
  for (const PairKind kind : {PairKind::soft_solid, PairKind::soft_soft}) {
    const char* color = kind == PairKind::soft_solid ? report::palette::blue : report::palette::vermillion;
    const double end = card.find(kind)->delta_max;
    SoftContact law = make_soft_contact(card, kind, kModulus, 0.3, 0.0, false);
    const Series inside = soft_curve(law, to_string(kind), color, 0.0, end, "");
    curves.push_back(inside);
    curves.push_back(soft_curve(law, to_string(kind) + ", extrapolated", color, end, 0.5, "6 3"));
    law.range.beyond = Extrapolation::clamp;
    const Series clamped = soft_curve(law, to_string(kind) + ", clamped", color, end, 0.5, "2 3");
    curves.push_back(clamped);
    for (std::size_t k = 0; k < inside.x.size(); ++k) {
      const ThresholdPowerLaw& n = card.find(kind)->normal;
      const double power = n.a.value * (std::pow(inside.x[k], n.b.value) - std::pow(n.delta.value, n.b.value));
      EXPECT_NEAR(inside.y[k], inside.x[k] < n.delta.value ? 0.0 : kModulus * kRadius * kRadius * power, 1e-12);
    }
    EXPECT_EQ(clamped.y.back(), clamped.y.front());
  }
  expect_picture({.id = "soft",
                  .title = "Soft particles of 16 mm, grains of 0.5 MPa: the card of results/published",
                  .x = {.label = "\u0394 = hn/Rs"},
                  .y = {.label = "normal force Fn [N]"}},
                 curves, "law_soft.svg");
}

/// Force per plane over E Rs^2 of a soft particle pressed by planes from the given sides.
double multi_contact_force(const MultiContactForm& form, bool bag, const std::vector<Vec3>& sides, double x) {
  const LostVolume nu = lost_volume(lens(x, 0.0), 1.0, 1.0);
  MultiContactSum<3> sum;
  for (const Vec3& n : sides) sum.add(nu.nu, n);
  sum.close(form.pressure, bag ? sum.volume : form.equivalent_volume(sum));
  return nu.slope * sum.gain * (bag ? sum.volume : form.felt(sum, nu.nu, sides.front()));
}

TEST(LawPictures, MultiContacts) {
  const LawTable table = load_law_table(source("results/law_table/law_table.toml"));
  const LawTableEntry& entry = table.entries.back();
  const std::vector<Vec3> one{{{0.0, 0.0, 1.0}}};
  std::vector<Vec3> six;
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0}) {
      Vec3 n{};
      n[k] = sign;
      six.push_back(n);
    }
  std::vector<Series> curves;
  for (const auto& [kind, text] : enum_names<LawForm>) {
    const std::string name = text;
    const MultiContactLaw& law = *entry.find(kind);
    const MultiContactForm form{{law.a.value, law.b.value, law.delta.value},
                                {law.m0.value, law.m1.value, law.m2.value}};
    const char* color = kind == LawForm::pair        ? report::palette::grey
                        : kind == LawForm::isotropic ? report::palette::vermillion
                                                     : report::palette::blue;
    Series alone = curve(name + ", one plane", color, "6 3");
    Series multi_contact = curve(name + ", six planes", color);
    for (int k = 0; k <= 50; ++k) {
      const double x = 0.2 * k / 50.0;
      alone.x.push_back(x);
      multi_contact.x.push_back(x);
      alone.y.push_back(multi_contact_force(form, kind == LawForm::isotropic, one, x));
      multi_contact.y.push_back(kind == LawForm::pair ? alone.y.back()
                                                      : multi_contact_force(form, kind == LawForm::isotropic, six, x));
      // One plane alone is the power law itself, whatever the coupling is.
      const double power =
          x > law.delta.value ? law.a.value * (std::pow(x, law.b.value) - std::pow(law.delta.value, law.b.value)) : 0.0;
      EXPECT_NEAR(alone.y.back(), power, 1e-9 + 1e-6 * power);
    }
    if (kind != LawForm::pair) {
      EXPECT_GT(multi_contact.y.back(), 2.0 * alone.y.back());
    }
    curves.push_back(alone);
    if (kind != LawForm::pair) curves.push_back(multi_contact);
  }
  expect_picture({.id = "crowd",
                  .title = "One and six planes: the table of results/law_table",
                  .x = {.label = "h/Rs of each plane"},
                  .y = {.label = "force of one plane over E Rs\u00b2"}},
                 curves, "law_multi_contact.svg");
}

TEST(LawPictures, Cohesion) {
  const CohesiveDisk<true, false> law{.normal = 1.0, .tangential = 1.0, .friction = 0.5, .adhesion = 1.0, .range = 1.5};
  Series normal = curve("normal force", report::palette::blue);
  Series cone = curve("largest tangential force, \u00b5 = 0.5", report::palette::vermillion, "6 3");
  ContactState<2> s;
  s.normal = {{0.0, 1.0}};
  s.constants = law.pair_constants({0.5, 0.5});
  for (int k = -80; k <= 120; ++k) {
    s.overlap = 0.025 * k;
    s.sliding = {{1e3, 0.0}};
    s.dt = 1.0;
    const ContactResponse<2> r = law.evaluate(s);
    normal.x.push_back(s.overlap);
    normal.y.push_back(r.normal_force);
    cone.x.push_back(s.overlap);
    cone.y.push_back(std::abs(r.tangential_force[0]));
    const double h = s.overlap;
    EXPECT_NEAR(r.normal_force, h > 0.0 ? h - 1.0 : h > -1.5 ? -(1.0 + h / 1.5) : 0.0, 1e-12);
    EXPECT_NEAR(cone.y.back(), h > 0.0 ? 0.5 * h : 0.0, 1e-12);
  }
  expect_picture({.id = "cohesion",
                  .title = "Cohesive disks; the range of attraction is drawn larger than it is",
                  .x = {.label = "K_N h/F0; negative: gap"},
                  .y = {.label = "force over F0"}},
                 {normal, cone}, "law_cohesion.svg");
}

TEST(LawPictures, TheComparisonCanFail) {
  EXPECT_TRUE(same_data("a\n1.00001 2e-3\n", "a\n1 0.002\n"));
  EXPECT_FALSE(same_data("a\n1.001 2\n", "a\n1 2\n"));
  EXPECT_FALSE(same_data("a\n1 2\n", "a\n1 2\n3 4\n"));
  EXPECT_FALSE(same_data("a\n1 2\n", "b\n1 2\n"));
}

}  // namespace
}  // namespace softgrain

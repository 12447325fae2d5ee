// Pictures of packs: series over strain and pressure; a slice, with discs where grains are cut and lines between the
// centres of grains in contact as wide as the force; the states that grain_box.h5 holds.
#include "pipelines/kinds/grain_box/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/core/particles.h"
#include "microsim/grain_box/box_measure.h"
#include "microsim/grain_box/record.h"
#include "pipelines/report/html.h"
#include "pipelines/report/svg_draw.h"

namespace softgrain::report {

namespace {

constexpr double kMegapascal = 1e6;
constexpr double kBinsPerDecade = 20.0;

}  // namespace

int main_axis(const GrainBoxResult& result) {
  if (result.state.points.empty()) return 2;
  const Vec3& e = result.state.points.back().strain;
  int axis = 2;
  for (int k = 0; k < 2; ++k)
    if (e[k] > e[axis] + 1e-9) axis = k;
  return axis;
}

Series over_strain(const GrainBoxResult& result, PointValue y, double unit, const SeriesStyle& style) {
  Series s{.label = result.spec.name, .hover = {}, .x = {}, .y = {}, .style = style};
  const int axis = main_axis(result);
  for (const BoxPoint& p : result.state.points) {
    if (p.phase < BoxPhase::friction) continue;
    s.x.push_back(100.0 * p.strain[axis]);
    s.y.push_back(y(p) * unit);
  }
  return s;
}

Series binned_over_pressure(const GrainBoxResult& result, double BoxPoint::*y, double unit, const SeriesStyle& style) {
  struct Bin {
    double x = 0.0;
    double y = 0.0;
    int count = 0;
  };
  std::map<int, Bin> bins;
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    if (!std::isfinite(p->*y) || !(p->pressure > 0.0)) continue;
    Bin& bin = bins[static_cast<int>(std::floor(kBinsPerDecade * std::log10(p->pressure)))];
    bin.x += p->pressure / kMegapascal;
    bin.y += p->*y * unit;
    ++bin.count;
  }
  Series s{.label = result.spec.name, .hover = {}, .x = {}, .y = {}, .style = style};
  for (const auto& [index, bin] : bins) {
    s.x.push_back(bin.x / bin.count);
    s.y.push_back(bin.y / bin.count);
  }
  return s;
}

Series over_pressure(const GrainBoxResult& result, double BoxPoint::*y, double unit, const SeriesStyle& style) {
  Series s{.label = {}, .hover = {}, .x = {}, .y = {}, .style = style};
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    if (!std::isfinite(p->*y)) continue;
    s.x.push_back(p->pressure / kMegapascal);
    s.y.push_back(p->*y * unit);
  }
  return s;
}

Series fitted_line(const PowerFit& fit, const std::array<double, 2>& range, double unit, const std::string& label,
                   const SeriesStyle& style) {
  Series s{.label = label, .hover = {}, .x = {}, .y = {}, .style = style, .sets_range = false};
  if (!std::isfinite(fit.exponent)) return s;
  for (const double pressure : range) {
    s.x.push_back(pressure / kMegapascal);
    s.y.push_back(unit * fit.prefactor * std::pow(pressure, fit.exponent));
  }
  return s;
}

namespace {

constexpr double kWidth = 560.0;
constexpr double kTop = 30.0;
constexpr double kMargin = 12.0;
/// Width of the line of a contact that carries five times the mean force [px], and the most it may be.
constexpr double kLineOfFive = 6.0;
constexpr double kWidestLine = 9.0;

/// Maps the plane of the slice (x to the right, z up) to pixels.
class SliceView {
 public:
  explicit SliceView(const GrainPack& pack) : pack_(pack) {
    low_ = {{pack.walls[0].point[0], pack.walls[2].point[1], pack.walls[4].point[2]}};
    lengths_ = box_lengths(pack);
    scale_ = (kWidth - 2.0 * kMargin) / lengths_[0];
    middle_ = low_[1] + 0.5 * lengths_[1];
    double sum = 0.0;
    for (const double r : pack.radius) sum += r;
    half_thickness_ = sum / static_cast<double>(pack.radius.size());
  }

  [[nodiscard]] double x(double at) const { return kMargin + (at - low_[0]) * scale_; }
  [[nodiscard]] double y(double at) const { return kTop + (low_[2] + lengths_[2] - at) * scale_; }
  [[nodiscard]] double height() const { return kTop + lengths_[2] * scale_ + kMargin; }
  [[nodiscard]] std::string discs() const;
  [[nodiscard]] std::string forces() const;
  [[nodiscard]] std::string frame() const;

 private:
  [[nodiscard]] bool in_slice(std::int32_t grain) const {
    return std::abs(pack_.position[static_cast<std::size_t>(grain)][1] - middle_) <= half_thickness_;
  }

  const GrainPack& pack_;
  Vec3 low_{};
  Vec3 lengths_{};
  double scale_ = 1.0;
  double middle_ = 0.0;
  double half_thickness_ = 0.0;
};

std::string SliceView::discs() const {
  std::string out = "<g fill=\"#e9edf0\" stroke=\"#9aa7b0\" stroke-width=\"0.7\">\n";
  for (std::size_t n = 0; n < pack_.radius.size(); ++n) {
    const double off = pack_.position[n][1] - middle_;
    const double r2 = pack_.radius[n] * pack_.radius[n] - off * off;
    if (r2 <= 0.0) continue;
    out += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n", svg::number(x(pack_.position[n][0])),
                       svg::number(y(pack_.position[n][2])), svg::number(std::sqrt(r2) * scale_));
  }
  return out + "</g>\n";
}

std::string SliceView::forces() const {
  const double mean = count_contacts(pack_).mean_force;
  if (!(mean > 0.0)) return "";
  std::string sticking;
  std::string sliding;
  for (const PackContact& c : pack_.contacts) {
    const bool wall = c.j >= pack_.grains();
    if (!(c.normal_force > 0.0) || !in_slice(c.i) || (!wall && !in_slice(c.j))) continue;
    const Vec3& a = pack_.position[static_cast<std::size_t>(c.i)];
    const Vec3 b = wall ? a - c.normal * (pack_.radius[static_cast<std::size_t>(c.i)] - c.overlap)
                        : pack_.position[static_cast<std::size_t>(c.j)];
    const double width = std::min(kWidestLine, kLineOfFive / 5.0 * c.normal_force / mean);
    (c.sliding ? sliding : sticking) +=
        fmt::format("<path d=\"M{} {}L{} {}\" stroke-width=\"{}\"/>\n", svg::number(x(a[0])), svg::number(y(a[2])),
                    svg::number(x(b[0])), svg::number(y(b[2])), svg::number(width));
  }
  return fmt::format(
      "<g stroke=\"{}\" stroke-linecap=\"round\">\n{}</g>\n<g stroke=\"{}\" stroke-linecap=\"round\">\n{}</g>\n",
      palette::blue, sticking, palette::vermillion, sliding);
}

std::string SliceView::frame() const {
  return fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#1a1a1a\"/>\n",
                     svg::number(kMargin), svg::number(kTop), svg::number(lengths_[0] * scale_),
                     svg::number(lengths_[2] * scale_));
}

}  // namespace

std::string pack_view(const GrainBoxResult& result) {
  const GrainPack& pack = result.state.pack;
  if (pack.walls.size() != static_cast<std::size_t>(kBoxWalls) || pack.radius.empty()) return "";
  const SliceView view(pack);
  const std::string title = "Slice: " + result.spec.name;
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
             "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" fill=\"#1a1a1a\">\n",
             svg::number(kWidth), svg::number(view.height()), escape(title)) +
         svg::text(kMargin, 16.0, title, {.size = 13.5, .anchor = "start", .bold = true}) + view.discs() +
         view.forces() + view.frame() + "</svg>\n";
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

/// Point of a contact. For two spheres it lies in the plane of the circle in which they meet.
Vec3 contact_point(const GrainPack& pack, const PackContact& c) {
  const auto i = static_cast<std::size_t>(c.i);
  const double ri = pack.radius[i];
  double arm = ri - c.overlap;
  if (c.j < pack.grains()) {
    const double rj = pack.radius[static_cast<std::size_t>(c.j)];
    const double distance = ri + rj - c.overlap;
    arm = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
  }
  return pack.position[i] - c.normal * arm;
}

void add_bodies(const GrainPack& pack, double density, Snapshot& s) {
  for (std::size_t k = 0; k < pack.radius.size(); ++k) {
    SnapshotParticle p;
    p.position = pack.position[k];
    p.radius = pack.radius[k];
    p.mass = density * kSphereVolume * p.radius * p.radius * p.radius;
    p.id = p.body = static_cast<std::int64_t>(k);
    s.particles.push_back(p);
  }
  for (const PackWall& w : pack.walls) {
    SnapshotWall wall;
    wall.point = w.point;
    wall.normal = w.normal;
    s.walls.push_back(wall);
  }
}

Snapshot picture_of(const GrainBoxResult& result) {
  const GrainPack& pack = result.state.pack;
  Snapshot s;
  s.kind = SnapshotKind::grain_box;
  s.series = result.spec.name;
  add_bodies(pack, result.spec.material.density, s);
  s.has_contacts = true;
  for (const PackContact& c : pack.contacts) {
    SnapshotContact out;
    out.i = c.i;
    out.j = c.j;
    out.from = pack.position[static_cast<std::size_t>(c.i)];
    out.point = contact_point(pack, c);
    out.to = c.j < pack.grains() ? pack.position[static_cast<std::size_t>(c.j)] : out.point;
    out.force = c.normal * c.normal_force + c.tangential_force;
    out.normal_force = c.normal_force;
    s.contacts.push_back(out);
  }
  if (!result.state.points.empty()) {
    const Vec3& strain = result.state.points.back().strain;
    s.strain = *std::max_element(strain.v.begin(), strain.v.end());
    s.frame = static_cast<std::int64_t>(result.state.points.size()) - 1;
  }
  s.label = fmt::format("grain box {}, strain {:.4g}", result.spec.name, std::isnan(s.strain) ? 0.0 : s.strain);
  return s;
}

}  // namespace

void visit_grain_boxes(const std::string& path, SnapshotChoice /*choice*/, const VisitSnapshot& visit) {
  for (const GrainBoxResult& result : load_grain_boxes(path)) visit(picture_of(result));
}

}  // namespace softgrain

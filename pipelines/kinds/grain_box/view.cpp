// A slice through a pack: discs where grains are cut, lines between the centres of grains in contact as wide as the
// force.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "microsim/grain_box/box_measure.h"
#include "pipelines/kinds/grain_box/curves.h"
#include "pipelines/report/html.h"
#include "pipelines/report/svg_draw.h"

namespace softgrain::report {

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

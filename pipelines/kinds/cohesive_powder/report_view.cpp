#include "pipelines/kinds/cohesive_powder/report_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "pipelines/report/html.h"
#include "pipelines/report/svg_draw.h"

namespace softgrain::report {

namespace {

constexpr double kWidth = 620.0;
constexpr double kTop = 30.0;
constexpr double kMargin = 10.0;
constexpr double kLegend = 26.0;
/// The most a line may be wide [a].
constexpr double kWidestLine = 0.7;
/// Lines of nearly the same width share an element, so that the file stays small.
constexpr double kWidthStep = 0.15;

constexpr const char* kCompressive = "#c8102e";
constexpr const char* kTensile = "#00843d";
constexpr const char* kBlue = "#1f5fd0";
constexpr const char* kDisk = "#f4ecd8";
constexpr const char* kIdleDisk = "#b4b4b4";

/// A coordinate with one decimal, in as few letters as possible.
std::string coordinate(double px) {
  std::string text = fmt::format("{:.1f}", px);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

/// The cell in pixels, y up.
struct CellView {
  Vec<2> lengths{};
  double left = 0.0;
  double top = 0.0;
  double scale = 1.0;  ///< [px per a]

  [[nodiscard]] double x(double at) const { return left + at * scale; }
  [[nodiscard]] double y(double at) const { return top + (lengths[1] - at) * scale; }
  [[nodiscard]] double width() const { return lengths[0] * scale; }
  [[nodiscard]] double height() const { return lengths[1] * scale; }
  [[nodiscard]] Vec<2> folded(Vec<2> at) const {
    for (int k = 0; k < 2; ++k) at[k] -= lengths[k] * std::floor(at[k] / lengths[k]);
    return at;
  }
};

/// Calls draw(image) for every image of a box around `at` that touches the cell. `at` lies in the cell.
template <class Draw>
void for_images(const CellView& view, const Vec<2>& low, const Vec<2>& high, const Draw& draw) {
  for (int p = -1; p <= 1; ++p)
    for (int q = -1; q <= 1; ++q) {
      const Vec<2> shift{{p * view.lengths[0], q * view.lengths[1]}};
      const bool inside = high[0] + shift[0] > 0.0 && low[0] + shift[0] < view.lengths[0] && high[1] + shift[1] > 0.0 &&
                          low[1] + shift[1] < view.lengths[1];
      if (inside) draw(shift);
    }
}

Vec<2> centre_of(const SnapshotParticle& disk) { return {{disk.position[0], disk.position[1]}}; }

/// Lengths of the periodic cell [a].
Vec<2> lengths_of(const Snapshot& s) { return {{s.cell_edges[0][0], s.cell_edges[1][1]}}; }

std::string circle(const CellView& view, const SnapshotParticle& disk) {
  const Vec<2> at = view.folded(centre_of(disk));
  const Vec<2> r{{disk.radius, disk.radius}};
  std::string out;
  for_images(view, at - r, at + r, [&](const Vec<2>& shift) {
    out += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n", coordinate(view.x(at[0] + shift[0])),
                       coordinate(view.y(at[1] + shift[1])), svg::number(disk.radius * view.scale));
  });
  return out;
}

std::string line(const CellView& view, const Vec<2>& centre, const Vec<2>& branch) {
  const Vec<2> from = view.folded(centre);
  const Vec<2> to = from - branch;
  const Vec<2> low{{std::min(from[0], to[0]), std::min(from[1], to[1])}};
  const Vec<2> high{{std::max(from[0], to[0]), std::max(from[1], to[1])}};
  std::string out;
  for_images(view, low, high, [&](const Vec<2>& shift) {
    out += fmt::format("M{} {}L{} {}", coordinate(view.x(from[0] + shift[0])), coordinate(view.y(from[1] + shift[1])),
                       coordinate(view.x(to[0] + shift[0])), coordinate(view.y(to[1] + shift[1])));
  });
  return out;
}

/// Lines of one colour, by width class.
class LineGroup {
 public:
  explicit LineGroup(std::string style) : style_(std::move(style)) {}
  void add(double width, const std::string& data) {
    by_width_[std::max<int>(1, static_cast<int>(std::lround(width / kWidthStep)))] += data;
  }
  [[nodiscard]] std::string svg() const {
    if (by_width_.empty()) return "";
    std::string out = "<g fill=\"none\" " + style_ + ">\n";
    for (const auto& [width, data] : by_width_)
      out += fmt::format("<path d=\"{}\" stroke-width=\"{}\"/>\n", data, svg::number(width * kWidthStep));
    return out + "</g>\n";
  }

 private:
  std::string style_;
  std::map<int, std::string> by_width_;
};

std::string solid_style(const char* color) { return fmt::format("stroke=\"{}\" stroke-linecap=\"round\"", color); }

std::string draw_contacts(const CellView& view, const PowderSample& sample, PowderLines lines, double zero) {
  LineGroup unstressed(solid_style(kBlue));
  LineGroup compressive(solid_style(kCompressive));
  LineGroup tensile(solid_style(kTensile));
  LineGroup distant(fmt::format("stroke=\"{}\" stroke-dasharray=\"2.5 1.5\"", kBlue));
  const double strong = strong_force(sample.contacts);
  const double thin = std::clamp(0.06 * view.scale, 0.8, 2.0);
  for (const auto& c : sample.contacts) {
    const bool idle = std::abs(c.normal_force) < zero;
    if (idle && lines == PowderLines::forces) continue;
    const double share = strong > 0.0 ? std::min(kStrongLine * std::abs(c.normal_force) / strong, kWidestLine) : 0.0;
    const double width = lines == PowderLines::forces ? share * view.scale : (idle ? 1.5 : 1.0) * thin;
    LineGroup& group = c.overlap <= 0.0 ? distant : idle ? unstressed : c.normal_force > 0.0 ? compressive : tensile;
    group.add(width, line(view, centre_of(sample.packing.particles[static_cast<std::size_t>(c.i)]), c.branch));
  }
  return compressive.svg() + tensile.svg() + unstressed.svg() + distant.svg();
}

std::string draw_disks(const CellView& view, const PowderSample& sample, double zero) {
  std::vector<bool> carries(sample.packing.particles.size(), false);
  for (const auto& c : sample.contacts)
    if (std::abs(c.normal_force) >= zero)
      carries[static_cast<std::size_t>(c.i)] = carries[static_cast<std::size_t>(c.j)] = true;
  std::string active;
  std::string idle;
  for (std::size_t n = 0; n < carries.size(); ++n)
    (carries[n] ? active : idle) += circle(view, sample.packing.particles[n]);
  const auto group = [](const char* fill, const std::string& content) {
    return fmt::format("<g fill=\"{}\" stroke=\"#8d8575\" stroke-width=\"0.5\">\n{}</g>\n", fill, content);
  };
  return group(kDisk, active) + group(kIdleDisk, idle);
}

struct LegendEntry {
  const char* color;
  const char* text;
  bool disk = false;
  bool dashed = false;
};

std::string draw_legend_row(const std::vector<LegendEntry>& entries, double y) {
  std::string out;
  double x = kMargin;
  for (const LegendEntry& e : entries) {
    out += e.disk ? fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"6\" fill=\"{}\" stroke=\"#8d8575\"/>",
                                svg::number(x + 10.0), svg::number(y), e.color)
                  : fmt::format("<path d=\"M{} {}h20\" stroke=\"{}\" stroke-width=\"3\"{}/>", svg::number(x),
                                svg::number(y), e.color, e.dashed ? " stroke-dasharray=\"4 2.4\"" : "");
    out += svg::text(x + 25.0, y + 4.0, e.text, {.size = 11.5, .anchor = "start"});
    x += 25.0 + svg::text_width(e.text, 11.5) + 10.0;
  }
  return out;
}

std::string frame_and_clip(const CellView& view, const std::string& id, const std::string& content) {
  const std::string rectangle =
      fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", svg::number(view.left), svg::number(view.top),
                  svg::number(view.width()), svg::number(view.height()));
  return fmt::format("<clipPath id=\"{}\">{}/></clipPath>\n<g clip-path=\"url(#{})\">\n{}</g>\n", id, rectangle, id,
                     content) +
         rectangle + " fill=\"none\" stroke=\"#1a1a1a\"/>\n";
}

std::string open_svg(double width, double height, const std::string& title) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
      "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" fill=\"#1a1a1a\">\n",
      svg::number(width), svg::number(height), escape(title));
}

bool drawable(const Snapshot& s) {
  const Vec<2> lengths = lengths_of(s);
  return !s.particles.empty() && lengths[0] > 0.0 && lengths[1] > 0.0 && std::isfinite(lengths[0] + lengths[1]);
}

/// Letters and digits of a title: unique in a page as titles are.
std::string id_of(const std::string& title) {
  std::string id = "clip-";
  for (const char c : title)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) id += c;
  return id;
}

}  // namespace

double strong_force(const std::vector<ContactRecord<2>>& contacts) {
  std::vector<double> force;
  for (const auto& c : contacts) force.push_back(std::abs(c.normal_force));
  if (force.empty()) return 0.0;
  std::sort(force.begin(), force.end());
  return force[static_cast<std::size_t>(0.95 * static_cast<double>(force.size() - 1))];
}

std::string packing_view(const PowderSample& sample, PowderLines lines, double zero, const std::string& title) {
  if (!drawable(sample.packing)) return "";
  const Vec<2> lengths = lengths_of(sample.packing);
  const CellView view{lengths, kMargin, kTop, (kWidth - 2.0 * kMargin) / lengths[0]};
  const double bottom = kTop + view.height();
  std::vector<LegendEntry> legend{{kCompressive, "compressive"}, {kTensile, "tensile"}};
  if (lines == PowderLines::stressed) legend.push_back({kBlue, "unstressed"});
  legend.push_back({kBlue, "distant pair", false, true});
  legend.push_back({kIdleDisk, "disk without force", true});
  return open_svg(kWidth, bottom + kLegend, title) +
         svg::text(kMargin, 18.0, title, {.size = 13.5, .anchor = "start", .bold = true}) +
         frame_and_clip(view, id_of(title), draw_disks(view, sample, zero) + draw_contacts(view, sample, lines, zero)) +
         draw_legend_row(legend, bottom + 0.5 * kLegend) + "</svg>\n";
}

std::string snapshot_view(const Snapshot& snapshot, double scale, double width, const std::string& title) {
  if (!drawable(snapshot)) return "";
  const Vec<2> lengths = lengths_of(snapshot);
  const CellView view{lengths, 0.5 * (width - lengths[0] * scale), 22.0, scale};
  std::string disks = "<g fill=\"#56677a\">\n";
  for (const SnapshotParticle& d : snapshot.particles) disks += circle(view, d);
  return open_svg(width, 22.0 + view.height() + 2.0, title) + svg::text(0.5 * width, 14.0, title, {.size = 12.0}) +
         frame_and_clip(view, id_of(title), disks + "</g>\n") + "</svg>\n";
}

}  // namespace softgrain::report

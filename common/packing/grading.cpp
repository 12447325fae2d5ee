#include "common/packing/grading.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {

namespace {

/// Integral of r^power/r over [low, high].
double power_integral(double low, double high, double power) {
  const double length = std::log(high / low);
  if (std::abs(power * length) < 1e-8) return std::pow(low, power) * length * (1.0 + 0.5 * power * length);
  return std::pow(low, power) * std::expm1(power * length) / power;
}

std::string ends_text(double rmin, double rmax) {
  return fmt::format("radius_min = {}\nradius_max = {}\n", rmin, rmax);
}

std::string piece_text(const SizePiece& p) {
  const std::string material = p.material == 0 ? "" : fmt::format(", material = {}", p.material);
  if (p.low == p.high) return fmt::format("{{radius = {}, volume_share = {}{}}}", p.low, p.volume, material);
  return fmt::format("{{radius_min = {}, radius_max = {}, exponent = {}, volume_share = {}{}}}", p.low, p.high,
                     p.exponent, p.volume, material);
}

bool nearly(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }

constexpr int kSpheres = 3;

void scale_to(std::vector<SizePiece>& pieces, double share) {
  double all = 0.0;
  for (const SizePiece& p : pieces) all += p.volume;
  for (SizePiece& p : pieces) p.volume *= share / all;
}

}  // namespace

double SizePiece::passing(double r, int power) const {
  if (r <= low) return 0.0;  // grains of exactly this size do not pass
  if (r >= high) return 1.0;
  const double p = 1.0 + power - exponent;
  return power_integral(low, r, p) / power_integral(low, high, p);
}

double SizePiece::mean_power(int power) const {
  if (low == high) return std::pow(low, power);
  return power_integral(low, high, 1.0 + power - exponent) / power_integral(low, high, 1.0 - exponent);
}

double SizePiece::radius(double u) const {
  if (low == high) return low;
  const double power = 1.0 - exponent;
  const double length = std::log(high / low);
  const double x = std::abs(power * length) < 1e-8 ? u * length : std::log1p(u * std::expm1(power * length)) / power;
  return std::clamp(low * std::exp(x), low, high);
}

Grading::Grading(GradingForm form, std::string text, std::vector<SizePiece> pieces, int dimension)
    : form_(form),
      dimension_(dimension),
      text_(fmt::format("form = \"{}\"\n", to_string(form)) + std::move(text)),
      pieces_(std::move(pieces)) {
  double all = 0.0;
  for (const SizePiece& p : pieces_) {
    if (!(p.low > 0.0) || !(p.high >= p.low) || !std::isfinite(p.high) || !std::isfinite(p.exponent))
      throw InputError(fmt::format("sizes: from {:g} to {:g} m; sizes must be positive and ascend", p.low, p.high));
    if (!(p.volume >= 0.0) || !std::isfinite(p.volume))
      throw InputError(fmt::format("sizes: {:g} is no share of the volume", p.volume));
    all += p.volume;
  }
  if (!(all > 0.0)) throw InputError("sizes: no grain has any of them");
  std::erase_if(pieces_, [](const SizePiece& p) { return p.volume == 0.0; });
  double number = 0.0;
  double below = 0.0;
  for (SizePiece& p : pieces_) {
    p.volume /= all;
    number_.push_back(number += p.volume / p.mean_power(dimension));
    volume_.push_back(below);
    below += p.volume;
  }
  if (!(number > 0.0) || !std::isfinite(number))
    throw InputError("sizes: so small, or so far apart, that their numbers are no numbers");
  for (double& n : number_) n /= number;
  number_.back() = 1.0;
  for (std::size_t k = 1; k < pieces_.size(); ++k)
    if (pieces_[k].low < pieces_[k - 1].high) volume_.clear();
}

Grading Grading::power_law(double exponent, double rmin, double rmax, int dimension) {
  return {GradingForm::power_law,
          fmt::format("exponent = {}\n", exponent) + ends_text(rmin, rmax),
          {{rmin, rmax, exponent, 1.0}},
          dimension};
}

Grading Grading::fuller(double q, double rmin, double rmax, int dimension) {
  return {GradingForm::fuller,
          fmt::format("exponent = {}\n", q) + ends_text(rmin, rmax),
          {{rmin, rmax, 1.0 + dimension - q, 1.0}},
          dimension};
}

Grading Grading::log_normal(double median, double geometric_deviation, double rmin, double rmax, int dimension) {
  constexpr int kPieces = 400;
  const double sigma = std::log(geometric_deviation);
  if (!(sigma > 0.0) || !(median > 0.0)) throw InputError("sizes: a log-normal distribution needs a deviation above 1");
  if (!(rmax > rmin) || !(rmin > 0.0))
    throw InputError("sizes: radius_max must be above radius_min, and both positive");
  const auto below = [&](double r) { return gsl_cdf_ugaussian_P(std::log(r / median) / sigma); };
  std::vector<SizePiece> pieces;
  double low = rmin;
  for (int k = 1; k <= kPieces; ++k) {
    const double high = k == kPieces ? rmax : rmin * std::pow(rmax / rmin, static_cast<double>(k) / kPieces);
    pieces.push_back({low, high, 1.0 + dimension, below(high) - below(low)});
    low = high;
  }
  return {GradingForm::log_normal,
          fmt::format("radius_median = {}\ngeometric_deviation = {}\n", median, geometric_deviation) +
              ends_text(rmin, rmax),
          std::move(pieces), dimension};
}

Grading Grading::classes(std::vector<SizePiece> pieces, int dimension) {
  std::vector<std::string> texts;
  for (const SizePiece& p : pieces) texts.push_back(piece_text(p));
  return {GradingForm::classes, fmt::format("class = [{}]\n", fmt::join(texts, ", ")), std::move(pieces), dimension};
}

Grading Grading::sieve_curve(const std::vector<double>& sieve_radius, const std::vector<double>& passing,
                             int dimension) {
  std::vector<SizePiece> pieces;
  std::vector<double> openings;
  for (const double r : sieve_radius) openings.push_back(2.0 * r);
  for (std::size_t k = 1; k < sieve_radius.size(); ++k)
    pieces.push_back({sieve_radius[k - 1], sieve_radius[k], 1.0 + dimension, passing[k] - passing[k - 1]});
  return {GradingForm::sieve_curve,
          fmt::format("openings = [{}]\npassing = [{}]\n", fmt::join(openings, ", "), fmt::join(passing, ", ")),
          std::move(pieces), dimension};
}

Grading Grading::list(std::vector<double> radii, int dimension, std::vector<double> counts) {
  if (!counts.empty() && counts.size() != radii.size())
    throw InputError(fmt::format("sizes: {} counts of {} radii: one for each", counts.size(), radii.size()));
  if (std::all_of(counts.begin(), counts.end(), [](double n) { return n == 1.0; })) counts.clear();
  std::vector<std::pair<double, double>> grains;
  for (std::size_t k = 0; k < radii.size(); ++k) grains.emplace_back(radii[k], counts.empty() ? 1.0 : counts[k]);
  std::erase_if(grains, [](const auto& g) { return g.second == 0.0; });
  std::sort(grains.begin(), grains.end());
  std::vector<SizePiece> pieces;
  std::vector<double> sizes;
  std::vector<double> numbers;
  for (const auto& [r, n] : grains) {
    pieces.push_back({r, r, 1.0 + dimension, n * std::pow(r, dimension)});
    sizes.push_back(r);
    numbers.push_back(n);
  }
  std::string text = fmt::format("radii = [{}]\n", fmt::join(sizes, ", "));
  if (!counts.empty()) text += fmt::format("counts = [{}]\n", fmt::join(numbers, ", "));
  return {GradingForm::list, std::move(text), std::move(pieces), dimension};
}

std::string Grading::name() const {
  return fmt::format("{}, diameters from {:.4g} to {:.4g} mm", to_string(form_), 2e3 * smallest(), 2e3 * largest());
}

std::optional<double> Grading::exponent() const {
  const SizePiece& first = pieces_.front();
  return pieces_.size() == 1 && first.low < first.high ? std::optional(first.exponent) : std::nullopt;
}

double Grading::smallest() const {
  return std::min_element(pieces_.begin(), pieces_.end(), [](auto& a, auto& b) { return a.low < b.low; })->low;
}

double Grading::largest() const {
  return std::max_element(pieces_.begin(), pieces_.end(), [](auto& a, auto& b) { return a.high < b.high; })->high;
}

double Grading::passing(double r) const {
  if (volume_.empty()) {
    double sum = 0.0;
    for (const SizePiece& p : pieces_) sum += p.volume * p.passing(r, dimension_);
    return sum;
  }
  const auto after = std::lower_bound(pieces_.begin(), pieces_.end(), r, [](auto& p, double x) { return p.low < x; });
  if (after == pieces_.begin()) return 0.0;
  const auto k = static_cast<std::size_t>(after - pieces_.begin()) - 1;
  return volume_[k] + pieces_[k].volume * pieces_[k].passing(r, dimension_);
}

std::size_t Grading::piece_at(double u) const {
  return static_cast<std::size_t>(std::upper_bound(number_.begin(), number_.end() - 1, u) - number_.begin());
}

std::int32_t Grading::material(double u) const { return pieces_[piece_at(u)].material; }

double Grading::radius(double u) const {
  const std::size_t k = piece_at(u);
  const double before = k == 0 ? 0.0 : number_[k - 1];
  return pieces_[k].radius(std::clamp((u - before) / (number_[k] - before), 0.0, 1.0));
}

double Grading::mean_volume() const {
  double per_volume = 0.0;
  for (const SizePiece& p : pieces_) per_volume += p.volume / p.mean_power(dimension_);
  return 1.0 / per_volume;
}

std::vector<double> Grading::draw(std::size_t n, RandomStream& random) const {
  std::vector<double> radii;
  for (const DrawnGrain& g : draw_grains(n, random)) radii.push_back(g.radius);
  return radii;
}

std::vector<DrawnGrain> Grading::draw_grains(std::size_t n, RandomStream& random) const {
  const double place = random.uniform();
  std::vector<DrawnGrain> grains;
  for (std::size_t k = 0; k < n; ++k) {
    const double u = (static_cast<double>(k) + place) / static_cast<double>(n);
    grains.push_back({radius(u), material(u)});
  }
  std::ranges::stable_sort(grains, {}, &DrawnGrain::radius);  // classes may overlap
  return grains;
}

double Grading::largest_difference(const std::vector<double>& radii) const {
  constexpr double kSame = 1e-9;  // sizes that differ by less are one: they were scaled on the way
  std::vector<double> sorted = radii;
  std::sort(sorted.begin(), sorted.end());
  double all = 0.0;
  for (const double r : sorted) all += volume(r);
  double below = 0.0;
  double worst = 0.0;
  for (std::size_t k = 0; k < sorted.size();) {
    const double r = sorted[k];
    const double before = below;
    for (; k < sorted.size() && sorted[k] <= r * (1.0 + kSame); ++k) below += volume(sorted[k]) / all;
    worst = std::max(
        {worst, std::abs(passing(r * (1.0 - kSame)) - before), std::abs(passing(r * (1.0 + 2.0 * kSame)) - below)});
  }
  return worst;
}

double Grading::obtained_passing(const std::vector<double>& radii, double r) const {
  double all = 0.0;
  double below = 0.0;
  for (const double x : radii) {
    all += volume(x);
    if (x < r) below += volume(x);
  }
  return below / all;
}

bool Grading::same_shape(double unit, const Grading& other, double other_unit) const {
  return dimension_ == other.dimension_ && std::equal(pieces_.begin(), pieces_.end(), other.pieces_.begin(),
                                                      other.pieces_.end(), [&](const SizePiece& a, const SizePiece& b) {
                                                        return nearly(a.low / unit, b.low / other_unit) &&
                                                               nearly(a.high / unit, b.high / other_unit) &&
                                                               nearly(a.volume, b.volume) && a.material == b.material &&
                                                               (a.low == a.high || nearly(a.exponent, b.exponent));
                                                      });
}

std::vector<SizePiece> pieces_between(const Grading& grading, double low, double high) {
  std::vector<SizePiece> out;
  for (const SizePiece& p : grading.pieces()) {
    if (p.low == p.high) {
      if (p.low >= low && p.low < high) out.push_back(p);
      continue;
    }
    const double from = std::max(low, p.low);
    const double to = std::min(high, p.high);
    if (!(from < to)) continue;
    out.push_back({from, to, p.exponent, p.volume * (p.passing(to, kSpheres) - p.passing(from, kSpheres)), p.material});
  }
  std::erase_if(out, [](const SizePiece& p) { return !(p.volume > 0.0); });
  return out;
}

Grading mixture_of(std::vector<SizePiece> coarse, std::vector<SizePiece> fines, double fines_share) {
  scale_to(coarse, 1.0 - fines_share);
  scale_to(fines, fines_share);
  coarse.insert(coarse.end(), fines.begin(), fines.end());
  return Grading::classes(std::move(coarse));
}

Grading sizes_or_power_law(const std::optional<Grading>& sizes, double exponent, double largest, double ratio) {
  return sizes ? *sizes : Grading::power_law(exponent, largest / ratio, largest);
}

}  // namespace softgrain

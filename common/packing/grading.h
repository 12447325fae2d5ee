// Size distributions of grains, whatever their form: pieces of power laws, each with a share of the volume.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"

namespace softgrain {

class RandomStream;

enum class GradingForm { power_law, fuller, log_normal, classes, sieve_curve, list };

template <>
inline constexpr auto enum_names<GradingForm> = enum_name_list<GradingForm>({{GradingForm::power_law, "power-law"},
                                                                             {GradingForm::fuller, "fuller"},
                                                                             {GradingForm::log_normal, "log-normal"},
                                                                             {GradingForm::classes, "classes"},
                                                                             {GradingForm::sieve_curve, "sieve-curve"},
                                                                             {GradingForm::list, "list"}});

/// Radii between low and high [m] with number density ~ r^-exponent; low = high: all alike.
struct SizePiece {
  double low = 0.0;
  double high = 0.0;
  double exponent = 4.0;      ///< 4: the volume of spheres is even over the logarithm of the size
  double volume = 1.0;        ///< share of the volume of all grains
  std::int32_t material = 0;  ///< what its grains are made of, place in GrainMaterials

  [[nodiscard]] double radius(double u) const;  ///< below it are u of its grains, 0 <= u <= 1
  /// The mean of r^power over its grains.
  [[nodiscard]] double mean_power(int power) const;
  /// Share of the sum of r^power in grains below r.
  [[nodiscard]] double passing(double r, int power) const;
};

/// A grain that is drawn from a distribution.
struct DrawnGrain {
  double radius = 0.0;  ///< [m]
  std::int32_t material = 0;
};

/// A distribution by volume ("passing" of a sieve analysis), from which the one by number follows. In the plane volumes
/// are areas of disks, as masses are.
class Grading {
 public:
  /// P(r) ~ r^-exponent by number [SP 1.1]. All of these throw InputError for sizes that are not positive or fall.
  static Grading power_law(double exponent, double rmin, double rmax, int dimension = 3);
  /// Volume passing ((r^q - rmin^q)/(rmax^q - rmin^q)): Fuller's curve with q = 1/2 and rmin = 0, Andreasen's and
  /// Andersen's with a least size [Dinger and Funk]. q != 0.
  static Grading fuller(double q, double rmin, double rmax, int dimension = 3);
  /// Logarithms of sizes normal by volume about that of the median, with deviation ln(geometric_deviation), cut off at
  /// both ends; passing within 3e-5 of the exact one over two decades.
  static Grading log_normal(double median, double geometric_deviation, double rmin, double rmax, int dimension = 3);
  /// Shares of volume are scaled to 1; classes may overlap.
  static Grading classes(std::vector<SizePiece> pieces, int dimension = 3);
  /// Passing known at some sizes, straight over the logarithm of the size between: sieve_radius ascends, passing from 0
  /// to 1.
  static Grading sieve_curve(const std::vector<double>& sieve_radius, const std::vector<double>& passing,
                             int dimension = 3);
  /// Grading of given grains: `counts` of each radius (weights by number, any sum), one of each where it is empty.
  static Grading list(std::vector<double> radii, int dimension = 3, std::vector<double> counts = {});

  [[nodiscard]] GradingForm form() const { return form_; }
  /// The keys and values that read_grading makes the same distribution of, a line each; equal texts: equal radii.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// "sieve-curve, diameters from 0.5 to 4 mm".
  [[nodiscard]] std::string name() const;
  [[nodiscard]] const std::vector<SizePiece>& pieces() const { return pieces_; }
  /// b of the number density ~ r^-b; empty where the sizes are no single power law, and where all are alike.
  [[nodiscard]] std::optional<double> exponent() const;
  [[nodiscard]] double smallest() const;
  [[nodiscard]] double largest() const;
  /// Share of the volume in grains smaller than r.
  [[nodiscard]] double passing(double r) const;
  /// Radius below which u of all grains are, by number, 0 <= u <= 1; where classes overlap, one class after another.
  [[nodiscard]] double radius(double u) const;
  /// What a grain of radius(u) is made of.
  [[nodiscard]] std::int32_t material(double u) const;
  [[nodiscard]] int dimension() const { return dimension_; }
  /// r^3, of disks r^2.
  [[nodiscard]] double volume(double r) const { return dimension_ == 2 ? r * r : r * r * r; }
  /// <r^3> over grains [m^3], of disks <r^2> [m^2].
  [[nodiscard]] double mean_volume() const;
  /// `n` radii, one from each of n equal shares of the number at the same random place in each: without bias, and with
  /// less scatter of the volume than independent ones. Ascending. A list of n radii gives these.
  [[nodiscard]] std::vector<double> draw(std::size_t n, RandomStream& random) const;
  /// The same grains with what they are made of: of pieces that overlap, each has its share of the number.
  [[nodiscard]] std::vector<DrawnGrain> draw_grains(std::size_t n, RandomStream& random) const;
  /// Largest difference between the passing of radii and the one asked for, beside each grain. None can be below half
  /// the volume share of the largest grain, and one that is drawn is not above that share.
  [[nodiscard]] double largest_difference(const std::vector<double>& radii) const;
  /// Volume of `radii` smaller than `r`, over that of all.
  [[nodiscard]] double obtained_passing(const std::vector<double>& radii, double r) const;

  friend bool operator==(const Grading& a, const Grading& b) {
    return a.dimension_ == b.dimension_ && a.text_ == b.text_;
  }
  /// Whether both are the same law, each in its own unit of length.
  [[nodiscard]] bool same_shape(double unit, const Grading& other, double other_unit) const;

 private:
  Grading(GradingForm form, std::string text, std::vector<SizePiece> pieces, int dimension);

  /// Place of the piece with radius(u).
  [[nodiscard]] std::size_t piece_at(double u) const;

  GradingForm form_ = GradingForm::list;
  int dimension_ = 3;
  std::string text_;
  std::vector<SizePiece> pieces_;
  std::vector<double> number_;  ///< share of the number in the pieces up to each, the last 1
  std::vector<double> volume_;  ///< share of the volume in the pieces before each; empty: pieces overlap
};

// Coarse and fine parts of a size distribution of spheres, and mixtures that have other shares of them.

/// The grains from `low` to below `high`, with their shares of the volume of all; exact, whatever the form. Empty where
/// there are none.
std::vector<SizePiece> pieces_between(const Grading& grading, double low, double high);

/// Both together; the fines have this share of the volume, and each part keeps its own distribution. One part may be
/// empty when its share is 0. Throws InputError as Grading does.
Grading mixture_of(std::vector<SizePiece> coarse, std::vector<SizePiece> fines, double fines_share);

/// The sizes, or where there are none P(r) ~ r^-exponent up to `largest`, `ratio` times the smallest.
Grading sizes_or_power_law(const std::optional<Grading>& sizes, double exponent, double largest, double ratio);

/// Truncated power-law radii P(r) ~ r^-b, rmin < r < rmax [SP 1.1].
struct PowerLawRadii {
  double exponent = 3.5;  ///< b, not 1
  double rmin = 0.0;
  double rmax = 0.0;

  /// Inverse of the cumulative distribution at u in [0, 1]:
  /// r = [rmin^(1-b) + u (rmax^(1-b) - rmin^(1-b))]^(1/(1-b)).
  [[nodiscard]] double radius(double u) const;

  /// Share of grains with radius above r (complementary cumulative distribution).
  [[nodiscard]] double share_above(double r) const;
};

/// Maximum-likelihood exponent of radii, truncated at the smallest and largest of them, with its standard error
/// (Fisher information). Throws InputError with fewer than 3 different radii.
struct ExponentFit {
  double exponent = 0.0;
  double standard_error = 0.0;
};
ExponentFit fit_exponent(const std::vector<double>& radii);

}  // namespace softgrain

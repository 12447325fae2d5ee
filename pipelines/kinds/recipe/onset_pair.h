// Onsets of two mixes and what follows from them, with the error of the difference.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/kinds/recipe/mix_run.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {

/// A number of one mix from its onset, and K and n of its fit.
using NumberOf = std::function<double(double onset, double modulus, double exponent)>;
inline double onset_itself(double onset, double /*modulus*/, double /*exponent*/) { return onset; }

/// By levels, by rods, and between them as the run takes it (LevelForms).
inline constexpr std::size_t kJoinedWays = 3;
struct OnsetWays {
  std::array<double, kJoinedWays> value{};
  std::array<std::vector<double>, kJoinedWays> replicates;
};

/// The same of both mixes, replicate r of one together with replicate r of the other.
struct OnsetPair {
  OnsetWays a;
  OnsetWays b;
  /// By how much each way may be off for one mix more than for the other.
  std::array<double, kJoinedWays> model{};
  double model_degrees = 1.0;  ///< degrees of freedom of that
  double widen = 0.0;          ///< by how much the checks of both miss their intervals differently
};

/// A scatter is not known when more of its replicates than this share have no number: what is left is a choice of them.
inline constexpr double kMostUndefined = 0.1;

/// Onsets of all levels of two recipes with the same numbers of levels. What the error of a difference consists of:
/// - scatter of packings: replicates_together(), those that are in both count once;
/// - rods: how far packings lie off them changes from mix to mix, by neighbour_slope() of these distances times
///   moved_share(), at most by the deviations of both runs together; levels have no error of this kind, as with one
///   recipe;
/// - where checks lie outside their intervals: by how much the distances of A and B differ.
class PairedOnsets {
 public:
  /// Keeps references to the runs. Throws NotPaired, UnusableResult.
  PairedOnsets(const MixRun& a, const MixRun& b);

  /// `count` levels from `first` on.
  [[nodiscard]] OnsetPair joined(std::size_t first, std::size_t count) const;
  /// One packing of each, as measured; nothing where the fits do not have them.
  [[nodiscard]] std::optional<OnsetPair> measured(std::size_t variant_a, std::size_t variant_b) const;

  /// What the value of a mix gives.
  [[nodiscard]] double value(const OnsetPair& pair, bool of_a, const NumberOf& number) const;
  /// `difference`, of the values of the runs, with an error: the interval holds that about itself and those about the
  /// differences by levels and by rods. Each adds scatter, model and `more` in squares (with_error_parts). Without an
  /// error where more than kMostUndefined of the replicates have no number.
  [[nodiscard]] Estimate difference(double difference, const OnsetPair& pair, const NumberOf& of_a,
                                    const NumberOf& of_b, const std::vector<ErrorPart>& more) const;

  /// Share of the replicates of a difference for which a number is not defined, in the way that has most of them.
  [[nodiscard]] double undefined_share(const OnsetPair& pair, const NumberOf& of_a, const NumberOf& of_b) const;

  /// Share of the solid volume of these levels that has another size in the other mix.
  [[nodiscard]] double moved(std::size_t first, std::size_t count) const;
  [[nodiscard]] bool shared(const std::string& in_a, const std::string& in_b) const;
  /// Whether the other run has this packing of A or B too.
  [[nodiscard]] bool in_both(bool of_a, const std::string& name) const;
  [[nodiscard]] std::size_t same() const { return same_; }                      ///< packings that are in both
  [[nodiscard]] std::size_t packings() const { return fits_.b.groups.size(); }  ///< packings of B
  [[nodiscard]] const PairedFits& fits() const { return fits_; }

 private:
  /// Differences of a number, replicate by replicate, in one of the ways; NaN where it is not defined.
  [[nodiscard]] std::vector<double> replicates_of(const OnsetPair& pair, const NumberOf& of_a, const NumberOf& of_b,
                                                  std::size_t way) const;
  [[nodiscard]] OnsetWays ways_of(const LevelForms& forms, double share_of_rods, std::size_t first,
                                  std::size_t count) const;
  [[nodiscard]] double widen() const;

  const MixRun& a_;
  const MixRun& b_;
  std::map<std::string, std::string> shared_;  ///< name in B: name in A
  PairedFits fits_;
  std::size_t same_ = 0;
  LevelForms forms_a_;
  LevelForms forms_b_;
  NeighbourSlope slope_;
};

}  // namespace softgrain

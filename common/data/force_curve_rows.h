// Inner side of force_curves.h: the rows of a file into samples, once it is known which column is what.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/data/force_curves.h"
#include "common/io/csv_file.h"

namespace softgrain {

/// Where each quantity stands in a file; `none` when it is not there.
struct CurveLayout {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t hn = none, delta = none, fn = none, error = none, sample = none, ht = none, ft = none, kt = none,
              branch = none;
  std::string repeat;                                                  ///< number of the repeat; empty: no repeats
  double touch = 0.0;                                                  ///< displacement at first touch [m]
  double zero_force = 0.0;                                             ///< force that is read without contact [N]
  double machine_stiffness = std::numeric_limits<double>::infinity();  ///< [N/m]
  std::string sample_name;  ///< sample name of all rows, from a comment; empty: the name of the file
};

/// Reads the rows of one file into samples.
class CurveRows {
 public:
  /// All are kept by reference; `out` has its spec.
  CurveRows(const CsvFile& file, const CurveLayout& at, const ForceCurveOptions& options, ForceCurves& out)
      : file_(file), at_(at), options_(options), out_(out) {}

  /// Throws InputError with file and line.
  void read();

 private:
  /// The rows that were turned at one overlap.
  struct Turn {
    double delta = std::numeric_limits<double>::quiet_NaN();
    bool after_reading = false;  ///< it follows a reading of the normal force at this overlap
    std::vector<double> angles;
  };

  /// A reading of negative overlap that follows one of the loading.
  struct Negative {
    int line = 0;
    double delta = 0.0;
    double force = 0.0;  ///< [N]; NaN: not said
  };

  [[nodiscard]] double required(const CsvRow& row, std::size_t column, Unit unit) const;
  [[nodiscard]] double overlap(const CsvRow& row) const;
  [[nodiscard]] bool has_force(const CsvRow& row) const;
  [[nodiscard]] bool is_rotated(const CsvRow& row) const;
  void add_tangential(const CsvRow& row, double delta, std::size_t sample);
  std::size_t sample_of(const CsvRow& row);  ///< index into the samples
  void add_before_touch(const CsvRow& row, double delta, std::size_t sample);
  void refuse_wrong_sign(const std::string& sample, const Negative& reading, double before, double after) const;
  void refuse_deepest_of_wrong_sign(const ForceCurve& sample, const Negative& reading) const;
  void add_normal(const CsvRow& row, double delta, std::size_t index);
  [[nodiscard]] bool returns(const CsvRow& row, double delta, const ForceCurve& sample) const;
  static void add_returned(const ForcePoint& point, ForceCurve& sample);
  void leave_out_jitter();
  void add_stiffness(const CsvRow& row, double delta, ForceCurve& sample) const;
  void note_falls();
  void require_enough() const;

  const CsvFile& file_;
  const CurveLayout& at_;
  const ForceCurveOptions& options_;
  ForceCurves& out_;
  std::unordered_map<std::string, std::size_t> index_;  ///< index of each sample by its name
  std::vector<std::vector<int>> lines_;                 ///< file lines of the normal points of each sample
  std::vector<Turn> turns_;                             ///< turn that each sample is in
  std::vector<std::optional<Negative>> negative_;       ///< the last reading of each sample, where it is one
  std::int64_t before_touch_ = 0;
  std::int64_t dropped_ = 0;
};

}  // namespace softgrain

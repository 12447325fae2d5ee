#include "common/packing/sieve_retained.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr double kRoundedSum = 0.01;  // percents of a dozen sieves, each rounded to 0.1 %
constexpr double kLoss = 0.02;        // of mass on the way through the sieves

bool near_all(double value, double all, double tolerance) { return std::abs(value - all) <= tolerance * all; }

class RetainedReader {
 public:
  RetainedReader(const RetainedTable& table, SieveColumn meaning) : table_(table), meaning_(meaning) {
    for (const RetainedRow& row : table.rows) take(row);
    if (table.pan && (std::isfinite(table.pan->value) || meaning == SieveColumn::retained)) take(*table.pan);
    if (values_.empty()) throw InputError(table.where_header + "no row has a sieve");
    for (const double v : values_) sum_ += v;
    rises_ = std::is_sorted(values_.begin(), values_.end());
  }

  RetainedCurve read() {
    if (meaning_ == SieveColumn::running) decide_direction();
    find_whole();
    if (meaning_ == SieveColumn::unclear) decide();
    RetainedCurve curve;
    if (meaning_ == SieveColumn::passing)
      for (const RetainedRow& row : table_.rows) curve.passing.push_back(row.value / whole_.value_or(values_.front()));
    else
      curve.passing = meaning_ == SieveColumn::retained ? from_each() : from_all();
    curve.meaning = meaning_;
    curve.remarks = remarks_;
    return curve;
  }

 private:
  void take(const RetainedRow& row) {
    if (!std::isfinite(row.value)) throw InputError(row.where + ": what is retained is missing");
    if (row.value < 0.0)
      throw InputError(fmt::format("{}: {} is retained; it must not be negative", row.where, row.cell));
    values_.push_back(row.value);
  }

  [[nodiscard]] bool has_pan() const { return table_.pan.has_value(); }

  /// What 100 % is in the column; of masses the total, where there is one.
  void find_whole() {
    if (table_.measure == SieveMeasure::percent || table_.measure == SieveMeasure::share) {
      whole_ = 1.0;
    } else {
      if (table_.measure == SieveMeasure::unknown)
        for (const double all : {100.0, 1.0})
          if (fits_each(all) || fits_all(all)) whole_ = all;
      percent_ = whole_.has_value();
      if (!whole_) whole_ = table_.total;
      if (whole_ && !(*whole_ > 0.0)) whole_.reset();
      return;
    }
    percent_ = true;
  }

  [[nodiscard]] double tolerance() const { return percent_ ? kRoundedSum : kLoss; }
  [[nodiscard]] bool fits_each(double all) const {
    return meaning_ != SieveColumn::cumulative && near_all(sum_, all, kRoundedSum);
  }
  [[nodiscard]] bool fits_all(double all) const {
    return meaning_ != SieveColumn::retained && rises_ && near_all(values_.back(), all, kRoundedSum);
  }

  void decide_direction() {
    const bool falls = std::is_sorted(values_.rbegin(), values_.rend());
    if (falls == rises_) refuse("is what passes, or what is retained in all", "passing");
    meaning_ = falls ? SieveColumn::passing : SieveColumn::cumulative;
    if (has_pan() && falls && values_.size() > table_.rows.size()) values_.pop_back();
  }

  void decide() {
    if (!rises_) {
      meaning_ = SieveColumn::retained;
      return;
    }
    if (!whole_) refuse("is what each sieve retains, or all sieves down to it", "retained");
    const double each = std::abs(sum_ - *whole_) / *whole_;
    const double all = std::abs(values_.back() - *whole_) / *whole_;
    const bool only_all = percent_ && !has_pan() && sum_ > (1.0 + kRoundedSum) * *whole_ && values_.back() < *whole_;
    if (std::min(each, all) <= tolerance())
      meaning_ = each < all ? SieveColumn::retained : SieveColumn::cumulative;
    else if (only_all)
      meaning_ = SieveColumn::cumulative;
    else
      refuse("is what each sieve retains, or all sieves down to it", "retained");
  }

  [[noreturn]] void refuse(const char* what, const char* other) const {
    throw InputError(
        fmt::format("{}column \"{}\" {}? Its numbers do not tell: give column = \"{}\" or column = "
                    "\"cumulative retained\" in the table of sizes of the scene",
                    table_.where_header, table_.title, what, other));
  }

  std::vector<double> from_each() {
    if (has_pan() && !std::isfinite(table_.pan->value))
      throw InputError(table_.pan->where + ": what is retained is missing");
    double all = sum_;
    const std::string total = whole_ ? rounded_text(percent_ && *whole_ == 1.0 ? 100.0 : *whole_, {6}) : "";
    if (whole_ && !near_all(sum_, *whole_, tolerance())) {
      if (has_pan() || sum_ > *whole_)
        throw InputError(fmt::format("{}column \"{}\": all sieves{} retain {}, not {}{}", table_.where_header,
                                     table_.title, has_pan() ? " and the pan" : "",
                                     rounded_text(percent_ && *whole_ == 1.0 ? 100.0 * sum_ : sum_, {6}), total,
                                     percent_ ? " %" : " as the line of the total says"));
      all = *whole_;
      remarks_.push_back("there is no row of a pan; what no sieve retains passes the finest");
    } else if (!has_pan() && !percent_) {
      remarks_.push_back("there is no row of a pan; nothing is taken to pass the finest sieve");
    }
    if (!(all > 0.0)) throw InputError(table_.where_header + "no sieve retains anything");
    return passing_of_sums(all);
  }

  /// Sums from the finest, so that all is exactly 1 where the coarsest sieve retains nothing.
  [[nodiscard]] std::vector<double> passing_of_sums(double all) const {
    std::vector<double> passing(table_.rows.size());
    double below = std::max(all - sum_, 0.0);
    if (has_pan()) below += table_.pan->value;
    for (std::size_t k = table_.rows.size(); k-- > 0; below += table_.rows[k].value) passing[k] = below;
    for (double& share : passing) share /= below;
    return passing;
  }

  std::vector<double> from_all() {
    const bool pan = values_.size() > table_.rows.size();
    double all = pan ? values_.back() : whole_.value_or(values_.back());
    if (pan && whole_ && !near_all(all, *whole_, tolerance()))
      throw InputError(
          fmt::format("{}: {} is retained down to the pan; it must be all", table_.pan->where, table_.pan->cell));
    if (!pan && !whole_)
      remarks_.push_back("there is no row of a pan and no total; nothing is taken to pass the finest sieve");
    if (!(all > 0.0)) throw InputError(table_.where_header + "no sieve retains anything");
    std::vector<double> passing;
    for (const RetainedRow& row : table_.rows) {
      if (row.value > all * (1.0 + 1e-9))
        throw InputError(fmt::format("{}: {} is retained in all; at most {} is there", row.where, row.cell,
                                     percent_ && *whole_ == 1.0 ? "100 %" : rounded_text(all, {6})));
      passing.push_back(std::max(all - row.value, 0.0) / all);
    }
    return passing;
  }

  const RetainedTable& table_;
  SieveColumn meaning_;
  std::vector<double> values_;  ///< from the coarsest sieve to the finest, and the pan
  double sum_ = 0.0;
  bool rises_ = false;
  std::optional<double> whole_;
  bool percent_ = false;  ///< `whole_` is 100 % rather than a mass
  std::vector<std::string> remarks_;
};

}  // namespace

RetainedCurve passing_of_retained(const RetainedTable& table, SieveColumn meaning) {
  return RetainedReader(table, meaning).read();
}

}  // namespace softgrain

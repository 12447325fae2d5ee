#include "common/data/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"

namespace softgrain {

namespace {

std::string text_of(const h5::Shape& shape) { return shape.empty() ? "1 number" : join_text(shape, " x "); }

std::string text_of(const Limits& limits) {
  if (!std::isfinite(limits.high)) return fmt::format("at least {}", limits.low);
  return fmt::format("{} to {}", limits.low, limits.high);
}

}  // namespace

void require_unit(const h5::Group& group, const std::string& name, const std::string& unit) {
  const std::string said = group.text_of(name, "unit");
  if (said == unit) return;
  throw IoError(said.empty() ? fmt::format("data set '{}' says no unit, '{}' is expected", name, unit)
                             : fmt::format("data set '{}' is in '{}', '{}' is expected", name, said, unit));
}

void require_shape(const h5::Group& group, const std::string& name, const h5::Shape& shape) {
  const h5::Shape there = group.shape(name);
  if (there == shape) return;
  throw IoError(fmt::format("data set '{}' has a wrong {}: {}, {} expected", name,
                            shape.size() == 1 && there.size() == 1 ? "length" : "shape", text_of(there),
                            text_of(shape)));
}

void require_within(double value, const Limits& limits, const std::string& name, std::size_t row) {
  if (!std::isfinite(value))
    throw IoError(fmt::format("data set '{}' holds a number that is not finite, in row {}", name, row));
  if (value < limits.low || value > limits.high)
    throw IoError(fmt::format("data set '{}' holds {} in row {}; allowed: {}", name, value, row, text_of(limits)));
}

std::vector<double> finite_numbers(const h5::Group& group, const std::string& name) {
  std::vector<double> values = group.doubles(name);
  const auto wrong = std::ranges::find_if(values, [](double x) { return !std::isfinite(x); });
  if (wrong != values.end())
    group.refuse(name, fmt::format("holds a number that is not finite, number {} of {}",
                                   std::distance(values.begin(), wrong) + 1, values.size()));
  return values;
}

void require_finite_content(const h5::Group& group) {
  for (const std::string& name : group.children())
    if (group.has_group(name))
      require_finite_content(group.open(name));
    else
      (void)finite_numbers(group, name);
}

std::vector<double> read_numbers(const h5::Group& group, const std::string& name, const std::string& unit,
                                 const h5::Shape& shape, const Limits& limits) {
  require_shape(group, name, shape);
  require_unit(group, name, unit);
  std::vector<double> values = group.doubles(name);
  const std::size_t width =
      shape.size() > 1 ? std::max<std::size_t>(values.size() / std::max<std::size_t>(shape[0], 1), 1) : 1;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (limits.finite) require_within(values[k], limits, name, k / width);
  return values;
}

double read_attribute(const h5::Group& group, const std::string& name, const Limits& limits) {
  const double value = group.number(name);
  if (!std::isfinite(value)) throw IoError(fmt::format("attribute '{}' is not finite", name));
  if (value < limits.low || value > limits.high)
    throw IoError(fmt::format("attribute '{}' is {}; allowed: {}", name, value, text_of(limits)));
  return value;
}

void StoredColumn::write(const h5::Group& group) const {
  const std::size_t numbers = whole ? wholes.size() : reals.size();
  const h5::Shape shape = form.width == 1 ? h5::Shape{} : h5::Shape{numbers / form.width, form.width};
  if (whole)
    group.write(name, std::span<const std::int64_t>(wholes), shape);
  else
    group.write(name, std::span<const double>(reals), shape);
  group.attribute_of(name, "unit", unit);
}

void StoredColumn::read(const h5::Group& group, std::size_t length) {
  if (!whole) {
    reals = read_numbers(group, name, unit, form.width == 1 ? h5::Shape{length} : h5::Shape{length, form.width},
                         form.limits);
    return;
  }
  require_shape(group, name, {length});
  require_unit(group, name, unit);
  wholes = group.integers(name);
  for (std::size_t k = 0; k < length; ++k) {
    const auto value = static_cast<double>(wholes[k]);
    if (form.unknown != nullptr && (value < form.limits.low || value > form.limits.high)) throw IoError(form.unknown);
    require_within(value, form.limits, name, k);
  }
}

std::size_t column_length(const h5::Group& group, const std::string& name) {
  const h5::Shape shape = group.shape(name);
  if (shape.size() != 1) throw IoError("data set '" + name + "' has a wrong shape: " + text_of(shape));
  return group.integers(name).size();
}

void write_histogram(const h5::Group& group, const Histogram& h) {
  group.attribute("low", h.low);
  group.attribute("high", h.high);
  group.attribute("below", h.below);
  group.attribute("above", h.above);
  group.write("counts", h.counts);
}

void add_counts(Histogram& sum, const Histogram& more) {
  for (std::size_t k = 0; k < sum.counts.size(); ++k) sum.counts[k] += more.counts[k];
  sum.below += more.below;
  sum.above += more.above;
}

}  // namespace softgrain

#include "tests/verification/page/page.h"

#include <cmath>
#include <utility>

#include "pipelines/report/number_format.h"

namespace softgrain::verification {

std::string error_text(double error) { return report::format_number(std::abs(error), 2); }

std::string relative_error(double here, double reference) { return error_text(here / reference - 1.0); }

std::string value_text(double value, int digits) { return report::format_number(value, digits); }

PageRow row(const std::string& what, const std::string& quantity, double reference, double here,
            const std::string& step) {
  return {what, quantity, value_text(reference), value_text(here), relative_error(here, reference), step};
}

report::Series series(const std::string& label, report::SeriesStyle style, std::vector<double> x,
                      std::vector<double> y) {
  report::Series out;
  out.label = label;
  out.style = std::move(style);
  out.x = std::move(x);
  out.y = std::move(y);
  return out;
}

report::SeriesStyle line(const char* color, const std::string& dash) {
  report::SeriesStyle out;
  out.color = color;
  out.dash = dash;
  return out;
}

report::SeriesStyle points(const char* color, report::Marker marker) {
  report::SeriesStyle out = line_and_points(color, marker);
  out.width = 0.0;
  return out;
}

report::SeriesStyle line_and_points(const char* color, report::Marker marker) {
  report::SeriesStyle out;
  out.color = color;
  out.marker = marker;
  return out;
}

}  // namespace softgrain::verification

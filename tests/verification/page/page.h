// The page of results/verification: what each family of cases contributes.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/svg_plot.h"

namespace softgrain::verification {

/// A row of the table, as it is printed.
struct PageRow {
  std::string what;       ///< case
  std::string quantity;   ///< with unit
  std::string reference;  ///< closed form, or what others measured
  std::string here;
  std::string error;
  std::string step;
};

struct PageFigure {
  std::string file;  ///< without ending
  std::string says;  ///< for those who do not see it
  std::string svg;
};

struct PageSection {
  std::string title;
  std::string text;  ///< Markdown
  std::vector<PageRow> rows;
  std::vector<PageFigure> figures;
};

PageSection impact_section();
PageSection oblique_section();
PageSection rolling_section();
PageSection restitution_section();
PageSection chain_section();
PageSection lattice_section();
PageSection energy_section();

/// "1.2e-5" as 1.2×10⁻⁵; relative error of `here` against `reference`, without sign.
std::string error_text(double error);
std::string relative_error(double here, double reference);
/// Significant digits.
std::string value_text(double value, int digits = 7);

/// A row with numbers: the error is relative.
PageRow row(const std::string& what, const std::string& quantity, double reference, double here,
            const std::string& step);

/// A curve; without data: to be filled.
report::Series series(const std::string& label, report::SeriesStyle style, std::vector<double> x = {},
                      std::vector<double> y = {});

/// A line, and markers without a line.
report::SeriesStyle line(const char* color, const std::string& dash = {});
report::SeriesStyle points(const char* color, report::Marker marker = report::Marker::circle);
report::SeriesStyle line_and_points(const char* color, report::Marker marker = report::Marker::circle);

}  // namespace softgrain::verification

// The style sheet and the scripts of a report. They are kept as files in pipelines/report/assets/ and become part of
// the program when it is built (cmake/embed_texts.cmake).
#pragma once

#include <string_view>

namespace softgrain::report::assets {

std::string_view report_css();  ///< style for screen, phone and print
std::string_view report_js();   ///< values under the pointer, legend entries that hide and show their curves
std::string_view packing_js();  ///< the packing in 3D, on top of three.js

}  // namespace softgrain::report::assets

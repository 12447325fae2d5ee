// The style sheet and the scripts of a report. They are kept as files in pipelines/report/assets/ and become part of
// the program when it is built (cmake/embed_texts.cmake).
#pragma once

#include <string_view>

namespace softgrain::report::assets {

std::string_view report_css();  ///< style for screen, phone and print
std::string_view report_js();   ///< values under the pointer, legend entries that hide and show their curves

// The packing in 3D, on top of three.js, in this order.
std::string_view packing_data_js();   ///< states and colours
std::string_view packing_scene_js();  ///< what is drawn
std::string_view packing_view_js();   ///< what the reader does

}  // namespace softgrain::report::assets

// The packing in 3D: states of the run, three.js from the installed package, and the scripts that draw with it.
#include <filesystem>
#include <optional>

#include "common/io/text_file.h"
#include "pipelines/report/html.h"
#include "pipelines/report/packing_data.h"
#include "pipelines/report/report.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

/// What the arrays of all states may take of the page [byte], and how many states a series may have.
constexpr std::size_t kBudget = 5'000'000;
constexpr std::size_t kStates = 24;

/// Debian's package libjs-three; other systems may put the same file there.
constexpr const char* kThree = "/usr/share/javascript/three/three.min.js";
constexpr const char* kThreeLicense = "/usr/share/doc/libjs-three/copyright";

/// The library, and with it the licence that has to go with every copy; nothing when they are not installed.
std::optional<std::string> three_js() {
  for (const char* file : {kThree, kThreeLicense})
    if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  const std::string source = read_text(kThree);
  // Such a text would end the element that holds it.
  if (source.find("</script") != std::string::npos) return std::nullopt;
  return "<script type=\"text/plain\" id=\"three-license\">\n" + escape(read_text(kThreeLicense)) + "</script>\n" +
         script(source);
}

}  // namespace

std::string packing_section(const RunData& run) {
  if (is_set(run)) return "";  // those of the runs are in their own reports
  std::vector<PackingSeries> series = packing_series_of(run.directory, kStates);
  std::erase_if(series, [](const PackingSeries& s) { return s.kind == SnapshotKind::powder; });  // has its own pictures
  if (series.empty()) return "";
  const std::optional<std::string> three = three_js();
  const std::string heading = "Packing in 3D";
  if (!three)
    return section("packing", heading, "The recorded states in three dimensions.",
                   paragraph(std::string("Left out: three.js is not installed (Debian package libjs-three, ") + kThree +
                             "). With it, softgrain report writes this page again with the packing."));
  const std::vector<std::string> left_out = fit_into(series, kBudget);
  std::string body =
      "<figure><div class=\"packing\" id=\"packing-view\"><p>The packing needs JavaScript and "
      "WebGL.</p></div>\n<figcaption>" +
      escape(
          "Drag to turn, wheel or two fingers to zoom, right button or shift to move; a click on a grain shows what it "
          "carries. Several recorded states: the slider goes to one, play through all. Tubes of force chains are as "
          "wide as the normal force; red pushes, green pulls.") +
      "</figcaption></figure>\n";
  for (const std::string& sentence : left_out) body += paragraph(sentence);
  body += "<script type=\"application/json\" id=\"packing-data\">" + packing_json(series) + "</script>\n" + *three;
  body += script(assets::packing_data_js()) + script(assets::packing_scene_js()) + script(assets::packing_view_js());
  return section("packing", heading, "The recorded states in three dimensions; drag to turn them.", body);
}

}  // namespace softgrain::report

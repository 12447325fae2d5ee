#include "pipelines/report/report.h"

#include <filesystem>

#include "common/io/text_file.h"
#include "pipelines/report/figures.h"
#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"

namespace softgrain {

void write_report(const std::string& run_directory) {
  using namespace report;
  const RunData run = load_run(run_directory);
  std::string body = own_data_section(run);
  body += inverse_section(run);
  body += law_table_section(run);
  body += hierarchy_section(run);
  body += normal_section(run);
  body += tangential_section(run);
  body += stiffness_section(run);
  body += laws_section(run);
  body += relaxations_section(run);
  body += macro_section(run);
  body += macro_scenes_section(run);
  body += packing_section(run);
  body += radii_section(run);
  body += particles_section(run);
  body += grain_box_section(run);
  body += powder_variants_section(run);
  body += powder_section(run);
  body += cost_section(run);
  body += provenance_section(run);
  body = heading_section(run) + contents(body) + remarks_section(run) + body;
  const std::string name = std::filesystem::weakly_canonical(run_directory).filename().string();
  std::filesystem::create_directories(run_directory + "/figures");
  for (const Figure& figure : figures_of(body))
    write_text_atomic(run_directory + "/figures/" + figure.name + ".svg", figure.svg);
  write_text_atomic(run_directory + "/report.html", page("softgrain: " + name, body));
}

}  // namespace softgrain

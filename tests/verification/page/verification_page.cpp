// Runs every outside case and writes what results/verification has of them: cases.csv, cases.md and a plot of each.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "common/core/text.h"
#include "common/io/provenance.h"
#include "pipelines/report/figure_table.h"
#include "tests/verification/page/page.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

constexpr const char* kHead = R"(# Outside cases: remarks and pictures

Written by `verification_page`, which the [page](README.md) explains; all numbers are in [cases.csv](cases.csv). Errors are relative unless
they carry a unit. No random numbers are drawn.)";

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file.string() + " cannot be written");
}

std::string table_of(const std::vector<PageSection>& sections) {
  TextTable table{{"case", "quantity", "reference", "here", "error", "step"}, {}};
  for (const PageSection& s : sections)
    for (const PageRow& r : s.rows) table.rows.push_back({r.what, r.quantity, r.reference, r.here, r.error, r.step});
  return as_csv(table);
}

std::string text_of(const PageSection& section) {
  std::string out = "\n## " + section.title + "\n\n" + section.text + "\n";
  for (const PageFigure& f : section.figures) out += "\n![" + f.says + "](" + f.file + ".svg)\n";
  return out;
}

void write_page(const std::filesystem::path& directory) {
  const std::vector<PageSection> sections{impact_section(), oblique_section(), rolling_section(), restitution_section(),
                                          chain_section(),  lattice_section(), energy_section()};
  std::filesystem::create_directories(directory);
  std::string page = kHead + (" Version " + build_provenance().version + ".\n");
  for (const PageSection& s : sections) {
    page += text_of(s);
    for (const PageFigure& f : s.figures) write(directory / (f.file + ".svg"), report::without_table(f.svg).svg + "\n");
  }
  write(directory / "cases.md", page);
  write(directory / "cases.csv", table_of(sections));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "verification_page DIR: writes cases.csv, cases.md and its pictures\n");
    return 2;
  }
  try {
    write_page(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 3;
  }
  return 0;
}

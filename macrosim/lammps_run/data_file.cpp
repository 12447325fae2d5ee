#include "macrosim/lammps_run/data_file.h"

#include <fmt/format.h>

#include <fstream>

#include "common/core/error.h"
#include "common/io/atomic_rename.h"

namespace softgrain::lammps {

namespace {

std::string head(const std::string& title, const MacroPacking& packing, const BodyTypes& types) {
  std::string text = fmt::format("{}\n\n{} atoms\n{} atom types\n\n", title, packing.bodies.size(), types.count());
  for (int k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    text += fmt::format("{} {} {}lo {}hi\n", packing.low[k], packing.high[k], axis, axis);
  }
  return text + "\nAtoms # sphere\n\n";
}

}  // namespace

void write_data_file(const std::string& path, const std::string& title, const MacroPacking& packing,
                     const BodyTypes& types, double density, double inner_solid_fraction) {
  std::ofstream out(temporary_name(path), std::ios::binary);
  out << head(title, packing, types);
  fmt::memory_buffer line;
  for (std::size_t k = 0; k < packing.bodies.size() && out; ++k) {
    const MacroBody& b = packing.bodies[k];
    line.clear();
    fmt::format_to(fmt::appender(line), "{} {} {} {} {} {} {}\n", k + 1, types.of[k], 2.0 * b.r,
                   b.soft ? density * inner_solid_fraction : density, b.x[0], b.x[1], b.x[2]);
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
  }
  out.close();
  if (!out) throw FileTrouble(path + ": cannot be written: " + system_message());
  rename_into_place(path);
}

}  // namespace softgrain::lammps

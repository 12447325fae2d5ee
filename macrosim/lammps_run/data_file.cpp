#include "macrosim/lammps_run/data_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "common/core/error.h"
#include "common/io/file_safety.h"

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

bool is_solid(const MacroPacking& packing, const BodySpring& s) {
  return !packing.bodies[static_cast<std::size_t>(s.i)].soft && !packing.bodies[static_cast<std::size_t>(s.j)].soft;
}

/// Text in parts, of which the first is `head`, as a file that is there whole or not at all.
class TextFile {
 public:
  TextFile(std::string path, const std::string& head)
      : path_(std::move(path)), out_(temporary_name(path_), std::ios::binary) {
    out_ << head;
  }

  template <class... Values>
  void line(fmt::format_string<Values...> form, Values&&... values) {
    line_.clear();
    fmt::format_to(fmt::appender(line_), form, std::forward<Values>(values)...);
    if (out_) out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
  }

  void close() {
    out_.close();
    if (!out_) throw IoError(path_ + ": cannot be written: " + system_message());
    rename_into_place(path_);
  }

 private:
  std::string path_;
  std::ofstream out_;
  fmt::memory_buffer line_;
};

}  // namespace

void write_data_file(const std::string& path, const std::string& title, const MacroPacking& packing,
                     const BodyTypes& types, double density, double inner_solid_fraction) {
  TextFile out(path, head(title, packing, types));
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) {
    const MacroBody& b = packing.bodies[k];
    out.line("{} {} {} {} {} {} {}\n", k + 1, types.of[k], 2.0 * b.r, b.soft ? density * inner_solid_fraction : density,
             b.x[0], b.x[1], b.x[2]);
  }
  out.close();
}

void write_springs_file(const std::string& path, const MacroPacking& packing) {
  const auto count = std::count_if(packing.springs.begin(), packing.springs.end(),
                                   [&](const BodySpring& s) { return is_solid(packing, s); });
  TextFile out(path, fmt::format("{} springs\n", count));
  for (const BodySpring& s : packing.springs)
    if (is_solid(packing, s)) out.line("{} {} {} {} {}\n", s.i + 1, s.j + 1, s.spring[0], s.spring[1], s.spring[2]);
  out.close();
}

bool has_springs(const MacroSpec& spec, const MacroPacking& packing) {
  return spec.friction > 0.0 && spec.preparation != Preparation::lammps &&
         std::any_of(packing.springs.begin(), packing.springs.end(),
                     [&](const BodySpring& s) { return is_solid(packing, s); });
}

}  // namespace softgrain::lammps

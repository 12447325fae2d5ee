#include "macrosim/lammps_run/data_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <utility>

#include "common/core/error.h"
#include "common/io/file_safety.h"

namespace softgrain::lammps {

namespace {

/// 0 for radii in (largest/2, largest], 1 for the next octave below...
int size_class(double r, double largest) { return static_cast<int>(std::floor(std::log2(largest / r))); }

std::string range(std::int32_t first, std::int32_t count) {
  if (count == 0) return "";
  return count == 1 ? fmt::format("{}", first) : fmt::format("{}*{}", first, first + count - 1);
}

/// Types of one kind of bodies, from `first` on; returns how many.
std::int32_t add_kind(const MacroPacking& packing, bool soft, std::int32_t first, BodyTypes& types) {
  double largest = 0.0;
  for (const MacroBody& b : packing.bodies)
    if (b.soft == soft) largest = std::max(largest, b.r);
  std::map<int, double> classes;  // largest radius of each
  for (const MacroBody& b : packing.bodies) {
    if (b.soft != soft) continue;
    double& of_class = classes[size_class(b.r, largest)];
    of_class = std::max(of_class, b.r);
  }
  std::map<int, std::int32_t> type;
  for (const auto& [size, radius] : classes) {
    type[size] = first + static_cast<std::int32_t>(type.size());
    types.largest.push_back(radius);
  }
  for (std::size_t k = 0; k < packing.bodies.size(); ++k)
    if (packing.bodies[k].soft == soft) types.of[k] = type.at(size_class(packing.bodies[k].r, largest));
  return static_cast<std::int32_t>(type.size());
}

std::string head(const std::string& title, const MacroPacking& packing, const BodyTypes& types) {
  std::string text = fmt::format("{}\n\n{} atoms\n{} atom types\n\n", title, packing.bodies.size(), types.count());
  for (int k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    text += fmt::format("{} {} {}lo {}hi\n", packing.low[k], packing.high[k], axis, axis);
  }
  return text + "\nAtoms # sphere\n\n";
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

std::string BodyTypes::solid_range() const { return range(1, solid); }
std::string BodyTypes::soft_range() const { return range(solid + 1, soft); }

BodyTypes body_types(const MacroPacking& packing) {
  BodyTypes types;
  types.of.assign(packing.bodies.size(), 0);
  types.solid = add_kind(packing, false, 1, types);
  types.soft = add_kind(packing, true, types.solid + 1, types);
  return types;
}

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

void write_springs_file(const std::string& path, const MacroSpec& spec, const MacroPacking& packing) {
  const std::vector<BodySpring> springs = springs_of_test(spec, packing);
  const auto bodies = static_cast<std::int32_t>(packing.bodies.size());
  const bool rolls = any_rolls(springs);
  TextFile out(path, fmt::format("{} springs{}\n", springs.size(), rolls ? " rolls" : ""));
  for (const BodySpring& s : springs) {
    out.line("{} {} {} {} {}", s.i + 1, s.j < bodies ? s.j + 1 : bodies - s.j - 1, s.spring[0], s.spring[1],
             s.spring[2]);
    if (rolls) out.line(" {} {} {}", s.roll[0], s.roll[1], s.roll[2]);
    out.line("\n");
  }
  out.close();
}

bool has_springs(const MacroSpec& spec, const MacroPacking& packing) {
  return spec.preparation != Preparation::lammps && !springs_of_test(spec, packing).empty();
}

}  // namespace softgrain::lammps

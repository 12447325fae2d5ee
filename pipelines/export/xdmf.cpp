// XDMF version 2, as ParaView 5.11 reads it: particles as Polyvertex with their numbers named by a data set, contacts
// as Polyline of two nodes each; one collection per file, since times of particles and contacts differ.
#include "pipelines/export/export.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "common/core/text.h"
#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

std::string number_type(bool integer) {
  return integer ? "NumberType=\"Int\" Precision=\"8\"" : "NumberType=\"Float\" Precision=\"8\"";
}

std::string joined(const std::vector<std::size_t>& numbers) { return join_text(numbers, " "); }

/// A whole data set.
std::string whole(const std::string& path, const std::vector<std::size_t>& shape, bool integer = false) {
  return fmt::format("<DataItem Format=\"HDF\" {} Dimensions=\"{}\">{}</DataItem>", number_type(integer), joined(shape),
                     path);
}

/// Where a part of a data set begins, and how long it is; everything else is whole.
struct Part {
  std::vector<std::size_t> begin;
  std::vector<std::size_t> count;
};

std::string part_of(const std::string& path, const std::vector<std::size_t>& shape, const Part& part,
                    const std::vector<std::size_t>& result, bool integer = false) {
  const std::vector<std::size_t> stride(shape.size(), 1);
  return fmt::format(
      "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{}\" Type=\"HyperSlab\">"
      "<DataItem Format=\"XML\" Dimensions=\"3 {}\">{} {} {}</DataItem>{}</DataItem>",
      joined(result), shape.size(), joined(part.begin), joined(stride), joined(part.count),
      whole(path, shape, integer));
}

std::string attribute(const char* name, const char* type, const char* centre, const std::string& item) {
  return fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n", name, type,
                     centre, item);
}

std::string grid(const std::string& name, double moment, const std::string& topology, const std::string& geometry,
                 const std::string& attributes) {
  return fmt::format(
      "      <Grid Name=\"{}\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n        {}\n"
      "        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n{}      </Grid>\n",
      name, moment, topology, geometry, attributes);
}

std::string vertices(std::size_t count, const std::string& item) {
  return fmt::format(
      "<Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"{}\">{}</Topology>", count, item);
}
std::string lines(std::size_t count, const std::string& item) {
  return fmt::format("<Topology TopologyType=\"Polyline\" NodesPerElement=\"2\" NumberOfElements=\"{}\">{}</Topology>",
                     count, item);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string collection(const std::string& name, const std::string& grids) {
  return fmt::format("    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}    </Grid>\n",
                     escaped(name), grids);
}

void write_document(const std::string& path, const std::string& collections) {
  write_text_atomic(
      path, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n  <Domain>\n" + collections + "  </Domain>\n</Xdmf>\n");
}

/// "run.h5" and "states_macro.h5" give "run" and "states_macro".
std::string beside(const std::string& file, const std::string& ending) {
  const fs::path path(file);
  return (path.parent_path() / (path.stem().string() + ending)).string();
}

std::string particles_of_run(const h5::Group& root, const std::string& file) {
  const h5::Group trajectory = root.open("trajectory");
  const h5::Shape shape = trajectory.shape("position");
  const std::vector<double> time = trajectory.doubles("time");
  const std::size_t n = shape[1];
  std::string grids;
  for (std::size_t k = 0; k < time.size() && n > 0; ++k) {
    const Part frame{{k, 0, 0}, {1, n, 3}};
    const auto of_frame = [&](const char* name) {
      return part_of(file + ":/trajectory/" + name, shape, frame, {n, 3});
    };
    grids += grid(fmt::format("frame {}", k), time[k], vertices(n, whole(file + ":/bodies/id", {n}, true)),
                  of_frame("position"),
                  attribute("radius", "Scalar", "Node", whole(file + ":/bodies/radius", {n})) +
                      attribute("id", "Scalar", "Node", whole(file + ":/bodies/id", {n}, true)) +
                      attribute("material", "Scalar", "Node", whole(file + ":/bodies/material", {n}, true)) +
                      attribute("velocity", "Vector", "Node", of_frame("velocity")) +
                      attribute("spin", "Vector", "Node", of_frame("spin")));
  }
  return collection("particles", grids);
}

std::string contacts_of_run(const h5::Group& root, const std::string& file) {
  const h5::Group group = root.open("frame_contacts");
  const std::vector<std::int64_t> frame = group.integers("frame");
  const std::vector<std::int64_t> count = group.integers("count");
  const std::vector<double> time = root.open("trajectory").doubles("time");
  const h5::Shape ends = group.shape("ends");
  const h5::Shape force = group.shape("force");
  const h5::Shape segment = group.shape("segment");
  std::size_t begin = 0;
  std::string grids;
  for (std::size_t k = 0; k < frame.size(); ++k) {
    const auto n = static_cast<std::size_t>(count[k]);
    const std::string path = file + ":/frame_contacts/";
    if (n > 0)
      grids += grid(fmt::format("frame {}", frame[k]), time.at(static_cast<std::size_t>(frame[k])),
                    lines(n, part_of(path + "segment", segment, {{0, 0}, {n, 2}}, {n, 2}, true)),
                    part_of(path + "ends", ends, {{2 * begin, 0}, {2 * n, 3}}, {2 * n, 3}),
                    attribute("force", "Vector", "Cell", part_of(path + "force", force, {{begin, 0}, {n, 3}}, {n, 3})) +
                        attribute("normal_force", "Scalar", "Cell",
                                  part_of(path + "normal_force", {force[0]}, {{begin}, {n}}, {n})));
    begin += n;
  }
  return collection("contacts", grids);
}

std::string particles_of_state(const h5::Group& state, const std::string& path, double moment) {
  const h5::Group group = state.open("particles");
  const std::size_t n = group.shape("radius")[0];
  std::string attributes = attribute("radius", "Scalar", "Node", whole(path + "/particles/radius", {n}));
  for (const char* name : {"id", "role", "body", "material"})
    attributes += attribute(name, "Scalar", "Node", whole(path + "/particles/" + name, {n}, true));
  if (group.has("velocity"))
    attributes += attribute("velocity", "Vector", "Node", whole(path + "/particles/velocity", {n, 3}));
  return grid(escaped(state.text("label")), moment, vertices(n, whole(path + "/particles/index", {n}, true)),
              whole(path + "/particles/position", {n, 3}), attributes);
}

std::string contacts_of_state(const h5::Group& state, const std::string& path, double moment) {
  const std::size_t n = state.open("contacts").shape("normal_force")[0];
  if (n == 0) return "";
  return grid(escaped(state.text("label")), moment, lines(n, whole(path + "/contacts/segment", {n, 2}, true)),
              whole(path + "/contacts/ends", {2 * n, 3}),
              attribute("force", "Vector", "Cell", whole(path + "/contacts/force", {n, 3})) +
                  attribute("normal_force", "Scalar", "Cell", whole(path + "/contacts/normal_force", {n})));
}

double moment_of(const h5::Group& state) {
  for (const char* name : {"time", "strain", "overlap"})
    if (state.has_attribute(name)) return state.number(name);
  return static_cast<double>(state.integer("frame"));
}

/// Series in order, with the names of their states.
std::vector<std::pair<std::string, std::vector<std::string>>> series_of(const h5::Group& states) {
  std::vector<std::pair<std::string, std::vector<std::string>>> out;
  for (const std::string& name : states.children()) {
    const std::string series = states.open(name).text("series");
    if (out.empty() || out.back().first != series) out.emplace_back(series, std::vector<std::string>{});
    out.back().second.push_back(name);
  }
  return out;
}

std::string collections(const std::vector<std::pair<std::string, std::string>>& series) {
  std::string text;
  for (const auto& [name, grids] : series)
    if (!grids.empty()) text += collection(name, grids);
  return text;
}

}  // namespace

void write_run_xdmf(const std::string& run_file) {
  const h5::Group root = h5::open_file(run_file);
  const std::string file = fs::path(run_file).filename().string();
  write_document(beside(run_file, ".xdmf"), particles_of_run(root, file));
  write_document(beside(run_file, "_contacts.xdmf"), contacts_of_run(root, file));
}

std::vector<std::string> states_xdmf_files(const std::string& states_file) {
  return {beside(states_file, ".xdmf"), beside(states_file, "_contacts.xdmf")};
}

void write_states_xdmf(const std::string& states_file) {
  const h5::Group states = open_snapshots(states_file).open("states");
  const std::string file = fs::path(states_file).filename().string();
  std::vector<std::pair<std::string, std::string>> particles;  // series in order, and their grids
  std::vector<std::pair<std::string, std::string>> contacts;
  for (const auto& [series, names] : series_of(states)) {
    std::vector<double> moments;
    for (const std::string& name : names) moments.push_back(moment_of(states.open(name)));
    const std::vector<double> times = times_of(std::move(moments));
    particles.emplace_back(series, "");
    contacts.emplace_back(series, "");
    for (std::size_t k = 0; k < names.size(); ++k) {
      const h5::Group one = states.open(names[k]);
      const std::string path = file + ":/states/" + names[k];
      particles.back().second += particles_of_state(one, path, times[k]);
      if (one.has("contacts")) contacts.back().second += contacts_of_state(one, path, times[k]);
    }
  }
  write_document(beside(states_file, ".xdmf"), collections(particles));
  write_document(beside(states_file, "_contacts.xdmf"), collections(contacts));
}

}  // namespace softgrain

#include "pipelines/export/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/export/export_files.h"
#include "pipelines/snapshots/snapshots.h"

namespace softgrain {

namespace {

/// One state in the index of its series.
struct Entry {
  double moment = 0.0;
  std::int64_t frame = 0;
  std::size_t particles = 0;
  std::size_t contacts = 0;
  std::string particles_file;
  std::string contacts_file;  ///< empty: not kept
};

struct Series {
  ExportedSeries facts;
  std::string moment;  ///< "time [s]"; empty: states have none
  std::vector<Entry> entries;
};

/// What tells states of a series apart beside their frame, with its unit.
std::string moment_header(const Snapshot& s) {
  if (s.moment_name() == Moment::frame) return "";
  return fmt::format("{} [{}]", to_string(s.moment_name()), s.moment_name() == Moment::time ? s.time_unit : "1");
}

/// The index of a series for ParaView: which file is of which time.
std::string collection(const std::vector<Entry>& entries, std::string Entry::*file) {
  std::vector<double> moments;
  for (const Entry& e : entries) moments.push_back(e.moment);
  const std::vector<double> times = times_of(std::move(moments));
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (std::size_t k = 0; k < entries.size(); ++k)
    if (const std::string& name = entries[k].*file; !name.empty())
      text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", times[k], name);
  return text + "  </Collection>\n</VTKFile>\n";
}

std::string table(const Series& s) {
  const bool has_moment = !s.moment.empty();
  std::string text =
      fmt::format("number,frame,{}particles,contacts,particles_file,contacts_file\n", has_moment ? s.moment + "," : "");
  for (std::size_t k = 0; k < s.entries.size(); ++k) {
    const Entry& e = s.entries[k];
    text += fmt::format("{},{},{}{},{},{},{}\n", k, e.frame, has_moment ? fmt::format("{},", e.moment) : "",
                        e.particles, e.contacts, e.particles_file, e.contacts_file);
  }
  return text;
}

class Exporter {
 public:
  /// What an earlier export of this form left in the directory goes.
  Exporter(ExportFormat format, std::string directory)
      : format_(format),
        directory_(std::move(directory)),
        list_(directory_, format_),
        unlisted_(list_.is_default_folder() && !list_.exists()) {
    list_.remove_listed();
  }

  void add(const Snapshot& s) {
    Series& series = series_of(s);
    const auto number = static_cast<std::int64_t>(series.entries.size());
    Entry entry{s.moment(), s.frame, s.particles.size(), s.contacts.size(), "", ""};
    for (const ExportFile& file : files_of(s, number)) {
      write(file.name, file.text);
      if (file.content == StateContent::particles) entry.particles_file = file.name;
      if (file.content == StateContent::contacts) entry.contacts_file = file.name;
    }
    series.entries.push_back(entry);
    ++series.facts.states;
    if (s.has_contacts) ++series.facts.with_contacts;
    if (format_ == ExportFormat::lammps_data && !has_masses(s))
      series.facts.remark = "the masses of the particles are not recorded: densities in the file are 1";
  }

  std::vector<ExportedSeries> finish() {
    std::vector<ExportedSeries> out;
    for (Series& s : all_) {
      write_index(s);
      out.push_back(s.facts);
    }
    return out;
  }

 private:
  Series& series_of(const Snapshot& s) {
    for (Series& known : all_)
      if (known.facts.name == s.series) return known;
    all_.push_back({{s.series, s.kind, 0, 0, {}}, moment_header(s), {}});
    // More states than this series has would play after its own.
    if (unlisted_) list_.remove_series(s.series);
    return all_.back();
  }

  /// Names of the index files: of particles, and of contacts where a format has two.
  [[nodiscard]] std::vector<std::string> index_files(const Series& s) const {
    const std::string stem = file_name_of(s.facts.name);
    if (format_ == ExportFormat::vtp) return {stem + "_particles.pvd", stem + "_contacts.pvd"};
    return format_ == ExportFormat::csv ? std::vector{stem + ".csv"} : std::vector<std::string>{};
  }

  [[nodiscard]] std::vector<ExportFile> files_of(const Snapshot& s, std::int64_t number) const {
    switch (format_) {
      case ExportFormat::vtp:
        return vtp_files(s, number);
      case ExportFormat::csv:
        return csv_files(s, number);
      case ExportFormat::lammps_data:
        return data_files(s, number);
      case ExportFormat::lammps_dump:
        return dump_files(s, number);
    }
    throw std::logic_error("export: a form without files");
  }

  /// Throws InputError, and takes back what was written, where a file of this name is there that no export listed.
  void write(const std::string& name, const std::string& text) {
    if (!written_.insert(name).second) {
      list_.remove_listed();
      throw InputError(fmt::format("{}: two series of states would both be the file {}", directory_, name));
    }
    if (list_.holds(name)) {
      list_.remove_listed();
      throw InputError(fmt::format(
          "{}/{}: is there already and of no earlier export: move it away, or choose another --out", directory_, name));
    }
    list_.add(name);
    write_text_atomic(directory_ + "/" + name, text);
  }

  void write_index(Series& s) {
    const std::vector<std::string> names = index_files(s);
    if (format_ == ExportFormat::vtp) {
      s.facts.files = {names[0]};
      write(names[0], collection(s.entries, &Entry::particles_file));
      if (s.facts.with_contacts == 0) return;
      s.facts.files.push_back(names[1]);
      write(names[1], collection(s.entries, &Entry::contacts_file));
    } else if (format_ == ExportFormat::csv) {
      s.facts.files = names;
      write(names[0], table(s));
    } else {
      s.facts.files = {s.entries.front().particles_file};
    }
  }

  ExportFormat format_;
  std::string directory_;
  ExportList list_;
  std::set<std::string> written_;
  bool unlisted_;  ///< an export of an earlier version, which kept no list, may have left files here
  std::vector<Series> all_;
};

}  // namespace

std::vector<double> times_of(std::vector<double> moments) {
  const auto grows = [](double a, double b) { return a < b; };
  if (std::adjacent_find(moments.begin(), moments.end(), std::not_fn(grows)) != moments.end())
    std::iota(moments.begin(), moments.end(), 0.0);
  return moments;
}

ExportFormat export_format(const std::string& name) {
  if (const auto format = parse_enum<ExportFormat>(name)) return *format;
  const std::vector<const char*> known = all_enum_names<ExportFormat>();
  if (name.empty()) throw InputError("export: which form? give --to, one of " + join_text(known));
  const std::string near = nearest_word(name, {known.begin(), known.end()});
  throw InputError(fmt::format("export: --to {}: unknown form; {}allowed are {}", name,
                               near.empty() ? "" : "nearest is " + near + "; ", join_text(known)));
}

std::string file_name_of(const std::string& series) {
  std::string name = series;
  for (char& c : name)
    if (c == '/' || c == '\\' || c == ' ' || c == '"' || c == '<' || c == '&' || c == ',') c = '_';
  return name;
}

std::string state_file_name(const Snapshot& snapshot, StateContent content, std::int64_t number,
                            const std::string& extension) {
  return fmt::format("{}_{}_{:06}.{}", file_name_of(snapshot.series), to_string(content), number, extension);
}

std::vector<ExportedSeries> export_states(const std::string& run, ExportFormat format, const std::string& directory) {
  std::optional<Exporter> exporter;
  // A simulation starts from one state.
  const SnapshotChoice choice = format == ExportFormat::lammps_data ? SnapshotChoice::last : SnapshotChoice::all;
  for_each_snapshot(run, choice, [&](const Snapshot& s) {
    if (!exporter) {
      require_writable_directory(directory);
      exporter.emplace(format, directory);
    }
    exporter->add(s);
  });
  if (!exporter)
    throw InputError(run +
                     ": holds no states (run.h5, states_*.h5, powder.h5 or grain_box.h5): runs of kind particles, "
                     "soft-particle, pipeline, macro, macro-comparison, cohesive-powder and grain-box keep them, "
                     "unless [output] says snapshots = 0 or record = false");
  return exporter->finish();
}

}  // namespace softgrain

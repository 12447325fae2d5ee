// States of a run as files for other programs: VTP for ParaView and OVITO, dumps and data files of LAMMPS, CSV tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/data/snapshot.h"

namespace softgrain {

enum class ExportFormat { vtp, lammps_dump, lammps_data, csv };

template <>
inline constexpr auto enum_names<ExportFormat> =
    enum_name_list<ExportFormat>({{ExportFormat::vtp, "vtp"},
                                  {ExportFormat::lammps_dump, "lammps-dump"},
                                  {ExportFormat::lammps_data, "lammps-data"},
                                  {ExportFormat::csv, "csv"}});

/// Throws InputError that names the nearest for a word that is none of them.
ExportFormat export_format(const std::string& name);

/// What a file of a state is of.
enum class StateContent { particles, contacts, wall_contacts, walls };

template <>
inline constexpr auto enum_names<StateContent> = enum_name_list<StateContent>({{StateContent::particles, "particles"},
                                                                               {StateContent::contacts, "contacts"},
                                                                               {StateContent::wall_contacts,
                                                                                "wall_contacts"},
                                                                               {StateContent::walls, "walls"}});

/// One file of a state.
struct ExportFile {
  StateContent content = StateContent::particles;
  std::string name;  ///< relative to the directory of the export
  std::string text;
};

/// The files of one state, number `number` (from 0) of its series as it is exported. Names begin with the series ('/'
/// becomes '_'), then say what the file holds and the number: shelled-0_particles_000002.vtp.
std::vector<ExportFile> vtp_files(const Snapshot& snapshot, std::int64_t number);
std::vector<ExportFile> dump_files(const Snapshot& snapshot, std::int64_t number);
/// One file for `read_data` with atom_style sphere. Types are the pairs of role and material that there are.
std::vector<ExportFile> data_files(const Snapshot& snapshot, std::int64_t number);
/// Whether all masses are known, from which the densities in a data file follow; otherwise they are 1.
bool has_masses(const Snapshot& snapshot);
std::vector<ExportFile> csv_files(const Snapshot& snapshot, std::int64_t number);

/// SERIES_KIND_NUMBER.extension
std::string state_file_name(const Snapshot& snapshot, StateContent content, std::int64_t number,
                            const std::string& extension);
std::string file_name_of(const std::string& series);

/// Times of the states of a series for programs that sort states by them: their moments, or, where these do not grow
/// from each state to the next (strains of unloading, of a hold), the numbers of the states from 0.
std::vector<double> times_of(std::vector<double> moments);

/// What a series became.
struct ExportedSeries {
  std::string name;
  SnapshotKind kind = SnapshotKind::particles;
  std::int64_t states = 0;
  std::int64_t with_contacts = 0;
  std::vector<std::string>
      files;             ///< files to open: .pvd of a VTP series, table of a CSV series, first dump, data file
  std::string remark{};  ///< what stands in the files for what the run does not say; empty: nothing
};

/// Writes all states of a run (as read_snapshots() takes it) to `directory`, which is made; as data files of LAMMPS the
/// last one of each series. Every file atomically. What an earlier export of the same form left there is removed first
/// (export_files.h); other files stay. Throws InputError when there are no states, or a file is in the way that no
/// export listed; IoError.
std::vector<ExportedSeries> export_states(const std::string& run, ExportFormat format, const std::string& directory);

// Small XDMF files beside HDF5 files, through which ParaView reads the states in them without a copy.

/// Beside run.h5 of kind "particles": run.xdmf with the particles of every frame, run_contacts.xdmf with the contacts
/// of the frames that kept them, each a temporal collection. Atomic. Throws IoError.
void write_run_xdmf(const std::string& run_file);

/// Beside a file of states (states_*.h5): one collection per series in NAME.xdmf (particles) and NAME_contacts.xdmf.
void write_states_xdmf(const std::string& states_file);
/// Their names.
std::vector<std::string> states_xdmf_files(const std::string& states_file);

}  // namespace softgrain

// Small XDMF files beside HDF5 files, through which ParaView reads the states in them without a copy.
#pragma once

#include <string>
#include <vector>

namespace softgrain {

/// Beside run.h5 of kind "particles": run.xdmf with the particles of every frame, run_contacts.xdmf with the contacts
/// of the frames that kept them, each a temporal collection. Atomic. Throws IoError.
void write_run_xdmf(const std::string& run_file);

/// Beside a file of states (states_*.h5): one collection per series in NAME.xdmf (particles) and NAME_contacts.xdmf.
void write_states_xdmf(const std::string& states_file);
/// Their names.
std::vector<std::string> states_xdmf_files(const std::string& states_file);

}  // namespace softgrain

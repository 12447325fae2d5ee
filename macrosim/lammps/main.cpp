// softgrain-lammps: LAMMPS with the contact laws of softgrain. Takes the command line of LAMMPS.
// SPDX-License-Identifier: BSD-3-Clause
#include <mpi.h>

#include <exception>
#include <iostream>
#include <string>

#include "input.h"
#include "lammps.h"
#include "macrosim/lammps/pair_softgrain.h"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int status = 0;
  try {
    LAMMPS_NS::LAMMPS lmp(argc, argv, MPI_COMM_WORLD);
    softgrain::lammps::add_styles(lmp);
    lmp.input->file();
  } catch (const std::exception& e) {
    std::cerr << "softgrain-lammps: " << e.what() << '\n';
    status = 1;
    MPI_Abort(MPI_COMM_WORLD, status);
  }
  MPI_Finalize();
  return status;
}

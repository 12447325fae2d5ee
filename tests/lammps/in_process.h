// LAMMPS with our styles inside a test, on one rank.
#pragma once

#include <mpi.h>

#include <fstream>
#include <string>

// LAMMPS headers last: they define macros.
#include "atom.h"
#include "force.h"
#include "input.h"
#include "lammps.h"
#include "macrosim/lammps/pair_softgrain.h"

namespace softgrain::test {

class InProcess {
 public:
  InProcess() {
    char words[][8] = {"test", "-log", "none", "-screen", "none"};
    char* list[] = {words[0], words[1], words[2], words[3], words[4]};
    lmp_ = new LAMMPS_NS::LAMMPS(5, list, MPI_COMM_WORLD);
    lammps::add_styles(*lmp_);
  }
  ~InProcess() { delete lmp_; }
  InProcess(const InProcess&) = delete;
  InProcess& operator=(const InProcess&) = delete;

  void operator()(const std::string& command) { lmp_->input->one(command); }
  [[nodiscard]] LAMMPS_NS::Atom& atoms() { return *lmp_->atom; }
  [[nodiscard]] LAMMPS_NS::PairSoftgrain& pair() { return dynamic_cast<LAMMPS_NS::PairSoftgrain&>(*lmp_->force->pair); }
  [[nodiscard]] LAMMPS_NS::LAMMPS& lammps() { return *lmp_; }

 private:
  LAMMPS_NS::LAMMPS* lmp_ = nullptr;
};

}  // namespace softgrain::test

// All contact laws that need nothing but the C++ standard library (C++20). Installed as one file, <softgrain/laws.h>,
// with a licence that lets programs under other licences include it; the program evaluates the very same functions.
//
//   law            normal force                                    files of the tree
//   HertzMindlin   sqrt(R12) h^(3/2)/D - eta vn                    hertz_mindlin.h
//   LinearSpring   kn h - eta vn                                   linear_spring.h
//   SoftContact    E R^2 (a Delta^b + c), Delta = h/R > delta      soft_contact.h
//   SoftUnloading  the same, and a branch of its own for unloading soft_contact.h
//   CohesiveDisk   K_N h - F0 - eta vn, attraction at a distance   cohesive_disk.h
//   SoftMultiContact      E R^2 dnu/dx p(S)/S B: several contacts         soft_multi_contact.h, multi_contact_form.h
//   rolling_spring moment of rolling resistance, of the first two  rolling_spring.h
//
// How to use one: pair_constants(PairBodies) once per pair, evaluate(ContactState) as often as wanted. SI units.
// SoftMultiContact asks for a pass before: share() of every contact to the sums of its bodies, finish() once per body.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include "common/contact/cohesive_disk.h"
#include "common/contact/hertz_mindlin.h"
#include "common/contact/linear_spring.h"
#include "common/contact/multi_contact_form.h"
#include "common/contact/rolling_spring.h"
#include "common/contact/soft_contact.h"
#include "common/contact/soft_multi_contact.h"

// Laws at arrays of overlaps, through the laws of the contact loop. All is linear in the modulus of a law: with E R^2
// in its place forces come in newtons, with E R stiffnesses in newtons per metre.
#pragma once

#include <span>
#include <vector>

#include "common/contact/soft_contact.h"
#include "common/core/enum_names.h"
#include "pipelines/law/multi_contact_middle.h"

namespace softgrain::python {

/// What is wanted of a law.
enum class LawOutput {
  force,       ///< elastic, along the normal
  stiffness,   ///< d force / d overlap
  tangential,  ///< stiffness of the tangential spring
  volume       ///< equivalent volume S of multi-contact laws, whatever the modulus
};

}  // namespace softgrain::python

namespace softgrain {

template <>
inline constexpr auto enum_names<python::LawOutput> =
    enum_name_list<python::LawOutput>({{python::LawOutput::force, "force"},
                                       {python::LawOutput::stiffness, "stiffness"},
                                       {python::LawOutput::tangential, "tangential"},
                                       {python::LawOutput::volume, "volume"}});

}  // namespace softgrain

namespace softgrain::python {

/// A law of a card at overlaps Delta = h/R; `out` has as many.
void card_array(const SoftContact& contact, LawOutput what, std::span<const double> delta, std::span<double> out);

/// Values for one neighbour of a soft particle among others: overlaps [state][neighbour] over R in, one number per
/// state out. For all neighbours (`which` < 0) the output is [state][neighbour]. Laws are without unloading and
/// rolling.
void multi_contact_array(const MultiContactLaws& laws, const std::vector<law::MultiContactNeighbour>& around,
                         LawOutput what, int which, std::span<const double> overlap, std::span<double> out);

}  // namespace softgrain::python

// softgrain._laws: the contact laws of cards and tables at numpy arrays. The package softgrain around it is what people
// use.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <nlohmann/json.hpp>

#include "common/core/error.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/provenance.h"
#include "microsim/multi_contact_arrangements.h"
#include "pipelines/commands/complaints.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/python/binding/binding_tools.h"
#include "pipelines/python/binding/law_bindings.h"

namespace softgrain::python {

std::optional<Extrapolation> beyond_of(const std::optional<std::string>& name) {
  if (!name) return std::nullopt;
  return parse_choice<Extrapolation>("beyond", *name);
}

namespace {

namespace py = pybind11;

/// Our errors as those of softgrain.errors, with the places and keys that they name.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& e) {
    const std::string told = error_objects(e.what()).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const py::object made =
        py::module_::import("softgrain.errors").attr("error_of")(static_cast<int>(e.status()), told);
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
  }
}

/// The file (that of a run directory) and its law, which must have forces at contacts.
py::tuple load(const std::string& path) {
  FittedLaw law = load_law(path);
  read_refits(law);
  return std::visit(
      [&]<class Content>(Content& content) -> py::tuple {
        if constexpr (std::is_same_v<Content, CellCard>)
          throw InputError(law.path +
                           ": a card of the cell law has no forces at contacts: softgrain law show tells its numbers");
        else if constexpr (std::is_same_v<Content, LawCard>)
          return py::make_tuple(law.path, CardBinding(std::move(content)));
        else
          return py::make_tuple(law.path, TableBinding(std::move(content)));
      },
      law.content);
}

TableBinding load_table(const std::string& path) {
  LawTable table = load_law_table(path);
  read_replicates(table, path);
  return TableBinding(std::move(table));
}

py::tuple arrangement(const std::string& name, double shallow) {
  const auto which = parse_choice<Arrangement>("arrangement", name);
  if (which == Arrangement::scattered)
    throw InputError("arrangement = \"scattered\": is drawn for measurements; give directions of your own");
  std::vector<std::array<double, 3>> directions;
  for (const Vec3& d : directions_of(which)) directions.push_back(d.v);
  return py::make_tuple(directions, depth_shares(which, shallow));
}

}  // namespace

PYBIND11_MODULE(_laws, m) {
  m.doc() = "Contact laws of softgrain, as its simulations evaluate them. Used by softgrain.law.";
  py::register_exception_translator(translate);
  m.attr("version") = build_provenance().version;
  m.attr("commit") = build_provenance().commit;
  m.def("load", load);
  m.def("arrangement", arrangement);
  py::class_<CardBinding>(m, "Card")
      .def(py::init([](const std::string& path) { return CardBinding(load_card(path)); }))
      .def("values", &CardBinding::values)
      .def("interval", &CardBinding::interval);
  py::class_<TableChoice>(m, "TableChoice")
      .def(py::init([](std::optional<std::string> form, std::optional<double> fraction, std::string range,
                       std::optional<std::string> beyond) {
        return TableChoice{std::move(form), fraction, std::move(range), std::move(beyond)};
      }));
  py::class_<NeighbourChoice>(m, "Neighbours")
      .def(py::init(
          [](std::vector<std::string> kinds, std::vector<double> ratios, std::vector<std::vector<double>> directions) {
            return NeighbourChoice{std::move(kinds), std::move(ratios), std::move(directions)};
          }));
  py::class_<TableBinding>(m, "Table")
      .def(py::init(&load_table))
      .def("about", &TableBinding::about)
      .def("values", &TableBinding::values)
      .def("interval", &TableBinding::interval);
}

}  // namespace softgrain::python

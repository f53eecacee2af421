// The Python module `epafi`: load or build a scene, step it, access its columns as NumPy arrays without copying.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <csignal>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "scenes/include/epafi/epafi.h"
#include "scenes/version.h"
#include "viz_export/output/output_observers.h"

namespace py = pybind11;

namespace epafi {
namespace {

/// Converts a Python value (dict, list, str, bool, int, float) to TOML on one line.
std::string toml_of(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::int_>(value)) return py::str(value);
  if (py::isinstance<py::float_>(value))
    return fmt::format("{:.17g}", value.cast<double>()).find_first_of(".einf") == std::string::npos
               ? fmt::format("{:.17g}.0", value.cast<double>())
               : fmt::format("{:.17g}", value.cast<double>());
  if (py::isinstance<py::str>(value)) {
    std::string out = "\"";
    for (const char c : value.cast<std::string>()) {
      if (c == '"' || c == '\\') out += '\\';
      if (c == '\n')
        out += "\\n";
      else
        out += c;
    }
    return out + "\"";
  }
  std::string out;
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [key, item] : value.cast<py::dict>())
      out += (out.empty() ? "" : ", ") + toml_of(py::str(key)) + " = " + toml_of(item);
    return "{" + out + "}";
  }
  if (!py::isinstance<py::sequence>(value) && !py::hasattr(value, "__iter__"))
    throw py::type_error("a scene is made of dict, list, str, bool, int and float, not of " +
                         std::string(py::str(py::type::of(value))));
  for (const auto& item : value)
    out += (out.empty() ? "" : ", ") + toml_of(item.get_type().attr("__module__").cast<std::string>() == "numpy"
                                                   ? item.attr("item")()
                                                   : py::reinterpret_borrow<py::object>(item));
  return "[" + out + "]";
}

std::string scene_of(const py::dict& tables) {
  std::string text;
  for (const auto& [key, value] : tables) text += toml_of(py::str(key)) + " = " + toml_of(value) + "\n";
  return text;
}

/// A scene that runs, with its measures but without files.
class Run {
 public:
  explicit Run(std::unique_ptr<Assembly> assembly) : assembly_(std::move(assembly)) {
    Simulation& sim = simulation();
    for (const auto& spec : assembly_->scene.measures) {
      auto recorder = std::make_unique<MeasureRecorder>(spec.name, assembly_->measure(spec), nullptr, nullptr,
                                                        EverySteps::of_time(spec.interval, sim.time_step));
      recorders_.push_back(recorder.get());
      sim.observers.push_back(std::move(recorder));
    }
    keep_in_place(sim.world.ids_given());
  }
  Simulation& simulation() { return *assembly_->simulation; }
  World& world() { return simulation().world; }
  std::uint64_t total_steps() const { return assembly_->steps; }
  const std::string& title() const { return assembly_->scene.title; }

  void step(std::uint64_t count) {
    Simulation& sim = simulation();
    std::optional<Failure> failure;
    {
      const py::gil_scoped_release free;
      with_team([&] {
        for (std::uint64_t k = 0; k < count && !failure; ++k)
          failure = sim.advance(sim.steps() + 1 == assembly_->steps);
      });
    }
    if (failure)
      throw std::runtime_error(failure->kind + ": " + failure->text +
                               (failure->body ? " ('" + body_name(*assembly_, *failure->body) + "')" : ""));
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  py::dict energy() {
    Simulation& sim = simulation();
    const Energy e = sim.ledger.measure(sim.world);
    py::dict out;
    out["kinetic"] = e.kinetic;
    out["potential"] = e.potential;
    out["elastic"] = e.elastic;
    out["dissipated"] = e.dissipated;
    out["work"] = e.work;
    out["relative_error"] = sim.ledger.relative_error();
    return out;
  }
  py::dict measures() const {
    py::dict out;
    for (const auto* r : recorders_) {
      py::dict components;
      for (const auto& [name, v] : r->summary()) {
        py::dict c;
        c["last"] = v.last;
        c["min"] = v.min;
        c["max"] = v.max;
        components[py::str(name)] = c;
      }
      out[py::str(r->name())] = components;
    }
    return out;
  }

 private:
  /// Poured bodies must not move the columns: arrays handed out point into them.
  void keep_in_place(std::size_t bodies) { world().reserve(bodies); }
  std::unique_ptr<Assembly> assembly_;
  std::vector<MeasureRecorder*> recorders_;
};

/// Array over a column of numbers or of Eigen vectors, read-only or not, kept alive by `owner`.
template <class T, class Column>
py::array view(Column& column, py::ssize_t width, const py::object& owner, bool writable = false) {
  const auto n = static_cast<py::ssize_t>(column.size());
  T* data = n > 0 ? reinterpret_cast<T*>(&column[0]) : nullptr;
  std::size_t stride = sizeof(column[0]);
  if constexpr (requires { column.stride(); }) stride = column.stride();
  const auto row = static_cast<py::ssize_t>(stride);
  py::array out =
      width == 1 ? py::array(py::dtype::of<T>(), {n}, {row}, data, owner)
                 : py::array(py::dtype::of<T>(), {n, width}, {row, static_cast<py::ssize_t>(sizeof(T))}, data, owner);
  if (!writable) py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

template <class T, class Get>
auto column(Get get, py::ssize_t width, bool writable = false) {
  return [=](const py::object& self) { return view<T>(get(self.cast<Run&>()), width, self, writable); };
}

/// New array with `width` values for each contact of the last step, written by put(contacts, k, to); includes contacts
/// of the loop over spheres.
template <class T, class Put>
auto of_contacts(py::ssize_t width, Put put) {
  return [=](Run& run) {
    const Simulation& sim = run.simulation();
    const ContactPieces pieces(sim.world, sim.work.contacts, sim.pipeline.contact_model.get());
    std::vector<T> values;
    for (std::size_t piece = 0; piece < pieces.size(); ++piece)
      pieces.read(piece, [&](const ContactSet& c, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          values.resize(values.size() + static_cast<std::size_t>(width));
          put(sim.world, c, k, &values[values.size() - static_cast<std::size_t>(width)]);
        }
      });
    const auto rows = static_cast<py::ssize_t>(values.size()) / width;
    return width == 1 ? py::array_t<T>(rows, values.data()) : py::array_t<T>({rows, width}, values.data());
  };
}

void bind_functions(py::module_& m) {
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const SceneError& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    } catch (const FileError& e) {
      PyErr_SetString(PyExc_OSError, e.what());
    }
  });
  m.def(
      "load",
      [](const std::string& path, const std::vector<std::string>& overrides) {
        return std::make_unique<Run>(load(path, overrides));
      },
      py::arg("path"), py::arg("overrides") = std::vector<std::string>{},
      "A scene file; overrides: KEY.PATH=VALUE, as --set takes them.");
  m.def(
      "build",
      [](const py::dict& scene, const std::vector<std::string>& overrides) {
        return std::make_unique<Run>(load_text(scene_of(scene), overrides));
      },
      py::arg("scene"), py::arg("overrides") = std::vector<std::string>{},
      "A scene as nested dicts and lists with the keys of a scene file.");
  m.def(
      "set_threads", [](int n) { set_thread_count(n); }, py::arg("count"),
      "Threads of all runs from now on; the bits do not depend on it.");
}

/// Steps, clock and energies.
void bind_course(py::class_<Run>& run) {
  run.def("step", &Run::step, py::arg("count") = 1,
          "Makes `count` steps; raises RuntimeError where the simulation fails.")
      .def("energy", &Run::energy, "Energies [J] and the ledger's relative error.")
      .def("measures", &Run::measures, "Last, smallest and largest value of every component of the scene's measures.")
      .def_property_readonly("title", &Run::title)
      .def_property_readonly("total_steps", &Run::total_steps, "Steps of the scene's duration.")
      .def_property_readonly("steps", [](Run& r) { return r.simulation().steps(); })
      .def_property_readonly(
          "time", [](Run& r) { return r.world().time; }, "[s]")
      .def_property_readonly(
          "time_step", [](Run& r) { return r.simulation().time_step; }, "[s]")
      .def_property_readonly("state_hash", [](Run& r) { return state_hash(r.world()); });
}

/// Bodies by id and by slot.
void bind_names(py::class_<Run>& run) {
  run.def_property_readonly("id",
                            column<std::uint32_t>(
                                [](Run & r) -> auto& { return r.world().id; }, 1),
                            "Body in each slot; slots change when bodies are sorted or removed.")
      .def_property_readonly(
          "slot",
          [](Run& r) {
            const World& w = r.world();
            std::vector<std::int64_t> slots(w.ids_given(), -1);
            for (std::size_t s = 0; s < w.size(); ++s)
              slots[static_cast<std::uint32_t>(w.id[s])] = static_cast<std::int64_t>(s);
            return py::array_t<std::int64_t>(static_cast<py::ssize_t>(slots.size()), slots.data());
          },
          "Slot of each body by its id, -1 where it is gone: position[slot] is in the order of the scene. A copy.");
}

/// Columns of the state, one row a slot.
void bind_columns(py::class_<Run>& run) {
  run.def_property_readonly("material", column<std::uint16_t>(
                                            [](Run & r) -> auto& { return r.world().material; }, 1))
      .def_property_readonly("inverse_mass",
                             column<double>(
                                 [](Run & r) -> auto& { return r.world().inverse_mass; }, 1),
                             "[1/kg], 0 for fixed bodies")
      .def_property_readonly("position",
                             column<double>(
                                 [](Run & r) -> auto& { return r.world().position; }, 3),
                             "(n, 3) [m]")
      .def_property_readonly("velocity",
                             column<double>(
                                 [](Run & r) -> auto& { return r.world().velocity; }, 3, true),
                             "(n, 3) [m/s]; may be written: a kick")
      .def_property_readonly("force",
                             column<double>(
                                 [](Run & r) -> auto& { return r.world().force; }, 3),
                             "(n, 3) contact force [N], smooth contact")
      .def_property_readonly("orientation",
                             column<double>(
                                 [](Run & r) -> auto& { return r.world().orientation; }, 4),
                             "(n, 4) quaternion x y z w as in SciPy, where bodies turn; files have w x y z: "
                             "orientation[:, [3, 0, 1, 2]]")
      .def_property_readonly("angular_velocity",
                             column<double>(
                                 [](Run & r) -> auto& { return r.world().angular_velocity; }, 3),
                             "(n, 3) world axes [rad/s]");
}

/// Contacts of the last step.
void bind_contacts(py::class_<Run>& run) {
  run.def_property_readonly(
         "contact_bodies",
         of_contacts<std::uint32_t>(2,
                                    [](const World& w, const ContactSet& c, std::size_t k, std::uint32_t* to) {
                                      to[0] = static_cast<std::uint32_t>(w.id[c.a[k]]);
                                      to[1] = static_cast<std::uint32_t>(w.id[c.b[k]]);
                                    }),
         "(n, 2) ids of A and B; contacts of the last step, a copy as the next three")
      .def_property_readonly(
          "contact_gap",
          of_contacts<double>(1, [](const World&, const ContactSet& c, std::size_t k, double* to) { *to = c.gap[k]; }),
          "[m], < 0 overlap")
      .def_property_readonly("contact_normal",
                             of_contacts<double>(3, [](const World&, const ContactSet& c, std::size_t k,
                                                       double* to) { std::copy_n(c.normal[k].data(), 3, to); }),
                             "(n, 3) from A to B")
      .def_property_readonly("contact_force",
                             of_contacts<double>(3,
                                                 [](const World&, const ContactSet& c, std::size_t k, double* to) {
                                                   const Vec3 f = k < c.force.size() ? c.force[k] : Vec3(Vec3::Zero());
                                                   std::copy_n(f.data(), 3, to);
                                                 }),
                             "(n, 3) on A [N]");
}

}  // namespace

PYBIND11_MODULE(epafi, m) {
  m.doc() =
      "Epafi: many-body contact. load() or build() a scene, step() it, read its columns as NumPy arrays without "
      "copying.";
  m.attr("__version__") = version();
  bind_functions(m);
  py::class_<Run> run(
      m, "Run",
      "A scene that runs. Arrays are views of its columns: always of the present moment, in the order of "
      "slots (see id).");
  bind_course(run);
  bind_names(run);
  bind_columns(run);
  bind_contacts(run);
}

}  // namespace epafi

// The class `Log`: the record of a world, row by row.
#include "runs/log.hpp"
#include "bindings/bound_state.hpp"

namespace irsim {
namespace {

/// A NumPy array that views a column as it is now; it does not show rows that are added later.
template <class T, class Element>
nb::object column_view(const Column<Element>& column, std::initializer_list<std::size_t> shape) {
  if (column.size() == 0) return own(std::vector<T>(), shape);
  return view<T>(std::shared_ptr<Element>(column.numbers, column.numbers->data()), shape);
}

std::shared_ptr<Log> make_log(const World& world, const std::vector<int>& movers, int columns, bool scans) {
  for (const int i : movers) {
    if (i < 0 || i >= world.objects) throw nb::index_error("no such object");
  }
  if (columns < 0 || columns > 3) throw nb::value_error("a control has up to three columns");
  return std::make_shared<Log>(world, movers, columns, scans);
}

}  // namespace

void bind_log(nb::module_& m) {
  nb::class_<Log>(m, "Log")
      .def(nb::new_(&make_log), nb::arg("world"), nb::arg("movers"), nb::arg("columns"), nb::arg("scans"))
      .def(
          "attach",
          [](const std::shared_ptr<Log>& self, BoundState& bound) {
            bound.check_idle();
            if (self->objects != bound.world->objects ||
                (self->scans && self->beams != static_cast<std::size_t>(bound.world->beams_per_world))) {
              throw nb::value_error("this log was made for another world");
            }
            bound.state.record = self;
          },
          nb::arg("state"))
      .def(
          "detach",
          [](const Log& self, BoundState& bound) {
            bound.check_idle();
            if (bound.state.record.get() == &self) bound.state.record.reset();
          },
          nb::arg("state"))
      .def(
          "add",
          [](Log& self, BoundState& bound) {
            bound.check_idle();
            if (bound.state.record.get() != &self) throw nb::value_error("this log is not attached to this state");
            self.add(bound.state);
          },
          nb::arg("state"))
      .def("clear", &Log::clear)
      .def_ro("first", &Log::first)
      .def_ro("rows", &Log::rows)
      .def_prop_ro("bytes", &Log::bytes)
      .def_prop_ro("pose",
                   [](const Log& s) {
                     return column_view<double>(s.pose, {static_cast<std::size_t>(s.rows), s.movers.size(), 3});
                   })
      .def_prop_ro("control",
                   [](const Log& s) {
                     const std::size_t columns = s.columns;
                     return column_view<float>(s.control, {static_cast<std::size_t>(s.rows), s.movers.size(), columns});
                   })
      .def_ro("commanded", &Log::commanded)
      .def_prop_ro("command",
                   [](const Log& s) {
                     const std::size_t columns = s.columns;
                     return column_view<float>(s.command,
                                               {static_cast<std::size_t>(s.rows), s.commanded.size(), columns});
                   })
      .def_prop_ro("goal_rows",
                   [](const Log& s) { return column_view<std::int64_t>(s.goal_rows, {s.goal_rows.size()}); })
      .def_prop_ro("goal",
                   [](const Log& s) {
                     const std::size_t n = s.objects;
                     return column_view<double>(s.goal, {s.goal_rows.size(), n, 3});
                   })
      .def_prop_ro("flag_rows",
                   [](const Log& s) { return column_view<std::int64_t>(s.flag_rows, {s.flag_rows.size()}); })
      .def_prop_ro("flags",
                   [](const Log& s) {
                     const std::size_t n = s.objects;
                     return column_view<std::uint8_t>(s.flags, {s.flag_rows.size(), n});
                   })
      .def_prop_ro("scan_rows",
                   [](const Log& s) { return column_view<std::int64_t>(s.scan_rows, {s.scan_rows.size()}); })
      .def_prop_ro("reading_rows",
                   [](const Log& s) { return column_view<std::int64_t>(s.reading_rows, {s.reading_rows.size()}); })
      .def_prop_ro("readings",
                   [](const Log& s) { return column_view<double>(s.readings, {s.reading_rows.size(), s.gauges}); })
      .def_prop_ro("ranges", [](const Log& s) { return column_view<float>(s.ranges, {s.scan_rows.size(), s.beams}); });
}

}  // namespace irsim

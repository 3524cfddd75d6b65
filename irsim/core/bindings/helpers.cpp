// Classes from lists of fields, whatever the struct.
#include "bindings/helpers.hpp"

#include <algorithm>

namespace irsim {
namespace {

/// The memory of an instance; another type, or memory in another state, is an argument that does not fit.
void* memory_of(const BoundStruct& bound, nb::handle self, bool constructed) {
  if (!nb::isinstance(self, bound.type) || nb::inst_ready(self) != constructed) throw nb::next_overload();
  return nb::inst_ptr<void>(self);
}

/// Raise TypeError unless the keyword arguments name each field and nothing else.
void check_names(const nb::kwargs& given, const std::vector<BoundField>& fields) {
  for (const BoundField& field : fields) {
    if (!given.contains(field.name)) throw nb::type_error((std::string("missing argument: ") + field.name).c_str());
  }
  for (const auto item : given) {
    const auto name = nb::cast<std::string>(item.first);
    const auto named = [&](const BoundField& field) { return name == field.name; };
    if (std::none_of(fields.begin(), fields.end(), named))
      throw nb::type_error(("unexpected argument: " + name).c_str());
  }
}

void construct(const BoundStruct& bound, nb::handle self, const nb::kwargs& given) {
  void* memory = memory_of(bound, self, false);
  bound.construct(memory);
  check_names(given, bound.fields);
  for (const BoundField& field : bound.fields) {
    try {
      field.read(field, static_cast<char*>(memory) + field.offset, given[field.name]);
    } catch (const nb::cast_error&) {
      throw nb::type_error((std::string("argument of the wrong type: ") + field.name).c_str());
    }
  }
  nb::inst_mark_ready(self);
}

}  // namespace

std::size_t index_of(const BoundField& field, const std::string& word) {
  const auto same = [&](const char* other) { return word == other; };
  const auto found = std::find_if(field.words.begin(), field.words.end(), same);
  if (found != field.words.end()) return static_cast<std::size_t>(found - field.words.begin());
  throw nb::value_error((std::string(field.name) + ": '" + word + "' is not one of the choices").c_str());
}

void bind_struct(nb::object type, BoundStruct bound) {
  bound.type = type;
  const auto shared = std::make_shared<const BoundStruct>(std::move(bound));
  const nb::object property = nb::module_::import_("builtins").attr("property");
  nb::list names;
  for (const BoundField& field : shared->fields) {
    const auto getter = [shared, &field](nb::handle self) {
      return field.show(field, static_cast<const char*>(memory_of(*shared, self, true)) + field.offset);
    };
    type.attr(field.name) = property(nb::cpp_function(getter, nb::is_method(), nb::is_getter()));
    names.append(field.name);
  }
  type.attr("fields") = nb::tuple(names);
  nb::cpp_function_def([shared](nb::handle self, const nb::kwargs& given) { construct(*shared, self, given); },
                       nb::scope(type), nb::name("__init__"), nb::is_method());
}

}  // namespace irsim

// Helpers of the bindings: arrays without copies, and classes from lists of fields.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "fields.hpp"

namespace irsim {

namespace nb = nanobind;

/// A NumPy array that views shared memory and keeps it alive.
template <class T, class Element>
nb::object view(const std::shared_ptr<Element>& memory, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::shared_ptr<Element>(memory);
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::shared_ptr<Element>*>(p); });
  return nb::ndarray<nb::numpy, T>(reinterpret_cast<T*>(memory.get()), shape.size(), shape.begin(), owner).cast();
}

/// A NumPy array that owns its memory.
template <class T>
nb::object own(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto kept = std::make_shared<std::vector<T>>(std::move(values));
  if (kept->empty()) kept->resize(1);
  return view<T>(std::shared_ptr<T>(kept, kept->data()), shape);
}

template <class Target, class Owner, class Value>
void read_field(Target& owner, const Field<Owner, Value>& field, nb::handle value) {
  owner.*(field.member) = nb::cast<Value>(value);
}
/// The index of a word among the choices of a field.
template <class Choices>
std::size_t index_of(const Choices& field, const std::string& word) {
  for (std::size_t i = 0; i < field.words.size(); ++i) {
    if (word == field.words[i]) return i;
  }
  throw nb::value_error((std::string(field.name) + ": '" + word + "' is not one of the choices").c_str());
}
template <class Target, class Owner, class Enum, std::size_t N>
void read_field(Target& owner, const Choice<Owner, Enum, N>& field, nb::handle value) {
  owner.*(field.member) = static_cast<Enum>(index_of(field, nb::cast<std::string>(value)));
}
template <class Target, class Owner, class Enum, std::size_t N>
void read_field(Target& owner, const Choices<Owner, Enum, N>& field, nb::handle value) {
  std::vector<Enum>& list = owner.*(field.member);
  list.clear();
  for (const std::string& word : nb::cast<std::vector<std::string>>(value)) {
    list.push_back(static_cast<Enum>(index_of(field, word)));
  }
}

template <class Target, class Owner, class Value>
nb::object show_field(const Target& owner, const Field<Owner, Value>& field) {
  return nb::cast(owner.*(field.member));
}
template <class Target, class Owner, class Enum, std::size_t N>
nb::object show_field(const Target& owner, const Choice<Owner, Enum, N>& field) {
  return nb::cast(field.words[static_cast<std::size_t>(owner.*(field.member))]);
}

template <class Target, class Owner, class Enum, std::size_t N>
nb::object show_field(const Target& owner, const Choices<Owner, Enum, N>& field) {
  nb::list words;
  for (const Enum one : owner.*(field.member)) words.append(field.words[static_cast<std::size_t>(one)]);
  return words;
}

/// Set the field at an index of the list.
template <class T>
void read_at(T& target, std::size_t index, nb::handle value) {
  T::fields([&](const auto&... field) {
    [[maybe_unused]] std::size_t at = 0;
    ((at++ == index ? read_field(target, field, value) : void()), ...);
  });
}

/// The field at an index of the list.
template <class T>
nb::object show_at(const T& source, std::size_t index) {
  nb::object shown;
  T::fields([&](const auto&... field) {
    [[maybe_unused]] std::size_t at = 0;
    ((at++ == index ? void(shown = show_field(source, field)) : void()), ...);
  });
  return shown;
}

/// Raise TypeError unless the keyword arguments name each of `names` and nothing else.
void check_names(const nb::kwargs& given, const std::vector<const char*>& names);

/// Bind a struct that has `fields`, with a keyword constructor, the tuple `fields` and read-only attributes.
template <class T>
void bind_fields(nb::module_& m, const char* name) {
  const auto names =
      T::fields([](const auto&... field) { return std::vector<const char*>{static_cast<const char*>(field.name)...}; });
  nb::class_<T> bound(m, name);
  // One type of getter per struct: what nanobind compiles for each type costs more than the search for the index.
  for (std::size_t i = 0; i < names.size(); ++i) {
    bound.def_prop_ro(names[i], [i](const T& self) { return show_at(self, i); });
  }
  bound.attr("fields") = nb::tuple(nb::cast(names));
  bound.def("__init__", [names](T* self, nb::kwargs given) {
    new (self) T();
    check_names(given, names);
    for (std::size_t i = 0; i < names.size(); ++i) {
      try {
        read_at(*self, i, given[names[i]]);
      } catch (const nb::cast_error&) {
        throw nb::type_error((std::string("argument of the wrong type: ") + names[i]).c_str());
      }
    }
  });
}

void bind_features(nb::module_& m);
void bind_log(nb::module_& m);
void bind_maps(nb::module_& m);
void bind_networks(nb::module_& m);
void bind_planning(nb::module_& m);
void bind_world(nb::module_& m);
void bind_state(nb::module_& m);
void bind_steps(nb::module_& m);
void bind_object(nb::module_& m);
void bind_observing(nb::module_& m);
void bind_learners(nb::module_& m);
void bind_pictures(nb::module_& m);
void bind_tools(nb::module_& m);
void bind_clearance(nb::module_& m);
void bind_policies(nb::module_& m);

}  // namespace irsim

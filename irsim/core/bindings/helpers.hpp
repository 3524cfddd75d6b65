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
#include <nanobind/stl/vector.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "bindings/variants.hpp"
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

/// One field of a bound struct. It knows the type of the value, but not of the struct: what nanobind compiles for each
/// type takes seconds, so all structs share the functions for a type of value.
struct BoundField {
  const char* name;
  std::size_t offset;  // in the struct [bytes]
  nb::object (*show)(const BoundField& field, const void* value);
  void (*read)(const BoundField& field, void* value, nb::handle given);
  std::vector<const char*> words;  // of a choice
};

/// A bound struct: how its memory becomes an object, and its fields.
struct BoundStruct {
  nb::handle type;
  void (*construct)(void* memory);
  std::vector<BoundField> fields;
};

/// The index of a word among the choices of a field.
std::size_t index_of(const BoundField& field, const std::string& word);

template <class Value>
void read_value(const BoundField&, void* value, nb::handle given) {
  *static_cast<Value*>(value) = nb::cast<Value>(given);
}
template <class Value>
nb::object show_value(const BoundField&, const void* value) {
  return nb::cast(*static_cast<const Value*>(value));
}
template <class Enum>
void read_choice(const BoundField& field, void* value, nb::handle given) {
  *static_cast<Enum*>(value) = static_cast<Enum>(index_of(field, nb::cast<std::string>(given)));
}
template <class Enum>
nb::object show_choice(const BoundField& field, const void* value) {
  return nb::cast(field.words[static_cast<std::size_t>(*static_cast<const Enum*>(value))]);
}
template <class Enum>
void read_choices(const BoundField& field, void* value, nb::handle given) {
  auto& list = *static_cast<std::vector<Enum>*>(value);
  list.clear();
  for (const std::string& word : nb::cast<std::vector<std::string>>(given)) {
    list.push_back(static_cast<Enum>(index_of(field, word)));
  }
}
template <class Enum>
nb::object show_choices(const BoundField& field, const void* value) {
  nb::list words;
  for (const Enum one : *static_cast<const std::vector<Enum>*>(value))
    words.append(field.words[static_cast<std::size_t>(one)]);
  return words;
}

template <class Owner, class Value>
BoundField bound_field(const Field<Owner, Value>& field, std::size_t offset) {
  return {field.name, offset, &show_value<Value>, &read_value<Value>, {}};
}
template <class Owner, class Enum, std::size_t N>
BoundField bound_field(const Choice<Owner, Enum, N>& field, std::size_t offset) {
  return {field.name, offset, &show_choice<Enum>, &read_choice<Enum>, {field.words.begin(), field.words.end()}};
}
template <class Owner, class Enum, std::size_t N>
BoundField bound_field(const Choices<Owner, Enum, N>& field, std::size_t offset) {
  return {field.name, offset, &show_choices<Enum>, &read_choices<Enum>, {field.words.begin(), field.words.end()}};
}

/// Give a class the keyword constructor, the tuple `fields` and the read-only attributes of a struct.
void bind_struct(nb::object type, BoundStruct bound);

/// Bind a struct that has `fields`.
template <class T>
void bind_fields(nb::module_& m, const char* name) {
  BoundStruct bound{nb::handle(), [](void* memory) { new (memory) T(); }, {}};
  const T any{};
  T::fields([&](const auto&... field) {
    const auto* start = reinterpret_cast<const char*>(&any);
    (bound.fields.push_back(
         bound_field(field, static_cast<std::size_t>(reinterpret_cast<const char*>(&(any.*(field.member))) - start))),
     ...);
  });
  bind_struct(nb::class_<T>(m, name), std::move(bound));
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

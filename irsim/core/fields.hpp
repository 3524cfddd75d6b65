// How options structs list their fields: for the bindings, comparisons and the test against the Python models. A struct
// has `fields(visit)`, which calls `visit` with all of them; as a template it costs nothing where it is not used.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <variant>
#include <vector>

namespace irsim {

template <class Owner, class Value>
struct Field {
  const char* name;
  Value Owner::* member;
};

/// A field that Python gives as one of a few words; the enumerators have the same order, from 0.
template <class Owner, class Enum, std::size_t N>
struct Choice {
  const char* name;
  Enum Owner::* member;
  std::array<const char*, N> words;
};

/// A list of such words.
template <class Owner, class Enum, std::size_t N>
struct Choices {
  const char* name;
  std::vector<Enum> Owner::* member;
  std::array<const char*, N> words;
};

template <class Owner, class Value>
constexpr Field<Owner, Value> field(const char* name, Value Owner::* member) {
  return {name, member};
}

template <class Owner, class Enum, class... Words>
constexpr Choice<Owner, Enum, sizeof...(Words)> choice(const char* name, Enum Owner::* member, Words... words) {
  return {name, member, {words...}};
}

template <class Owner, class Enum, class... Words>
constexpr Choices<Owner, Enum, sizeof...(Words)> choices(const char* name, std::vector<Enum> Owner::* member,
                                                         Words... words) {
  return {name, member, {words...}};
}

/// Whether two options structs are equal in every field.
template <class Options>
bool same(const Options& a, const Options& b) {
  return Options::fields([&](const auto&... f) { return ((a.*(f.member) == b.*(f.member)) && ...); });
}

/// Call `call` with the options that a variant of features holds; without options, do nothing.
template <class Feature, class Call>
void with(const Feature& feature, Call&& call) {
  std::visit(
      [&](const auto& options) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(options)>, std::monostate>) call(options);
      },
      feature);
}

}  // namespace irsim

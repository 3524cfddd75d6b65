// Variants of bound classes as arguments and results: what nanobind/stl/variant.h does for variants of any types takes
// the compiler a multiple of the time.
#pragma once

#include <nanobind/nanobind.h>

#include <variant>

namespace nanobind::detail {

/// Signatures of functions name no None for a variant that may hold nothing, as callers must give a feature.
template <class... Ts>
struct remove_opt_mono<std::variant<std::monostate, Ts...>> {
  using type = std::variant<Ts...>;
};

template <>
struct type_caster<std::monostate> : none_caster<std::monostate> {};

template <class... Ts>
struct type_caster<std::variant<Ts...>> {
  using Variant = std::variant<Ts...>;
  NB_TYPE_CASTER(Variant, union_name(make_caster<Ts>::Name...))

  bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept { return (take<Ts>(given) || ...); }

  static handle from_cpp(const Variant& variant, rv_policy, cleanup_list*) noexcept {
    handle out;
    ((std::holds_alternative<Ts>(variant) ? void(out = give(*std::get_if<Ts>(&variant))) : void()), ...);
    return out;
  }

 private:
  template <class T>
  bool take(handle given) noexcept {
    if constexpr (std::is_same_v<T, std::monostate>) {
      if (!given.is_none()) return false;
      value.template emplace<T>();
    } else {
      if (!isinstance<T>(given) || !inst_ready(given)) return false;
      value.template emplace<T>(*inst_ptr<T>(given));
    }
    return true;
  }

  static handle give(std::monostate) noexcept { return none().release(); }
  template <class T>
  static handle give(const T& alternative) noexcept {
    return make_caster<T>::from_cpp(alternative, rv_policy::copy, nullptr);
  }
};

}  // namespace nanobind::detail

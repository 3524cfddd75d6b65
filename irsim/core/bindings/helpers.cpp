// Names of keyword arguments, which the bindings of all structs check.
#include "bindings/helpers.hpp"

#include <algorithm>

namespace irsim {

void check_names(const nb::kwargs& given, const std::vector<const char*>& names) {
  for (const char* name : names) {
    if (!given.contains(name)) throw nb::type_error((std::string("missing argument: ") + name).c_str());
  }
  for (const auto item : given) {
    const auto name = nb::cast<std::string>(item.first);
    const bool known = std::any_of(names.begin(), names.end(), [&](const char* other) { return name == other; });
    if (!known) throw nb::type_error(("unexpected argument: " + name).c_str());
  }
}

}  // namespace irsim

// Options classes of kinematics, behaviors, sensors, shapes and observation parts and reward terms, generated from
// their lists of fields.
#include "bindings/helpers.hpp"
#include "parts.gen.hpp"
#include "rewards.gen.hpp"
#include "world/spec.hpp"

namespace irsim {

void bind_features(nb::module_& m) {
  bind_fields<LidarErrors>(m, "LidarErrors");
#define IRSIM_BIND(Type) bind_fields<Type>(m, #Type);
  IRSIM_KINEMATICS(IRSIM_BIND)
  IRSIM_BEHAVIORS(IRSIM_BIND)
  IRSIM_SENSORS(IRSIM_BIND)
  IRSIM_SHAPES(IRSIM_BIND)
  IRSIM_PARTS(IRSIM_BIND)
  IRSIM_REWARDS(IRSIM_BIND)
#undef IRSIM_BIND
}

}  // namespace irsim

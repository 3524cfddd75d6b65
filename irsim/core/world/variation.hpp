// The differences between the episodes of a task, besides places: who takes part, sizes, limits, noise, delays, times
// of sensors, ground, geometry.
#pragma once

#include <vector>

#include "fields.hpp"

namespace irsim {

enum class Quantity {
  number,
  size,
  speed,
  acceleration,
  sensor_noise,
  latency,
  delay,
  lag,
  sensor_rate,
  sensor_latency,
  slip,
  grip
};

/// A quantity that is drawn for each scene, uniformly: a whole number of `low` to `high`, or a factor.
struct Variation {
  Quantity quantity;
  std::vector<int> objects;
  double low, high;
  bool same;  // whether all objects share one draw; a number is one anyway
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using V = Variation;
    return visit(choice("quantity", &V::quantity, "number", "size", "speed", "acceleration", "sensor_noise", "latency",
                        "delay", "lag", "sensor_rate", "sensor_latency", "slip", "grip"),
                 field("objects", &V::objects), field("low", &V::low), field("high", &V::high),
                 field("same", &V::same));
  }
};

/// The draws at one level of a curriculum.
struct Level {
  std::vector<Variation> variations;
  int first_variant;  // the variants of the world of which one is drawn
  int variants;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("variations", &Level::variations), field("first_variant", &Level::first_variant),
                 field("variants", &Level::variants));
  }
};

struct World;
struct State;

/// Draw what varies in the present scene of world w, at its level.
void vary(const World& world, State& state, int w);
/// The world whose places and shapes world w has in its present scene: the variant that was drawn, if there are any.
const World& variant_of(const World& world, const State& state, int w);

}  // namespace irsim

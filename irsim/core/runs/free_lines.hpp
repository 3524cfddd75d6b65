// Straight lines past static objects: lines of sight.
#pragma once

#include <cstdint>
#include <vector>

#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {

/// For each k, whether the closed line from `start[k]` to `end[k]` meets none of the static objects that `blocking`
/// (N,) marks. A line that is not finite meets nothing.
void free_lines(const World& world, const Shapes& shapes, const Fixed& fixed, const Vec2* start, const Vec2* end,
                std::size_t count, const std::uint8_t* blocking, std::uint8_t* out);

}  // namespace irsim

// Clearances of robots over recorded poses: distances to other robots, people and static objects.
#pragma once

#include <cstdint>
#include <vector>

#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {

/// The kind of an object, as a robot sees it.
enum class ObjectKind : std::uint8_t { robot, human, fixed, ignored };
constexpr int kKinds = 3;  // number of kinds to which distances are measured

/// Find, for each of `robots` and each kind, the distance [m] to the nearest other footprint and its index. `poses`:
/// (rows, N) of one world with these shapes and static objects; `kinds`: (N,). `distance` and `partner`: (rows, robots,
/// kKinds); NaN and -1 without a footprint of that kind. Among equally near footprints the first counts.
void clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                const std::vector<int>& robots, const std::vector<ObjectKind>& kinds, double* distance,
                std::int32_t* partner);

/// Find, for each of `robots`, the smallest distance [m] to any other footprint over its first `ends` rows, the index
/// of that object and the first such row. Arguments are as for `clearances`. A pair is measured again only when it can
/// have come nearer than the smallest distance so far.
void least_clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                      const std::vector<int>& robots, const std::vector<ObjectKind>& kinds,
                      const std::vector<int>& ends, double* distance, std::int32_t* partner, std::int32_t* row);

}  // namespace irsim

// How near robots came to what is around them, after the event: distances over recorded poses.
#pragma once

#include <cstdint>
#include <vector>

#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {

/// What an object is to a robot beside it.
enum class Company : std::uint8_t { robot, human, fixed, nobody };
constexpr int kCompanies = 3;  // those with distances

/// For each of `robots` and each kind of company the distance [m] to the nearest other footprint and its index.
/// `poses`: (rows, N) of one world with these shapes and static objects; `company`: (N,). `distance` and
/// `partner`: (rows, robots, kCompanies); NaN and -1 where there is none. Of equally near ones the first counts.
void clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                const std::vector<int>& robots, const std::vector<Company>& company, double* distance,
                std::int32_t* partner);

/// For each of `robots` the least distance [m] to any other footprint over its first `ends` rows, whose it is, and the
/// first such row. As `clearances` otherwise. Pairs are looked at again only once they can have come nearer than the
/// least so far.
void least_clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                      const std::vector<int>& robots, const std::vector<Company>& company, const std::vector<int>& ends,
                      double* distance, std::int32_t* partner, std::int32_t* row);

}  // namespace irsim

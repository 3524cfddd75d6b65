#include "footprints/free_cells.hpp"

namespace irsim {
namespace {

constexpr double kEvenSpeed = 0.3;  // speed added to those of both bodies, so that none is left without room [m/s]

}  // namespace

Border border(const Hull& body, const Separation& apart, double own, double other, double margin) {
  const double share = (kEvenSpeed + own) / (2.0 * kEvenSpeed + own + other);
  return {apart.axis, body.least(apart.axis) - share * std::max(0.0, apart.gap - margin)};
}

double FreeCell::room(const Hull& body, Vec2 place, Vec2 shift, Vec2 turn) {
  double room = kInfinity;
  if (empty()) return room;
  const std::size_t count = body.count;
  moved.resize(3 * count);
  const Vec2 to = place + shift;
  for (std::size_t k = 0; k < count; ++k) moved[k] = to + rotate(body.corner[k] - place, turn);
  const Hull there{moved.data(), moved.data() + count, body.count, body.round};
  for (const Border& one : borders) room = std::min(room, there.least(one.axis) - one.limit);
  if (room < 0.0 || fixtures.empty()) return room;
  for (std::size_t k = 0; k < count; ++k) moved[count + k] = rotate(body.normal[k], turn);
  for (const Fixture& one : fixtures) {
    for (std::size_t k = 0; k < count; ++k) moved[2 * count + k] = moved[k] - one.shift;
    const Hull relative{moved.data() + 2 * count, moved.data() + count, body.count, body.round};
    room = std::min(room, separation(relative, one.hull).gap - one.gap);
  }
  return room;
}

}  // namespace irsim

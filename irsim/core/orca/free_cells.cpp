#include "orca/free_cells.hpp"

namespace irsim {
namespace {

constexpr double kEvenSpeed = 0.3;  // speed added to those of both bodies, so that none is left without room [m/s]

}  // namespace

Border border(const Hull& body, const Separation& apart, double own, double other, double margin) {
  const double share = (kEvenSpeed + own) / (2.0 * kEvenSpeed + own + other);
  return {apart.axis, body.least(apart.axis) - share * std::max(0.0, apart.gap - margin)};
}

Border border(const Hull& body, const Separation& apart, double margin) {
  return {apart.axis, body.least(apart.axis) - std::max(0.0, apart.gap - margin)};
}

double room(const Hull& body, Vec2 place, Vec2 shift, Vec2 turn, const std::vector<Border>& borders) {
  double room = kInfinity;
  for (const Border& one : borders) {
    // The axis is turned back instead of all corners.
    const Vec2 axis = unrotate(one.axis, turn);
    double least = kInfinity;
    for (int k = 0; k < body.count; ++k) least = std::min(least, dot(axis, body.corner[k] - place));
    room = std::min(room, least + dot(one.axis, place + shift) - one.limit);
  }
  return room;
}

}  // namespace irsim

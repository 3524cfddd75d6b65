#include "footprints/free_cells.hpp"

#include <cmath>

namespace irsim {
namespace {

constexpr double kEvenSpeed = 0.3;  // speed added to the speeds of both bodies, so that each keeps some room [m/s]
constexpr int kWayHalvings = 6;     // of a part of a way whose chord does not tell whether it is free

bool crosses(const Border& border, const CellBody& body, const Manoeuvre& way) {
  const Hull& hull = body.hull;
  const double now = hull.least(border.axis) - hull.round - border.limit;
  const double least = std::max(0.0, way.bulge - border.reserve);
  if (now - way.travel >= least) return false;
  const double base = hull.round + border.limit - dot(border.axis, body.position);
  for (std::size_t k = 1; k < way.places.size(); ++k) {
    const Place& place = way.places[k];
    const Vec2 axis = unrotate(border.axis, place.turn);
    double room = kInfinity;
    for (int c = 0; c < hull.count; ++c) room = std::min(room, dot(axis, hull.corner[c] - body.position));
    room += dot(border.axis, place.shift) - base;
    if (room < least) return true;
  }
  return false;
}

/// The place in the middle of the way between two places, on an arc or on the straight line.
Place halfway(const Place& from, const Place& to, bool arcs) {
  const double angle = 0.5 * (from.angle + to.angle);
  Vec2 shift = (from.shift + to.shift) * 0.5;
  if (arcs && to.angle != from.angle) {
    const Vec2 chord = to.shift - from.shift;
    shift = shift + Vec2{chord.y, -chord.x} * (0.5 * std::tan(0.25 * (to.angle - from.angle)));
  }
  return {shift, angle, unit(angle), 0.5 * (from.time + to.time), 0.0};
}

/// A body on its way past a fixture, seen from this.
class Passage {
 public:
  Passage(const CellBody& body, const FreeCell::Fixture& fixture, const Manoeuvre& way, std::vector<Vec2>& memory)
      : body_(body), fixture_(fixture), bulge_(way.bulge), arcs_(way.arcs), memory_(memory) {
    memory_.resize(4 * static_cast<std::size_t>(body.hull.count));
  }

  /// The smallest amount by which it keeps the distance; the search ends where this is negative.
  double room(const Manoeuvre& way) {
    double room = fixture_.now - fixture_.gap, left = room - bulge_;  // way that is free for certain
    bool known = false;                                               // whether `before_` is the place before
    for (std::size_t k = 1; k < way.places.size(); ++k) {
      const Place &from = way.places[k - 1], &to = way.places[k];
      if (!fixture_.stands && to.time > 1.0) break;  // its place at that time is unknown
      const double travel = to.travel + norm(fixture_.shift) * (to.time - from.time);
      if (travel <= left) {
        left -= travel, known = false;
        continue;
      }
      if (!known) {
        before_ = look(from, 0);
        left = before_.gap - fixture_.gap - bulge_;
        if (travel <= left) {
          left -= travel;
          continue;
        }
      }
      const Separation after = look(to, 1);
      room = std::min(room, after.gap - fixture_.gap);
      if (room < 0.0) return room;
      if (fixture_.gap > 0.0 && !is_free(from, before_.axis, to, after.axis, bulge_, kWayHalvings))
        return -bulge_ - fixture_.gap;
      before_ = after, known = true;
      left = after.gap - fixture_.gap - bulge_;
    }
    return room;
  }

 private:
  /// The body at a place, moved by what the fixture has moved until then: corners, then normals.
  Hull at(const Place& place, int slot) {
    const Hull& hull = body_.hull;
    Vec2* corners = memory_.data() + static_cast<std::size_t>(2 * slot) * hull.count;
    Vec2* normals = corners + hull.count;
    const Vec2 to = body_.position + place.shift - fixture_.shift * place.time;
    for (int k = 0; k < hull.count; ++k) corners[k] = to + rotate(hull.corner[k] - body_.position, place.turn);
    for (int k = 0; k < hull.count; ++k) normals[k] = rotate(hull.normal[k], place.turn);
    return {corners, normals, hull.count, hull.round};
  }
  Separation look(const Place& place, int slot) { return separation(at(place, slot), fixture_.hull); }

  /// Distance of a place from the fixture along an axis [m].
  double gap_along(Vec2 axis, const Place& place) const {
    const Hull& hull = body_.hull;
    const Vec2 turned = unrotate(axis, place.turn);
    double least = kInfinity;
    for (int c = 0; c < hull.count; ++c) least = std::min(least, dot(turned, hull.corner[c] - body_.position));
    least += dot(axis, body_.position + place.shift - fixture_.shift * place.time);
    return least + fixture_.hull.least(axis * -1.0) - hull.round - fixture_.hull.round;
  }

  /// Whether one line separates both ends of a part from the fixture, and so all between them, or if not, whether its
  /// halves are free.
  bool is_free(const Place& from, Vec2 first, const Place& to, Vec2 last, double bulge, int halvings) {
    const double least = 0.5 * fixture_.gap + bulge;
    if (gap_along(first, from) >= least && gap_along(first, to) >= least) return true;
    if (gap_along(last, from) >= least && gap_along(last, to) >= least) return true;
    if (halvings == 0) return false;
    const Place middle = halfway(from, to, arcs_);
    const Separation there = look(middle, 1);
    bulge *= 0.25;
    return there.gap >= 0.5 * fixture_.gap + bulge && is_free(from, first, middle, there.axis, bulge, halvings - 1) &&
           is_free(middle, there.axis, to, last, bulge, halvings - 1);
  }

  const CellBody& body_;
  const FreeCell::Fixture& fixture_;
  const double bulge_;
  const bool arcs_;
  std::vector<Vec2>& memory_;
  Separation before_{};
};

}  // namespace

Border border(const Hull& stop, const Separation& apart, double own, double other, double margin) {
  const double share = (kEvenSpeed + own) / (2.0 * kEvenSpeed + own + other);
  const double least = stop.least(apart.axis) - stop.round;
  return {apart.axis, least - share * std::max(0.0, apart.gap - margin),
          0.5 * std::min(margin, std::max(0.0, apart.gap))};
}

bool FreeCell::holds(const CellBody& body, const Manoeuvre& way) {
  for (const Border& one : borders) {
    if (crosses(one, body, way)) return false;
  }
  for (const Fixture& one : fixtures) {
    if (one.stands && Passage(body, one, way, moved).room(way) < 0.0) return false;
  }
  return true;
}

double FreeCell::room(const CellBody& body, const Manoeuvre& way) {
  double room = kInfinity;
  for (const Fixture& one : fixtures) {
    if (!one.stands) room = std::min(room, Passage(body, one, way, moved).room(way));
  }
  return room;
}

}  // namespace irsim

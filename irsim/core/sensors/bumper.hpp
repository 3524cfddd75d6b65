// Bumper: which sectors of the hull press against something.
#pragma once

#include "collision/distance.hpp"
#include "collision/touch.hpp"
#include "fields.hpp"
#include "sensing.hpp"

namespace irsim {

struct BumperOptions {
  std::vector<std::array<double, 2>> sectors;  // first and last bearing of each, about the origin of the body [rad]
  double reach;                                // surfaces nearer to the hull than this press it [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using B = BumperOptions;
    return visit(field("sectors", &B::sectors), field("reach", &B::reach));
  }
};

inline std::vector<double> beams(const BumperOptions&) { return {}; }
/// For each sector 1 if it is pressed.
inline int readings(const BumperOptions& options) { return static_cast<int>(options.sectors.size()); }

inline bool in_sector(const std::array<double, 2>& sector, Vec2 from_origin) {
  const double bearing = std::atan2(from_origin.y, from_origin.x), after = wrap(bearing - sector[0] - kPi) + kPi;
  return after <= sector[1] - sector[0];
}

/// A body against which a hull may press.
class Pressing {
 public:
  Pressing(const Sensing& s, const Footprint& hull, const Footprint& other, double reach)
      : s_(s), hull_(hull), other_(other), reach_(reach), overlap_(touch(hull, other)) {}

  /// Whether the part of the hull in a sector is within reach of the body, or in it.
  bool in(const std::array<double, 2>& sector) const {
    for (int k = 0; k < hull_.count; ++k) {
      const Part& part = hull_.parts[k];
      const Vec2* vertices = hull_.vertices + part.first;
      if (part.kind == Kind::circle) {
        if (arcs(sector, *vertices, part.radius)) return true;
        continue;
      }
      for (int v = 0; v < part.last - part.first; ++v) {
        if (edge(sector, vertices[v], vertices[v + 1], reach_)) return true;
      }
    }
    return false;
  }

 private:
  bool arcs(const std::array<double, 2>& sector, Vec2 centre, double radius) const {
    constexpr int kChords = 72;
    const double sagitta = radius * (1.0 - std::cos(kPi / kChords));
    for (int k = 0; k < kChords; ++k) {
      const Vec2 a = unit(kTurn * k / kChords), b = unit(kTurn * (k + 1) / kChords);
      if (edge(sector, centre + a * radius, centre + b * radius, reach_ + sagitta)) return true;
    }
    return false;
  }
  /// Cut an edge of the hull where it leaves the sector, and look at the pieces inside.
  bool edge(const std::array<double, 2>& sector, Vec2 from, Vec2 to, double reach) const {
    Box near;
    near.include(from), near.include(to);
    if (overlap_) near.include(s_.pose.position());
    if (!grown(near, reach).meets(other_.box)) return false;
    const Vec2 a = unrotate(from - s_.pose.position(), s_.direction), along = unrotate(to - from, s_.direction);
    double cuts[4] = {0.0, 1.0, 1.0, 1.0};
    int count = 1;
    for (const double bearing : sector) {
      const Vec2 ray = unit(bearing);
      const double t = -cross(a, ray) / cross(along, ray);
      if (t > 0.0 && t < 1.0 && dot(a + along * t, ray) > 0.0) cuts[count++] = t;
    }
    std::sort(cuts + 1, cuts + count);
    cuts[count] = 1.0;
    for (int k = 0; k < count; ++k) {
      if (!in_sector(sector, a + along * (0.5 * (cuts[k] + cuts[k + 1])))) continue;
      if (piece(from + (to - from) * cuts[k], from + (to - from) * cuts[k + 1], reach)) return true;
    }
    return false;
  }
  /// Of a hull that is in the body, what lies between the origin and this piece may be in it, too.
  bool piece(Vec2 a, Vec2 b, double reach) const {
    const Vec2 origin = s_.pose.position(), corners[4] = {a, b, origin, a};
    Box box;
    for (const Vec2 corner : {a, b}) box.include(corner);
    const Part line{Kind::linestring, 0, 1, 0.0, 0.0};
    if (distance({&line, 1, corners, &box, box, {}, 0.0}, other_) <= reach) return true;
    if (!overlap_) return false;
    box.include(origin);
    const Part wedge{Kind::polygon, 0, 3, 0.0, cross(b - a, origin - b) < 0.0 ? -1.0 : 1.0};
    return touch({&wedge, 1, corners, &box, box, {}, 0.0}, other_);
  }

  const Sensing& s_;
  const Footprint &hull_, &other_;
  double reach_;
  bool overlap_;
};

inline void bumper(const BumperOptions& o, const Sensing& s) {
  const int count = readings(o), carrier = s.mount.object;
  std::fill_n(s.readings, count, 0.0);
  const Footprint hull = s.footprint(carrier);
  const Box near = grown(hull.box, o.reach);
  for (const int object : s.world.visible) {
    if (object == carrier) continue;
    const Footprint other = s.footprint(object);
    if (!near.meets(other.box)) continue;
    const Pressing pressing(s, hull, other, o.reach);
    for (int k = 0; k < count; ++k) {
      if (s.readings[k] == 0.0) s.readings[k] = pressing.in(o.sectors[k]);
    }
  }
  // Bodies that were pushed apart in the step have touched in it.
  for (const Contact& contact : s.state.scenes[s.w].contacts) {
    if (contact.a != carrier && contact.b != carrier) continue;
    const Vec2 at = unrotate(contact.point - s.pose.position(), s.direction);
    for (int k = 0; k < count; ++k) {
      if (in_sector(o.sectors[k], at)) s.readings[k] = 1.0;
    }
  }
}

}  // namespace irsim

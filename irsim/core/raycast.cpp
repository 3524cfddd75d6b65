#include "raycast.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kNearest = 1e-9;       // closer hits are not hits [m]
constexpr double kBearingError = 1e-4;  // bound on the error of `bearing` [rad]
constexpr double kOutside = 1e-9;       // how far "just outside" an edge is, relative to the size of the body

/// atan2 to within kBearingError: an odd polynomial fitted to atan on [0, 1], unfolded to the octants.
double bearing(Vec2 v) {
  const double ax = std::fabs(v.x), ay = std::fabs(v.y);
  const double large = std::max(ax, ay), small = std::min(ax, ay);
  const double q = small / (large + std::numeric_limits<double>::min()), s = q * q;
  double a = q * (0.99996929 + s * (-0.33167787 + s * (0.18510297 + s * (-0.09174844 + s * 0.02377510))));
  if (ay > ax) a = 0.5 * kPi - a;
  if (v.x < 0.0) a = kPi - a;
  return v.y < 0.0 ? -a : a;
}

/// Whether p is inside a filled part other than `except`.
bool covered(const Footprint& body, int except, Vec2 p) {
  for (int k = 0; k < body.count; ++k) {
    if (k == except) continue;
    const Part& part = body.parts[k];
    const Vec2* vertices = body.vertices + part.first;
    if (part.kind == Kind::circle && squared(p - *vertices) < part.radius * part.radius) return true;
    if (part.kind == Kind::polygon && inside_ring(vertices, part.last - part.first, p)) return true;
  }
  return false;
}

}  // namespace

/// From a to b, both relative to the origin of the fan.
struct Fan::Edge {
  const Footprint& body;
  int part, object;
  Vec2 a, b, along;
  double area;  // a x along; 0: the origin is on the line
};

Fan::Fan(BeamBuffers& buffers, Vec2 origin, Vec2 heading, const Mount& mount, double reach)
    : buffers_(buffers), origin_(origin), heading_(heading), count_(mount.count), reach_(reach) {
  const auto n = static_cast<std::size_t>(count_);
  for (auto* list : {&buffers.dx, &buffers.dy, &buffers.range}) list->resize(std::max(list->size(), n));
  buffers.hit.resize(std::max(buffers.hit.size(), n));
  std::fill_n(buffers.range.begin(), n, std::nextafter(reach, kInfinity));
  std::fill_n(buffers.hit.begin(), n, -1);
  const double spacing = count_ > 1 ? mount.angle[1] - mount.angle[0] : 0.0;
  narrow_ = spacing > 1e-7;
  first_ = count_ > 0 ? mount.angle[0] : 0.0;
  per_radian_ = narrow_ ? 1.0 / spacing : 0.0;
  turn_ = kTurn * per_radian_;
  widen(0.0);
}

void Fan::widen(double error) {
  stray_ = std::max(stray_, std::fabs(error));
  guard_ = 1.0 + (2.0 * kBearingError + stray_) * per_radian_;
}

double Fan::beam_of(Vec2 from_origin) const {
  return (bearing(unrotate(from_origin, heading_)) - first_) * per_radian_;
}

template <class Test>
void Fan::between(double low, double high, Test&& test) {
  low -= guard_, high += guard_;
  if (!narrow_ || !(high - low < turn_)) {
    for (int i = 0; i < count_; ++i) test(i);
    return;
  }
  for (const double shift : {-turn_, 0.0, turn_}) {  // the bundle may reach across the rear
    const double from = std::max(low + shift, 0.0), to = std::min(high + shift, count_ - 1.0);
    if (!(from <= to)) continue;
    for (int i = static_cast<int>(from), last = static_cast<int>(to); i <= last; ++i) test(i);
  }
}

void Fan::cast(const Footprint& body, int object) {
  const Vec2 d = body.centre - origin_;
  const double distance2 = squared(d), reach = reach_ + body.radius;
  if (!(distance2 <= reach * reach)) return;
  for (int part = 0; part < body.count; ++part) {
    if (body.parts[part].kind == Kind::circle) {
      cast_circle(body, part, object);
    } else {
      cast_edges(body, part, object);
    }
  }
}

void Fan::record(int i, double range, const Footprint& body, int part, Vec2 outward, int object) {
  if (!(range > kNearest && range < buffers_.range[i])) return;
  if (body.count > 1) {  // only the boundary of the union of the parts counts
    const Vec2 at = origin_ + Vec2{buffers_.dx[i], buffers_.dy[i]} * range;
    if (covered(body, part, at + outward * (kOutside * (body.radius + norm(at))))) return;
  }
  buffers_.range[i] = range;
  buffers_.hit[i] = object;
}

void Fan::cast_circle(const Footprint& body, int part, int object) {
  const Vec2 centre = body.vertices[body.parts[part].first] - origin_;
  const double radius = body.parts[part].radius, distance = norm(centre);
  const auto test = [&](int i) {
    const Vec2 beam{buffers_.dx[i], buffers_.dy[i]};
    const double ahead = dot(centre, beam), aside = cross(centre, beam);
    const double half2 = radius * radius - aside * aside;
    if (!(half2 >= 0.0)) return;
    const double half = std::sqrt(half2);
    for (const double range : {ahead - half, ahead + half}) {
      if (range < kNearest || range >= buffers_.range[i]) continue;
      record(i, range, body, part, (beam * range - centre) * (1.0 / std::max(radius, 1e-300)), object);
    }
  };
  if (!(distance > radius * (1.0 + 1e-6))) {
    for (int i = 0; i < count_; ++i) test(i);
    return;
  }
  const double middle = beam_of(centre), half = std::asin(radius / distance) * per_radian_;
  between(middle - half, middle + half, test);
}

void Fan::test(int i, const Edge& edge) {
  const Vec2 beam{buffers_.dx[i], buffers_.dy[i]};
  const double den = cross(beam, edge.along);
  double range;
  if (den != 0.0) {
    const double inverse = 1.0 / den;
    const double at = cross(edge.a, beam) * inverse;
    if (!(at >= 0.0 && at <= 1.0)) return;
    range = edge.area * inverse;
  } else {
    if (edge.area != 0.0) return;
    // the beam runs along the edge: the nearest end ahead
    const double a = dot(edge.a, beam), b = dot(edge.b, beam);
    const double near = std::min(a, b);
    range = near > kNearest ? near : std::max(a, b);
  }
  if (!(range > kNearest && range < buffers_.range[i])) return;
  Vec2 outward;
  if (edge.body.count > 1) {
    const double length = norm(edge.along);
    const double turn = edge.body.parts[edge.part].turn;
    if (length > 0.0) outward = Vec2{edge.along.y, -edge.along.x} * (turn / length);
  }
  record(i, range, edge.body, edge.part, outward, edge.object);
}

void Fan::cast_edges(const Footprint& body, int part, int object) {
  const Part& p = body.parts[part];
  const Vec2* vertices = body.vertices + p.first;
  const int edges = p.last - p.first;
  const double half_turn = 0.5 * turn_, unsure = 1e-3 * per_radian_;
  Vec2 a = vertices[0] - origin_;
  double a_beam = beam_of(a);
  for (int k = 0; k < edges; ++k) {
    const Vec2 b = vertices[k + 1] - origin_;
    const double b_beam = beam_of(b);
    const Edge edge{body, part, object, a, b, b - a, cross(a, b - a)};
    double low = std::min(a_beam, b_beam), high = std::max(a_beam, b_beam);
    const double width = high - low;
    if (std::fabs(width - half_turn) <= unsure) {
      high = low + turn_;  // passes so near the origin that either side may be the right one: all beams
    } else if (width > half_turn) {
      std::swap(low, high);
      high += turn_;
    }
    between(low, high, [&](int i) { test(i, edge); });
    a = b, a_beam = b_beam;
  }
}

}  // namespace irsim

#include "sensing/raycast.hpp"

#include "geometry/predicates.hpp"
#include "maps/walk.hpp"

namespace irsim {
namespace {

constexpr double kMinRange = 1e-9;      // closer hits do not count [m]
constexpr double kSlack = 1e-12;        // edges are extended by this share, so that no beam slips through a corner
constexpr double kBearingError = 1e-4;  // bound on the error of `bearing` [rad]
constexpr double kNarrow = 2.8,
                 kBlur = 0.1;      // angle of a narrow fan, and error of its beams, that leave half a turn [rad]
constexpr double kOutside = 1e-9;  // offset from an edge to a point just outside it, relative to the coordinates

/// atan2 with an error of at most kBearingError: an odd polynomial fitted to atan on [0, 1], unfolded to the octants.
inline double bearing(Vec2 v) {
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

/// An edge from a to b, both relative to the origin of the fan.
struct Fan::Edge {
  const Footprint& body;
  int part, object;
  Vec2 a, b, along;
  double area;  // a x along; 0 if the origin is on the line
};

Fan::Fan(BeamBuffers& buffers, Vec2 origin, Vec2 heading, const Mount& mount, double reach)
    : buffers_(buffers), origin_(origin), heading_(heading), count_(mount.count), reach_(reach) {
  const auto n = static_cast<std::size_t>(count_);
  for (auto* list : {&buffers.dx, &buffers.dy, &buffers.range}) list->resize(std::max(list->size(), n));
  buffers.hit.resize(std::max(buffers.hit.size(), n));
  buffers.bodies.clear();
  std::fill_n(buffers.range.begin(), n, std::nextafter(reach, kInfinity));
  std::fill_n(buffers.hit.begin(), n, -1);
  const double spacing = count_ > 1 ? mount.angle[1] - mount.angle[0] : 0.0;
  ordered_ = spacing > 1e-7;
  first_ = count_ > 0 ? mount.angle[0] : 0.0;
  per_radian_ = ordered_ ? 1.0 / spacing : 0.0;
  turn_ = kTurn * per_radian_;
  widen(0.0);
  narrow_ = ordered_ && spacing * (count_ - 1) < kNarrow;
  if (narrow_) {
    const Vec2 first = rotate({mount.cosine[0], mount.sine[0]}, heading);
    const Vec2 last = rotate({mount.cosine[n - 1], mount.sine[n - 1]}, heading);
    before_ = {first.y, -first.x}, after_ = {-last.y, last.x};
  }
}

void Fan::widen(double error) { blur_ = std::max(blur_, (kBearingError + std::fabs(error)) * per_radian_); }

inline double Fan::beam_of(Vec2 from_origin) const {
  return (bearing(unrotate(from_origin, heading_)) - first_) * per_radian_;
}

template <class Test>
inline void Fan::between(double low, double high, Test&& test) const {
  low -= blur_, high += blur_;
  const auto run = [&](double from, double to) {
    from = std::max(from, 0.0), to = std::min(to, count_ - 1.0);
    int i = static_cast<int>(from);
    if (i < from) ++i;
    for (; i <= to; ++i) test(i);
  };
  if (!ordered_ || !(high - low < turn_)) return run(0.0, count_);
  run(low, high);
  if (high >= turn_) run(low - turn_, high - turn_);  // the beams may extend across the rear
  if (low + turn_ < count_) run(low + turn_, high + turn_);
}

/// Whether a disc lies beside a narrow fan. If this is not certain it is false.
inline bool Fan::aside(Vec2 from_origin, double radius) const {
  const double blur = blur_ / per_radian_, far = std::fabs(from_origin.x) + std::fabs(from_origin.y);
  if (blur > kBlur) return false;
  return std::max(dot(from_origin, before_), dot(from_origin, after_)) >
         radius * (1.0 + 1e-9) + far * blur * (1.0 + blur) + 1e-9;
}

void Fan::consider(int object, Vec2 centre, double radius) {
  const Vec2 d = centre - origin_;
  const double distance2 = squared(d), reach = reach_ + radius;
  if (!(distance2 <= reach * reach && distance2 < kInfinity)) return;
  if (narrow_ && aside(d, radius)) return;
  const double distance = std::sqrt(distance2);
  const double edge = distance - radius * (1.0 + 1e-9) - 1e-9;  // lower bound of the distance to the body
  BeamBuffers::Body body{edge, 0.0, turn_, object};
  if (edge > 0.0 && ordered_) {
    const double middle = beam_of(d), half = 0.5 * kPi * (radius / distance) * per_radian_;  // asin x <= x pi / 2
    body.low = middle - half, body.high = middle + half;
    bool seen = false;
    between(body.low, body.high, [&](int) { seen = true; });
    if (!seen) return;
  }
  buffers_.bodies.push_back(body);
}

void Fan::sort_by_distance() {
  constexpr int kRings = 32;
  std::vector<BeamBuffers::Body>&from = buffers_.bodies, &to = buffers_.sorted;
  if (from.size() < 8) return;
  std::uint32_t start[kRings + 1] = {};
  const double per_ring = kRings / std::max(reach_, 1e-300);
  const auto ring = [&](const BeamBuffers::Body& body) {
    return static_cast<int>(clip(body.distance * per_ring, 0.0, kRings - 1.0));
  };
  for (const auto& body : from) ++start[ring(body) + 1];
  for (int r = 0; r < kRings; ++r) start[r + 1] += start[r];
  to.resize(from.size());
  for (const auto& body : from) to[start[ring(body)]++] = body;
  std::swap(from, to);
}

bool Fan::hidden(const BeamBuffers::Body& body) const {
  bool open = !(body.distance > 0.0);
  if (!open) between(body.low, body.high, [&](int i) { open = open || !(buffers_.range[i] < body.distance); });
  return !open;
}

inline bool Fan::nearer(int i, double range, int object) const {
  return range < buffers_.range[i] || (range == buffers_.range[i] && object < buffers_.hit[i]);
}

void Fan::cast_body(const Footprint& body, int object) {
  for (int part = 0; part < body.count; ++part) {
    const Part& p = body.parts[part];
    if (p.kind == Kind::circle) {
      cast_circle(body, part, object);
    } else if (p.cells != nullptr) {
      cast_cells(*p.cells, object);
    } else {
      cast_edges(body, part, object);
    }
  }
}

/// Whether a hit on a part of a compound is on the boundary of the union of the parts.
bool Fan::on_union(int i, double range, const Footprint& body, int part, Vec2 outward) const {
  const Vec2 at = origin_ + Vec2{buffers_.dx[i], buffers_.dy[i]} * range;
  return !covered(body, part, at + outward * (kOutside * (body.radius + norm(at))));
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
      if (!(range > kMinRange) || !nearer(i, range, object)) continue;
      const Vec2 outward = (beam * range - centre) * (1.0 / std::max(radius, 1e-300));
      if (body.count > 1 && !on_union(i, range, body, part, outward)) continue;
      buffers_.range[i] = range;
      buffers_.hit[i] = object;
      return;
    }
  };
  if (!(distance > radius * (1.0 + 1e-6))) return between(0.0, turn_, test);
  const double middle = beam_of(centre), half = std::asin(radius / distance) * per_radian_;
  between(middle - half, middle + half, test);
}

void Fan::cast_cells(const OccupancyGrid& grid, int object) {
  const CellWalk walk(grid, origin_);
  for (int i = 0; i < count_; ++i) {
    const double range = walk.hit({buffers_.dx[i], buffers_.dy[i]}, kMinRange, buffers_.range[i]);
    if (!nearer(i, range, object)) continue;
    buffers_.range[i] = range;
    buffers_.hit[i] = object;
  }
}

inline void Fan::test(int i, const Edge& edge) {
  const Vec2 beam{buffers_.dx[i], buffers_.dy[i]};
  const double den = cross(beam, edge.along);
  double range;
  if (den != 0.0) {
    const double inverse = 1.0 / den;
    const double at = cross(edge.a, beam) * inverse;
    if (!(at >= -kSlack && at <= 1.0 + kSlack)) return;
    range = edge.area * inverse;
  } else {
    if (edge.area != 0.0) return;
    const double a = dot(edge.a, beam), b = dot(edge.b, beam);  // a beam along the edge hits the nearest end ahead
    range = std::min(a, b) > kMinRange ? std::min(a, b) : std::max(a, b);
  }
  if (!(range > kMinRange) || !nearer(i, range, edge.object)) return;
  if (edge.body.count > 1) {
    const double length = norm(edge.along), turn = edge.body.parts[edge.part].turn;
    const Vec2 outward = length > 0.0 ? Vec2{edge.along.y, -edge.along.x} * (turn / length) : Vec2{};
    if (!on_union(i, range, edge.body, edge.part, outward)) return;
  }
  buffers_.range[i] = range;
  buffers_.hit[i] = edge.object;
}

void Fan::cast_edges(const Footprint& body, int part, int object) {
  const Part& p = body.parts[part];
  const Vec2* vertices = body.vertices + p.first;
  const int edges = p.last - p.first;
  const double half_turn = 0.5 * turn_, unsure = 4.0 * kBearingError * per_radian_;
  // From outside, edges that face away are hidden, except from beams that pass their ends.
  const bool outside = body.count == 1 && squared(body.centre - origin_) > body.radius * body.radius * (1.0 + 1e-6);
  const double facing_away = outside ? p.turn : 0.0;
  Vec2 a = vertices[0] - origin_;
  double a_beam = beam_of(a);
  for (int k = 0; k < edges; ++k) {
    const Vec2 b = vertices[k + 1] - origin_;
    const double b_beam = beam_of(b);
    const Edge edge{body, part, object, a, b, b - a, cross(a, b - a)};
    const auto test_edge = [&](int i) { test(i, edge); };
    double low = std::min(a_beam, b_beam), high = std::max(a_beam, b_beam);
    const double width = high - low;
    a = b, a_beam = b_beam;
    if (std::fabs(width - half_turn) <= unsure) {
      high = low + turn_;  // The edge passes so near the origin that its side is uncertain, so all beams are tested.
    } else if (width > half_turn) {
      std::swap(low, high);
      high += turn_;
    }
    if (edge.area * facing_away > 0.0) {
      between(low, low, test_edge);
      between(high, high, test_edge);
    } else {
      between(low, high, test_edge);
    }
  }
}

}  // namespace irsim

#include "collision/swept.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kTouching = 1e-9;  // pieces that are this near touch [m]
constexpr int kMaxSearches = 20000;
constexpr double kGrain = 1e-6;  // slack of boxes and circles, far above rounding errors [m]

/// One of two faces during the search.
struct Body {
  const Stride& stride;
  const Vec2* vertices;  // body frame
  int count;
  double radius;
  double acceleration;  // largest of a vertex [m per step^2]
  Vec2* placed;         // its vertices at the present time
  Vec2 origin, velocity;

  void place(double time) {
    const Pose pose = stride.at(time);
    const Vec2 heading = unit(pose.theta);
    origin = pose.position();
    velocity = stride.velocity(time);
    for (int k = 0; k < count; ++k) placed[k] = origin + rotate(vertices[k], heading);
  }
  /// Velocity of a vertex along a direction [m per step].
  double speed(int k, Vec2 along) const {
    const Vec2 arm = placed[k] - origin;
    return dot(velocity + Vec2{-arm.y, arm.x} * stride.turn, along);
  }
  /// How far the vertices reach along a direction after a time if they keep their velocities [m].
  double reach(Vec2 along, double after) const {
    double most = -kInfinity;
    for (int k = 0; k < count; ++k) most = std::max(most, dot(placed[k], along) + speed(k, along) * after);
    return most;
  }
};

struct NearestPair {
  Vec2 from, to;
  double squared = kInfinity;
  void offer(Vec2 p, Vec2 q) {
    const double d = irsim::squared(q - p);
    if (d < squared) squared = d, from = p, to = q;
  }
};

/// The nearest points of two convex pieces that do not overlap.
NearestPair nearest_points_of(const Body& a, const Body& b) {
  NearestPair best;
  const int edges_a = a.count > 2 ? a.count : a.count - 1, edges_b = b.count > 2 ? b.count : b.count - 1;
  if (edges_a == 0 && edges_b == 0) best.offer(a.placed[0], b.placed[0]);
  for (int k = 0; k < edges_a; ++k) {
    const Vec2 p = a.placed[k], q = a.placed[k + 1 == a.count ? 0 : k + 1];
    for (int m = 0; m < b.count; ++m) best.offer(nearest_on_segment(p, q, b.placed[m]), b.placed[m]);
  }
  for (int m = 0; m < edges_b; ++m) {
    const Vec2 p = b.placed[m], q = b.placed[m + 1 == b.count ? 0 : m + 1];
    for (int k = 0; k < a.count; ++k) best.offer(a.placed[k], nearest_on_segment(p, q, a.placed[k]));
  }
  return best;
}

/// Lower bound of the gap between two pieces along a direction after a time, a concave function of it.
double gap_after(const Body& a, const Body& b, Vec2 along, double after) {
  const double bend = 0.5 * (a.acceleration + b.acceleration) * after * after;
  return -b.reach(along * -1.0, after) - a.reach(along, after) - a.radius - b.radius - bend;
}

/// A time up to which the gap along a direction certainly stays open, at most `left`.
double open_until(const Body& a, const Body& b, Vec2 along, double left) {
  double low = 0.0, high = left, at_low = gap_after(a, b, along, 0.0), at_high = gap_after(a, b, along, left);
  if (!(at_low > 0.0)) return 0.0;
  if (at_high > 0.0) return left;
  for (int round = 0; round < 8; ++round) {
    // A concave function lies above its secant, but for rounding errors.
    low += (high - low) * (at_low / (at_low - at_high));
    at_low = gap_after(a, b, along, low);
    if (!(at_low > kTouching)) break;
    const double middle = 0.5 * (low + high), at_middle = gap_after(a, b, along, middle);
    if (at_middle > 0.0) {
      low = middle, at_low = at_middle;
    } else {
      high = middle, at_high = at_middle;
    }
  }
  return low;
}

double first_contact_of(Body a, Body b, double begin, double end, Vec2& where) {
  double time = begin;
  for (int search = 0; search < kMaxSearches; ++search) {
    a.place(time), b.place(time);
    const NearestPair near = nearest_points_of(a, b);
    const double length = std::sqrt(near.squared), gap = length - a.radius - b.radius;
    const Vec2 along = length > 0.0 ? (near.to - near.from) * (1.0 / length) : Vec2{1.0, 0.0};
    if (gap <= kTouching) {
      where = near.from + along * (a.radius + 0.5 * gap);
      return time;
    }
    const double open = open_until(a, b, along, end - time);
    if (open >= end - time) return kInfinity;
    where = near.from;
    if (!(time + open > time)) return time;  // they overlap, or a rounding error decides
    time += open;
  }
  return time;
}

double arm_of(const Vec2* vertices, int count) {
  double most = 0.0;
  for (int k = 0; k < count; ++k) most = std::max(most, squared(vertices[k]));
  return std::sqrt(most);
}

/// The box round the motion of some vertices with a radius.
Box box_of(const Stride& stride, const Vec2* vertices, int count, double radius, double arm) {
  Box box;
  for (const double time : {0.0, 1.0}) {
    const Pose pose = stride.at(time);
    const Vec2 heading = unit(pose.theta);
    for (int k = 0; k < count; ++k) box.include(pose.position() + rotate(vertices[k], heading));
    if (stride.rests()) break;
  }
  return grown(box, radius + stride.bulge(arm) + kGrain);
}

bool is_convex_ring(const Vec2* ring, int edges) {
  double sign = 0.0;
  for (int k = 0; k < edges; ++k) {
    const double turn = turn_of(ring[k], ring[k + 1], ring[k + 1 == edges ? 1 : k + 2]);
    if (turn == 0.0) continue;
    if (sign * turn < 0.0) return false;
    sign = turn;
  }
  return true;
}

class FaceFinder {
 public:
  FaceFinder(const Moving& body, const Box& area, std::vector<Vec2>& points, std::vector<SweptFace>& out)
      : body_(body), area_(area), points_(points), out_(out) {}

  void add_all() {
    for (int p = 0; p < body_.count; ++p) {
      if (body_.parts[p].kind == Kind::cells) {
        add_cells(*body_.parts[p].cells);
      } else {
        add_part(body_.parts[p]);
      }
    }
  }

 private:
  void add(const Vec2* vertices, int count, double radius) {
    const double arm = arm_of(vertices, count);
    const Box box = box_of(body_.stride, vertices, count, radius, arm);
    if (!box.meets(area_)) return;
    out_.push_back({static_cast<int>(points_.size()), count, radius, arm, box});
    points_.insert(points_.end(), vertices, vertices + count);
  }
  void add_part(const Part& part) {
    const Vec2* first = body_.vertices + part.first;
    const int edges = part.last - part.first;
    if (part.kind == Kind::circle) return add(first, 1, part.radius);
    if (part.kind == Kind::polygon && is_convex_ring(first, edges)) return add(first, edges, 0.0);
    for (int k = 0; k < edges; ++k) add(first + k, 2, 0.0);
  }
  /// Occupied cells side by side in a row are one rectangle.
  void add_cells(const OccupancyGrid& grid) {
    int from = 0, to = -2, row = -1;
    const auto close = [&] {
      if (to < from) return;
      const Vec2 low = grid.corner(from, row), high = grid.corner(to + 1, row + 1);
      const Vec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
      add(corners, 4, 0.0);
    };
    grid.any_in(area_, [&](int i, int j) {
      if (j != row || i != to + 1) close(), from = i, row = j;
      to = i;
      return false;
    });
    close();
  }

  const Moving& body_;
  const Box& area_;
  std::vector<Vec2>& points_;
  std::vector<SweptFace>& out_;
};

/// The box round the motion of the bounding circle of a body.
Box box_of(const Moving& body) { return box_of(body.stride, &body.centre, 1, body.radius, norm(body.centre)); }

}  // namespace

double first_contact(const Moving& a, const Moving& b, double begin, double end, SweptBuffers& buffers, Vec2& where) {
  buffers.points.clear(), buffers.faces_a.clear(), buffers.faces_b.clear();
  FaceFinder(a, box_of(b), buffers.points, buffers.faces_a).add_all();
  if (buffers.faces_a.empty()) return kInfinity;
  FaceFinder(b, box_of(a), buffers.points, buffers.faces_b).add_all();
  double first = kInfinity;
  for (const SweptFace& p : buffers.faces_a) {
    if (buffers.a.size() < static_cast<std::size_t>(p.count)) buffers.a.resize(p.count);
    for (const SweptFace& q : buffers.faces_b) {
      if (!p.box.meets(q.box)) continue;
      if (buffers.b.size() < static_cast<std::size_t>(q.count)) buffers.b.resize(q.count);
      const Body one{
          a.stride, &buffers.points[p.first], p.count, p.radius, a.stride.acceleration(p.arm), buffers.a.data(), {},
          {}};
      const Body other{
          b.stride, &buffers.points[q.first], q.count, q.radius, b.stride.acceleration(q.arm), buffers.b.data(), {},
          {}};
      Vec2 place;
      const double time = first_contact_of(one, other, begin, std::min(end, first), place);
      if (time < first) first = time, where = place;
    }
  }
  return first;
}

}  // namespace irsim

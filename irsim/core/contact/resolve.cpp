// How two bodies overlap, and how far each gives way.
#include <algorithm>

#include "contact/solver.hpp"

namespace irsim {
namespace {

constexpr double kContactGap = 1e-5;      // a smaller gap counts as contact [m]
constexpr double kMinArm = 1e-6;          // a push that passes the centroid this closely does not turn the body [m]
constexpr double kMinCorrection = 1e-12;  // smaller corrections do not count as a motion [m]

const Vec2 kBoxNormals[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};

int cell_of(double offset, double size, int count) {
  return static_cast<int>(clip(std::floor(offset / size), -2.0, count + 2.0));
}

}  // namespace

Placed ContactSolver::piece(int p) const {
  const Convex& c = bodies_.pieces[p];
  return {&buffers_.vertices[c.first], &buffers_.normals[c.first], c.count, c.radius};
}

const Overlap& ContactSolver::find_overlap(Buffers::Pair& pair) {
  const Buffers::Body &a = buffers_.bodies[pair.a], &b = buffers_.bodies[pair.b];
  pair.known = true;
  pair.a_moves = a.moves, pair.b_moves = b.moves;
  pair.overlap = {};
  const auto near = [](const Box& p, const Box& q) {
    return p.x0 - kContactGap <= q.x1 && q.x0 <= p.x1 + kContactGap && p.y0 - kContactGap <= q.y1 &&
           q.y0 <= p.y1 + kContactGap;
  };
  if (!near(a.box, b.box)) return pair.overlap;
  if (bodies_.cells[pair.a] != nullptr) {
    pair.overlap = overlap_with_cells(pair.b, *bodies_.cells[pair.a]);
    pair.overlap.normal = pair.overlap.normal * -1.0;
    return pair.overlap;
  }
  if (bodies_.cells[pair.b] != nullptr) return pair.overlap = overlap_with_cells(pair.a, *bodies_.cells[pair.b]);
  for (int p = bodies_.begin[pair.a]; p < bodies_.begin[pair.a + 1]; ++p) {
    if (!near(buffers_.boxes[p], b.box)) continue;
    for (int q = bodies_.begin[pair.b]; q < bodies_.begin[pair.b + 1]; ++q) {
      if (!near(buffers_.boxes[p], buffers_.boxes[q])) continue;
      const Overlap found = overlap_of(piece(p), piece(q), kContactGap);
      if (found.depth > pair.overlap.depth) pair.overlap = found;
    }
  }
  return pair.overlap;
}

Overlap ContactSolver::overlap_at(int a, int b, const Pose& at_a, const Pose& at_b) {
  const auto put = [&](int object, const Pose& at) {
    const Pose now = std::exchange(state_.pose[first_ + object], at);
    place(object);
    state_.pose[first_ + object] = now;
  };
  put(a, at_a), put(b, at_b);
  Buffers::Pair pair{a, b, 0, 0, 0, false, {}, -1, 0.0, false, false};
  return overlap(pair);
}

Overlap ContactSolver::overlap_with_cells(int object, const OccupancyGrid& grid) const {
  Overlap deepest;
  for (int p = bodies_.begin[object]; p < bodies_.begin[object + 1]; ++p) {
    const Box& box = buffers_.boxes[p];
    const auto column = [&](double x) { return cell_of(x - grid.origin().x, grid.cell().x, grid.columns()); };
    const auto row = [&](double y) { return cell_of(y - grid.origin().y, grid.cell().y, grid.rows()); };
    const int i0 = std::max(0, column(box.x0 - kContactGap) - 1);
    const int i1 = std::min(grid.columns() - 1, column(box.x1 + kContactGap) + 1);
    const int j0 = std::max(0, row(box.y0 - kContactGap)), j1 = std::min(grid.rows() - 1, row(box.y1 + kContactGap));
    for (int j = j0; j <= j1; ++j) {
      for (int first = grid.next_occupied(j, i0, i1); first >= 0;) {
        int last = first;
        while (last < i1 && grid.occupied(last + 1, j)) ++last;
        const Vec2 low = grid.corner(first, j), high = grid.corner(last + 1, j + 1);
        const Vec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
        const Overlap found = overlap_of(piece(p), {corners, kBoxNormals, 4, 0.0}, kContactGap);
        if (found.depth > deepest.depth) deepest = found;
        first = last + 2 <= i1 ? grid.next_occupied(j, last + 2, i1) : -1;
      }
    }
  }
  return deepest;
}

ContactSolver::Share ContactSolver::share_of(int object, Vec2 direction, Vec2 point) const {
  const double w = bodies_.inverse_mass[object];
  if (w == 0.0) return {};
  const Buffers::Body& body = buffers_.bodies[object];
  Vec2 free = direction;
  double into = -1e-9;
  // Only the block that opposes the motion most counts here; the next sweep takes care of the others.
  for (const Buffers::Block& block : buffers_.blocks[object]) {
    const double against = dot(direction, block.normal);
    if (!(against < into)) continue;
    into = against;
    const Vec2 along = direction - block.normal * into;
    const bool sticks = body.passive && norm(along) <= -into * block.friction;
    free = sticks ? Vec2{} : along;
  }
  if (stalling_) {
    for (const Buffers::Block& block : buffers_.blocks[object]) {
      if (dot(free, block.normal) < -1e-9) free = {};
    }
  }
  const double gain = std::max(0.0, dot(free, direction));
  double arm = cross(point - body.centroid, direction);
  if (std::fabs(arm) < kMinArm) arm = 0.0;
  const double i = bodies_.inverse_inertia[object];
  return {free * w, gain * w, i * arm, i * arm * arm};
}

double ContactSolver::pushed_friction(int body, Vec2 direction) {
  buffers_.reached.assign(world_.objects, 0);
  buffers_.reached[body] = 1;
  buffers_.queue.assign(1, body);
  double sum = 0.0;
  for (std::size_t head = 0; head < buffers_.queue.size(); ++head) {
    const int i = buffers_.queue[head];
    sum += ground_friction(world_, i);
    for (int k = buffers_.first_link[i]; k < buffers_.first_link[i + 1]; ++k) {
      Buffers::Pair& p = buffers_.pairs[buffers_.links[k]];
      const int j = p.a == i ? p.b : p.a;
      if (buffers_.reached[j] || !buffers_.bodies[j].passive) continue;
      const Overlap& o = overlap(p);
      if (!(o.depth > -kContactGap)) continue;
      if (!(dot(p.a == i ? o.normal * -1.0 : o.normal, direction) > 1e-6)) continue;
      buffers_.reached[j] = 1;
      buffers_.queue.push_back(j);
    }
  }
  return sum;
}

bool ContactSolver::resolve(Buffers::Pair& pair) {
  const Overlap o = overlap(pair);
  if (!(o.depth > -kContactGap)) return false;
  const int a = pair.a, b = pair.b;
  Share to_a = share_of(a, o.normal, o.point), to_b = share_of(b, o.normal * -1.0, o.point);
  if (buffers_.bodies[a].driven && buffers_.bodies[b].passive) decide_who_yields(a, to_a, b, to_b, o.normal * -1.0);
  if (buffers_.bodies[b].driven && buffers_.bodies[a].passive) decide_who_yields(b, to_b, a, to_a, o.normal);
  pair.a_yields = to_a.total() > 0.0, pair.b_yields = to_b.total() > 0.0;
  const double depth = o.depth + options_.slop, total = to_a.total() + to_b.total();
  record_contact(pair, o, depth);
  bool moved = false;
  if (depth > 0.0 && total > 0.0) {
    const double scale = depth / total;
    pair.scale += scale;
    if (pair.a_yields) displace(a, to_a.direction * scale, to_a.turn * scale);
    if (pair.b_yields) displace(b, to_b.direction * scale, to_b.turn * scale);
    moved = depth > kMinCorrection;
  }
  const double friction = 0.5 * (world_.dynamics[a].friction + world_.dynamics[b].friction);
  // A body that can only turn blocks the other one, too.
  if (!(to_b.translation > 0.0) && bodies_.inverse_mass[a] > 0.0) add_block(a, o.normal, friction);
  if (!(to_a.translation > 0.0) && bodies_.inverse_mass[b] > 0.0) add_block(b, o.normal * -1.0, friction);
  return moved;
}

void ContactSolver::add_block(int object, Vec2 normal, double friction) {
  if (buffers_.blocks[object].empty()) buffers_.blocked.push_back(object);
  buffers_.blocks[object].push_back({normal, friction});
}

void ContactSolver::decide_who_yields(int driver, Share& to_driver, int body, Share& to_body, Vec2 push) {
  if (stalling_ || ground_friction(world_, driver) < pushed_friction(body, push)) {
    to_body = {};
  } else if (to_body.translation > 1e-9 * bodies_.inverse_mass[body]) {
    to_driver = {};
  }
}

void ContactSolver::displace(int object, Vec2 by, double turn) {
  shift(world_, state_, first_ + object, by, turn, bodies_.centroid[object]);
  Buffers::Body& body = buffers_.bodies[object];
  body.moved = body.moved + by;
  body.turned += turn;
  ++body.moves;
  place(object);
}

}  // namespace irsim

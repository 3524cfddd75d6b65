#include "rvo/velocity_obstacles.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kMinTime = 1e-4;           // smallest time to a collision in the penalty [s]
constexpr double kMinRelativeSpeed = 1e-7;  // added to relative speeds [m/s]
constexpr double kLeastShare = 0.125;       // of the distance within which walls are passed, before the last resort
constexpr double kLeastProgress = 0.01;     // share of the desired velocity that leads past walls
constexpr double kParallelSpeed = 1e-9;     // slower approaches count as parallel motion [m/s]

/// The best sample so far: the one of smallest cost, then the first in order.
struct Best {
  double cost = kInfinity;
  int i = -1, j = -1;

  void offer(double c, int column, int row) {
    if (c < cost || (c == cost && (column < i || (column == i && row < j)))) cost = c, i = column, j = row;
  }
};

/// Call `visit(i, distance2)` for the columns (or rows) of an axis in order of their distance from `v`, while
/// `is_within(distance2)` holds.
template <class Within, class Visit>
void outwards(const Axis& axis, double v, Within&& is_within, Visit&& visit) {
  int left = axis.nearest(v), right = left + 1;
  const auto distance2 = [&](int i) {
    if (i < 0 || i >= axis.count) return kInfinity;
    const double d = axis.at(i) - v;
    return d * d;
  };
  double dl = distance2(left), dr = distance2(right);
  while (true) {
    const bool go_left = dl <= dr;
    const double d = go_left ? dl : dr;
    if (d == kInfinity || !is_within(d)) return;
    if (go_left) {
      visit(left, d);
      dl = distance2(--left);
    } else {
      visit(right, d);
      dr = distance2(++right);
    }
  }
}

/// Shrink rows [low, high] to those where `holds(row)` is true: all rows above `edge` if `above`, else all below it.
/// The edge, in rows, is subject to rounding errors.
template <class Holds>
void narrow_rows(double edge, bool above, int count, int& low, int& high, Holds&& holds) {
  if (above) {
    int j = static_cast<int>(clip(std::ceil(edge), 0.0, count));
    while (j > 0 && holds(j - 1)) --j;
    while (j < count && !holds(j)) ++j;
    low = std::max(low, j);
  } else {
    int j = static_cast<int>(clip(std::floor(edge), -1.0, count - 1.0));
    while (j < count - 1 && holds(j + 1)) ++j;
    while (j >= 0 && !holds(j)) --j;
    high = std::min(high, j);
  }
}

/// Rows low to high of a column, both included.
struct RowRange {
  int low, high;
};

/// The rows of the column at x that a cone blocks.
RowRange blocked_rows(const Cone& cone, double x, const Axis& y) {
  int low = 0, high = y.count - 1;
  const double across = x - cone.apex.x, inverse = 1.0 / y.spacing;
  const auto row_of = [&](Vec2 edge) { return (cone.apex.y + edge.y * across / edge.x - y.first) * inverse; };
  if (cone.left.x != 0.0) {
    narrow_rows(row_of(cone.left), cone.left.x < 0.0, y.count, low, high,
                [&](int j) { return cone.under_left({x, y.at(j)}); });
  } else if (!cone.under_left({x, y.first})) {
    return {0, -1};
  }
  if (low > high) return {0, -1};
  if (cone.right.x != 0.0) {
    narrow_rows(row_of(cone.right), cone.right.x > 0.0, y.count, low, high,
                [&](int j) { return cone.over_right({x, y.at(j)}); });
  } else if (!cone.over_right({x, y.first})) {
    return {0, -1};
  }
  return {low, high};
}

/// The first row of the column at x, from j in direction `step`, that no cone blocks; a row outside the column if all
/// are blocked. Cones that block move to the front, because they are likely to block the next column, too.
int next_free(std::vector<Cone>& cones, double x, const Axis& y, int j, int step) {
  while (j >= 0 && j < y.count) {
    const Vec2 w{x, y.at(j)};
    std::size_t k = 0;
    while (k < cones.size() && !cones[k].blocks(w)) ++k;
    if (k == cones.size()) return j;
    const RowRange rows = blocked_rows(cones[k], x, y);
    j = step > 0 ? rows.high + 1 : rows.low - 1;
    if (k > 0) std::swap(cones[k], cones[k / 2]);
  }
  return j;
}

/// The free sample nearest to `desired`; none if `Best::i` is negative. `cones` change their order.
Best nearest_free_sample(const VelocityObstacles& o, std::vector<Cone>& cones, const Axis& x, const Axis& y,
                         Vec2 desired) {
  Best best;
  const int middle = y.nearest(desired.y);
  const auto column = [&](int i, double dx2) {
    const double at = x.at(i);
    for (const int step : {1, -1}) {
      for (int j = step > 0 ? middle : middle - 1;; j += step) {
        j = next_free(cones, at, y, j, step);
        if (j < 0 || j >= y.count) break;
        const double dy = y.at(j) - desired.y, cost = dx2 + dy * dy;
        if (cost > best.cost) break;
        if (o.walled({at, y.at(j)})) continue;
        best.offer(cost, i, j);
        break;
      }
    }
  };
  outwards(x, desired.x, [&](double d) { return d <= best.cost; }, column);
  return best;
}

/// The free sample nearest to `desired` if walls that can be passed block the directions that meet them within `share`
/// of their `look`. A ring whose hull is within this distance blocks all directions between its tangents.
Best way_past_walls(VelocityObstacles& o, double share, const Axis& x, const Axis& y, Vec2 desired) {
  o.look_share = share;
  o.ways = o.cones;
  for (const Front& front : o.walls.fronts) {
    if (front.last > front.first && !front.everywhere && front.farthest < front.look * share)
      o.ways.push_back({{}, front.tangents.left, front.tangents.right});
  }
  return nearest_free_sample(o, o.ways, x, y, desired);
}

/// The inverse of the time to the first collision at velocity w [1/s].
double urgency(const VelocityObstacles& o, Vec2 w, bool walls) {
  double most = 0.0, urgent = 0.0;
  const Approach* first = nullptr;
  for (const Approach& other : o.approaches) {
    if (other.gap == 0.0) {
      urgent = 1.0 / kMinTime;
      continue;
    }
    const double speed2 = squared(w * 2.0 - other.sum) * other.inverse2;
    if (speed2 >= most) most = speed2, first = &other;
  }
  if (first != nullptr) urgent = std::max(urgent, (norm(w * 2.0 - first->sum) + kMinRelativeSpeed) / first->gap);
  for (const Stretch& line : o.stretches) {
    const double t = line.time(w);
    urgent = std::max(urgent, 1.0 / (t == 0.0 ? kMinTime : t));
  }
  if (walls) {
    for (const Barrier& wall : o.walls.barriers) urgent = std::max(urgent, 1.0 / clip(wall.time(w), kMinTime, kNever));
  }
  return urgent;
}

/// A search for the smallest penalty that skips blocks of samples which cannot contain it.
class Penalties {
 public:
  Penalties(const VelocityObstacles& obstacles, const Axis& x, const Axis& y, Vec2 desired, double factor, bool walls)
      : o_(obstacles), x_(x), y_(y), desired_(desired), factor_(factor), walls_(walls) {}

  Best best() {
    const Block all{0, x_.count, 0, y_.count};
    visit(all, least(all));
    return best_;
  }

 private:
  static constexpr int kMaxLeaf = 2;  // blocks of at most this many columns and rows are searched one by one
  struct Block {
    int i0, i1, j0, j1;  // columns i0 .. i1 - 1, rows j0 .. j1 - 1
  };

  /// Lower bound of the cost of all samples of a block, from the distances of both terms to its box.
  double least(const Block& b) const {
    const Vec2 low{x_.at(b.i0), y_.at(b.j0)}, high{x_.at(b.i1 - 1), y_.at(b.j1 - 1)};
    const auto beyond2 = [&](Vec2 p) {
      const double dx = std::max(std::max(low.x - p.x, p.x - high.x), 0.0);
      const double dy = std::max(std::max(low.y - p.y, p.y - high.y), 0.0);
      return dx * dx + dy * dy;
    };
    double urgent = 0.0, most2 = 0.0;
    for (const Approach& other : o_.approaches) {
      if (other.gap == 0.0) {
        urgent = 1.0 / kMinTime;
      } else {
        most2 = std::max(most2, beyond2(other.sum * 0.5) * other.inverse2);
      }
    }
    urgent = std::max(urgent, 2.0 * std::sqrt(most2));
    return (factor_ * urgent + std::sqrt(beyond2(desired_))) * (1.0 - 1e-12);
  }

  void visit(const Block& b, double bound) {
    if (bound > best_.cost) return;
    const int columns = b.i1 - b.i0, rows = b.j1 - b.j0;
    if (columns <= kMaxLeaf && rows <= kMaxLeaf) {
      for (int i = b.i0; i < b.i1; ++i)
        for (int j = b.j0; j < b.j1; ++j) look_at(i, j);
      return;
    }
    Block one = b, two = b;
    if (columns >= rows) {
      one.i1 = two.i0 = b.i0 + columns / 2;
    } else {
      one.j1 = two.j0 = b.j0 + rows / 2;
    }
    const double first = least(one), second = least(two);
    if (first <= second) {
      visit(one, first);
      visit(two, second);
    } else {
      visit(two, second);
      visit(one, first);
    }
  }

  void look_at(int i, int j) {
    const Vec2 w{x_.at(i), y_.at(j)};
    if (!walls_ && o_.walled(w)) return;
    best_.offer(factor_ * urgency(o_, w, walls_) + norm(w - desired_), i, j);
  }

  const VelocityObstacles& o_;
  const Axis &x_, &y_;
  Vec2 desired_;
  double factor_;
  bool walls_;
  Best best_;
};

}  // namespace

double Stretch::time(Vec2 w) const {
  const double offset = cross(along, a);  // positive if the ego is on the right of the line
  const double towards = offset > 0.0 ? cross(along, w) : -cross(along, w);
  if (!(towards > kParallelSpeed)) return kNever;
  const double t = std::max((std::fabs(offset) - radius) / towards, 0.0);
  const double at = dot(w * t - a, along);
  return at >= -radius && at <= length + radius ? t : kNever;
}

Axis Axis::arange(double start, double stop, double spacing) {
  const double count = std::ceil((stop - start) / spacing);
  return {start, (start + spacing) - start, count > 0.0 ? static_cast<int>(std::min(count, 1e6)) : 0};
}

int Axis::nearest(double v) const {
  return static_cast<int>(clip(std::floor((v - first) / spacing + 0.5), 0.0, count - 1.0));
}

void VelocityObstacles::clear() {
  cones.clear();
  approaches.clear();
  stretches.clear();
  walls.clear();
}

Vec2 best_sample(VelocityObstacles& obstacles, const Axis& x, const Axis& y, Vec2 desired, double factor) {
  if (obstacles.walls.passable) {
    for (double share = 1.0; share >= kLeastShare; share *= 0.5) {
      const Best way = way_past_walls(obstacles, share, x, y, desired);
      if (way.i < 0) continue;
      const Vec2 w{x.at(way.i), y.at(way.j)};
      if (dot(w, desired) > kLeastProgress * squared(desired)) return w;
    }
  }
  obstacles.look_share = 0.0;
  Best best = nearest_free_sample(obstacles, obstacles.cones, x, y, desired);
  if (best.i < 0) best = Penalties(obstacles, x, y, desired, factor, false).best();
  if (best.i < 0) best = Penalties(obstacles, x, y, desired, factor, true).best();
  return {x.at(best.i), y.at(best.j)};
}

}  // namespace irsim

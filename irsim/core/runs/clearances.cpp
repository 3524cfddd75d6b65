#include "runs/clearances.hpp"

#include <algorithm>
#include <cmath>

#include "collision/distance.hpp"

namespace irsim {
namespace {

constexpr double kRounding = 1.0 + 1e-12;  // factor that covers rounding errors

/// The nearest object so far.
struct Closest {
  double distance = kInfinity;
  int partner = -1;

  void consider(double away, int object) {
    if (away < distance || (away == distance && object < partner)) distance = away, partner = object;
  }
};

}  // namespace

void clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                const std::vector<int>& robots, const std::vector<ObjectKind>& kinds, double* distance_out,
                std::int32_t* partner_out) {
  Outlines moving;
  moving.resize(shapes.size[0]);
  const auto body = [&](int i) { return (world.is_static[i] ? fixed.outlines : moving).footprint(shapes, i); };
  std::vector<int> movers, standing;  // objects to which distances are measured
  bool stands[kKinds] = {false, false, false};
  for (int i = 0; i < world.objects; ++i) {
    if (kinds[i] == ObjectKind::ignored) continue;
    (world.is_static[i] ? standing : movers).push_back(i);
    if (world.is_static[i]) stands[static_cast<int>(kinds[i])] = true;
  }
  std::vector<Vec2> centres(movers.size());  // centres of the bounding circles of the movers
  std::vector<Closest> before(robots.size() * kKinds);
  for (std::size_t t = 0; t < rows; ++t) {
    const Pose* pose = poses + t * world.objects;
    for (const int i : world.moving) moving.place(shapes, i, pose[i], unit(pose[i].theta));
    for (std::size_t m = 0; m < movers.size(); ++m) centres[m] = moving.centres[shapes.placed[movers[m]].object];
    for (std::size_t r = 0; r < robots.size(); ++r) {
      const int self = robots[r];
      const Footprint own = body(self);
      Closest* last = before.data() + r * kKinds;
      Closest found[kKinds];
      // The nearest object of the row before is a good first guess, since most others are farther away.
      for (int k = 0; k < kKinds; ++k) {
        if (last[k].partner >= 0) found[k].consider(distance(own, body(last[k].partner)), last[k].partner);
      }
      const auto look = [&](int other) {
        const int kind = static_cast<int>(kinds[other]);
        if (other != self && other != last[kind].partner) found[kind].consider(distance(own, body(other)), other);
      };
      for (std::size_t m = 0; m < movers.size(); ++m) {
        // Skip bounding circles farther apart than the nearest distance so far. Overlaps can be deeper than circles
        // show.
        const double touching = own.radius + shapes.radius[movers[m]];
        const double reach = touching + std::max(found[static_cast<int>(kinds[movers[m]])].distance, 0.0);
        if (!(squared(centres[m] - own.centre) > reach * reach * kRounding)) look(movers[m]);
      }
      double reach = 0.0;
      for (int k = 0; k < kKinds; ++k) {
        if (stands[k]) reach = std::max(reach, found[k].distance);
      }
      if (std::isfinite(reach) && own.box.finite()) {
        const Box near{own.box.x0 - reach, own.box.y0 - reach, own.box.x1 + reach, own.box.y1 + reach};
        fixed.grid.query(near, [&](int other) {
          if (kinds[other] != ObjectKind::ignored) look(other);
        });
      } else {
        for (const int other : standing) look(other);
      }
      for (int k = 0; k < kKinds; ++k) {
        last[k] = found[k];
        const bool any = found[k].partner >= 0;
        *distance_out++ = any ? found[k].distance : kNone;
        *partner_out++ = found[k].partner;
      }
    }
  }
}

namespace {

/// Bodies of recorded rows, placed when they are needed, and bounds on how far any point of each has moved by each row.
class Recorded {
 public:
  Recorded(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows)
      : world_(world), shapes_(shapes), fixed_(fixed), poses_(poses), rows_(rows) {
    const std::size_t n = world.objects;
    moving_.resize(shapes.size[0]);
    placed_.assign(n, -1);
    reach_.resize(n);
    travel_.resize(n);
    middle_.resize(n);
    speed_.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const Footprint body = at(static_cast<int>(i), 0);
      reach_[i] = body.radius;
      middle_[i].assign(world.is_static[i] ? 1 : rows, body.centre);
      if (world.is_static[i]) continue;
      for (std::size_t t = 0; t < rows; ++t) middle_[i][t] = poses[t * n + i].position();
      const double offset = norm(body.centre - poses[i].position());
      reach_[i] += offset;
      const bool round = body.count == 1 && body.parts[0].kind == Kind::circle;
      const double arm = round ? offset : reach_[i];  // largest motion of a point per radian of turn [m]
      travel_[i].assign(rows, 0.0);
      for (std::size_t t = 1; t < rows; ++t) {
        const Pose &before = poses[(t - 1) * n + i], &now = poses[t * n + i];
        double way = norm(now.position() - before.position());
        if (arm > 0.0) way += arm * std::abs(wrap(now.theta - before.theta));
        travel_[i][t] = travel_[i][t - 1] + way;
        speed_[i] = std::max(speed_[i], way);
      }
    }
  }

  Footprint at(int object, int row) {
    if (world_.is_static[object]) return fixed_.outlines.footprint(shapes_, object);
    if (placed_[object] != row) {
      const Pose& pose = poses_[static_cast<std::size_t>(row) * world_.objects + object];
      moving_.place(shapes_, object, pose, unit(pose.theta));
      placed_[object] = row;
    }
    return moving_.footprint(shapes_, object);
  }

  /// Lower bound of the distance between two objects [m].
  double bound(int a, int b, int row) const { return norm(middle(a, row) - middle(b, row)) - reach_[a] - reach_[b]; }

  /// The first row after `row` by which two objects can have come nearer to each other by more than `slack`.
  int next(int a, int b, int row, double slack) const {
    const int last = static_cast<int>(rows_) - 1;
    if (!(travelled(a, last) - travelled(a, row) + travelled(b, last) - travelled(b, row) > slack)) return last + 1;
    const double fastest = speed_[a] + speed_[b];
    if (slack >= fastest) return row + static_cast<int>(slack / fastest) + 1;
    const double most = travelled(a, row) + travelled(b, row) + slack;
    int later = row + 1;
    while (later <= last && !(travelled(a, later) + travelled(b, later) > most)) ++later;
    return later;
  }

 private:
  Vec2 middle(int object, int row) const { return middle_[object][world_.is_static[object] ? 0 : row]; }

  double travelled(int object, int row) const { return world_.is_static[object] ? 0.0 : travel_[object][row]; }

  const World& world_;
  const Shapes& shapes_;
  const Fixed& fixed_;
  const Pose* poses_;
  std::size_t rows_;
  Outlines moving_;
  std::vector<int> placed_;  // (N,) row at whose pose each object is placed
  std::vector<double> reach_;
  std::vector<std::vector<Vec2>> middle_;  // by object, because loops over pairs run through the rows of two objects
  std::vector<std::vector<double>> travel_;
  std::vector<double> speed_;  // largest motion of any point from one row to the next [m]
};

}  // namespace

void least_clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                      const std::vector<int>& robots, const std::vector<ObjectKind>& kinds,
                      const std::vector<int>& ends, double* distance_out, std::int32_t* partner_out,
                      std::int32_t* row_out) {
  Recorded recorded(world, shapes, fixed, poses, rows);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const int self = robots[r], end = std::min(ends[r], static_cast<int>(rows));
    double least = kInfinity;
    int partner = -1, when = -1;
    for (int other = 0; other < world.objects; ++other) {
      if (other == self || kinds[other] == ObjectKind::ignored) continue;
      for (int t = 0; t < end;) {
        double apart = recorded.bound(self, other, t);
        if (!(apart >= least)) {
          apart = distance(recorded.at(self, t), recorded.at(other, t));
          if (apart < least) least = apart, partner = other, when = t;
        }
        t = recorded.next(self, other, t, apart - least);
      }
    }
    *distance_out++ = partner >= 0 ? least : kNone;
    *partner_out++ = partner;
    *row_out++ = when;
  }
}

}  // namespace irsim

#include "clearance.hpp"

#include "collision/distance.hpp"

namespace irsim {
namespace {

constexpr double kRounding = 1.0 + 1e-12;

/// The nearest so far.
struct Nearest {
  double distance = kInfinity;
  int partner = -1;

  void consider(double away, int object) {
    if (away < distance || (away == distance && object < partner)) distance = away, partner = object;
  }
};

}  // namespace

void clearances(const World& world, const Shapes& shapes, const Fixed& fixed, const Pose* poses, std::size_t rows,
                const std::vector<int>& robots, const std::vector<Company>& company, double* distance_out,
                std::int32_t* partner_out) {
  Outlines moving;
  moving.resize(shapes.size[0]);
  const auto body = [&](int i) { return (world.is_static[i] ? fixed.outlines : moving).footprint(shapes, i); };
  std::vector<int> movers, standing;  // who can be near whom
  bool stands[kCompanies] = {false, false, false};
  for (int i = 0; i < world.objects; ++i) {
    if (company[i] == Company::nobody) continue;
    (world.is_static[i] ? standing : movers).push_back(i);
    if (world.is_static[i]) stands[static_cast<int>(company[i])] = true;
  }
  std::vector<Vec2> centres(movers.size());  // of the bounding circles of the movers
  std::vector<Nearest> before(robots.size() * kCompanies);
  for (std::size_t t = 0; t < rows; ++t) {
    const Pose* pose = poses + t * world.objects;
    for (const int i : world.moving) moving.place(shapes, i, pose[i], unit(pose[i].theta));
    for (std::size_t m = 0; m < movers.size(); ++m) centres[m] = moving.centres[shapes.placed[movers[m]].object];
    for (std::size_t r = 0; r < robots.size(); ++r) {
      const int self = robots[r];
      const Footprint own = body(self);
      Nearest* last = before.data() + r * kCompanies;
      Nearest found[kCompanies];
      // whoever was nearest in the row before is a good first guess: most others are farther than that
      for (int k = 0; k < kCompanies; ++k) {
        if (last[k].partner >= 0) found[k].consider(distance(own, body(last[k].partner)), last[k].partner);
      }
      const auto look = [&](int other) {
        const int kind = static_cast<int>(company[other]);
        if (other != self && other != last[kind].partner) found[kind].consider(distance(own, body(other)), other);
      };
      for (std::size_t m = 0; m < movers.size(); ++m) {
        // circles that are farther apart than the nearest so far; what overlaps may be deeper than they tell
        const double touching = own.radius + shapes.radius[movers[m]];
        const double reach = touching + std::max(found[static_cast<int>(company[movers[m]])].distance, 0.0);
        if (!(squared(centres[m] - own.centre) > reach * reach * kRounding)) look(movers[m]);
      }
      double reach = 0.0;
      for (int k = 0; k < kCompanies; ++k) {
        if (stands[k]) reach = std::max(reach, found[k].distance);
      }
      if (std::isfinite(reach) && own.box.finite()) {
        const Box near{own.box.x0 - reach, own.box.y0 - reach, own.box.x1 + reach, own.box.y1 + reach};
        fixed.grid.query(near, [&](int other) {
          if (company[other] != Company::nobody) look(other);
        });
      } else {
        for (const int other : standing) look(other);
      }
      for (int k = 0; k < kCompanies; ++k) {
        last[k] = found[k];
        const bool any = found[k].partner >= 0;
        *distance_out++ = any ? found[k].distance : kNone;
        *partner_out++ = found[k].partner;
      }
    }
  }
}

}  // namespace irsim

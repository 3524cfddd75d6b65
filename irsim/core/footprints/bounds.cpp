// The cell of an object with `footprint_orca`: where it may be until it stands.
#include <algorithm>

#include "footprints/decider.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kLeastGap = 0.005;          // part of a gap that stays free [m]
constexpr double kLeastStandingGap = 0.001;  // gap that is kept from what stands [m]

}  // namespace

void fill_reaches(const Decision& decision, const OrcaCrowd& all, FootprintCrowd& crowd) {
  const World& world = decision.world;
  const State& state = decision.state;
  const Shapes& shapes = *state.scenes[decision.w()].shapes;
  crowd.stops.clear();
  crowd.reaches.assign(world.moving.size(), {});
  crowd.widest = 0.0;
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const int i = world.moving[m], row = decision.first_row + i, group = all.group[m];
    MoverReach& one = crowd.reaches[m];
    one.centre = state.pose[row].position() + rotate(shapes.centre[i], state.heading(row));
    one.radius = shapes.radius[i];
    if (group >= 0 && std::holds_alternative<FootprintOrcaOptions>(world.behaviors[group].behavior)) {
      const Ahead ahead{world, state, row, i, norm(shapes.centre[i]) + shapes.radius[i], crowd.extra};
      one.range = ahead.range(), one.play = one.range;
      one.glides = glides(world, state, row, i);
      if (one.glides) {
        one.play = ahead.play();
        ahead.stop(crowd.way);
        if (crowd.way.moves() || crowd.way.bulge > 0.0) {
          one.stop = crowd.stops.count();
          crowd.stops.add(crowd.hulls[static_cast<int>(m)], state.pose[row].position(), crowd.way);
          one.radius += crowd.way.travel + crowd.way.bulge;
        }
      }
    }
    crowd.widest = std::max(crowd.widest, one.range + shapes.radius[i]);
    if (one.range == 0.0)
      crowd.widest = std::max(crowd.widest, norm(all.movers[m].velocity) * world.step_time + shapes.radius[i]);
  }
}

void bound_by_mover(FootprintSelf& self, const Encounter& encounter, const Separation* apart) {
  FootprintCrowd& crowd = self.crowd;
  const State& state = self.state();
  const MoverReach &mine = self.limits(), &its = crowd.reaches[encounter.mover];
  const Shapes& shapes = *state.scenes[self.decision.w()].shapes;
  const int object = self.world().moving[encounter.mover], row = self.decision.first_row + object;
  const double distance = norm(its.centre - mine.centre);
  const Hull body = crowd.hulls[encounter.mover];
  if (encounter.alike && !encounter.standing) {
    const double reach = mine.play + its.play + kLeastGap;
    if (distance - mine.radius - its.radius > reach) return;
    const Hull own = mine.stop < 0 ? self.hull : crowd.stops[mine.stop];
    const Hull other = its.stop < 0 ? body : crowd.stops[its.stop];
    const bool bodies = mine.stop < 0 && its.stop < 0 && apart;
    const Separation rest = bodies                         ? *apart
                            : encounter.mover < self.mover ? mirrored_separation(own, other)
                                                           : separation(own, other);
    if (rest.gap > reach) return;
    const double toward = std::max(0.0, dot(rest.axis, encounter.moves));
    crowd.cell.borders.push_back(border(own, rest, std::max(0.0, -dot(rest.axis, self.velocity)), toward, kLeastGap));
    return;
  }
  const Vec2 shift = encounter.moves * self.world().step_time;
  const double reach = mine.range + norm(shift) + kLeastGap;
  if (distance - shapes.radius[self.object] - shapes.radius[object] > reach) return;
  const double gap = apart ? apart->gap : separation(self.hull, body).gap;
  if (gap > reach) return;
  const bool stands = encounter.standing || state.waits(row);
  const double least = stands ? std::min(kLeastStandingGap, gap) : kLeastGap;
  crowd.cell.fixtures.push_back({body, least, gap, shift, stands});
}

void bound_by_wall(FootprintSelf& self, const Hull& wall, const Separation& apart) {
  if (apart.gap > self.limits().range + kLeastStandingGap) return;
  self.crowd.cell.fixtures.push_back({wall, std::min(kLeastStandingGap, apart.gap), apart.gap, {}, true});
}

}  // namespace irsim

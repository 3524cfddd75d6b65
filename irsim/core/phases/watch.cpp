// Zones and fields of view: who enters, leaves, crosses, comes into view, goes out of view.
#include "collision/touch.hpp"
#include "geometry/predicates.hpp"
#include "phases.hpp"
#include "sensing/view.hpp"

namespace irsim {
namespace {

constexpr double kSlack = 1e-6;  // covers the rounding errors of a first test of distances

/// Whether a path from `from` to `to` leads from one side of the line ab to the other, at `where` between its ends. A
/// point on the line counts as right of it, so that a path that only touches the line does not cross it, and a path
/// that pauses on the line crosses it once.
bool crosses(Vec2 a, Vec2 b, Vec2 from, Vec2 to, Vec2& where) {
  const double before = turn_of(a, b, from), after = turn_of(a, b, to);
  if ((before > 0.0) == (after > 0.0)) return false;
  where = from + (to - from) * (before / (before - after));
  const double along = dot(where - a, b - a);
  return along >= 0.0 && along <= squared(b - a);
}

void watch_line(const World& world, State& state, int w, int zone) {
  const Footprint line = world.zones.footprint(zone);
  const Vec2 a = line.vertices[0], b = line.vertices[1];
  const std::vector<Vec2>& before = state.scenes[w].watched.position;
  for (const int i : world.moving) {
    const Vec2 now = state.pose[w * world.objects + i].position();
    Vec2 where;
    if (!crosses(a, b, before[i], now, where)) continue;
    const bool to_left = turn_of(a, b, now) > 0.0;
    state.log_numbers(w, to_left ? EventKind::crossing_to_left : EventKind::crossing_to_right, world.number[i], zone,
                      where);
  }
}

void watch_region(const World& world, State& state, int w, int zone) {
  const Footprint region = world.zones.footprint(zone);
  std::uint8_t* inside = state.scenes[w].watched.inside.data() + static_cast<std::size_t>(zone) * world.objects;
  for (const int i : world.moving) {
    const Footprint body = state.footprint(world, w, i);
    const bool now = body.box.meets(region.box) && touch(body, region);
    if (now == (inside[i] != 0)) continue;
    inside[i] = now;
    state.log_numbers(w, now ? EventKind::zone_entry : EventKind::zone_exit, world.number[i], zone,
                      state.pose[w * world.objects + i].position());
  }
}

void watch_view(const World& world, State& state, int w, std::size_t number, Workspace& work) {
  const View& view = world.views[number];
  std::uint8_t* seen = state.scenes[w].watched.seen.data() + number * world.objects;
  const Vec2 from = state.pose[w * world.objects + view.object].position();
  for (int i = 0; i < world.objects; ++i) {
    if (!world.is_target[i]) continue;
    const auto [centre, radius] = state.bounds(world, w, i);
    const double reach = view.reach + radius + kSlack;
    const bool near = squared(centre - from) <= reach * reach * (1.0 + kSlack);  // most others are not
    const bool now = near && sees(world, state, w, view, i, work);
    if (now == (seen[i] != 0)) continue;
    seen[i] = now;
    state.log(world, w, now ? EventKind::sight_start : EventKind::sight_end, view.object, i,
              state.pose[w * world.objects + i].position());
  }
}

}  // namespace

void watch(const World& world, State& state, int w, Workspace& work) {
  const int zones = world.zones.count();
  if (zones == 0 && world.views.empty()) return;
  Watched& watched = state.scenes[w].watched;
  const std::size_t n = world.objects;
  const bool moved = !watched.position.empty();
  if (!moved) {
    watched.position.resize(n);
    watched.inside.assign(zones * n, 0);
    watched.seen.assign(world.views.size() * n, 0);
  }
  for (int zone = 0; zone < zones; ++zone) {
    if (!world.zones.is_line(zone)) {
      watch_region(world, state, w, zone);
    } else if (moved) {
      watch_line(world, state, w, zone);
    }
  }
  for (std::size_t v = 0; v < world.views.size(); ++v) watch_view(world, state, w, v, work);
  for (std::size_t i = 0; i < n; ++i)
    watched.position[i] = state.pose[w * world.objects + static_cast<int>(i)].position();
}

}  // namespace irsim

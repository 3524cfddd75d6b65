#include "sensing/fog.hpp"

#include "sensing/beams.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kMaxDistance = 1e9;  // beams that start or end farther away are ignored [m]
constexpr int kFractionBits = 40;     // fraction bits of fixed-point coordinates; kMaxFogCells fits into the others

struct Cells {
  std::uint8_t* explored;
  const Fog& fog;
  Vec2 origin, cell;

  /// Mark the cell at a point, given in cells from the origin.
  void mark(double i, double j) const {
    if (i >= 0.0 && j >= 0.0 && i < fog.columns && j < fog.rows) {
      explored[static_cast<std::size_t>(i) * fog.rows + static_cast<std::size_t>(j)] = 1;
    }
  }

  /// Distances along a beam at which it enters and leaves the fog.
  std::pair<double, double> over(Vec2 from, Vec2 beam) const {
    double low = 0.0, high = kInfinity;
    const auto clip_axis = [&](double at, double rate, double size) {
      if (rate == 0.0) {
        if (at < 0.0 || at > size) high = -1.0;
        return;
      }
      const double a = -at / rate, b = (size - at) / rate;
      low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
    };
    clip_axis(from.x - origin.x, beam.x, fog.size[0]);
    clip_axis(from.y - origin.y, beam.y, fog.size[1]);
    return {low, high};
  }

  /// Mark the cells under samples of a beam that are half a cell apart, and under its end.
  void along(Vec2 from, Vec2 beam, double range) const {
    const double step = 0.5 * std::min(cell.x, cell.y);
    const double all = std::fabs(from.x) + std::fabs(from.y) + std::fabs(beam.x) + std::fabs(beam.y);
    if (!(all < kMaxDistance)) return;  // the pose is not finite, or much too far away
    const auto [low, high] = over(from, beam);
    if (!(low <= high && high < kMaxDistance)) return;  // the beam misses the fog, or is too far away for exact steps
    const double last = std::min(range, high + step);
    const Vec2 start{(from.x - origin.x) / cell.x, (from.y - origin.y) / cell.y};
    const Vec2 stride{beam.x * step / cell.x, beam.y * step / cell.y};
    const double first = std::max(0.0, std::floor(low / step)), count = std::ceil(last / step) - first;
    if (count > 0.0) samples(start + stride * first, stride, static_cast<std::int64_t>(count));
    mark(start.x + beam.x * range / cell.x, start.y + beam.y * range / cell.y);
  }

  /// Mark the cells under `count` points that are `stride` apart. No more than a few at the ends may miss the fog.
  /// Coordinates are integers in units of 2^-40 cells, which is much faster than rounding two numbers for each point.
  void samples(Vec2 start, Vec2 stride, std::int64_t count) const {
    const auto fixed = [](double at) {
      return static_cast<std::int64_t>(at * (std::int64_t{1} << kFractionBits) + std::copysign(0.5, at));
    };
    const auto inside = [&](std::int64_t x, std::int64_t y) {
      return x >= 0 && y >= 0 && x >> kFractionBits < fog.columns && y >> kFractionBits < fog.rows;
    };
    std::int64_t x = fixed(start.x), y = fixed(start.y);
    const std::int64_t dx = fixed(stride.x), dy = fixed(stride.y), rows = fog.rows;
    for (; count > 0 && !inside(x, y); --count) x += dx, y += dy;
    while (count > 0 && !inside(x + (count - 1) * dx, y + (count - 1) * dy)) --count;
    // Both ends are inside, so all points between them are.
    for (; count > 0; --count) {
      explored[(x >> kFractionBits) * rows + (y >> kFractionBits)] = 1;
      x += dx, y += dy;
    }
  }

  /// Mark the cells whose centre is within reach and within half the opening angle of the heading.
  void sector(const Pose& pose, double angle, double reach) const {
    if (!(std::fabs(pose.x) < kMaxDistance && std::fabs(pose.y) < kMaxDistance && reach >= 0.0)) return;
    const auto index = [](double at, double size, int count) { return clip(std::floor(at / size), 0.0, count - 1.0); };
    const Vec2 at = pose.position() - origin;
    const int i0 = static_cast<int>(index(at.x - reach, cell.x, fog.columns));
    const int i1 = static_cast<int>(index(at.x + reach, cell.x, fog.columns));
    const int j0 = static_cast<int>(index(at.y - reach, cell.y, fog.rows));
    const int j1 = static_cast<int>(index(at.y + reach, cell.y, fog.rows));
    for (int i = i0; i <= i1; ++i) {
      for (int j = j0; j <= j1; ++j) {
        const Vec2 d = Vec2{(i + 0.5) * cell.x, (j + 0.5) * cell.y} - at;
        if (!(norm(d) <= reach)) continue;
        if (angle < kTurn && !(std::fabs(wrap(std::atan2(d.y, d.x) - pose.theta)) <= 0.5 * angle)) continue;
        explored[static_cast<std::size_t>(i) * fog.rows + static_cast<std::size_t>(j)] = 1;
      }
    }
  }
};

}  // namespace

void lift_fog(const World& world, State& state, int w, Workspace& work) {
  const Fog& fog = *world.fog;
  const Cells cells{
      state.explored.data + static_cast<std::size_t>(w) * fog.cells(), fog, {fog.origin[0], fog.origin[1]}, fog.cell()};
  for (const int object : fog.carriers) {
    const auto sensor = std::find_if(world.scans.begin(), world.scans.end(),
                                     [&](const Scan& scan) { return scan.mount.object == object; });
    if (sensor == world.scans.end()) continue;
    const Mount& mount = sensor->mount;
    const int row = w * world.objects + object;
    if (state.absent(row)) continue;
    const Pose& pose = state.pose[row];
    const Vec2 body = state.heading(row);
    const Vec2 from = pose.position() + rotate({mount.offset[0], mount.offset[1]}, body);
    const Vec2 heading = unit(pose.theta + mount.offset[2]);
    const double* ranges = just_measured(world, state, w, *sensor);
    if (ranges == nullptr) continue;
    for (int i = 0; i < mount.count; ++i) {
      cells.along(from, rotate({mount.cosine[i], mount.sine[i]}, heading), ranges[i]);
    }
  }
  for (std::size_t k = 0; k < fog.views.size(); ++k) {
    const View& view = fog.views[k];
    const int row = w * world.objects + view.object;
    if (state.absent(row)) continue;
    const Pose& pose = state.pose[row];
    if (!view.occlusion) {
      cells.sector(pose, view.angle, view.reach);
      continue;
    }
    const Mount& mount = world.fog_beams[k];
    Fan fan(work.beams, pose.position(), state.heading(row), mount, view.reach);
    aim_all(fan, mount, state.heading(row));
    cast_at_visible(fan, world, state, w, view.object);
    for (int i = 0; i < mount.count; ++i) {
      cells.along(pose.position(), fan.beam(i), fan.hit(i) < 0 ? view.reach : fan.range(i));
    }
  }
}

}  // namespace irsim

#include "pictures/strokes.hpp"

#include <array>

namespace irsim {
namespace {

constexpr double kSagitta = 0.02;           // distance of an opaque circle from the polygon that stands for it [px]
constexpr int kFewestCorners = 12;          // of such a polygon
constexpr double kOneStep = 0.99;           // of a step around a circle; a smaller turn has one edge
constexpr double kSmooth = 0.015;           // half a width, squared, times the sine of a turn [px^2]
constexpr double kShortest = 1e-9;          // shorter segments are left out [px]
constexpr double kAlignedPx = 1e-4;         // deviation up to which a segment counts as horizontal or vertical
constexpr std::size_t kMostSnapped = 1024;  // corners; longer outlines are not snapped

int corners_of(double radius, double sagitta = kSagitta) {
  return std::max(kFewestCorners, static_cast<int>(std::ceil(kPi * std::sqrt(std::max(radius, 0.0) / (2 * sagitta)))));
}

/// Collect the polygon that stands for a circle; its area equals the circle's.
void add_circle(Raster& raster, Vec2 center, double radius, double opacity, bool backwards) {
  const int count = corners_of(radius, kSagitta / std::sqrt(opacity));
  const double step = (backwards ? -kTurn : kTurn) / count;
  const double reach = radius * std::sqrt(std::fabs(step) / std::sin(std::fabs(step)));
  const Vec2 turn = unit(step);
  Vec2 arm{reach, 0.0};
  const Vec2 start = center + arm;
  Vec2 last = start;
  for (int i = 1; i < count; ++i) {
    arm = rotate(arm, turn);
    raster.edge(last, center + arm);
    last = center + arm;
  }
  raster.edge(last, start);
}

/// Collect the edges from `arm` on around a circle, over an angle, in steps of which `corners` make a circle.
void add_arc(Raster& raster, Vec2 center, Vec2 arm, double angle, int corners) {
  const int count = std::max(1, static_cast<int>(std::ceil(angle / kTurn * corners)));
  const Vec2 turn = unit(angle / count);
  Vec2 last = arm;
  for (int i = 0; i < count; ++i) {
    const Vec2 next = rotate(last, turn);
    raster.edge(center + last, center + next);
    last = next;
  }
}

/// Collect the edges of a stroke at a corner between two segments with these directions.
///
/// The pieces of a stroke are one quad per segment and one fan or triangle at the outer side of each corner. Edges that
/// two of them share run in opposite directions and are left out, so that the quads end at the corner on the inner
/// side.
void add_corner(Raster& raster, Vec2 corner, Vec2 before, Vec2 after, const LineStyle& style, int corners) {
  const double half = style.width / 2, turn = cross(before, after), along = dot(before, after);
  const double side = turn > 0.0 || (turn == 0.0 && along <= 0.0) ? half : -half;
  const Vec2 from{before.y * side, -before.x * side}, to{after.y * side, -after.x * side};
  if (turn == 0.0 && along > 0.0) return;
  // A quad runs along its outer side first where the line turns to positive angles, else along its inner side.
  const bool positive = side > 0.0;
  const Vec2 inner_from = corner - from, inner_to = corner - to;
  if (positive) {
    raster.edge(corner, inner_from);
    raster.edge(inner_to, corner);
  } else {
    raster.edge(inner_from, corner);
    raster.edge(corner, inner_to);
  }
  const Vec2 begin = positive ? from : to, end = positive ? to : from;
  if (style.join == Join::kRound) {
    const double sine = std::fabs(turn);
    if (along > 0.0 && sine * corners < kTurn * kOneStep) return raster.edge(corner + begin, corner + end);
    return add_arc(raster, corner, begin, std::atan2(sine, along), corners);
  }
  const double half_angle = std::sqrt(std::max(0.0, (1.0 + along) / 2));  // cosine of half the change of direction
  // As Matplotlib has it, the tip is at most as many half widths away from the corner as the line has pixels.
  if (style.join == Join::kMiter && half_angle * style.width >= 1.0) {
    const Vec2 tip = corner + (from + to) * (0.5 / (half_angle * half_angle));
    raster.edge(corner + begin, tip);
    raster.edge(tip, corner + end);
  } else {
    raster.edge(corner + begin, corner + end);
  }
}

/// Whether a stroke turns so little between two segments that its sides may simply meet, whatever its join is: on the
/// inner side that takes away what the segments share, at most half of `kSmooth`, and it adds less on the outer side.
bool is_smooth(Vec2 before, Vec2 after, double shorter, double half) {
  const double reach = half * std::fabs(cross(before, after));
  return dot(before, after) > 0.0 && reach <= shorter && half * reach <= kSmooth;
}

}  // namespace

void add_disc(Raster& raster, Vec2 center, double radius, double opacity) {
  if (radius > 0.0) add_circle(raster, center, radius, opacity, false);
}

void add_ring(Raster& raster, Vec2 center, double radius, double width, double opacity) {
  add_disc(raster, center, radius + width / 2, opacity);
  if (radius > width / 2) add_circle(raster, center, radius - width / 2, opacity, true);
}

void add_stroke(Raster& raster, const std::vector<Vec2>& points, bool closed, const LineStyle& style) {
  thread_local std::vector<Vec2> path, directions;
  thread_local std::vector<double> lengths;
  thread_local std::vector<std::array<Vec2, 2>> sides;  // of each segment, from its begin and end to the left
  path.clear();
  directions.clear();
  lengths.clear();
  sides.clear();
  for (const Vec2 p : points) {
    if (path.empty() || norm(p - path.back()) > kShortest) path.push_back(p);
  }
  if (closed && path.size() > 1 && norm(path.front() - path.back()) <= kShortest) path.pop_back();
  if (path.size() < 2) return;
  const double half = style.width / 2;
  const int corners = corners_of(half);
  const std::size_t count = path.size(), segments = closed ? count : count - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec2 step = path[i + 1 == count ? 0 : i + 1] - path[i];
    lengths.push_back(norm(step));
    const Vec2 direction = step * (1.0 / lengths.back());
    directions.push_back(direction);
    const Vec2 across = Vec2{-direction.y, direction.x} * half;
    sides.push_back({across, across});
  }
  for (std::size_t i = closed ? 0 : 1; i < segments; ++i) {
    const std::size_t last = i == 0 ? segments - 1 : i - 1;
    const Vec2 before = directions[last], after = directions[i];
    if (is_smooth(before, after, std::min(lengths[last], lengths[i]), half)) {
      const Vec2 middle = (before + after) * (half / (1.0 + dot(before, after)));
      sides[last][1] = sides[i][0] = {-middle.y, middle.x};
    } else {
      add_corner(raster, path[i], before, after, style, corners);
    }
  }
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec2 from = path[i], to = path[i + 1 == count ? 0 : i + 1];
    raster.edge(from - sides[i][0], to - sides[i][1]);
    raster.edge(to + sides[i][1], from + sides[i][0]);
  }
  if (closed) return;
  const Vec2 first = directions.front(), last = directions.back();
  const Vec2 begin = Vec2{-first.y, first.x} * half, end = Vec2{last.y, -last.x} * half;
  if (style.round_caps) {
    add_arc(raster, path.front(), begin, kPi, corners);
    add_arc(raster, path.back(), end, kPi, corners);
  } else {
    raster.edge(path.front() + begin, path.front() - begin);
    raster.edge(path.back() + end, path.back() - end);
  }
}

void add_dashes(Raster& raster, const std::vector<Vec2>& points, const LineStyle& style) {
  if (points.size() < 2) return;
  std::size_t entry = 0;  // of the pattern; even ones are dashes
  double rest = style.dashes[0];
  std::vector<Vec2> dash;
  dash.push_back(points.front());
  for (std::size_t i = 1; i < points.size(); ++i) {
    Vec2 from = points[i - 1];
    double length = norm(points[i] - from);
    while (length > rest) {
      from = from + (points[i] - from) * (rest / length);
      length -= rest;
      if (entry % 2 == 0) {
        dash.push_back(from);
        add_stroke(raster, dash, false, style);
      }
      dash.clear();
      dash.push_back(from);
      entry = (entry + 1) % style.dashes.size();
      rest = style.dashes[entry];
    }
    rest -= length;
    dash.push_back(points[i]);
  }
  if (entry % 2 == 0 && dash.size() > 1) add_stroke(raster, dash, false, style);
}

bool snap(std::vector<Vec2>& points, bool closed, double width) {
  const std::size_t count = points.size();
  if (count > kMostSnapped) return false;
  for (std::size_t i = closed ? 0 : 1; i < count; ++i) {
    const Vec2 step = points[i] - points[(i + count - 1) % count];
    if (std::fabs(step.x) >= kAlignedPx && std::fabs(step.y) >= kAlignedPx) return false;
  }
  const double shift = std::lround(width) % 2 != 0 ? 0.5 : 0.0;
  for (Vec2& p : points) p = {std::floor(p.x + 0.5) + shift, std::floor(p.y + 0.5) + shift};
  return true;
}

}  // namespace irsim

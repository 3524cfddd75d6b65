#include "pictures/names.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace irsim {
namespace {

constexpr double kGaps[] = {4.0, 14.0, 26.0};    // distances of a name from its thing
constexpr double kGapCosts[] = {0.0, 0.3, 0.6};  // what they cost
constexpr double kOrderCost = 0.01;              // of each place after the first at a distance
constexpr double kWallCost = 0.15, kPlanCost = 0.12, kTrailCost = 0.06;
constexpr double kSlant = 0.75;  // corners are so much nearer than sides
constexpr double kSpread = 6.0;  // greatest distance of the points along a line

bool meets(const TextBox& box, const std::vector<TextBox>& others) {
  return std::any_of(others.begin(), others.end(), [&](const TextBox& other) {
    return box.right > other.left && box.left < other.right && box.top > other.bottom && box.bottom < other.top;
  });
}

bool holds(const TextBox& box, const std::vector<Vec2>& points) {
  return std::any_of(points.begin(), points.end(),
                     [&](Vec2 p) { return p.x > box.left && p.x < box.right && p.y > box.bottom && p.y < box.top; });
}

/// The lower left corner of a place: above, below, right, left, then the corners of the thing.
Vec2 corner_of(const NameWish& wish, double height, double gap, int place) {
  const double over = wish.at.y + wish.up + gap, under = wish.at.y - wish.up - gap - height;
  const double right = wish.at.x + wish.across + gap, left = wish.at.x - wish.across - gap - wish.width;
  const double middle = wish.at.x - wish.width / 2, half = wish.at.y - height / 2;
  if (place < 4) return place < 2 ? Vec2{middle, place == 0 ? over : under} : Vec2{place == 2 ? right : left, half};
  const double away = kSlant * wish.across + gap * kSlant;
  const double side = place < 6 ? wish.at.x + away : wish.at.x - away - wish.width;
  const double rise = kSlant * (wish.up + gap);
  return {side, place % 2 == 0 ? wish.at.y + rise : wish.at.y - rise - height};
}

}  // namespace

NamePlace place_name(const NameWish& wish, NameSurroundings& around) {
  NamePlace best;
  double least = std::numeric_limits<double>::infinity(), least_before_lines = least;
  for (int number = 0; number < 3 * kPlacesAround; ++number) {
    double cost = kGapCosts[number / kPlacesAround] + kOrderCost * (number % kPlacesAround);
    if (cost >= least) break;  // later places at this distance, and farther ones, cost even more
    const Vec2 low = corner_of(wish, around.height, kGaps[number / kPlacesAround], number % kPlacesAround);
    const TextBox box{low.x, low.y, low.x + wish.width, low.y + around.height};
    const TextBox& inside = around.inside;
    if (box.left < inside.left || box.bottom < inside.bottom || box.right > inside.right || box.top > inside.top ||
        meets(box, around.taken))
      continue;
    cost += meets(box, around.walls) ? kWallCost : 0.0;
    double whole = cost;
    if (cost <= least) {
      whole += holds(box, around.plans) ? kPlanCost : 0.0;
      whole += holds(box, around.trails) ? kTrailCost : 0.0;
    }
    if (whole < least || (whole == least && cost < least_before_lines)) {
      best = {number, box};
      least = whole;
      least_before_lines = cost;
    }
  }
  if (best.number >= 0) around.taken.push_back(best.box);
  return best;
}

void spread_points(const Vec2* line, std::size_t count, std::vector<Vec2>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < count; ++i) length += norm(line[i] - line[i - 1]);
  if (count < 2 || !std::isfinite(length)) return;
  const int pieces = 1 + static_cast<int>(std::min(length / kSpread, 1e6));
  std::size_t corner = 1;
  double begin = 0.0, step = norm(line[1] - line[0]);
  for (int i = 0; i <= pieces; ++i) {
    const double at = i == pieces ? length : length * i / pieces;
    while (corner + 1 < count && at > begin + step) {
      begin += step;
      ++corner;
      step = norm(line[corner] - line[corner - 1]);
    }
    const double share = step > 0.0 ? std::min((at - begin) / step, 1.0) : 0.0;
    points.push_back(line[corner - 1] + (line[corner] - line[corner - 1]) * share);
  }
}

}  // namespace irsim

#include "pictures/raster.hpp"

namespace irsim {

void Raster::clip(PixelBox box) {
  box_ = box;
  const int width = std::max(0, box.right - box.left), height = std::max(0, box.bottom - box.top);
  pitch_ = static_cast<std::size_t>(width) + 2;
  deltas_.resize(std::max(deltas_.size(), pitch_ * static_cast<std::size_t>(height)));
  rows_.resize(static_cast<std::size_t>(height));
  first_ = box.bottom;
  last_ = box.top - 1;
}

bool Raster::read_convex(const Vec2* points, std::size_t count) {
  const double wide = box_.right - box_.left, high = box_.bottom - box_.top;
  double top = high, bottom = 0.0;
  sides_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 a = points[i], b = points[(i + 1) % count];
    const double x0 = a.x - box_.left, y0 = a.y - box_.top, x1 = b.x - box_.left, y1 = b.y - box_.top;
    if (!(x0 >= 0.0 && x0 <= wide && std::isfinite(y0))) return false;
    top = std::min(top, y0);
    bottom = std::max(bottom, y0);
    if (y0 == y1) continue;
    const double slope = (x1 - x0) / (y1 - y0);
    sides_.push_back(y0 < y1 ? Side{x0, y0, y1, slope, 1.0f} : Side{x1, y1, y0, slope, -1.0f});
  }
  line_.resize(std::max(line_.size(), pitch_));
  convex_ = {0, static_cast<int>(std::max(top, 0.0)), 0, static_cast<int>(std::ceil(std::min(bottom, high)))};
  return true;
}

void Raster::outline(const Vec2* points, std::size_t count) {
  for (std::size_t i = 0; i + 1 < count; ++i) edge(points[i], points[i + 1]);
  if (count > 1) edge(points[count - 1], points[0]);
}

PixelBox Raster::touched(int first, int last) const {
  PixelBox box{box_.right, first, box_.left, last + 1};
  for (int y = first; y <= last; ++y) {
    const Row& row = rows_[y - box_.top];
    box.left = std::min(box.left, box_.left + row.from);
    box.right = std::max(box.right, std::min(box_.right, box_.left + row.to + 1));
  }
  return box;
}

void Raster::add_touched(std::vector<PixelBox>& boxes) const {
  constexpr int kBand = 32;  // rows; one box around a long oblique line would be mostly empty
  for (int first = first_; first <= last_; first += kBand) {
    const PixelBox box = touched(first, std::min(first + kBand - 1, last_));
    if (!is_empty(box)) boxes.push_back(box);
  }
}

/// Add an edge that may reach out of the box.
void Raster::cut_edge(Vec2 from, Vec2 to) {
  if (!(std::isfinite(from.x) && std::isfinite(from.y) && std::isfinite(to.x) && std::isfinite(to.y))) return;
  const double high = box_.bottom - box_.top, wide = box_.right - box_.left;
  double x0 = from.x - box_.left, y0 = from.y - box_.top, x1 = to.x - box_.left, y1 = to.y - box_.top;
  if (y0 == y1 || std::max(y0, y1) <= 0.0 || std::min(y0, y1) >= high) return;
  const double slope = (x1 - x0) / (y1 - y0);
  const auto cut = [&](double& x, double& y) {
    const double inside = std::min(std::max(y, 0.0), high);
    x += (inside - y) * slope;
    y = inside;
  };
  cut(x0, y0);
  cut(x1, y1);
  // Edges left or right of the box are moved to its border, so that the shares within stay the same.
  if (std::min(x0, x1) >= 0.0 && std::max(x0, x1) <= wide) return inner_edge(x0, y0, x1, y1);
  const auto at = [&](double x) { return y0 + (x - x0) / slope; };
  const auto piece = [&](double xa, double ya, double xb, double yb) {
    const auto moved = [&](double at) { return std::min(std::max(at, 0.0), wide); };
    inner_edge(moved(xa), ya, moved(xb), yb);
  };
  double x = x0, y = y0;
  for (const double border : {x0 < x1 ? 0.0 : wide, x0 < x1 ? wide : 0.0}) {
    if ((x < border) == (x1 < border) || x == border || x1 == border) continue;
    const double level = at(border);
    piece(x, y, border, level);
    x = border;
    y = level;
  }
  piece(x, y, x1, y1);
}

void Raster::inner_edge(double x0, double y0, double x1, double y1) {
  if (y0 == y1) return;
  // Edges run up and down by turns, so branches would often be foreseen wrongly; selections are not foreseen.
  const bool down = y0 < y1;
  const float direction = down ? 1.0f : -1.0f;
  const double from = down ? x0 : x1, to = down ? x1 : x0;
  const double low = std::min(y0, y1), high = std::max(y0, y1);
  x0 = from, x1 = to, y0 = low, y1 = high;
  const int top = static_cast<int>(y0), below = static_cast<int>(y1);
  const int bottom = below == y1 ? below - 1 : below;  // an edge that ends on a border of rows does not touch the next
  first_ = std::min(first_, box_.top + top);
  last_ = std::max(last_, box_.top + bottom);
  Row* row = rows_.data() + top;
  float* deltas = deltas_.data() + static_cast<std::size_t>(top) * pitch_;
  if (top == bottom) return part(*row, deltas, x0, x1, direction * static_cast<float>(y1 - y0));
  const double slope = (x1 - x0) / (y1 - y0);
  double x = x0, y = y0;
  for (int next = top + 1; next <= bottom; ++next, ++row, deltas += pitch_) {
    const double end = x + (next - y) * slope;
    part(*row, deltas, x, end, direction * static_cast<float>(next - y));
    x = end;
    y = next;
  }
  part(*row, deltas, x, x1, direction * static_cast<float>(y1 - y));
}

}  // namespace irsim

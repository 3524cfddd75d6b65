#include "pictures/pixels.hpp"

#include <algorithm>
#include <cstring>
#include <map>

namespace irsim {
namespace {

constexpr float kFullLevel = 255.0f;

/// Lay a colour over a pixel with the integers of Agg.
void lay_over_like_agg(std::uint8_t* pixel, const std::uint8_t* ink) {
  const int alpha = ink[3], below = pixel[3];
  const int whole = ((alpha + below) << 8) - alpha * below;
  for (int k = 0; k < 3; ++k) {
    const int level = pixel[k] * below;
    pixel[k] = static_cast<std::uint8_t>((((ink[k] << 8) - level) * alpha + (level << 8)) / whole);
  }
  pixel[3] = static_cast<std::uint8_t>(whole >> 8);
}

}  // namespace

void lay_image(const Pixels& below, const Pixels& above, int left, int top) {
  const int from = std::max(0, -left), to = std::min(above.width, below.width - left);
  const int first = std::max(0, -top), last = std::min(above.height, below.height - top);
  for (int y = first; y < last; ++y) {
    std::uint8_t* pixel = below.row(top + y) + kChannels * (left + from);
    const std::uint8_t* ink = above.row(y) + kChannels * from;
    for (int x = from; x < to; ++x, pixel += kChannels, ink += kChannels) {
      if (ink[3] != 0) lay_over_like_agg(pixel, ink);
    }
  }
}

namespace {

/// Lay the part `area` of a layer over the levels of that part.
void blend(float* levels, const PixelBox& area, const PixelBox& box, const PictureLayer& layer) {
  const int pitch = 3 * (box.right - box.left);
  for (int y = area.top; y < area.bottom; ++y) {
    float* level = levels + static_cast<std::ptrdiff_t>(y - box.top) * pitch + 3 * (area.left - box.left);
    if (layer.mask != nullptr) {
      const std::uint8_t* covered = layer.mask + (y - layer.top) * layer.stride + (area.left - layer.left);
      for (int x = area.left; x < area.right; ++x, level += 3, ++covered) {
        if (*covered == 0) continue;
        const float share = static_cast<float>(*covered) * layer.alpha / kFullLevel;
        for (int k = 0; k < 3; ++k) level[k] += (layer.color[k] - level[k]) * share;
      }
      continue;
    }
    const std::uint8_t* ink = layer.image.row(y - layer.top) + kChannels * (area.left - layer.left);
    for (int x = area.left; x < area.right; ++x, level += 3, ink += kChannels) {
      if (ink[3] == 0) continue;
      std::uint8_t pixel[kChannels] = {0, 0, 0, 255};
      for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint8_t>(level[k] + 0.5f);
      lay_over_like_agg(pixel, ink);
      for (int k = 0; k < 3; ++k) level[k] = pixel[k];
    }
  }
}

}  // namespace

void compose(const Pixels& pixels, const Pixels& ground, const std::vector<PixelBox>& boxes,
             const std::vector<PictureLayer>& layers) {
  thread_local std::vector<float> levels;
  for (const PixelBox& box : boxes) {
    if (is_empty(box)) continue;
    const int width = box.right - box.left;
    levels.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(box.bottom - box.top));
    float* level = levels.data();
    for (int y = box.top; y < box.bottom; ++y) {
      const std::uint8_t* pixel = ground.row(y) + kChannels * box.left;
      for (int x = 0; x < width; ++x, pixel += kChannels, level += 3) {
        level[0] = pixel[0], level[1] = pixel[1], level[2] = pixel[2];
      }
    }
    for (const PictureLayer& layer : layers) {
      const PixelBox place{layer.left, layer.top, layer.left + layer.width, layer.top + layer.height};
      const PixelBox area = common(box, place);
      if (!is_empty(area)) blend(levels.data(), area, box, layer);
    }
    level = levels.data();
    for (int y = box.top; y < box.bottom; ++y) {
      std::uint8_t* pixel = pixels.row(y) + kChannels * box.left;
      for (int x = 0; x < width; ++x, pixel += kChannels, level += 3) {
        for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint8_t>(level[k] + 0.5f);
      }
    }
  }
}

void copy_boxes(const Pixels& from, const Pixels& to, const std::vector<PixelBox>& boxes) {
  for (const PixelBox& box : boxes) {
    if (is_empty(box)) continue;
    const std::size_t count = kChannels * static_cast<std::size_t>(box.right - box.left);
    for (int y = box.top; y < box.bottom; ++y) {
      std::memcpy(to.row(y) + kChannels * box.left, from.row(y) + kChannels * box.left, count);
    }
  }
}

std::vector<PixelBox> merged(const std::vector<PixelBox>& boxes) {
  const auto area = [](const PixelBox& box) {
    return static_cast<std::ptrdiff_t>(box.right - box.left) * (box.bottom - box.top);
  };
  std::vector<PixelBox> out;
  for (PixelBox box : boxes) {
    if (is_empty(box)) continue;
    for (std::size_t i = 0; i < out.size();) {
      const PixelBox other = out[i];
      const PixelBox both = around(box, other);
      if (is_empty(common(box, other)) || area(both) > area(box) + area(other)) {
        ++i;
        continue;
      }
      box = both;
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;  // the larger box may overlap those before
    }
    out.push_back(box);
  }
  return out;
}

std::vector<PixelBox> gathered(const std::vector<PixelBox>& boxes) {
  constexpr std::size_t kFew = 24;  // boxes, which are merged as they are
  constexpr int kTile = 48;         // side of the tiles in which small boxes are gathered [px]
  if (boxes.size() <= kFew) return merged(boxes);
  std::vector<PixelBox> few;
  std::map<std::pair<int, int>, PixelBox> tiles;
  for (const PixelBox& box : boxes) {
    if (is_empty(box)) continue;
    if (box.right - box.left > kTile || box.bottom - box.top > kTile) {
      few.push_back(box);
      continue;
    }
    const auto [place, added] = tiles.try_emplace({box.top / kTile, box.left / kTile}, box);
    if (!added) place->second = around(place->second, box);
  }
  for (const auto& [place, box] : tiles) few.push_back(box);
  return merged(few);
}

void write_rgb_rows(const Pixels& pixels, std::uint8_t* out) {
  for (int y = 0; y < pixels.height; ++y) {
    const std::uint8_t* pixel = pixels.row(y);
    *out++ = 0;
    // Four bytes are written at once; the fourth is overwritten by the next pixel, and the last pixel is written alone.
    for (int x = 0; x + 1 < pixels.width; ++x, pixel += kChannels, out += 3) std::memcpy(out, pixel, kChannels);
    if (pixels.width > 0) std::memcpy(out, pixel, 3);
    out += pixels.width > 0 ? 3 : 0;
  }
}

namespace {

/// The box around the pixels of `boxes` for which `differs(x, y)`.
template <class Differs>
PixelBox box_where(const std::vector<PixelBox>& boxes, Differs&& differs) {
  PixelBox found{1 << 30, 1 << 30, 0, 0};
  for (const PixelBox& box : boxes) {
    for (int y = box.top; y < box.bottom; ++y) {
      int first = box.left;
      while (first < box.right && !differs(first, y)) ++first;
      if (first == box.right) continue;
      int last = box.right - 1;
      while (last >= found.right && !differs(last, y)) --last;
      found = {std::min(found.left, first), std::min(found.top, y), std::max(found.right, last + 1),
               std::max(found.bottom, y + 1)};
    }
  }
  return is_empty(found) ? PixelBox{} : found;
}

}  // namespace

PixelBox changed_box(const Pixels& before, const Pixels& after, const std::vector<PixelBox>& boxes) {
  return box_where(
      boxes, [&](int x, int y) { return word(before.row(y) + kChannels * x) != word(after.row(y) + kChannels * x); });
}

PixelBox opaque_box(const Pixels& pixels) {
  return box_where({{0, 0, pixels.width, pixels.height}},
                   [&](int x, int y) { return pixels.row(y)[kChannels * x + 3] != 0; });
}

}  // namespace irsim

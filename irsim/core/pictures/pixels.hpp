// Pixels, colours and boxes of pictures.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace irsim {

/// Left, top, right and bottom of a part of a picture [px], top row first; right and bottom are exclusive.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// (height, width, 4) red, green, blue and opacity, not premultiplied, in memory that others own.
struct Pixels {
  std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;  ///< bytes from one row to the next
  int width = 0, height = 0;

  std::uint8_t* row(int y) const { return data + y * stride; }
};

constexpr int kChannels = 4;

/// The four bytes of a pixel at once, to compare them.
inline std::uint32_t word(const std::uint8_t* pixel) {
  std::uint32_t value;
  std::memcpy(&value, pixel, sizeof value);
  return value;
}

/// A colour with opacity, 0..255.
struct Ink {
  std::uint8_t red = 0, green = 0, blue = 0, alpha = 0;
};

/// Lay a colour with the opacity `alpha` over a pixel.
inline void lay_over(std::uint8_t* pixel, const Ink& ink, int alpha) {
  if (alpha <= 0) return;
  const int below = pixel[3];
  if (below == 255) {
    // Two channels at once: each product of at most 255 * 255 has 16 bits of its own, and division by 255 is exact.
    constexpr std::uint32_t kLanes = 0x00ff00ffu, kHalves = 0x00800080u;
    const std::uint8_t bytes[kChannels] = {ink.red, ink.green, ink.blue, 255};
    if (alpha >= 255) {
      std::memcpy(pixel, bytes, sizeof bytes);
      return;
    }
    const std::uint32_t above = word(bytes), old = word(pixel);
    const std::uint32_t part = static_cast<std::uint32_t>(alpha), rest = 255 - part;
    std::uint32_t even = (above & kLanes) * part + (old & kLanes) * rest + kHalves;
    std::uint32_t odd = (above >> 8 & kLanes) * part + (old >> 8 & kLanes) * rest + kHalves;
    even = (even + (even >> 8 & kLanes)) >> 8 & kLanes;
    odd = (odd + (odd >> 8 & kLanes)) & ~kLanes;
    const std::uint32_t both = even | odd;
    std::memcpy(pixel, &both, sizeof both);
    return;
  }
  const int kept = below * (255 - alpha), whole = 255 * alpha + kept;
  pixel[0] = static_cast<std::uint8_t>((255 * alpha * ink.red + kept * pixel[0] + whole / 2) / whole);
  pixel[1] = static_cast<std::uint8_t>((255 * alpha * ink.green + kept * pixel[1] + whole / 2) / whole);
  pixel[2] = static_cast<std::uint8_t>((255 * alpha * ink.blue + kept * pixel[2] + whole / 2) / whole);
  pixel[3] = static_cast<std::uint8_t>((whole + 127) / 255);
}

/// Lay a picture over another, with its left upper corner at (left, top); what lies outside is cut off.
///
/// Levels are rounded as Agg does, so that what is drawn into a picture of its own looks as if it were drawn in place.
void lay_image(const Pixels& below, const Pixels& above, int left, int top);

/// A layer of a picture: an image (h, w, 4), or a mask (h, w) with a colour, whose left upper corner is at (left, top).
struct PictureLayer {
  Pixels image;                        ///< without data if it is a mask
  const std::uint8_t* mask = nullptr;  ///< 0..255
  std::ptrdiff_t stride = 0;           ///< bytes from one row of the mask to the next
  int width = 0, height = 0, left = 0, top = 0;
  float color[3] = {0, 0, 0};  ///< of the mask, 0..255
  float alpha = 1;             ///< of the mask, 0..1
};

/// Put parts of a picture together: the layers, the lowest first, over the same part of `ground`.
///
/// Masks are laid over exact levels, which are rounded once; images are rounded as Agg does.
void compose(const Pixels& pixels, const Pixels& ground, const std::vector<PixelBox>& boxes,
             const std::vector<PictureLayer>& layers);

/// Copy parts of a picture to another of the same size.
void copy_boxes(const Pixels& from, const Pixels& to, const std::vector<PixelBox>& boxes);

/// Replace boxes that overlap by one around both, unless that is larger than the two.
std::vector<PixelBox> merged(const std::vector<PixelBox>& boxes);

/// Few boxes around many: small boxes that lie close together become one, and then boxes that overlap are merged.
std::vector<PixelBox> gathered(const std::vector<PixelBox>& boxes);

/// The part that two boxes share; empty, with `right <= left` or `bottom <= top`, if they share nothing.
inline PixelBox common(const PixelBox& a, const PixelBox& b) {
  return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right), std::min(a.bottom, b.bottom)};
}

/// The box around two boxes.
inline PixelBox around(const PixelBox& a, const PixelBox& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right), std::max(a.bottom, b.bottom)};
}

inline bool is_empty(const PixelBox& box) { return box.right <= box.left || box.bottom <= box.top; }

/// Write the rows of a picture as (H, 1 + 3 W): a zero, then red, green and blue of each pixel.
void write_rgb_rows(const Pixels& pixels, std::uint8_t* out);

/// The box outside of which two pictures of the same size are equal; empty if they are equal.
///
/// Only `boxes` are compared, outside of which the pictures are known to be equal.
PixelBox changed_box(const Pixels& before, const Pixels& after, const std::vector<PixelBox>& boxes);

/// The box outside of which a picture is transparent; empty if all of it is.
PixelBox opaque_box(const Pixels& pixels);

}  // namespace irsim

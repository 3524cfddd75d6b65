// The pixels of GIF frames: indices of the nearest colours of a palette, compressed.
#pragma once

#include <array>
#include <vector>

#include "pictures/pixels.hpp"

namespace irsim {

/// Finds the nearest of at most 256 colours, and remembers what it has found.
class Palette {
 public:
  explicit Palette(std::vector<std::array<int, 3>> colors);

  /// What is known of a colour.
  struct Nearest {
    std::uint8_t index = 0;
    bool wrong = false;  ///< whether a channel differs by more than `kWrongLevels`
  };

  /// Find the nearest colour.
  Nearest nearest(const std::uint8_t* pixel) {
    const std::uint32_t color = pixel[0] | pixel[1] << 8 | pixel[2] << 16 | 0xff000000u;
    Slot& slot = slots_[color * 2654435761u >> (32 - kSlotBits)];
    if (slot.color != color) slot = {color, search(pixel)};
    return slot.nearest;
  }

 private:
  static constexpr int kSlotBits = 14, kWrongLevels = 32, kCellLevels = 4;
  struct Slot {
    std::uint32_t color = 0;
    Nearest nearest;
  };

  Nearest search(const std::uint8_t* pixel) const;

  std::vector<std::array<int, 3>> colors_;
  std::vector<Slot> slots_;
};

/// A compressed frame.
struct GifData {
  std::vector<std::uint8_t> bytes;  ///< code size, blocks of codes, end
  std::size_t wrong = 0;            ///< pixels that are far from their colour
};

/// Compress the part `box` of a picture.
///
/// Pixels that are as in `before`, unless that is null, become `transparent`, which is no index of the palette then;
/// only those in `boxes` may have changed.
GifData encode_gif(Palette& palette, const Pixels& pixels, const Pixels* before, const PixelBox& box,
                   const std::vector<PixelBox>& boxes, std::uint8_t transparent);

}  // namespace irsim

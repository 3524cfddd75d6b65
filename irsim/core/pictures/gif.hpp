// The pixels of GIF frames: indices of the nearest colours of a palette, compressed.
#pragma once

#include <array>
#include <vector>

#include "pictures/pixels.hpp"

namespace irsim {

/// Finds the nearest of at most 256 colours, and remembers what it has found.
///
/// Colours in the same cell of 4 levels in each channel get the same index, which compresses better and needs few
/// searches. A colour of the palette itself is always found.
class Palette {
 public:
  explicit Palette(std::vector<std::array<int, 3>> colors);

  /// The facts about a colour.
  struct Nearest {
    std::uint8_t index = 0;
    bool wrong = false;  ///< whether a channel differs by more than `kWrongLevels`
  };

  /// Find the nearest colour.
  Nearest nearest(const std::uint8_t* pixel) {
    const std::uint32_t cell = pixel[0] >> 2 | (pixel[1] >> 2) << 6 | (pixel[2] >> 2) << 12;
    std::uint32_t& slot = slots_[cell * 2654435761u >> (32 - kSlotBits)];
    if (slot >> kCellShift != cell + 1) slot = (cell + 1) << kCellShift | search(pixel);
    const std::uint8_t index = static_cast<std::uint8_t>(slot);
    return {(slot & kCrowded) != 0 ? exact(pixel, index) : index, (slot & kWrong) != 0};
  }

 private:
  static constexpr int kSlotBits = 13, kCellShift = 10, kWrongLevels = 32, kCellLevels = 4;
  static constexpr int kInCell = 1 << 20;  ///< added to the closeness of colours in the same cell
  static constexpr std::uint32_t kWrong = 1u << 8, kCrowded = 1u << 9;

  std::uint32_t search(const std::uint8_t* pixel) const;
  std::uint8_t exact(const std::uint8_t* pixel, std::uint8_t otherwise) const;

  std::vector<std::array<int, 3>> colors_;
  std::vector<std::uint32_t> slots_;  ///< of each cell, its number, whether it has several colours or is wrong, index
};

/// A compressed frame.
struct GifData {
  std::vector<std::uint8_t> bytes;  ///< code size, blocks of codes, end
  std::size_t wrong = 0;            ///< pixels that are far from their colour
};

/// Compress the part `box` of a picture.
///
/// With `before`, pixels that have not changed since become `transparent`, an index that the palette must not use then.
/// Only pixels in `boxes` may have changed.
GifData encode_gif(Palette& palette, const Pixels& pixels, const Pixels* before, const PixelBox& box,
                   const std::vector<PixelBox>& boxes, std::uint8_t transparent);

}  // namespace irsim

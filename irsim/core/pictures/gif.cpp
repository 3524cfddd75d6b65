#include "pictures/gif.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace irsim {
namespace {

constexpr int kColorBits = 8;
constexpr int kClear = 1 << kColorBits, kEnd = kClear + 1, kFirstCode = kEnd + 1;
constexpr int kMostCodes = 4096;
constexpr std::size_t kBlock = 255;

/// Writes codes of 9 to 12 bits into blocks.
class CodeWriter {
 public:
  explicit CodeWriter(std::vector<std::uint8_t>& out) : out_(out) {}

  void write(int code, int bits) {
    waiting_ |= static_cast<std::uint32_t>(code) << count_;
    count_ += bits;
    while (count_ >= 8) put();
  }

  void finish() {
    if (count_ > 0) put();
    if (length_ > 0) out_[start_] = static_cast<std::uint8_t>(length_);
    out_.push_back(0);
  }

 private:
  void put() {
    if (length_ == 0) {
      start_ = out_.size();
      out_.push_back(0);
    }
    out_.push_back(static_cast<std::uint8_t>(waiting_));
    waiting_ >>= 8;
    count_ -= 8;
    if (++length_ == kBlock) {
      out_[start_] = static_cast<std::uint8_t>(kBlock);
      length_ = 0;
    }
  }

  std::vector<std::uint8_t>& out_;
  std::size_t start_ = 0, length_ = 0;
  std::uint32_t waiting_ = 0;
  int count_ = 0;
};

/// The compression of GIF (Lempel, Ziv and Welch), with a short way through long runs of one index.
///
/// Most of a frame is a single index, transparent or white. The strings of that index alone are `runs_[0]`, one long,
/// `runs_[1]`, two long and so on; the longest that fits into a run is found without walking through its pixels.
class Compressor {
 public:
  Compressor(std::vector<std::uint8_t>& out, std::uint8_t common) : writer_(out), common_(common) {
    codes_.assign(kSlots, 0);
    writer_.write(kClear, bits_);
    restart();
  }

  void add(std::uint8_t index, std::size_t count) {
    if (index != common_) {
      while (count-- > 0) add(index);
      return;
    }
    while (count > 0) {
      if (prefix_ >= 0 && length_ == 0) {  // a string that ends in another index
        add(index);
        --count;
        continue;
      }
      const std::size_t most = runs_.size(), next = std::min(most, length_ + count);
      count -= next - length_;
      length_ = next;
      prefix_ = runs_[next - 1];
      if (count == 0) return;
      --count;
      emit(index);
    }
  }

  void finish() {
    if (prefix_ >= 0) writer_.write(prefix_, bits_);
    grow();
    writer_.write(kEnd, bits_);
    writer_.finish();
  }

 private:
  static constexpr int kSlotBits = 13, kCodeBits = 12;
  static constexpr std::size_t kSlots = std::size_t{1} << kSlotBits;

  void add(std::uint8_t index) {
    if (prefix_ < 0) {
      prefix_ = index;
      length_ = index == common_;
      return;
    }
    const std::uint32_t known = codes_[find(key_of(index))];
    if (known == 0) return emit(index);
    prefix_ = static_cast<int>(known & (kMostCodes - 1));
    length_ = length_ > 0 && index == common_ ? length_ + 1 : 0;
  }

  /// Write the code of the present string, remember the string that is longer by `index`, and start from `index`.
  void emit(std::uint8_t index) {
    writer_.write(prefix_, bits_);
    if (next_ < kMostCodes) {
      const std::uint32_t key = key_of(index);
      codes_[find(key)] = key << kCodeBits | static_cast<std::uint32_t>(next_);
      if (length_ > 0 && index == common_) runs_.push_back(next_);
      grow();
      ++next_;
    } else {
      writer_.write(kClear, bits_);
      std::fill(codes_.begin(), codes_.end(), 0);
      restart();
    }
    prefix_ = index;
    length_ = index == common_;
  }

  void grow() {
    if (next_ == 1 << bits_ && bits_ < 12) ++bits_;
  }

  void restart() {
    bits_ = kColorBits + 1;
    next_ = kFirstCode;
    prefix_ = -1;
    length_ = 0;
    runs_.assign(1, common_);
  }

  /// The present string and the index after it.
  std::uint32_t key_of(std::uint8_t index) const { return static_cast<std::uint32_t>(prefix_) << kColorBits | index; }

  /// The slot of a key, or the empty slot for it.
  std::size_t find(std::uint32_t key) const {
    std::size_t slot = key * 2654435761u >> (32 - kSlotBits);
    while (codes_[slot] != 0 && codes_[slot] >> kCodeBits != key) slot = (slot + 1) % kSlots;
    return slot;
  }

  CodeWriter writer_;
  std::uint8_t common_;
  int bits_ = kColorBits + 1, next_ = kFirstCode, prefix_ = -1;
  std::size_t length_ = 0;  ///< of the present string, if it has only the common index; 0 otherwise
  std::vector<int> runs_;
  std::vector<std::uint32_t> codes_;  ///< key and code of each string that is known; 0 in an empty slot
};

}  // namespace

Palette::Palette(std::vector<std::array<int, 3>> colors)
    : colors_(std::move(colors)), slots_(std::size_t{1} << kSlotBits) {}

std::uint32_t Palette::search(const std::uint8_t* pixel) const {
  const auto cell = [](int level) { return level & ~(kCellLevels - 1); };
  int best = std::numeric_limits<int>::max(), inside = 0;
  std::size_t found = 0;
  for (std::size_t i = 0; i < colors_.size(); ++i) {
    int distance = 0;
    bool same = true;
    for (int k = 0; k < 3; ++k) {
      const int apart = colors_[i][k] - cell(pixel[k]) - kCellLevels / 2;
      distance += apart * apart;
      same = same && cell(colors_[i][k]) == cell(pixel[k]);
    }
    inside += same;
    if (same) distance -= kInCell;
    if (distance < best) {
      best = distance;
      found = i;
    }
  }
  bool wrong = false;
  for (int k = 0; k < 3; ++k) wrong = wrong || std::abs(colors_[found][k] - pixel[k]) > kWrongLevels;
  return static_cast<std::uint32_t>(found) | (wrong ? kWrong : 0) | (inside > 1 ? kCrowded : 0);
}

std::uint8_t Palette::exact(const std::uint8_t* pixel, std::uint8_t otherwise) const {
  for (std::size_t i = 0; i < colors_.size(); ++i) {
    const std::array<int, 3>& color = colors_[i];
    if (color[0] == pixel[0] && color[1] == pixel[1] && color[2] == pixel[2]) return static_cast<std::uint8_t>(i);
  }
  return otherwise;
}

namespace {

/// Compress a part of a row, all of whose pixels may have changed.
void encode_part(Palette& palette, Compressor& compressor, GifData& data, const std::uint8_t* row,
                 const std::uint8_t* old, int from, int to, std::uint8_t transparent) {
  const auto kept = [&](int x) { return old != nullptr && word(row + kChannels * x) == word(old + kChannels * x); };
  for (int x = from; x < to;) {
    int end = x + 1;
    std::uint8_t index = transparent;
    if (kept(x)) {
      while (end < to && kept(end)) ++end;
    } else {
      const std::uint32_t color = word(row + kChannels * x);
      while (end < to && word(row + kChannels * end) == color && !kept(end)) ++end;
      const Palette::Nearest nearest = palette.nearest(row + kChannels * x);
      data.wrong += nearest.wrong ? static_cast<std::size_t>(end - x) : 0;
      index = nearest.index;
    }
    compressor.add(index, static_cast<std::size_t>(end - x));
    x = end;
  }
}

}  // namespace

GifData encode_gif(Palette& palette, const Pixels& pixels, const Pixels* before, const PixelBox& box,
                   const std::vector<PixelBox>& boxes, std::uint8_t transparent) {
  GifData data;
  data.bytes.push_back(kColorBits);
  std::vector<PixelBox> parts;
  for (const PixelBox& given : boxes) {
    const PixelBox part = common(given, box);
    if (!is_empty(part)) parts.push_back(part);
  }
  std::sort(parts.begin(), parts.end(), [](const PixelBox& a, const PixelBox& b) { return a.left < b.left; });
  const std::uint8_t common_index = before != nullptr || is_empty(box)
                                        ? transparent
                                        : palette.nearest(pixels.row(box.top) + kChannels * box.left).index;
  Compressor compressor(data.bytes, common_index);
  for (int y = box.top; y < box.bottom; ++y) {
    const std::uint8_t* row = pixels.row(y);
    const std::uint8_t* old = before == nullptr ? nullptr : before->row(y);
    int x = box.left;
    for (const PixelBox& part : parts) {
      if (y < part.top || y >= part.bottom || part.right <= x) continue;
      if (part.left > x) compressor.add(transparent, static_cast<std::size_t>(part.left - x));
      x = std::max(x, part.left);
      encode_part(palette, compressor, data, row, old, x, part.right, transparent);
      x = part.right;
    }
    if (x < box.right) compressor.add(transparent, static_cast<std::size_t>(box.right - x));
  }
  compressor.finish();
  return data;
}

}  // namespace irsim

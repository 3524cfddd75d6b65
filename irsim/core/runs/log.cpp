#include "runs/log.hpp"

#include <algorithm>
#include <cstring>

#include "world/state.hpp"

namespace irsim {
namespace {

/// Add a block to `column` and its row to `rows`, unless it equals the last block bit for bit.
template <class T>
void add_if_changed(Column<std::int64_t>& rows, Column<T>& column, std::int64_t row, const T* now, std::size_t count) {
  if (count == 0) return;
  const bool same = column.size() >= count &&
                    std::memcmp(column.numbers->data() + column.size() - count, now, count * sizeof(T)) == 0;
  if (same) return;
  *rows.add(1) = row;
  std::copy_n(now, count, column.add(count));
}

/// Write the ranges that beams measured, infinite without a valid hit, like `returned_range` but without branches,
/// which lets compilers use vector instructions.
void write_returned_ranges(const double* ranges, const std::uint8_t* valid, std::size_t count, float* out) {
  constexpr std::uint32_t infinity = 0x7f800000;
  for (std::size_t b = 0; b < count; ++b) {
    const float range = static_cast<float>(ranges[b]);
    std::uint32_t bits;
    std::memcpy(&bits, &range, sizeof bits);
    const std::uint32_t mask = 0u - static_cast<std::uint32_t>(valid[b] != 0);
    bits = (bits & mask) | (infinity & ~mask);
    std::memcpy(out + b, &bits, sizeof bits);
  }
}

}  // namespace

Log::Log(const World& world, std::vector<int> movers_, int columns_, bool scans_)
    : movers(std::move(movers_)),
      objects(world.objects),
      columns(columns_),
      scans(scans_),
      beams(scans_ ? world.beams_per_world : 0),
      gauges(scans_ ? world.readings_per_world : 0),
      flags_now_(world.objects) {
  for (const int i : movers) {
    if (world.has_actuators[i]) commanded.push_back(i);
  }
}

void Log::add(const State& state) {
  if (rows == 0) first = state.count[0];
  double* poses = pose.add(3 * movers.size());
  float* controls = control.add(columns * movers.size());
  for (const int i : movers) {
    poses = std::copy_n(&state.pose[i].x, 3, poses);
    for (int c = 0; c < columns; ++c) *controls++ = static_cast<float>(state.control[i].value[c]);
  }
  if (!commanded.empty()) {
    float* commands = command.add(columns * commanded.size());
    for (const int i : commanded) {
      for (int c = 0; c < columns; ++c) *commands++ = static_cast<float>(state.command[i].value[c]);
    }
  }
  add_if_changed(goal_rows, goal, rows, state.goal.data, objects);
  for (int i = 0; i < objects; ++i) {
    flags_now_[i] = (state.arrived[i] ? 1 : 0) | (state.collided[i] ? 2 : 0) | (state.stopped[i] ? 4 : 0) |
                    (state.believes_arrived[i] ? 8 : 0);
  }
  add_if_changed(flag_rows, flags, rows, flags_now_.data(), objects);
  if (beams > 0) add_scan(state);
  add_if_changed(reading_rows, readings, rows, state.readings.data, gauges);
  ++rows;
}

void Log::add_scan(const State& state) {
  const std::size_t before = ranges.size();
  float* now = ranges.add(beams);
  write_returned_ranges(state.ranges.data, state.valid.data, beams, now);
  if (before >= beams && std::memcmp(now - beams, now, beams * sizeof(float)) == 0) {
    ranges.remove(beams);
  } else {
    *scan_rows.add(1) = rows;
  }
}

void Log::clear() {
  rows = 0;
  pose.clear(), control.clear(), command.clear(), goal.clear(), flags.clear(), ranges.clear();
  readings.clear(), reading_rows.clear();
  goal_rows.clear(), flag_rows.clear(), scan_rows.clear();
}

}  // namespace irsim

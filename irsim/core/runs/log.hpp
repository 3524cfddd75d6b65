// The record of a world: one row for each step while it is attached to a state.
#pragma once

#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#include "geometry/vec.hpp"
#include "world/world.hpp"

namespace irsim {

struct State;

/// Allocates numbers without setting them to zero, because each is written as soon as a vector has made room for it.
template <class T>
struct Unset : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Unset<U>;
  };
  using std::allocator<T>::allocator;
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
};

/// Numbers that can grow while NumPy arrays view them; the viewed numbers do not change.
template <class T>
struct Column {
  using Numbers = std::vector<T, Unset<T>>;
  std::shared_ptr<Numbers> numbers = std::make_shared<Numbers>();

  /// Add `count` numbers at the end and return where to write them.
  T* add(std::size_t count) {
    if (numbers.use_count() > 1) numbers = std::make_shared<Numbers>(*numbers);
    numbers->resize(numbers->size() + count);
    return numbers->data() + numbers->size() - count;
  }
  /// Remove the numbers that were added last; nothing may view them.
  void remove(std::size_t count) { numbers->resize(numbers->size() - count); }
  void clear() {
    if (numbers.use_count() > 1) numbers = std::make_shared<Numbers>();
    numbers->clear();
  }
  std::size_t size() const { return numbers->size(); }
};

/// Rows of world 0. Each row has poses and controls of the movers; goals, flags, scans and readings are stored only
/// where they differ from the row before.
struct Log {
  Log(const World& world, std::vector<int> movers, int columns, bool scans);

  /// Add a row with the present state.
  void add(const State& state);
  /// Remove all rows. The next row has goals, flags and scans.
  void clear();

  std::vector<int> movers;     // objects whose pose and control are recorded
  std::vector<int> commanded;  // movers whose commands pass through actuators, and are recorded, too
  int objects, columns;        // `columns`: recorded numbers of each control
  bool scans;
  std::size_t beams, gauges;  // numbers of a scan, and of the sensors that report numbers instead

  std::int64_t first = 0, rows = 0;  // step of the first row, number of rows
  Column<double> pose;               // (rows, movers, 3)
  Column<float> control;             // (rows, movers, columns)
  Column<float> command;             // (rows, commanded, columns)
  Column<std::int64_t> goal_rows, flag_rows, scan_rows, reading_rows;
  Column<Goal> goal;           // (goal_rows, N)
  Column<std::uint8_t> flags;  // (flag_rows, N): 1 arrived, 2 collided, 4 stopped, 8 believes to have arrived
  Column<float> ranges;        // (scan_rows, beams), infinite without a valid hit
  Column<double> readings;     // (reading_rows, gauges)

  std::size_t bytes() const {
    return 8 * (pose.size() + 3 * goal.size() + readings.size()) +
           4 * (control.size() + command.size() + ranges.size());
  }

 private:
  /// Add the ranges of all beams, unless they equal the last ones bit for bit.
  void add_scan(const State& state);

  std::vector<std::uint8_t> flags_now_;
};

}  // namespace irsim

// What a world writes down of each step while somebody records it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/vec.hpp"
#include "world/world.hpp"

namespace irsim {

struct State;

/// Numbers that NumPy may look at while more are added: what is looked at stays as it is.
template <class T>
struct Column {
  std::shared_ptr<std::vector<T>> numbers = std::make_shared<std::vector<T>>();

  /// Room for so many more at the end.
  T* add(std::size_t count) {
    if (numbers.use_count() > 1) numbers = std::make_shared<std::vector<T>>(*numbers);
    numbers->resize(numbers->size() + count);
    return numbers->data() + numbers->size() - count;
  }
  void clear() {
    if (numbers.use_count() > 1) numbers = std::make_shared<std::vector<T>>();
    numbers->clear();
  }
  std::size_t size() const { return numbers->size(); }
};

/// Rows of world 0: poses and controls of the movers each, goals, flags and scans where they differ from the row
/// before.
struct Log {
  Log(const World& world, std::vector<int> movers, int columns, bool scans);

  /// Write the present state down.
  void add(const State& state);
  /// Begin anew; the next row has everything.
  void clear();

  std::vector<int> movers;  // objects whose pose is written
  int objects, columns;     // `columns` numbers of each control
  bool scans;
  std::size_t beams;

  std::int64_t first = 0, rows = 0;  // step of the first row, how many there are
  Column<double> pose;               // (rows, movers, 3)
  Column<float> control;             // (rows, movers, columns)
  Column<std::int64_t> goal_rows, flag_rows, scan_rows;
  Column<Goal> goal;           // (goal_rows, N)
  Column<std::uint8_t> flags;  // (flag_rows, N): 1 arrived, 2 collided, 4 stopped
  Column<float> ranges;        // (scan_rows, beams), infinite where nothing was hit

  std::size_t bytes() const { return 8 * (pose.size() + 3 * goal.size()) + 4 * (control.size() + ranges.size()); }

 private:
  std::vector<std::uint8_t> flags_now_;
  std::vector<float> ranges_now_;
};

}  // namespace irsim

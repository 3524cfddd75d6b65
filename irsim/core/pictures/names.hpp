// Places for names beside the things that they name: over nothing that must be seen, always chosen in the same way.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// A part of a picture in units of 1/96 inch, y upwards.
struct TextBox {
  double left = 0, bottom = 0, right = 0, top = 0;
};

/// A name that needs a place: the middle of its thing, half the width and height of the thing, the width of the name.
struct NameWish {
  Vec2 at;
  double across = 0, up = 0, width = 0;
};

/// The place of a name: its number among all that were tried, the nearest first, or -1 if none is free.
struct NamePlace {
  int number = -1;
  TextBox box{};
};

/// The surroundings of names.
struct NameSurroundings {
  TextBox inside;                     ///< names stay in it
  double height = 0;                  ///< of a name
  std::vector<TextBox> taken, walls;  ///< boxes that names may not overlap, and should not overlap
  std::vector<Vec2> plans, trails;    ///< points of lines that names should not cover
};

/// Number of places at each of the three distances from a thing.
constexpr int kPlacesAround = 8;

/// Find the best place for a name, which is then taken.
NamePlace place_name(const NameWish& wish, NameSurroundings& around);

/// Append points along a line, so close together that a name hardly lies between two of them.
void spread_points(const Vec2* line, std::size_t count, std::vector<Vec2>& points);

}  // namespace irsim

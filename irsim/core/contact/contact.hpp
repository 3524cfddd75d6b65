// Contacts of `collision_mode: contact`: what they are, and the scratch memory that finds them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "contact/overlap.hpp"
#include "contact/packing.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct Bodies;

/// One contact of a step. a < b are object ids; `normal` points from b to a.
struct Contact {
  int a, b;
  Vec2 normal;
  double depth;  // deepest overlap that was found [m]
  Vec2 point;
  double force;  // [N]
};

struct ContactBuffers {
  /// One object where it is now.
  struct Body {
    Vec2 centroid;
    Vec2 start_velocity;  // before contacts [m/s]
    Box box;
    Vec2 moved;               // by contacts in this step [m]
    double turned = 0.0;      // [rad]
    std::uint32_t moves = 0;  // how often it was corrected in this step
    bool placed = false;
    bool driven, passive;  // of those that can be pushed
  };
  /// Two objects that may meet, a < b.
  struct Pair {
    int a, b, order;
    std::uint32_t a_moves, b_moves;  // when `overlap` was found
    bool known;
    Overlap overlap;
    int contact;              // among `contacts`, -1 none
    double scale;             // sum over all corrections
    bool a_yields, b_yields;  // in the last correction
  };
  /// Something that a body cannot be pushed into for the rest of a sweep.
  struct Block {
    Vec2 normal;  // from what is in the way to the body
    double friction;
  };
  std::vector<Body> bodies;
  std::vector<Vec2> vertices, normals;
  std::vector<Box> boxes;  // of pieces
  std::vector<Pair> pairs;
  std::vector<Box> outer;  // of objects
  Packing packing;
  std::vector<std::pair<int, int>> found;
  std::vector<int> distance, queue, links, first_link;
  std::vector<std::vector<Block>> blocks;  // by object
  std::vector<int> blocked;                // objects that have any
  std::vector<const Pair*> pair_of;        // contacts
  std::vector<std::uint8_t> reached;
};

}  // namespace irsim

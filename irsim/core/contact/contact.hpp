// Contacts of `collision_mode: contact`, and the scratch memory of the solver that finds them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "collision/stride.hpp"
#include "contact/overlap.hpp"
#include "contact/packing.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct Bodies;

/// One contact of a step between the objects a < b. `normal` points from b to a.
struct Contact {
  int a, b;
  Vec2 normal;
  double depth;  // largest overlap in this step [m]
  Vec2 point;
  double force;  // [N]
};

struct ContactBuffers {
  /// One object at its present pose.
  struct Body {
    Vec2 centroid;
    Vec2 start_velocity;  // velocity before contacts [m/s]
    Box box;
    Vec2 moved;               // displacement by contacts in this step [m]
    double turned = 0.0;      // rotation by contacts in this step [rad]
    std::uint32_t moves = 0;  // number of corrections in this step
    bool placed = false;
    bool driven, passive;  // whether a body that can be pushed has a drive
  };
  /// Two objects that may meet, a < b.
  struct Pair {
    int a, b, order;
    std::uint32_t a_moves, b_moves;  // values of `moves` for which `overlap` was computed
    bool known;
    Overlap overlap;
    int contact;              // index among the contacts of the scene, -1 without one
    double scale;             // sum of the scales of all corrections
    bool a_yields, b_yields;  // whether each body gave way in the last correction
  };
  /// An obstacle that a body cannot be pushed into for the rest of a sweep.
  struct Block {
    Vec2 normal;  // from the obstacle to the body
    double friction;
  };
  std::vector<Body> bodies;
  std::vector<Vec2> vertices, normals;
  std::vector<Box> boxes;  // boxes of the pieces
  std::vector<Pair> pairs;
  std::vector<Box> outer;  // boxes of the objects
  Packing packing;
  std::vector<std::pair<int, int>> found;
  std::vector<int> distance, queue, links, first_link;
  std::vector<std::vector<Block>> blocks;  // (N,) blocks of each object
  std::vector<int> blocked;                // objects that have blocks
  std::vector<const Pair*> pair_of;        // pair of each contact
  std::vector<std::uint8_t> reached;
  // of steps that are divided
  std::vector<Contact> merged;
  std::vector<Pose> end;              // (N,) where each object would be without contacts
  std::vector<Vec3> drift;            // (N,) what contacts add to each part of its motion [m, m, rad]
  std::vector<Vec3> twists;           // (N,) velocities before the contacts of a part
  std::vector<Stride> strides;        // of the moving objects
  std::vector<std::uint8_t> touched;  // (N,)
  std::vector<std::pair<int, int>> met;
  // of motions that are held
  std::vector<Pose> from;      // of the moving objects, where a step or a part of it begins
  std::vector<double> turned;  // of the moving objects, by how much they turn in it [rad]
  std::vector<Stride> went;    // of the moving objects
  std::vector<double> until;   // (N,) share of its motion that each object makes
  std::vector<Contact> held;
};

}  // namespace irsim

// The contacts of one world in one step. `contact.cpp` runs the sweeps, `pairs.cpp` finds and orders pairs of bodies,
// `resolve.cpp` pushes a pair apart, `forces.cpp` changes velocities and records contacts.
#pragma once

#include <utility>
#include <vector>

#include "contact/bodies.hpp"
#include "contact/push.hpp"
#include "contact/respond.hpp"

namespace irsim {

class ContactSolver {
 public:
  ContactSolver(const World& world, State& state, int w, Workspace& work, const Resolution& options)
      : options_(options),
        world_(world),
        state_(state),
        scene_(state.scenes[w]),
        bodies_(*scene_.bodies),
        work_(work),
        buffers_(work.contacts),
        first_(w * world.objects) {}

  /// Resolve the contacts of these pairs, or of all objects that may meet.
  void run(const std::vector<std::pair<int, int>>* given);
  void place_moving();
  /// How two objects overlap at other poses, after `place_moving`. The depth is -infinity if they are apart.
  Overlap overlap_at(int a, int b, const Pose& at_a, const Pose& at_b);

 private:
  using Buffers = ContactBuffers;

  /// How one body gives way along the normal of a contact.
  struct Share {
    Vec2 direction;      // translation per unit of scale
    double translation;  // part of it along the normal
    double turn;         // rotation per unit of scale [rad]
    double rotation;     // displacement along the normal that the rotation causes, per unit of scale
    double total() const { return translation + rotation; }
  };

  /// Resolve every pair once. Returns whether anything moved.
  bool sweep_all();
  double deepest_overlap();
  /// Put the pieces of an object where its pose is now.
  void place(int object);

  /// Distance that two bodies can approach each other by in a step, with a small margin [m].
  double reach_per_step() const;
  void add_candidate(int i, int j);
  void find_pairs();
  /// Keep each candidate once, sorted by ids or in the order given.
  void collect_pairs(bool as_given);
  /// Rank objects by the order in which IR-SIM's index of boxes finds them.
  void rank_boxes();
  /// Sort pairs by the distances of both objects, counted in contacts, from objects that cannot be pushed; pairs of
  /// equal distance stay as given, or are sorted by the first object and then by the rank of the second.
  void order_pairs(bool as_given);

  Placed piece(int p) const;
  /// How a pair overlaps, which `find_overlap` computes again if one of them has moved.
  const Overlap& overlap(Buffers::Pair& pair) {
    const Buffers::Body &a = buffers_.bodies[pair.a], &b = buffers_.bodies[pair.b];
    return pair.known && pair.a_moves == a.moves && pair.b_moves == b.moves ? pair.overlap : find_overlap(pair);
  }
  const Overlap& find_overlap(Buffers::Pair& pair);
  /// The deepest overlap of an object with the occupied cells of a map; adjacent cells of a row count as one box.
  Overlap overlap_with_cells(int object, const OccupancyGrid& grid) const;
  /// How far an object gives way along a unit direction, past the block that opposes it most.
  Share share_of(int object, Vec2 direction, Vec2 point) const;
  /// Ground friction of a body and of all bodies that it pushes ahead of it [N].
  double pushed_friction(int body, Vec2 direction);
  bool resolve(Buffers::Pair& pair);
  void add_block(int object, Vec2 normal, double friction);
  /// Decide whether a driver or the body that it pushes gives way. A driver with too little traction stalls. One with
  /// enough traction keeps its motion while the body can be shifted; a body that can only turn and a strong driver both
  /// give way. In a jam all drivers stall.
  void decide_who_yields(int driver, Share& to_driver, int body, Share& to_body, Vec2 push);
  void displace(int object, Vec2 by, double turn);

  /// Add the displacements of this step to the velocities.
  void change_velocities();
  /// Which share of a change of velocity counts, see `Resolution`.
  double counted(int object, Vec2 change, double yaw_rate) const;
  void record_contact(Buffers::Pair& pair, const Overlap& o, double depth);
  /// Give passive bodies the speed of separation that their restitution asks for.
  void bounce();
  /// World-frame velocity that the control of an object gives at its present pose [m/s].
  Vec2 velocity(int object);
  void measure_forces();
  /// Limit the force of a driver that pushes into a contact to its traction.
  void limit_force(Contact& contact, int object, Vec2 into);

  const Resolution& options_;
  const World& world_;
  State& state_;
  Scene& scene_;
  const Bodies& bodies_;
  Workspace& work_;
  Buffers& buffers_;
  int first_;
  bool stalling_ = false;  // late extra sweeps: no body is pushed into a block, and drivers stall
};

}  // namespace irsim

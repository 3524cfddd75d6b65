// Rigid contacts of one world: bodies that overlap are pushed apart, sweep by sweep.
#include "contact/contact.hpp"

#include <algorithm>

#include "contact/hold.hpp"
#include "contact/parts.hpp"
#include "contact/push.hpp"
#include "contact/solver.hpp"
#include "phases.hpp"

namespace irsim {
namespace {

constexpr double kMaxVisibleOverlap = 5e-4;  // larger overlaps are worth extra sweeps [m]
constexpr int kSweepsBeforeStall = 120;      // extra sweeps before drivers stall and wedged bodies stay put
// Pairs resolved in one step. Hundreds of bodies in one place are thus pushed apart over several steps.
constexpr int kMaxPairs = 4'000'000;

/// Update how long each object has touched something, and how long it has touched nothing.
void update_contact_times(const World& world, State& state, int w) {
  const int first = w * world.objects;
  for (int row = first; row < first + world.objects; ++row) state.touching[row] = (state.touching[row] & 1u) << 1;
  for (const Contact& contact : state.scenes[w].contacts) {
    state.touching[first + contact.a] |= 1u;
    state.touching[first + contact.b] |= 1u;
  }
  for (int row = first; row < first + world.objects; ++row) {
    const bool touches = (state.touching[row] & 1u) != 0;
    state.contact_time[row] = touches ? state.contact_time[row] + world.step_time : 0.0;
    state.air_time[row] = touches ? 0.0 : state.air_time[row] + world.step_time;
  }
}

}  // namespace

void ContactSolver::run(const std::vector<std::pair<int, int>>* given) {
  place_moving();
  if (given == nullptr) {
    find_pairs();
  } else {
    buffers_.found.clear();
    for (const auto& [i, j] : *given) add_candidate(i, j);
  }
  collect_pairs(given != nullptr);
  if (buffers_.pairs.empty()) return;
  order_pairs(given != nullptr);
  bool moved = true;
  const int affordable = kMaxPairs / static_cast<int>(buffers_.pairs.size()) + 1;
  for (int sweep = 0; moved && sweep < std::min(options_.sweeps, affordable); ++sweep) moved = sweep_all();
  // Jams of many bodies may need more sweeps, because no body may visibly overlap another at the end.
  for (int extra = 0;
       moved && extra < std::min(options_.extra_sweeps, affordable) && deepest_overlap() > kMaxVisibleOverlap;
       ++extra) {
    stalling_ = extra >= kSweepsBeforeStall;
    moved = sweep_all();
  }
  change_velocities();
  bounce();
  measure_forces();
}

bool ContactSolver::sweep_all() {
  for (const int i : buffers_.blocked) buffers_.blocks[i].clear();
  buffers_.blocked.clear();
  bool moved = false;
  for (Buffers::Pair& pair : buffers_.pairs) moved = resolve(pair) || moved;
  return moved;
}

double ContactSolver::deepest_overlap() {
  double largest = 0.0;
  for (Buffers::Pair& pair : buffers_.pairs) largest = std::max(largest, overlap(pair).depth);
  return largest;
}

void ContactSolver::place(int object) {
  Buffers::Body& body = buffers_.bodies[object];
  if (bodies_.cells[object] != nullptr) {
    body.box = bodies_.cells[object]->bounds();
    body.placed = true;
    return;
  }
  const int row = first_ + object;
  const Vec2 origin = state_.pose[row].position(), heading = state_.heading(row);
  body.box = {};
  for (int p = bodies_.begin[object]; p < bodies_.begin[object + 1]; ++p) {
    const Convex& piece = bodies_.pieces[p];
    Box box;
    for (int v = piece.first; v < piece.first + piece.count; ++v) {
      buffers_.vertices[v] = origin + rotate(bodies_.vertices[v], heading);
      buffers_.normals[v] = rotate(bodies_.normals[v], heading);
      box.include(buffers_.vertices[v]);
    }
    if (piece.count == 1) box = box_around(buffers_.vertices[piece.first], piece.radius);
    buffers_.boxes[p] = box;
    body.box.include(box);
  }
  body.centroid = origin + rotate(bodies_.centroid[object], heading);
  body.placed = true;
}

void ContactSolver::place_moving() {
  buffers_.bodies.resize(world_.objects);
  buffers_.blocked.clear();
  if (buffers_.blocks.size() < buffers_.bodies.size()) buffers_.blocks.resize(buffers_.bodies.size());
  buffers_.vertices.resize(bodies_.vertices.size());
  buffers_.normals.resize(bodies_.vertices.size());
  buffers_.boxes.resize(bodies_.pieces.size());
  for (int i = 0; i < world_.objects; ++i) {
    Buffers::Body& body = buffers_.bodies[i];
    const BodyDynamics& dynamics = world_.dynamics[i];
    body.moves = 0;
    body.moved = {};
    body.turned = 0.0;
    body.placed = false;
    buffers_.blocks[i].clear();
    body.driven = dynamics.driven && dynamics.pushable;
    body.passive = !dynamics.driven && dynamics.pushable;
    body.start_velocity = world_.is_static[i] ? Vec2{} : velocity(i);
  }
  for (const int i : world_.moving) place(i);
}

void push_apart(const World& world, State& state, int w, Workspace& work) {
  const int parts = parts_of_step(world, state, w, work);
  const Resolution usual{32, 480, 1e-6, world.step_time / parts};
  if (parts == 1 && state.scenes[w].in_motion) {
    std::vector<Pose>& from = work.contacts.from;
    std::vector<double>& turned = work.contacts.turned;
    from.clear(), turned.clear();
    for (const Stride& stride : work.contacts.strides) from.push_back(stride.from), turned.push_back(stride.turn);
    push_and_hold(world, state, w, work, usual, {from, turned, 1});
  } else if (parts == 1) {
    push_apart(world, state, w, work, usual, nullptr);
  } else {
    push_in_parts(world, state, w, work, usual, parts);
  }
  update_contact_times(world, state, w);
}

void push_apart(const World& world, State& state, int w, Workspace& work, const Resolution& options,
                const std::vector<std::pair<int, int>>* pairs) {
  state.scenes[w].contacts.clear();
  bodies_of(world, state, w);
  ContactSolver(world, state, w, work, options).run(pairs);
}

}  // namespace irsim

// Rigid contacts of one world: what overlaps is pushed apart, sweep by sweep (reference: dynamics 12).
#include "contact/contact.hpp"

#include <algorithm>

#include "contact/bodies.hpp"
#include "contact/push.hpp"
#include "contact/respond.hpp"
#include "phases.hpp"

namespace irsim {
namespace {

constexpr double kResting = 1e-5;      // a smaller gap counts as contact [m]
constexpr double kStraight = 1e-6;     // a push this near to the centroid does not turn [m]
constexpr double kVisible = 5e-4;      // overlap that is not left while extra sweeps may help [m]
constexpr double kStill = 1e-12;       // smaller corrections are none [m]
constexpr int kPatient = 120;          // extra sweeps before drivers stall and wedged bodies stay put
constexpr int kMostPairs = 4'000'000;  // looked at in a step: hundreds of bodies in one place part over several steps

const Vec2 kAxes[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};  // normals of a box

using Buffers = ContactBuffers;

class Solver {
 public:
  Solver(const World& world, State& state, int w, Workspace& work, const Resolution& options)
      : options_(options),
        world_(world),
        state_(state),
        scene_(state.scenes[w]),
        bodies_(*scene_.bodies),
        work_(work),
        b_(work.contacts),
        first_(w * world.objects) {}

  void run(const std::vector<std::pair<int, int>>* given) {
    place_moving();
    if (given == nullptr) {
      find_pairs();
    } else {
      b_.found.clear();
      for (const auto& [i, j] : *given) note(i, j);
    }
    take_pairs(given != nullptr);
    if (b_.pairs.empty()) return;
    order_pairs(given != nullptr);
    bool moved = true;
    const int affordable = kMostPairs / static_cast<int>(b_.pairs.size()) + 1;
    for (int sweep = 0; moved && sweep < std::min(options_.sweeps, affordable); ++sweep) moved = sweep_all();
    // Jams of many bodies may need more; nobody may be left visibly inside another.
    for (int extra = 0; moved && extra < std::min(options_.extra_sweeps, affordable) && deepest() > kVisible; ++extra) {
      careful_ = extra >= kPatient;
      moved = sweep_all();
    }
    change_velocities();
    bounce();
    measure_forces();
  }

 private:
  bool sweep_all() {
    for (const int i : b_.blocked) b_.blocks[i].clear();
    b_.blocked.clear();
    bool moved = false;
    for (Buffers::Pair& pair : b_.pairs) moved = resolve(pair) || moved;
    return moved;
  }

  double deepest() {
    double most = 0.0;
    for (Buffers::Pair& pair : b_.pairs) most = std::max(most, overlap(pair).depth);
    return most;
  }

  struct Share {
    Vec2 direction;      // of the translation per unit of scale and inverse mass
    double translation;  // along the normal
    double turn;         // per unit of scale [rad]
    double rotation;     // along the normal
    double total() const { return translation + rotation; }
  };

  // where things are ------------------------------------------------------------------------------------------------
  void place(int object) {
    Buffers::Body& body = b_.bodies[object];
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
        b_.vertices[v] = origin + rotate(bodies_.vertices[v], heading);
        b_.normals[v] = rotate(bodies_.normals[v], heading);
        box.include(b_.vertices[v]);
      }
      if (piece.count == 1) box = box_around(b_.vertices[piece.first], piece.radius);
      b_.boxes[p] = box;
      body.box.include(box);
    }
    body.centroid = origin + rotate(bodies_.centroid[object], heading);
    body.placed = true;
  }

  void place_moving() {
    b_.bodies.resize(world_.objects);
    b_.blocked.clear();
    if (b_.blocks.size() < b_.bodies.size()) b_.blocks.resize(b_.bodies.size());
    b_.vertices.resize(bodies_.vertices.size());
    b_.normals.resize(bodies_.vertices.size());
    b_.boxes.resize(bodies_.pieces.size());
    for (int i = 0; i < world_.objects; ++i) {
      Buffers::Body& body = b_.bodies[i];
      const Matter& matter = world_.matter[i];
      body.moves = 0;
      body.moved = {};
      body.turned = 0.0;
      body.placed = false;
      b_.blocks[i].clear();
      body.driven = matter.driven && matter.pushable;
      body.passive = !matter.driven && matter.pushable;
      body.start_velocity = world_.is_static[i] ? Vec2{} : velocity(i);
    }
    for (const int i : world_.moving) place(i);
  }

  // who may meet ------------------------------------------------------------------------------------------------------
  double margin() const {
    double fastest = 0.0;
    for (const int i : world_.moving) {
      double top = world_.matter[i].driven ? world_.vel_max[i][0] : 0.0;
      with(world_.drive[i], [&](const auto& drive) { top = travel_speed(drive, world_.vel_max[i]); });
      if (std::isfinite(top)) fastest = std::max(fastest, top);
      fastest = std::max(fastest, norm(b_.bodies[i].start_velocity));
    }
    return 2.0 * options_.step_time * fastest + 1e-6;
  }

  void note(int i, int j) {
    if (world_.unobstructed[i] || world_.unobstructed[j]) return;
    b_.found.emplace_back(std::min(i, j), std::max(i, j));
  }

  void find_pairs() {
    b_.found.clear();
    const double wide = margin();
    const auto widened = [](const Box& box, double by) {
      return Box{box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by};
    };
    if (!world_.fixed_objects.empty()) {
      for (const int i : world_.moving) {
        scene_.fixed->grid.query(widened(b_.bodies[i].box, wide), [&](int j) { note(i, j); });
      }
    }
    if (world_.moving.size() > 1) {
      scene_.sweep.pairs([&](int i) { return widened(b_.bodies[i].box, 0.5 * wide); },
                         [&](int i, int j) { note(i, j); });
    }
  }

  /// Each pair once, by ids or as given.
  void take_pairs(bool as_given) {
    b_.pairs.clear();
    if (!as_given) {
      std::sort(b_.found.begin(), b_.found.end());
      b_.found.erase(std::unique(b_.found.begin(), b_.found.end()), b_.found.end());
    }
    for (std::size_t k = 0; k < b_.found.size(); ++k) {
      const auto [i, j] = b_.found[k];
      if (!world_.matter[i].pushable && !world_.matter[j].pushable) continue;
      if (as_given && std::find(b_.found.begin(), b_.found.begin() + k, b_.found[k]) != b_.found.begin() + k) continue;
      b_.pairs.push_back({i, j, 0, 0, 0, false, {}, -1, 0.0, false, false});
      if (!b_.bodies[i].placed) place(i);
      if (!b_.bodies[j].placed) place(j);
    }
  }

  void pack() {
    b_.outer.resize(world_.objects);
    const Shapes& shapes = *scene_.shapes;
    for (int i = 0; i < world_.objects; ++i) {
      b_.outer[i] = world_.is_static[i] ? scene_.fixed->outlines.boxes[shapes.placed[i].object] : b_.bodies[i].box;
    }
    b_.packing.pack(b_.outer);
  }

  /// Pairs near immovable objects first, by how many objects away those are; then as given, or by the first id and, for
  /// its partners, in the order in which IR-SIM's index of boxes finds them.
  void order_pairs(bool as_given) {
    const int n = world_.objects;
    b_.first_link.assign(n + 1, 0);
    for (const Buffers::Pair& p : b_.pairs) ++b_.first_link[p.a], ++b_.first_link[p.b];
    int sum = 0;
    for (int& first : b_.first_link) sum += first, first = sum - first;
    b_.links.resize(2 * b_.pairs.size());
    b_.queue.assign(b_.first_link.begin(), b_.first_link.end());
    for (std::size_t k = 0; k < b_.pairs.size(); ++k) {
      b_.links[b_.queue[b_.pairs[k].a]++] = static_cast<int>(k);
      b_.links[b_.queue[b_.pairs[k].b]++] = static_cast<int>(k);
    }
    b_.distance.assign(n, n);
    b_.queue.clear();
    for (const Buffers::Pair& p : b_.pairs) {
      for (const int i : {p.a, p.b}) {
        if (world_.matter[i].pushable || b_.distance[i] == 0) continue;
        b_.distance[i] = 0;
        b_.queue.push_back(i);
      }
    }
    for (std::size_t head = 0; head < b_.queue.size(); ++head) {
      const int i = b_.queue[head];
      for (int k = b_.first_link[i]; k < b_.first_link[i + 1]; ++k) {
        const Buffers::Pair& p = b_.pairs[b_.links[k]];
        const int j = p.a == i ? p.b : p.a;
        if (b_.distance[j] <= b_.distance[i] + 1) continue;
        b_.distance[j] = b_.distance[i] + 1;
        b_.queue.push_back(j);
      }
    }
    for (Buffers::Pair& p : b_.pairs) p.order = b_.distance[p.a] + b_.distance[p.b];
    if (as_given) {
      std::stable_sort(b_.pairs.begin(), b_.pairs.end(),
                       [](const Buffers::Pair& p, const Buffers::Pair& q) { return p.order < q.order; });
    } else {
      pack();
      const std::vector<int>& rank = b_.packing.rank;
      std::sort(b_.pairs.begin(), b_.pairs.end(), [&](const Buffers::Pair& p, const Buffers::Pair& q) {
        return p.order != q.order ? p.order < q.order : p.a != q.a ? p.a < q.a : rank[p.b] < rank[q.b];
      });
    }
    for (std::size_t k = 0; k < b_.pairs.size(); ++k) {  // links again, in the new order
      if (k == 0) b_.queue.assign(b_.first_link.begin(), b_.first_link.end());
      b_.links[b_.queue[b_.pairs[k].a]++] = static_cast<int>(k);
      b_.links[b_.queue[b_.pairs[k].b]++] = static_cast<int>(k);
    }
  }

  // what overlaps -----------------------------------------------------------------------------------------------------
  Placed piece(int p) const {
    const Convex& c = bodies_.pieces[p];
    return {&b_.vertices[c.first], &b_.normals[c.first], c.count, c.radius};
  }

  const Overlap& overlap(Buffers::Pair& pair) {
    const Buffers::Body &a = b_.bodies[pair.a], &b = b_.bodies[pair.b];
    if (pair.known && pair.a_moves == a.moves && pair.b_moves == b.moves) return pair.overlap;
    pair.known = true;
    pair.a_moves = a.moves, pair.b_moves = b.moves;
    pair.overlap = {};
    const auto near = [](const Box& p, const Box& q) {
      return p.x0 - kResting <= q.x1 && q.x0 <= p.x1 + kResting && p.y0 - kResting <= q.y1 && q.y0 <= p.y1 + kResting;
    };
    if (!near(a.box, b.box)) return pair.overlap;
    if (bodies_.cells[pair.a] != nullptr) {
      pair.overlap = overlap_with_cells(pair.b, *bodies_.cells[pair.a]);
      pair.overlap.normal = pair.overlap.normal * -1.0;
      return pair.overlap;
    }
    if (bodies_.cells[pair.b] != nullptr) return pair.overlap = overlap_with_cells(pair.a, *bodies_.cells[pair.b]);
    for (int p = bodies_.begin[pair.a]; p < bodies_.begin[pair.a + 1]; ++p) {
      if (!near(b_.boxes[p], b.box)) continue;
      for (int q = bodies_.begin[pair.b]; q < bodies_.begin[pair.b + 1]; ++q) {
        if (!near(b_.boxes[p], b_.boxes[q])) continue;
        const Overlap found = overlap_of(piece(p), piece(q), kResting);
        if (found.depth > pair.overlap.depth) pair.overlap = found;
      }
    }
    return pair.overlap;
  }

  /// The deepest overlap of an object and the occupied cells of a map; cells of a row that lie side by side are one.
  Overlap overlap_with_cells(int object, const OccupancyGrid& grid) const {
    Overlap deepest;
    for (int p = bodies_.begin[object]; p < bodies_.begin[object + 1]; ++p) {
      const Box& box = b_.boxes[p];
      const auto column = [&](double x) { return cell_of(x - grid.origin().x, grid.cell().x, grid.columns()); };
      const auto row = [&](double y) { return cell_of(y - grid.origin().y, grid.cell().y, grid.rows()); };
      const int i0 = std::max(0, column(box.x0 - kResting) - 1);
      const int i1 = std::min(grid.columns() - 1, column(box.x1 + kResting) + 1);
      const int j0 = std::max(0, row(box.y0 - kResting)), j1 = std::min(grid.rows() - 1, row(box.y1 + kResting));
      for (int j = j0; j <= j1; ++j) {
        for (int first = grid.next_occupied(j, i0, i1); first >= 0;) {
          int last = first;
          while (last < i1 && grid.occupied(last + 1, j)) ++last;
          const Vec2 low = grid.corner(first, j), high = grid.corner(last + 1, j + 1);
          const Vec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
          const Overlap found = overlap_of(piece(p), {corners, kAxes, 4, 0.0}, kResting);
          if (found.depth > deepest.depth) deepest = found;
          first = last + 2 <= i1 ? grid.next_occupied(j, last + 2, i1) : -1;
        }
      }
    }
    return deepest;
  }
  static int cell_of(double offset, double size, int count) {
    return static_cast<int>(clip(std::floor(offset / size), -2.0, count + 2.0));
  }

  // who yields --------------------------------------------------------------------------------------------------------
  /// How far an object gives way along a unit direction, past what blocks it most.
  Share share_of(int object, Vec2 direction, Vec2 point) const {
    const double w = bodies_.inverse_mass[object];
    if (w == 0.0) return {};
    const Buffers::Body& body = b_.bodies[object];
    Vec2 free = direction;
    double into = -1e-9;
    for (const Buffers::Block& block : b_.blocks[object]) {  // the most in the way counts; the next sweep sees the rest
      const double against = dot(direction, block.normal);
      if (!(against < into)) continue;
      into = against;
      const Vec2 along = direction - block.normal * into;
      const bool sticks = body.passive && norm(along) <= -into * block.friction;
      free = sticks ? Vec2{} : along;
    }
    if (careful_) {
      for (const Buffers::Block& block : b_.blocks[object]) {
        if (dot(free, block.normal) < -1e-9) free = {};
      }
    }
    const double gain = std::max(0.0, dot(free, direction));
    double arm = cross(point - body.centroid, direction);
    if (std::fabs(arm) < kStraight) arm = 0.0;
    const double i = bodies_.inverse_inertia[object];
    return {free * w, gain * w, i * arm, i * arm * arm};
  }

  /// Ground friction of a body and of all that it pushes ahead of it [N].
  double load(int body, Vec2 direction) {
    b_.reached.assign(world_.objects, 0);
    b_.reached[body] = 1;
    b_.queue.assign(1, body);
    double sum = 0.0;
    for (std::size_t head = 0; head < b_.queue.size(); ++head) {
      const int i = b_.queue[head];
      sum += ground_friction(world_, i);
      for (int k = b_.first_link[i]; k < b_.first_link[i + 1]; ++k) {
        Buffers::Pair& p = b_.pairs[b_.links[k]];
        const int j = p.a == i ? p.b : p.a;
        if (b_.reached[j] || !b_.bodies[j].passive) continue;
        const Overlap& o = overlap(p);
        if (!(o.depth > -kResting)) continue;
        if (!(dot(p.a == i ? o.normal * -1.0 : o.normal, direction) > 1e-6)) continue;
        b_.reached[j] = 1;
        b_.queue.push_back(j);
      }
    }
    return sum;
  }

  bool resolve(Buffers::Pair& pair) {
    const Overlap o = overlap(pair);
    if (!(o.depth > -kResting)) return false;
    const int a = pair.a, b = pair.b;
    Share to_a = share_of(a, o.normal, o.point), to_b = share_of(b, o.normal * -1.0, o.point);
    if (b_.bodies[a].driven && b_.bodies[b].passive) settle(a, to_a, b, to_b, o.normal * -1.0);
    if (b_.bodies[b].driven && b_.bodies[a].passive) settle(b, to_b, a, to_a, o.normal);
    pair.a_yields = to_a.total() > 0.0, pair.b_yields = to_b.total() > 0.0;
    const double depth = o.depth + options_.slop, total = to_a.total() + to_b.total();
    note_contact(pair, o, depth);
    bool moved = false;
    if (depth > 0.0 && total > 0.0) {
      const double scale = depth / total;
      pair.scale += scale;
      if (pair.a_yields) displace(a, to_a.direction * scale, to_a.turn * scale);
      if (pair.b_yields) displace(b, to_b.direction * scale, to_b.turn * scale);
      moved = depth > kStill;
    }
    const double friction = 0.5 * (world_.matter[a].friction + world_.matter[b].friction);
    // What only turns is in the way all the same.
    if (!(to_b.translation > 0.0) && bodies_.inverse_mass[a] > 0.0) block(a, o.normal, friction);
    if (!(to_a.translation > 0.0) && bodies_.inverse_mass[b] > 0.0) block(b, o.normal * -1.0, friction);
    return moved;
  }

  void block(int object, Vec2 normal, double friction) {
    if (b_.blocks[object].empty()) b_.blocked.push_back(object);
    b_.blocks[object].push_back({normal, friction});
  }

  /// A driver with too little traction stalls; one with enough keeps its motion while the body can be shifted. A body
  /// that can only turn and a strong driver both give way. In a jam all drivers stall.
  void settle(int driver, Share& to_driver, int body, Share& to_body, Vec2 push) {
    if (careful_ || ground_friction(world_, driver) < load(body, push)) {
      to_body = {};
    } else if (to_body.translation > 1e-9 * bodies_.inverse_mass[body]) {
      to_driver = {};
    }
  }

  void displace(int object, Vec2 by, double turn) {
    shift(world_, state_, first_ + object, by, turn, bodies_.centroid[object]);
    Buffers::Body& body = b_.bodies[object];
    body.moved = body.moved + by;
    body.turned += turn;
    ++body.moves;
    place(object);
  }

  /// Displacements are velocities of this step.
  void change_velocities() {
    const double per_second = 1.0 / options_.step_time;
    for (const int i : world_.moving) {
      const Buffers::Body& body = b_.bodies[i];
      if (body.moves > 0) push(world_, state_, first_ + i, body.moved * per_second, body.turned * per_second);
    }
  }

  // what is told ------------------------------------------------------------------------------------------------------
  void note_contact(Buffers::Pair& pair, const Overlap& o, double depth) {
    if (pair.contact < 0) {
      pair.contact = static_cast<int>(scene_.contacts.size());
      scene_.contacts.push_back({pair.a, pair.b, o.normal + Vec2{}, depth, o.point, 0.0});  // no negative zeros
    } else if (Contact& known = scene_.contacts[pair.contact]; depth > known.depth) {
      known.normal = o.normal + Vec2{}, known.depth = depth, known.point = o.point;
    }
  }

  /// Passive bodies get the speed of separation that their bounciness asks for.
  void bounce() {
    b_.pair_of.resize(scene_.contacts.size());
    for (const Buffers::Pair& pair : b_.pairs) {
      if (pair.contact >= 0) b_.pair_of[pair.contact] = &pair;
    }
    for (std::size_t k = 0; k < scene_.contacts.size(); ++k) {
      const Contact& contact = scene_.contacts[k];
      const double e = 0.5 * (world_.matter[contact.a].restitution + world_.matter[contact.b].restitution);
      if (!(e > 0.0)) continue;
      const Buffers::Pair* pair = b_.pair_of[k];
      const auto weight = [&](int i, bool yields) {
        return yields && b_.bodies[i].passive ? bodies_.inverse_mass[i] : 0.0;
      };
      const double wa = weight(contact.a, pair->a_yields), wb = weight(contact.b, pair->b_yields);
      if (!(wa + wb > 0.0)) continue;
      const double before =
          dot(b_.bodies[contact.a].start_velocity - b_.bodies[contact.b].start_velocity, contact.normal);
      if (!(before < 0.0)) continue;
      const double missing = -e * before - dot(velocity(contact.a) - velocity(contact.b), contact.normal);
      if (!(missing > 0.0)) continue;
      const double impulse = missing / (wa + wb);
      if (wa > 0.0) push(world_, state_, first_ + contact.a, contact.normal * (wa * impulse), 0.0);
      if (wb > 0.0) push(world_, state_, first_ + contact.b, contact.normal * (-wb * impulse), 0.0);
    }
  }

  /// What the control gives at the present pose, world frame [m/s].
  Vec2 velocity(int object) {
    const int row = first_ + object;
    return velocity_of_control(world_, state_, row, state_.control[row], work_.neighbors.extra);
  }

  /// A driver that pushes into a contact cannot press harder than its traction.
  void measure_forces() {
    const double dt2 = options_.step_time * options_.step_time;
    for (const Buffers::Pair& pair : b_.pairs) {
      if (pair.contact < 0) continue;
      Contact& contact = scene_.contacts[pair.contact];
      contact.force = pair.scale / dt2;
      cap(contact, contact.a, contact.normal * -1.0);
      cap(contact, contact.b, contact.normal);
    }
  }
  void cap(Contact& contact, int object, Vec2 into) {
    if (!b_.bodies[object].driven) return;
    const int row = first_ + object;
    const Vec2 wanted = is_native(world_.drive[object])
                            ? velocity_of_control(world_, state_, row, state_.drive[row], work_.neighbors.extra)
                            : b_.bodies[object].start_velocity;
    if (dot(wanted, into) > 0.0) contact.force = std::min(contact.force, ground_friction(world_, object));
  }

  const Resolution& options_;
  const World& world_;
  State& state_;
  Scene& scene_;
  const Bodies& bodies_;
  Workspace& work_;
  Buffers& b_;
  int first_;
  bool careful_ = false;  // in extra sweeps nobody is pushed into anything and drivers stall
};

/// How long each object touches something, or nothing.
void keep_time(const World& world, State& state, int w) {
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

void push_apart(const World& world, State& state, int w, Workspace& work) {
  const Resolution usual{32, 480, 1e-6, world.step_time};
  push_apart(world, state, w, work, usual, nullptr);
  keep_time(world, state, w);
}

void push_apart(const World& world, State& state, int w, Workspace& work, const Resolution& options,
                const std::vector<std::pair<int, int>>* pairs) {
  state.scenes[w].contacts.clear();
  bodies_of(world, state, w);
  Solver(world, state, w, work, options).run(pairs);
}

}  // namespace irsim

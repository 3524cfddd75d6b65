// Contacts within a step that count as collisions (`world.contacts: swept`).
#include <algorithm>

#include "collision/touch.hpp"
#include "phases.hpp"
#include "phases/strides.hpp"

namespace irsim {
namespace {

constexpr double kApart = 1e-6;  // gap above which bodies are apart, far above rounding errors [m]

bool stops(const World& world, int object) {
  if (world.is_static[object] || world.unstoppable[object]) return false;
  return world.collision_mode == kStop || (world.collision_mode == kUnobstructedObstacles && world.is_robot[object]);
}

/// Find when a pair first touches, given when each object has stopped already. Afterwards, a pair of which neither
/// moves is left alone.
void examine(const World& world, State& state, int w, const std::vector<double>& until, NearPair& pair) {
  pair.when = kInfinity;
  if (until[pair.a] >= 1.0 && until[pair.b] >= 1.0 && !come_near(world, state, w, pair.a, pair.b)) return;
  Passage passage(world, state, w, pair.a, pair.b);
  double begin = 0.0;
  for (const int i : {pair.a, pair.b}) {
    if (until[i] >= 1.0) continue;
    passage.stop(i, until[i]);
    begin = std::max(begin, until[i]);
  }
  pair.when = passage.first_contact(begin, 1.0, pair.where);
  if (!(pair.when <= 1.0)) return;
  if ((begin == 0.0 && passage.in_contact(0.0)) || !passage.overlap_after(pair.when)) pair.when = kInfinity;
}

/// The pair that touches first and is not judged yet, or null.
NearPair* first_of(std::vector<NearPair>& pairs) {
  NearPair* first = nullptr;
  for (NearPair& pair : pairs) {
    if (!pair.judged && pair.when <= 1.0 && (first == nullptr || pair.when < first->when)) first = &pair;
  }
  return first;
}

/// Judge all pairs in the order of their contacts in time. An object that stops is in the way of the rest.
void judge_pairs(const World& world, State& state, int w, std::vector<double>& until) {
  std::vector<NearPair>& near = state.scenes[w].near;
  for (NearPair& pair : near) examine(world, state, w, until, pair);
  while (NearPair* hit = first_of(near)) {
    hit->judged = true;
    hit->begins = Passage(world, state, w, hit->a, hit->b).gap(0.0) > kApart;
    bool stopped[2] = {false, false};
    for (const int k : {0, 1}) {
      const int i = k == 0 ? hit->a : hit->b;
      if (!stops(world, i) || until[i] <= hit->when) continue;
      until[i] = hit->when;
      stopped[k] = true;
    }
    if (!stopped[0] && !stopped[1]) continue;
    const int a = hit->a, b = hit->b;
    for (NearPair& pair : near) {
      const bool meets_a = stopped[0] && (pair.a == a || pair.b == a),
                 meets_b = stopped[1] && (pair.a == b || pair.b == b);
      if (!pair.judged && (meets_a || meets_b) && pair.when > hit->when) examine(world, state, w, until, pair);
    }
  }
}

/// Put an object back to where it was at a time within the step.
void put_back(const World& world, State& state, int w, int object, double time) {
  const int row = w * world.objects + object;
  Pose pose = stride_of(world, state, w, object).at(time);
  pose.theta = into_range(wrap(pose.theta), world.angle_low[object], world.angle_high[object]);
  state.pose[row] = pose;
  for (int c = 0; c < 3; ++c) state.twist[row][c] *= time;  // the mean of the step
  if (!state.keep_history || state.history[row].empty()) return;
  double* last = state.history[row].data() + state.history[row].size() - 3 - state.extra_rows;
  last[0] = pose.x, last[1] = pose.y, last[2] = pose.theta;
}

bool is_same(const Pose& p, const Pose& q) { return p.x == q.x && p.y == q.y && p.theta == q.theta; }

}  // namespace

void judge(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  const int first = w * world.objects;
  std::sort(scene.near.begin(), scene.near.end(),
            [](const NearPair& p, const NearPair& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  std::vector<double>& until = scene.until;
  until.assign(world.objects, 1.0);
  if (scene.in_motion) judge_pairs(world, state, w, until);
  // Others pass on: their motions are described before any pose changes.
  for (const NearPair& pair : scene.near) {
    if (!pair.judged || until[pair.a] < 1.0 || until[pair.b] < 1.0) continue;
    const Passage passage(world, state, w, pair.a, pair.b);
    if (!passage.in_contact(1.0)) keep_meeting(world, state, w, passage, pair.when, pair.where);
  }
  for (const int i : world.moving) {
    if (until[i] < 1.0) put_back(world, state, w, i, until[i]);
  }
  place_moving(world, state, w);
  auto& held = scene.held;
  held.erase(std::remove_if(held.begin(), held.end(),
                            [&](const HeldPair& pair) {
                              return !is_same(state.pose[first + pair.a], pair.pose_a) ||
                                     !is_same(state.pose[first + pair.b], pair.pose_b);
                            }),
             held.end());
  for (const NearPair& pair : scene.near) {
    if (!pair.judged) continue;
    scene.pairs.emplace_back(pair.a, pair.b);
    if (until[pair.a] < 1.0 || until[pair.b] < 1.0)
      held.push_back({pair.a, pair.b, state.pose[first + pair.a], state.pose[first + pair.b]});
  }
  for (const HeldPair& pair : held) scene.pairs.emplace_back(pair.a, pair.b);
  for (const NearPair& pair : scene.near) {
    if (pair.judged) continue;
    const Footprint a = state.footprint(world, w, pair.a), b = state.footprint(world, w, pair.b);
    if (a.box.meets(b.box) && touch(a, b)) scene.pairs.emplace_back(pair.a, pair.b);
  }
}

}  // namespace irsim

#include "learning/learners.hpp"

#include <algorithm>

#include "phases.hpp"
#include "world/state.hpp"

namespace irsim {
namespace {

bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
bool is_same(const Goal& a, const Goal& b) {
  return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.theta, b.theta);
}

void command(const World& world, State& state, int w, int object, const double* wanted, const Commands& commands) {
  const int row = w * world.objects + object;
  state.given[row] = 1;
  if (commands.velocities) {
    const Vec2 velocity{wanted[0], wanted[1]};
    state.commanded[row] = velocity;
    command_velocity(world, state, w, object, velocity, {});
  } else {
    for (std::size_t k = 0; k < commands.width; ++k) state.command[row][k] = wanted[k];
  }
}

/// The terms of a learner and their sum.
void reward(const World& world, const State& state, const Learners& learners, std::size_t slot, int row, bool came,
            bool hit, const Outcome& out) {
  const std::size_t slots = learners.ended.size;
  const LearnerStep step{world.step_time,
                         learners.pose_before[slot],
                         state.pose[row],
                         learners.goal_before[slot],
                         came || !is_same(state.goal[row], learners.goal_before[slot]),
                         came,
                         hit,
                         learners.control_before[slot],
                         state.control[row],
                         state.vel_min[row],
                         state.vel_max[row],
                         state.twist[row][2],
                         {world, state, row, learners.kinds}};
  double sum = 0.0;
  for (std::size_t t = 0; t < learners.terms.size(); ++t) {
    double value = 0.0;
    with(learners.terms[t].first, [&](const auto& options) { value = learners.terms[t].second * run(options, step); });
    out.terms[t * slots + slot] = value;
    sum += value;
  }
  out.reward[slot] = sum;
}

void no_reward(const Learners& learners, std::size_t slot, const Outcome& out) {
  for (std::size_t t = 0; t < learners.terms.size(); ++t) out.terms[t * learners.ended.size + slot] = 0.0;
  out.reward[slot] = 0.0;
}

}  // namespace

Learners::Learners(const State& state, std::vector<int> indices_, std::vector<ObjectKind> kinds_,
                   std::vector<WeightedTerm> terms_, Ends ends_)
    : indices(std::move(indices_)), kinds(std::move(kinds_)), terms(std::move(terms_)), ends(ends_) {
  const std::size_t worlds = state.worlds, slots = worlds * each();
  taking_part = Array<std::uint8_t>(slots, 1);
  for (auto* flags : {&ended, &arrived, &collided}) *flags = Array<std::uint8_t>(slots);
  over = Array<std::uint8_t>(worlds);
  horizon = Array<std::int64_t>(worlds);
  pose_before.resize(slots), goal_before.resize(slots), control_before.resize(slots);
}

void begin_step(const World& world, State& state, Learners& learners, int w, const Commands* commands) {
  static constexpr double kNothing[3] = {0.0, 0.0, 0.0};
  for (std::size_t a = 0; a < learners.each(); ++a) {
    const std::size_t slot = w * learners.each() + a;
    const int object = learners.indices[a], row = w * world.objects + object;
    learners.pose_before[slot] = state.pose[row];
    learners.goal_before[slot] = state.goal[row];
    learners.control_before[slot] = state.control[row];
    if (commands == nullptr) continue;
    const double* wanted = learners.ended[slot] ? kNothing : commands->numbers + slot * commands->width;
    command(world, state, w, object, wanted, *commands);
  }
}

void end_step(const World& world, const State& state, Learners& learners, int w, const Outcome& out) {
  const Ends& ends = learners.ends;
  const bool was_over = learners.over[w], all_ended = done(world, state, w);
  bool over = was_over || all_ended || state.count[w] >= learners.horizon[w], every = true, any = false, hits = false;
  const std::size_t first = w * learners.each(), last = first + learners.each();
  for (std::size_t slot = first; slot < last; ++slot) {
    const int row = w * world.objects + learners.indices[slot - first];
    const bool arrived = state.arrived[row], collided = state.collided[row];
    const bool active = !learners.ended[slot] && !was_over;
    const bool came = arrived && !learners.arrived[slot] && active;
    const bool hit = collided && !learners.collided[slot] && active;
    const bool terminated = active && ((ends.arrival && came) || (ends.collision && hit) || all_ended);
    learners.arrived[slot] |= arrived;
    learners.collided[slot] = collided;
    learners.ended[slot] |= terminated;
    out.active[slot] = active, out.arrived[slot] = came, out.collided[slot] = hit, out.terminated[slot] = terminated;
    if (active && learners.taking_part[slot]) {
      reward(world, state, learners, slot, row, came, hit, out);
    } else {
      no_reward(learners, slot, out);
    }
    every = every && learners.ended[slot], any = any || terminated, hits = hits || hit;
  }
  over = over || every || (ends.world == WorldEnds::any && any) || (ends.world == WorldEnds::collision && hits);
  for (std::size_t slot = first; slot < last; ++slot) {
    const bool truncated = over && out.active[slot] && !out.terminated[slot];
    out.truncated[slot] = truncated;
    learners.ended[slot] |= truncated;
  }
  learners.over[w] = out.over[w] = over;
}

}  // namespace irsim

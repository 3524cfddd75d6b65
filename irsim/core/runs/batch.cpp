#include "runs/batch.hpp"

#include <algorithm>

#include "runs/fetch_ahead.hpp"

namespace irsim {
namespace {

void record(const World& world, const State& state, int w, Recording& out, Scans scans) {
  const std::size_t n = world.objects, first = w * n, beams = world.beams_per_world;
  out.pose.insert(out.pose.end(), state.pose.data + first, state.pose.data + first + n);
  out.control.insert(out.control.end(), state.control.data + first, state.control.data + first + n);
  out.goal.insert(out.goal.end(), state.goal.data + first, state.goal.data + first + n);
  out.arrived.insert(out.arrived.end(), state.arrived.data + first, state.arrived.data + first + n);
  out.collided.insert(out.collided.end(), state.collided.data + first, state.collided.data + first + n);
  out.stopped.insert(out.stopped.end(), state.stopped.data + first, state.stopped.data + first + n);
  if (scans.ranges)
    out.ranges.insert(out.ranges.end(), state.ranges.data + w * beams, state.ranges.data + (w + 1) * beams);
  if (scans.returns) {
    for (std::size_t b = w * beams; b < (w + 1) * beams; ++b) out.returns.push_back(returned_range(state, b));
  }
}

long long run_world(const World& world, State& state, int w, Workspace& work, const Schedule& schedule,
                    Recording* recording, Scans scans) {
  long long executed = 0;
  while (executed < schedule.steps && !(schedule.until_done && done(world, state, w))) {
    step_and_log(world, state, w, work, schedule.external);
    ++executed;
    if (recording != nullptr) record(world, state, w, *recording, scans);
  }
  if (recording != nullptr) recording->steps = executed;
  return executed;
}

}  // namespace

int hire(State& state, int threads) {
  const int hired = state.crew.hire(std::min(threads, state.worlds));
  while (static_cast<int>(state.workspaces.size()) < hired) state.workspaces.emplace_back();
  return hired;
}

void step_and_log(const World& world, State& state, int w, Workspace& work, bool external) {
  step(world, state, w, work, external);
  if (w == 0 && state.record) state.record->add(state);
}

long long run_worlds(const World& world, State& state, const Schedule& schedule, std::vector<Recording>* recordings,
                     Scans scans) {
  const int threads = hire(state, schedule.threads);
  std::vector<long long> most(threads, 0);
  in_shares(state.crew, state.worlds, threads, [&](std::size_t first, std::size_t last, int t) {
    for (std::size_t w = first; w < last; ++w) {
      Recording* recording = recordings != nullptr ? &(*recordings)[w] : nullptr;
      if (schedule.steps == 1) fetch_ahead(state, static_cast<int>(w), static_cast<int>(last));
      most[t] = std::max(most[t],
                         run_world(world, state, static_cast<int>(w), state.workspaces[t], schedule, recording, scans));
    }
  });
  return *std::max_element(most.begin(), most.end());
}

}  // namespace irsim

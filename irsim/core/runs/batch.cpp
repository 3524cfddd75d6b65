#include "runs/batch.hpp"

#include <atomic>
#include <exception>

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
    step(world, state, w, work, schedule.external);
    ++executed;
    if (w == 0 && state.record) state.record->add(state);
    if (recording != nullptr) record(world, state, w, *recording, scans);
  }
  if (recording != nullptr) recording->steps = executed;
  return executed;
}

}  // namespace

long long run_worlds(const World& world, State& state, const Schedule& schedule, std::vector<Recording>* recordings,
                     Scans scans) {
  const auto run_one = [&](int w, int last, Workspace& work) {  // `last`: end of the worlds that this thread runs
    Recording* recording = recordings != nullptr ? &(*recordings)[w] : nullptr;
    if (schedule.steps == 1) fetch_ahead(state, w, last);
    return run_world(world, state, w, work, schedule, recording, scans);
  };
  const int threads = state.crew.hire(std::min(schedule.threads, state.worlds));
  while (static_cast<int>(state.workspaces.size()) < threads) state.workspaces.emplace_back();
  if (threads == 1) {
    long long most = 0;
    for (int w = 0; w < state.worlds; ++w) most = std::max(most, run_one(w, state.worlds, state.workspaces[0]));
    return most;
  }
  // Each thread begins with the same worlds in every call, because their memory is then in the caches of its processor,
  // and goes on with what others have left.
  std::vector<std::atomic<int>> next(threads);
  const auto begin_of = [&](int t) { return static_cast<int>(static_cast<long long>(state.worlds) * t / threads); };
  for (int t = 0; t < threads; ++t) next[t] = begin_of(t);
  std::vector<long long> most(threads, 0);
  std::vector<std::exception_ptr> errors(threads);
  const int share = std::max(1, state.worlds / (8 * threads));
  state.crew.run(threads, [&](int t) {
    try {
      for (int k = 0; k < threads; ++k) {
        const int part = (t + k) % threads, end = begin_of(part + 1);
        for (int first = next[part].fetch_add(share); first < end; first = next[part].fetch_add(share)) {
          const int last = std::min(first + share, end);
          for (int w = first; w < last; ++w) most[t] = std::max(most[t], run_one(w, last, state.workspaces[t]));
        }
      }
    } catch (...) {
      errors[t] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  return *std::max_element(most.begin(), most.end());
}

}  // namespace irsim

#include "bindings/bound_state.hpp"

#include "world/exchange.hpp"

namespace irsim {
namespace {

State make_state(const World& world, const Seeds& seeds, bool history) {
  if (static_cast<int>(seeds.shape(0)) != world.copies) throw nb::value_error("one seed per world is needed");
  return State(world, seeds.data(), history);
}

}  // namespace

BoundState::BoundState(World& world_, const Seeds& seeds, bool history)
    : world(&world_), state(make_state(world_, seeds, history)) {
  expose();
}

BoundState::BoundState(World& world_, const BoundState& before, const std::vector<std::pair<BoundState*, int>>& origins)
    : world(&world_), state(world_, before.state.seed.data, before.state.keep_history, false) {
  if (world_.copies != 1 || before.world->copies != 1) throw nb::value_error("only single worlds can be continued");
  if (static_cast<int>(origins.size()) != world_.objects) throw nb::value_error("one origin per object is needed");
  before.check_idle();
  std::vector<Origin> from;
  for (const auto& [source, object] : origins) {
    source->check_row(object);
    from.push_back({source->world, &source->state, object});
  }
  continue_from(world_, state, *before.world, before.state, from);
  expose();
}

void BoundState::expose() {
  const std::size_t rows = state.rows, worlds = state.worlds, beams = state.ranges.size;
  const std::size_t extra_rows = state.extra_rows;
  pose = view<double>(state.pose.memory, {rows, 3});
  extra = view<double>(state.extra.memory, {rows, extra_rows});
  control = view<double>(state.control.memory, {rows, 3});
  twist = view<double>(state.twist.memory, {rows, 3});
  command = view<double>(state.command.memory, {rows, 3});
  commanded = view<double>(state.commanded.memory, {rows, 2});
  drive = view<double>(state.drive.memory, {rows, 3});
  actuated = view<double>(state.actuated.memory, {state.actuated.size, sizeof(Actuated) / sizeof(double)});
  contact_time = view<double>(state.contact_time.memory, {rows});
  air_time = view<double>(state.air_time.memory, {rows});
  touching = view<std::uint8_t>(state.touching.memory, {rows});
  given = view<std::uint8_t>(state.given.memory, {rows});
  arrived = view<std::uint8_t>(state.arrived.memory, {rows});
  believes_arrived = view<std::uint8_t>(state.believes_arrived.memory, {rows});
  collided = view<std::uint8_t>(state.collided.memory, {rows});
  stopped = view<std::uint8_t>(state.stopped.memory, {rows});
  radius = view<double>(state.radius.memory, {rows});
  vel_min = view<double>(state.vel_min.memory, {rows, 3});
  vel_max = view<double>(state.vel_max.memory, {rows, 3});
  acce = view<double>(state.acce.memory, {rows, 3});
  takes_part = view<std::uint8_t>(state.takes_part.memory, {rows});
  size_scale = view<double>(state.size_scale.memory, {rows});
  speed_scale = view<double>(state.speed_scale.memory, {rows});
  acceleration_scale = view<double>(state.acceleration_scale.memory, {rows});
  noise_scale = view<double>(state.noise_scale.memory, {rows});
  delay_scale = view<double>(state.delay_scale.memory, {rows});
  lag_scale = view<double>(state.lag_scale.memory, {rows});
  sensor_rate_scale = view<double>(state.sensor_rate_scale.memory, {rows});
  sensor_latency_scale = view<double>(state.sensor_latency_scale.memory, {rows});
  slip_scale = view<double>(state.slip_scale.memory, {rows});
  grip_scale = view<double>(state.grip_scale.memory, {rows});
  latency = view<std::int32_t>(state.latency.memory, {rows});
  level = view<std::int32_t>(state.level.memory, {worlds});
  variant = view<std::int32_t>(state.variant.memory, {worlds});
  pace = view<double>(state.pace.memory, {rows});
  start_step = view<std::int64_t>(state.start_step.memory, {rows});
  appeared = view<std::int64_t>(state.appeared.memory, {rows});
  infeasible = view<std::int32_t>(state.infeasible.memory, {rows});
  between_steps = view<std::int32_t>(state.between_steps.memory, {rows});
  goal = view<double>(state.goal.memory, {rows, 3});
  ranges = view<double>(state.ranges.memory, {beams});
  hits = view<std::int32_t>(state.hits.memory, {beams});
  valid = view<std::uint8_t>(state.valid.memory, {beams});
  beam_angles = view<double>(state.beam_angles.memory, {beams});
  velocities = view<double>(state.velocities.memory, {state.velocities.size});
  readings = view<double>(state.readings.memory, {state.readings.size});
  stamp = view<double>(state.stamp.memory, {worlds, world->sensors_per_world});
  const bool foggy = world->fog.has_value();
  const std::size_t columns = foggy ? world->fog->columns : 0, fog_rows = foggy ? world->fog->rows : 0;
  explored = view<std::uint8_t>(state.explored.memory, {worlds, columns, fog_rows});
  count = view<std::int64_t>(state.count.memory, {worlds});
  scene = view<std::uint32_t>(state.scene_index.memory, {worlds});
  noise = view<std::uint32_t>(state.noise.memory, {worlds});
  seed = view<std::uint64_t>(state.seed.memory, {worlds});
  failed_placement = view<std::int32_t>(state.failed_placement.memory, {worlds});
}

State& BoundState::of(const World& named) {
  if (&named != world) throw nb::value_error("this state belongs to another world");
  return state;
}
void BoundState::check_idle() const {
  if (busy) throw std::runtime_error("this simulation is in use by another thread: give each thread its own");
}
void BoundState::check_row(int row) const {
  check_idle();
  if (row < 0 || row >= state.rows) throw nb::index_error("no such row");
}
void BoundState::check_world(int w) const {
  check_idle();
  if (w < 0 || w >= state.worlds) throw nb::index_error("no such world");
}
void BoundState::check_mask(const Mask& mask) const {
  if (static_cast<int>(mask.shape(0)) != state.worlds) throw nb::value_error("the mask needs one flag per world");
}

}  // namespace irsim

#include "world/variation.hpp"

#include <algorithm>
#include <cmath>

#include "world/spec.hpp"
#include "world/state.hpp"

namespace irsim {
namespace {

constexpr std::uint64_t kRankDraw = 8;  // of the order in which objects take part; all others are of quantities
constexpr int kWholeWorld = -1;         // stands for an object in draws that belong to none

/// The number of the draw of a quantity.
std::uint64_t draw_of(Quantity quantity) {
  const auto number = static_cast<std::uint64_t>(quantity);
  return number < kRankDraw ? number : number + 1;
}

double drawn_number(double draw, const Variation& v) {
  return std::min(v.high, v.low + std::floor(draw * (v.high - v.low + 1.0)));
}

/// Let a drawn number of objects take part, the lowest ranks first.
void choose(const World& world, State& state, int w, const Variation& v, double number, const Key& key) {
  std::vector<std::pair<double, int>> order;
  for (const int i : v.objects)
    order.emplace_back(Draws(key, Stream::task, world.number[i]).uniform(kRankDraw), world.number[i]);
  std::vector<std::pair<double, int>> ranked = order;
  std::sort(ranked.begin(), ranked.end());
  const std::size_t count = std::min(static_cast<std::size_t>(number), ranked.size());
  for (std::size_t k = 0; k < v.objects.size(); ++k)
    state.takes_part[w * world.objects + v.objects[k]] = count > 0 && order[k] <= ranked[count - 1];
}

void set(State& state, int row, Quantity quantity, double value) {
  switch (quantity) {
    case Quantity::number:
      break;
    case Quantity::size:
      state.size_scale[row] = value;
      break;
    case Quantity::speed:
      state.speed_scale[row] = value;
      break;
    case Quantity::acceleration:
      state.acceleration_scale[row] = value;
      break;
    case Quantity::sensor_noise:
      state.noise_scale[row] = value;
      break;
    case Quantity::latency:
      state.latency[row] = static_cast<std::int32_t>(value);
      break;
    case Quantity::delay:
      state.delay_scale[row] = value;
      break;
    case Quantity::lag:
      state.lag_scale[row] = value;
      break;
    case Quantity::sensor_rate:
      state.sensor_rate_scale[row] = value;
      break;
    case Quantity::sensor_latency:
      state.sensor_latency_scale[row] = value;
      break;
    case Quantity::slip:
      state.slip_scale[row] = value;
      break;
    case Quantity::grip:
      state.grip_scale[row] = value;
      break;
  }
}

}  // namespace

void vary(const World& world, State& state, int w) {
  if (world.levels.empty()) return;
  const int first = w * world.objects;
  for (int row = first; row < first + world.objects; ++row) {
    state.takes_part[row] = 1;
    state.size_scale[row] = state.speed_scale[row] = state.acceleration_scale[row] = state.noise_scale[row] = 1.0;
    state.delay_scale[row] = state.lag_scale[row] = 1.0;
    state.sensor_rate_scale[row] = state.sensor_latency_scale[row] = 1.0;
    state.slip_scale[row] = state.grip_scale[row] = 1.0;
    state.latency[row] = 0;
  }
  const Key key = make_key(state.seed[w], state.scene_index[w], 0);
  const Level& level = world.levels[std::clamp(state.level[w], 0, static_cast<int>(world.levels.size()) - 1)];
  state.variant[w] = -1;
  if (level.variants > 0) {
    const double u = Draws(key, Stream::task, kWholeWorld).uniform(0);
    state.variant[w] = level.first_variant + std::min(level.variants - 1, static_cast<int>(u * level.variants));
  }
  for (const Variation& v : level.variations) {
    if (v.objects.empty()) continue;
    const auto draw = [&](int number) { return Draws(key, Stream::task, number).uniform(draw_of(v.quantity)); };
    const bool whole = v.quantity == Quantity::number || v.quantity == Quantity::latency;
    const auto value = [&](int number) {
      return whole ? drawn_number(draw(number), v) : v.low + (v.high - v.low) * draw(number);
    };
    int eldest = world.number[v.objects.front()];  // whose draw the objects share
    for (const int i : v.objects) eldest = std::min(eldest, world.number[i]);
    if (v.quantity == Quantity::number) {
      choose(world, state, w, v, value(eldest), key);
      continue;
    }
    for (const int i : v.objects) set(state, first + i, v.quantity, value(v.same ? eldest : world.number[i]));
  }
}

const World& variant_of(const World& world, const State& state, int w) {
  return world.variants.empty() || state.variant[w] < 0 ? world : *world.variants[state.variant[w]];
}

}  // namespace irsim

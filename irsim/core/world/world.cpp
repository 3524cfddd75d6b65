#include "world/world.hpp"

#include <algorithm>
#include <stdexcept>

#include "collision/touch.hpp"
#include "world/features.hpp"
#include "world/mounts.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

constexpr double kDiscCell = 2.0;  // cell size of the grid of static circles [m]

Vec3 padded(const std::vector<double>& values) {
  Vec3 out;
  for (std::size_t c = 0; c < 3 && c < values.size(); ++c) out[static_cast<int>(c)] = values[c];
  return out;
}

Pose pose_of(const std::vector<double>& values) {
  const Vec3 v = padded(values);
  return {v[0], v[1], v[2]};
}

bool is_random(const ObjectSpec& spec) {
  for (const PartSpec& part : spec.parts) {
    if (std::visit([](const auto& shape) { return is_drawn(shape); }, part)) return true;
  }
  return false;
}

bool same_behavior(const Behavior& a, const Behavior& b) {
  bool equal = false;
  with(a, [&](const auto& options) {
    const auto* other = std::get_if<std::decay_t<decltype(options)>>(&b);
    equal = other != nullptr && same(options, *other);
  });
  return equal;
}

void add_to_group(World& world, int object, const ObjectSpec& spec) {
  if (std::holds_alternative<std::monostate>(spec.behavior)) return;
  for (BehaviorGroup& group : world.behaviors) {
    if (group.group == spec.group && group.grouped == spec.grouped && same_behavior(group.behavior, spec.behavior)) {
      group.objects.push_back(object);
      return;
    }
  }
  world.behaviors.push_back({spec.behavior, spec.group, spec.grouped, {object}, {}});
}

void find_members(World& world) {
  for (BehaviorGroup& group : world.behaviors) {
    group.members = group.objects;
    if (!group.grouped) continue;
    group.members.clear();
    for (int i = 0; i < world.objects; ++i) {
      if (world.group[i] == group.group) group.members.push_back(i);
    }
  }
}

Actuators make_actuators(const ObjectSpec& spec, double step_time) {
  Actuators made;
  made.options = *spec.actuation;
  made.period = spec.actuation->command_period / step_time;
  for (int c = 0; c < 3; ++c) {
    made.delay[c] = spec.actuation->delay[c] / step_time;
    made.noisy = made.noisy || spec.actuation->noise[c] > 0.0;
  }
  return made;
}

/// Give each object the queue that its longest dead time needs.
void lay_out_queues(World& world) {
  std::vector<double> scale(world.actuators.size(), 1.0);
  for (const Level& level : world.levels) {
    for (const Variation& v : level.variations) {
      if (v.quantity != Quantity::delay || scale.empty()) continue;
      for (const int i : v.objects) scale[i] = std::max(scale[i], v.high);
    }
  }
  world.queue_slots = 0;
  for (std::size_t i = 0; i < scale.size(); ++i) {
    Actuators& actuators = world.actuators[i];
    const double longest = scale[i] * std::max({actuators.delay[0], actuators.delay[1], actuators.delay[2]});
    actuators.first = world.queue_slots;
    actuators.slots = longest > 0.0 ? 2 + static_cast<std::int64_t>(std::ceil(longest)) : 0;
    world.queue_slots += static_cast<std::size_t>(actuators.slots);
  }
}

void check(const ObjectSpec& spec) {
  if (spec.parts.empty()) throw std::invalid_argument("an object needs at least one part");
  if (!spec.timing.empty() && spec.timing.size() != spec.sensors.size())
    throw std::invalid_argument("there must be one timing for each sensor");
  if (std::any_of(spec.timing.begin(), spec.timing.end(),
                  [](const SensorTiming& t) { return !(t.rate >= 0.0 && t.latency >= 0.0 && t.latency < 1e6); }))
    throw std::invalid_argument("a rate and a latency must not be negative");
  if (spec.angle_range.size() != 2) throw std::invalid_argument("angle_range must have two numbers");
  if (std::isnan(spec.angle_range[0]) || std::isnan(spec.angle_range[1]) || spec.angle_range[0] >= spec.angle_range[1])
    throw std::invalid_argument("angle_range must be an interval");
  if (!(spec.mass > 0.0)) throw std::invalid_argument("mass must be positive");
}

/// Place the static objects at their poses, in outlines and in the grid that finds them.
void place_all(const World& world, const Shapes& shapes, const std::vector<Pose>& poses, Outlines& outlines,
               Grid& grid) {
  outlines.resize(shapes.size[1]);
  grid.clear(world.cell(shapes, world.fixed_objects));
  for (std::size_t k = 0; k < world.fixed_objects.size(); ++k) {
    const int i = world.fixed_objects[k];
    outlines.place(shapes, i, poses[k], unit(poses[k].theta));
    grid.add(i, outlines.boxes[shapes.placed[i].object]);
  }
  grid.build();
}

}  // namespace

World::World(double step_time_, int collision_mode_, double gravity_, std::vector<ObjectSpec> specs_,
             std::vector<Placement> placements_, int copies_, std::optional<Fog> fog_,
             std::vector<Perturbation> perturbations_, Zones zones_, std::vector<View> views_,
             const std::vector<int>& targets)
    : step_time(step_time_),
      collision_mode(collision_mode_),
      gravity(gravity_),
      copies(copies_),
      objects(static_cast<int>(specs_.size())),
      extra_rows(1),
      specs(std::move(specs_)),
      fog(std::move(fog_)),
      placements(std::move(placements_)),
      perturbations(std::move(perturbations_)),
      zones(std::move(zones_)),
      wheels_slip(!zones.grounds.empty()),
      views(std::move(views_)),
      is_target(objects, 0) {
  if (copies < 0) throw std::invalid_argument("copies must not be negative");
  for (const View& view : views) {
    if (view.object < 0 || view.object >= objects)
      throw std::invalid_argument("a field of view names an object that does not exist");
  }
  for (const int i : targets) {
    if (i < 0 || i >= objects) throw std::invalid_argument("a target is an object that does not exist");
    is_target[i] = 1;
  }
  bool random_shapes = false, random_statics = false;
  for (const Placement& placement : placements) {
    for (const int i : placed_objects(placement)) {
      if (i < 0 || i >= objects) throw std::invalid_argument("a placement names an object that does not exist");
      random_statics = random_statics || specs[i].is_static;
    }
  }
  paced.resize(specs.size());
  for (const Perturbation& each : perturbations) {
    if (each.object < 0 || each.object >= objects)
      throw std::invalid_argument("a perturbation names an object that does not exist");
    for (const int c : each.speeds) {
      if (c < 0 || c > 2) throw std::invalid_argument("a perturbation names a control that does not exist");
      paced[each.object][c] = true;
    }
    random_statics = random_statics || (specs[each.object].is_static && each.moves());
  }
  std::stable_partition(perturbations.begin(), perturbations.end(),
                        [&](const Perturbation& each) { return specs[each.object].is_static; });
  for (int i = 0; i < objects; ++i) {
    const ObjectSpec& s = specs[i];
    check(s);
    if (s.route && std::any_of(s.route->avoid.begin(), s.route->avoid.end(),
                               [&](int zone) { return zone < 0 || zone >= zones.count(); }))
      throw std::invalid_argument("an object avoids a zone that does not exist");
    random_shapes = random_shapes || is_random(s);
    is_robot.push_back(s.role == 0);
    is_static.push_back(s.is_static);
    behaves.push_back(!std::holds_alternative<std::monostate>(s.behavior));
    unobstructed.push_back(s.unobstructed);
    wander.push_back(s.wander);
    loop.push_back(s.loop);
    state_arrival.push_back(s.arrive_mode == 1);
    target_roles.push_back(static_cast<std::uint8_t>(s.target_roles));
    group.push_back(s.group);
    number.push_back(s.number < 0 ? i : s.number);
    drive.push_back(s.drive);
    unstoppable.push_back(s.role == 1 && std::holds_alternative<ReplayOptions>(s.behavior));
    const bool pushable = !s.is_static && std::isfinite(s.mass) && !unstoppable.back();
    dynamics.push_back({s.mass, s.friction, s.inertia, s.restitution, s.tau, s.driven, pushable});
    vel_min.push_back(padded(s.vel_min));
    vel_max.push_back(padded(s.vel_max));
    acce.push_back(padded(s.acce));
    angle_low.push_back(s.angle_range[0]);
    angle_high.push_back(s.angle_range[1]);
    goal_threshold.push_back(s.perceives_estimate ? 0.5 * s.goal_threshold : s.goal_threshold);
    range_low.push_back(pose_of(s.range_low));
    range_high.push_back(pose_of(s.range_high));
    extra_rows = std::max(extra_rows, static_cast<int>(s.extra.size()));
    with(s.drive, [&](const auto& options) {
      extra_rows = std::max(extra_rows, rows(options).inner);
      wheels_slip = wheels_slip || rows(options).slides;
    });
    (s.is_static ? fixed_objects : moving).push_back(i);
    if (s.role == 0) robots.push_back(i);
    if (!s.unobstructed) visible.push_back(i);
    reflectivity.push_back(s.reflectivity);
    material.push_back(s.material);
    optics = optics || s.material != Material::matt;
    if (s.route && !s.is_static) routed.push_back(i);
    if (s.appear_step > 0) latecomers.push_back(i);
    if (s.vanish_step > 0) leavers.push_back(i);
    random_statics = random_statics || (s.is_static && s.appear_step > 0);
    has_actuators.push_back(s.actuation && s.driven && !s.is_static && !unstoppable.back());
    add_to_group(*this, i, s);
    add_scans(*this, i, s);
  }
  if (std::any_of(has_actuators.begin(), has_actuators.end(), [](std::uint8_t has) { return has != 0; })) {
    for (int i = 0; i < objects; ++i)
      actuators.push_back(has_actuators[i] ? make_actuators(specs[i], step_time) : Actuators{});
    lay_out_queues(*this);
  }
  if (std::any_of(specs.begin(), specs.end(),
                  [](const ObjectSpec& s) { return s.perceives_estimate || s.perceives_tracks; })) {
    for (int i = 0; i < objects; ++i) perception.push_back(perception_of(*this, i, specs[i]));
  }
  find_members(*this);
  if (fog) add_fog_beams(*this);
  if (random_shapes) return;
  shapes = make_shapes(*this, {});
  if (collision_mode == kContact) bodies = make_bodies(*this, *shapes);
  if (random_statics) return;
  std::vector<Pose> poses;
  for (const int i : fixed_objects) poses.push_back(pose_of(specs[i].pose));
  fixed = make_fixed(*this, *shapes, std::move(poses));
}

World::~World() = default;

void World::set_levels(std::vector<Level> given, const std::vector<std::vector<int>>& speeds) {
  if (speeds.size() != static_cast<std::size_t>(objects))
    throw std::invalid_argument("there must be one list of speeds for each object");
  for (const Level& level : given) {
    for (const Variation& v : level.variations) {
      for (const int i : v.objects) {
        if (i < 0 || i >= objects) throw std::invalid_argument("a variation names an object that does not exist");
        for (const int c : speeds[i]) {
          if (c < 0 || c > 2) throw std::invalid_argument("a speed is a control that does not exist");
          if (v.quantity == Quantity::speed) paced[i][c] = true;
        }
      }
    }
    const int last = level.first_variant + level.variants;
    if (level.variants < 0 || level.first_variant < 0 || last > static_cast<int>(variants.size()))
      throw std::invalid_argument("a level names a variant that does not exist");
  }
  levels = std::move(given);
  lay_out_queues(*this);
  lay_out_pending(*this);
}

void World::set_variants(std::vector<std::shared_ptr<World>> given) {
  for (const std::shared_ptr<World>& one : given) {
    if (!one || one->objects != objects || one->is_static != is_static || one->beams_per_world != beams_per_world ||
        one->extra_rows != extra_rows)
      throw std::invalid_argument("a variant has other objects");
  }
  variants = std::move(given);
}

double World::cell(const Shapes& of, const std::vector<int>& ids) const {
  if (ids.empty()) return 1.0;
  std::vector<double> radii;
  for (const int i : ids) {
    if (!of.is_map(i)) radii.push_back(of.radius[i]);
  }
  if (radii.empty()) return 1.0;
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return 3.0 * *middle;
}

std::shared_ptr<const Shapes> make_shapes(const World& world, Key key) {
  auto shapes = std::make_shared<Shapes>();
  for (int i = 0; i < world.objects; ++i) {
    const Draws draws(key, Stream::shape, world.number[i]);
    shapes->add(draw_outlines(world.specs[i].parts, draws), world.is_static[i] != 0);
  }
  return shapes;
}

std::shared_ptr<const Fixed> make_fixed(const World& world, const Shapes& shapes, std::vector<Pose> poses) {
  auto fixed = std::make_shared<Fixed>();
  fixed->poses = std::move(poses);
  place_all(world, shapes, fixed->poses, fixed->outlines, fixed->grid);
  if (auto seen = shapes.closed()) {
    auto closed = std::make_unique<Closed>();
    closed->shapes = std::move(seen);
    place_all(world, *closed->shapes, fixed->poses, closed->outlines, closed->grid);
    fixed->closed = std::move(closed);
  }
  std::vector<Vec2> centres;
  for (const int i : world.fixed_objects) {
    const Footprint body = fixed->outlines.footprint(shapes, i);
    if (body.count != 1 || body.parts[0].kind != Kind::circle) continue;
    fixed->disc_ids.push_back(i);
    centres.push_back(body.centre);
  }
  fixed->disc_points.build(centres, kDiscCell);
  fixed->walls = make_walls(world, shapes, *fixed);
  fixed->obstacles = make_obstacles(world, shapes, *fixed);
  for (const int i : world.fixed_objects) {
    const Footprint body = fixed->outlines.footprint(shapes, i);
    fixed->grid.query(body.box, [&](int j) {
      if (j > i && touch(body, fixed->outlines.footprint(shapes, j))) fixed->pairs.emplace_back(i, j);
    });
  }
  std::sort(fixed->pairs.begin(), fixed->pairs.end());
  return fixed;
}

}  // namespace irsim

// The traces of contacts: velocities, bounces, records and forces.
#include "contact/solver.hpp"

namespace irsim {

void ContactSolver::change_velocities() {
  const double per_second = 1.0 / options_.step_time;
  for (const int i : world_.moving) {
    const Buffers::Body& body = buffers_.bodies[i];
    if (body.moves == 0) continue;
    const double rate = per_second * counted(i, body.moved * per_second, body.turned * per_second);
    push(world_, state_, first_ + i, body.moved * rate, body.turned * rate);
  }
}

double ContactSolver::counted(int object, Vec2 change, double yaw_rate) const {
  if (!std::isfinite(options_.fastest)) return 1.0;
  const Vec3& twist = state_.twist[first_ + object];
  const double radius = scene_.shapes->radius[object];
  double share = 1.0;
  const auto speed = [&] {
    const Vec2 along{twist[0] + share * change.x, twist[1] + share * change.y};
    return std::max(norm(along), 0.5 * radius * std::fabs(twist[2] + share * yaw_rate));
  };
  while (share > options_.share && speed() > options_.fastest) share *= 0.5;
  return std::max(share, options_.share);
}

void ContactSolver::record_contact(Buffers::Pair& pair, const Overlap& o, double depth) {
  if (pair.contact < 0) {
    pair.contact = static_cast<int>(scene_.contacts.size());
    scene_.contacts.push_back({pair.a, pair.b, o.normal + Vec2{}, depth, o.point, 0.0});  // no negative zeros
  } else if (Contact& known = scene_.contacts[pair.contact]; depth > known.depth) {
    known.normal = o.normal + Vec2{}, known.depth = depth, known.point = o.point;
  }
}

void ContactSolver::bounce() {
  buffers_.pair_of.resize(scene_.contacts.size());
  for (const Buffers::Pair& pair : buffers_.pairs) {
    if (pair.contact >= 0) buffers_.pair_of[pair.contact] = &pair;
  }
  for (std::size_t k = 0; k < scene_.contacts.size(); ++k) {
    const Contact& contact = scene_.contacts[k];
    const double e = 0.5 * (world_.dynamics[contact.a].restitution + world_.dynamics[contact.b].restitution);
    if (!(e > 0.0)) continue;
    const Buffers::Pair* pair = buffers_.pair_of[k];
    const auto weight = [&](int i, bool yields) {
      return yields && buffers_.bodies[i].passive ? bodies_.inverse_mass[i] : 0.0;
    };
    const double wa = weight(contact.a, pair->a_yields), wb = weight(contact.b, pair->b_yields);
    if (!(wa + wb > 0.0)) continue;
    const double before =
        dot(buffers_.bodies[contact.a].start_velocity - buffers_.bodies[contact.b].start_velocity, contact.normal);
    if (!(before < 0.0)) continue;
    const double missing = -e * before - dot(velocity(contact.a) - velocity(contact.b), contact.normal);
    if (!(missing > 0.0)) continue;
    const double impulse = missing / (wa + wb);
    if (wa > 0.0) push(world_, state_, first_ + contact.a, contact.normal * (wa * impulse), 0.0);
    if (wb > 0.0) push(world_, state_, first_ + contact.b, contact.normal * (-wb * impulse), 0.0);
  }
}

Vec2 ContactSolver::velocity(int object) {
  const int row = first_ + object;
  return velocity_of_control(world_, state_, row, state_.control[row], work_.neighbors.extra);
}

void ContactSolver::measure_forces() {
  const double dt2 = options_.step_time * options_.step_time;
  for (const Buffers::Pair& pair : buffers_.pairs) {
    if (pair.contact < 0) continue;
    Contact& contact = scene_.contacts[pair.contact];
    contact.force = pair.scale / dt2;
    limit_force(contact, contact.a, contact.normal * -1.0);
    limit_force(contact, contact.b, contact.normal);
  }
}

void ContactSolver::limit_force(Contact& contact, int object, Vec2 into) {
  if (!buffers_.bodies[object].driven) return;
  const int row = first_ + object;
  const Vec2 wanted = is_native(world_.drive[object])
                          ? velocity_of_control(world_, state_, row, state_.drive[row], work_.neighbors.extra)
                          : buffers_.bodies[object].start_velocity;
  if (dot(wanted, into) > 0.0) contact.force = std::min(contact.force, ground_friction(world_, object));
}

}  // namespace irsim

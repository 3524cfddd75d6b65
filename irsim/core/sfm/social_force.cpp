#include "sfm/social_force.hpp"

#include "behaviors/sfm.hpp"

namespace irsim {
namespace {

constexpr double kSamePlace = 1e-6;  // two objects this close have no direction between them, and so no force [m]
constexpr double kStraight = 1e-12;  // smaller angles are rounding errors of an object straight ahead [rad]

constexpr double kOnLine = 1e-9;  // products of a distance and a speed below this are rounding errors [m^2/s]

}  // namespace

bool SocialForces::meets(std::size_t k, Vec2 velocity) const {
  const Vec2 way{way_x_[k], way_y_[k]}, faster{faster_x_[k], faster_y_[k]};
  return dot(faster, way) > kOnLine && std::fabs(cross(velocity, way)) <= kOnLine;
}

void SocialForces::clear(std::size_t most) {
  count_ = 0;
  if (way_x_.size() >= most) return;
  for (auto* column : {&way_x_, &way_y_, &faster_x_, &faster_y_, &distance_, &length_, &along_x_, &along_y_, &sine_,
                       &cosine_, &reach_, &decay_, &angle_, &force_x_, &force_y_})
    column->resize(most);
}

void SocialForces::compute(const SfmOptions& o, Vec2 velocity) {
  const double *way_x = way_x_.data(), *way_y = way_y_.data();
  const double *faster_x = faster_x_.data(), *faster_y = faster_y_.data();
  double *along_x = along_x_.data(), *along_y = along_y_.data(), *sine = sine_.data(), *cosine = cosine_.data();
  double *distances = distance_.data(), *lengths = length_.data(), *reaches = reach_.data(), *decay = decay_.data();
  const double importance = o.lambda_importance, gamma = o.gamma, safety = 2.0 * o.safety_radius;
  const std::size_t count = count_;
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep
#endif
  for (std::size_t k = 0; k < count; ++k) {
    const double distance = std::sqrt(way_x[k] * way_x[k] + way_y[k] * way_y[k]), near = 1.0 / distance;
    const double towards_x = way_x[k] * near, towards_y = way_y[k] * near;
    const double x = faster_x[k] * importance + towards_x, y = faster_y[k] * importance + towards_y;
    const double length = std::sqrt(x * x + y * y), scale = 1.0 / length;
    const double ahead_x = x * scale, ahead_y = y * scale, reach = gamma * length;
    const double gap = distance - safety;
    along_x[k] = ahead_x, along_y[k] = ahead_y;
    sine[k] = ahead_x * towards_y - ahead_y * towards_x;
    cosine[k] = ahead_x * towards_x + ahead_y * towards_y;
    distances[k] = distance, lengths[k] = length, reaches[k] = reach;
    decay[k] = -(gap < 0.0 ? 0.0 : gap) / reach;
  }
  for (std::size_t k = 0; k < count; ++k) angle_[k] = std::atan2(sine[k], cosine[k]);
  for (std::size_t k = 0; k < count; ++k) {
    if (distances[k] < kSamePlace || !(lengths[k] > 0.0)) {
      force_x_[k] = force_y_[k] = sine[k] = 0.0;
      continue;
    }
    const double angle = angle_[k];
    const double braking = o.n_velocity * reaches[k] * angle, turning = o.n_angular * reaches[k] * angle;
    // Straight ahead neither side is nearer: two that approach each other on one line both take the right.
    const double sign = angle > kStraight ? 1.0 : angle < -kStraight ? -1.0 : !o.sidestep && meets(k, velocity);
    const double f_velocity = -std::exp(decay[k] - braking * braking);
    const double f_angular = -sign * std::exp(decay[k] - turning * turning);
    const Vec2 along{along_x[k], along_y[k]};
    const Vec2 force = along * f_velocity + Vec2{-along.y, along.x} * f_angular;
    force_x_[k] = force.x, force_y_[k] = force.y;
  }
}

}  // namespace irsim

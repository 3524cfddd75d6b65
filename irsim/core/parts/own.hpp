// The robot itself: motion, size, limits.
#pragma once

#include <vector>

#include "fields.hpp"
#include "observing.hpp"

namespace irsim {

struct OwnOptions {
  enum Feature {
    kVx,
    kVy,
    kSpeed,
    kYawRate,
    kHeadingCos,
    kHeadingSin,
    kRadius,
    kSteering,
    kArrived,
    kControl,
    kLow,
    kHigh
  };
  std::vector<Feature> features;
  Frame frame;
  int controls;         // number of controls of the drive
  double speed_max;     // [m/s]
  double yaw_rate_max;  // [rad/s]
  double radius_max;    // [m]
  double steering_max;  // [rad]
  double limit_max;
  bool clip;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = OwnOptions;
    return visit(choices("features", &O::features, "vx", "vy", "speed", "yaw_rate", "heading_cos", "heading_sin",
                         "radius", "steering", "arrived", "control", "low", "high"),
                 choice("frame", &O::frame, "own", "goal", "world"), field("controls", &O::controls),
                 field("speed_max", &O::speed_max), field("yaw_rate_max", &O::yaw_rate_max),
                 field("radius_max", &O::radius_max), field("steering_max", &O::steering_max),
                 field("limit_max", &O::limit_max), field("clip", &O::clip));
  }
};

inline std::size_t members(const OwnOptions&) { return 0; }
inline std::size_t width(const OwnOptions& o) {
  std::size_t count = 0;
  for (const auto feature : o.features) count += feature >= OwnOptions::kControl ? o.controls : 1;
  return count;
}

/// A control between its limits: -1 at the lower one, 1 at the upper one, 0 where there is no such interval.
inline double between_limits(double control, double low, double high) {
  const double extent = high - low;
  if (!(std::isfinite(extent) && extent > 0.0)) return 0.0;
  return (control - (low + extent / 2.0)) / (extent / 2.0);
}

inline void own(const OwnOptions& o, const Seen& seen, double* out, std::uint8_t*) {
  const Vec2 axis = x_axis(o.frame, seen);
  const Vec2 velocity = unrotate(seen.velocity, axis), heading = facing(seen.ahead, axis);
  for (const auto feature : o.features) {
    switch (feature) {
      case OwnOptions::kVx:
        *out++ = share(velocity.x, o.speed_max, o.clip);
        break;
      case OwnOptions::kVy:
        *out++ = share(velocity.y, o.speed_max, o.clip);
        break;
      case OwnOptions::kSpeed:
        *out++ = share(norm(velocity), o.speed_max, o.clip);
        break;
      case OwnOptions::kYawRate:
        *out++ = share(seen.yaw_rate, o.yaw_rate_max, o.clip);
        break;
      case OwnOptions::kHeadingCos:
        *out++ = heading.x;
        break;
      case OwnOptions::kHeadingSin:
        *out++ = heading.y;
        break;
      case OwnOptions::kRadius:
        *out++ = share(seen.radius, o.radius_max, o.clip);
        break;
      case OwnOptions::kSteering:
        *out++ = share(seen.steering, o.steering_max, o.clip);
        break;
      case OwnOptions::kArrived:
        *out++ = seen.arrived;
        break;
      case OwnOptions::kControl:
        for (int c = 0; c < o.controls; ++c)
          *out++ = share(between_limits(seen.control[c], seen.low[c], seen.high[c]), 1.0, o.clip);
        break;
      case OwnOptions::kLow:
        for (int c = 0; c < o.controls; ++c) *out++ = share(seen.low[c], o.limit_max, o.clip);
        break;
      case OwnOptions::kHigh:
        for (int c = 0; c < o.controls; ++c) *out++ = share(seen.high[c], o.limit_max, o.clip);
        break;
    }
  }
}

}  // namespace irsim

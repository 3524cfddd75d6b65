// Points, poses and boxes of the plane.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace irsim {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTurn = 2.0 * kPi;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // stands for a missing number
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Vec2 {
  double x = 0, y = 0;
};

inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(Vec2 a, double k) { return {a.x * k, a.y * k}; }
inline double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
inline double squared(Vec2 a) { return dot(a, a); }
inline double norm(Vec2 a) { return std::sqrt(squared(a)); }

/// Turn `a` by the angle whose cosine and sine are `direction`.
inline Vec2 rotate(Vec2 a, Vec2 direction) {
  return {a.x * direction.x - a.y * direction.y, a.x * direction.y + a.y * direction.x};
}
/// Turn `a` back by the angle whose cosine and sine are `direction`.
inline Vec2 unrotate(Vec2 a, Vec2 direction) {
  return {a.x * direction.x + a.y * direction.y, a.y * direction.x - a.x * direction.y};
}
inline Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Three numbers of a control, limit or velocity. Their meaning depends on the drive.
struct Vec3 {
  double value[3] = {0, 0, 0};
  double& operator[](int i) { return value[i]; }
  double operator[](int i) const { return value[i]; }
};

/// Position [m] and heading [rad], world frame.
struct Pose {
  double x = 0, y = 0, theta = 0;
  Vec2 position() const { return {x, y}; }
};

struct Box {
  double x0 = kInfinity, y0 = kInfinity, x1 = -kInfinity, y1 = -kInfinity;

  void include(Vec2 p) {
    x0 = std::min(x0, p.x), y0 = std::min(y0, p.y);
    x1 = std::max(x1, p.x), y1 = std::max(y1, p.y);
  }
  void include(const Box& b) {
    x0 = std::min(x0, b.x0), y0 = std::min(y0, b.y0);
    x1 = std::max(x1, b.x1), y1 = std::max(y1, b.y1);
  }
  bool finite() const { return std::isfinite(x0) && std::isfinite(y0) && std::isfinite(x1) && std::isfinite(y1); }
  bool meets(const Box& b) const { return x0 <= b.x1 && b.x0 <= x1 && y0 <= b.y1 && b.y0 <= y1; }
};

inline Box box_around(Vec2 centre, double radius) {
  return {centre.x - radius, centre.y - radius, centre.x + radius, centre.y + radius};
}

inline Box grown(const Box& box, double by) { return {box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by}; }

/// ((a + pi) mod 2 pi) - pi, in [-pi, pi); 0 if `a` is not finite.
inline double wrap(double a) {
  double m = a + kPi;
  if (m >= 0.0 && m < kTurn) return m - kPi;
  if (!std::isfinite(a)) return 0.0;
  m = std::fmod(m, kTurn);
  if (m < 0.0) m += kTurn;
  if (m >= kTurn) m = 0.0;
  return m - kPi;
}

/// `a` shifted by full turns into the closed interval [low, high], where `high - low` is a full turn.
inline double into_range(double a, double low, double high) {
  if (!(a < low || a > high)) return a;
  if (std::fabs(a - low) > 8 * kTurn) a = low + wrap(a - low) + kPi;
  while (a > high) a -= kTurn;
  while (a < low) a += kTurn;
  return a;
}

/// Like numpy.clip: the result is `high` if the bounds cross.
inline double clip(double a, double low, double high) { return std::min(std::max(a, low), high); }

}  // namespace irsim

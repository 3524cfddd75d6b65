// A detector of people and robots with the tracker behind it: what is seen, where, how fast, and what is mistaken.
#pragma once

#include "fields.hpp"
#include "geometry/sector.hpp"
#include "sensing/gauges.hpp"
#include "sensing/view.hpp"
#include "surroundings/perception.hpp"

namespace irsim {

/// The roles that a detector looks for, as in `has_role`.
enum class Targets : std::uint8_t { all, robot, obstacle };

struct DetectorOptions {
  std::array<double, 3> offset;   // in the body frame [m, m, rad]
  double range_max, angle_range;  // reach [m] and full opening angle [rad]
  Targets targets;
  double probability;                 // of a detection in a measurement, near and in full sight
  double half_range, range_softness;  // where it has fallen to one half, and how gently [m]; 0: it does not fall
  bool occlusion;                     // whether others hide what stands behind them
  double min_visible;                 // share of an outline that must be in sight
  double position_std, velocity_std;  // of the noise [m], [m/s]
  double false_tracks;                // how many begin on average [1/s]
  double false_radius;                // of what they seem to be [m]
  double id_switches;                 // how often two near tracks take each other's id, on average [1/s]
  double keep;                        // time for which a track goes on without detections [s]
  int max_tracks;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using D = DetectorOptions;
    return visit(field("offset", &D::offset), field("range_max", &D::range_max), field("angle_range", &D::angle_range),
                 choice("targets", &D::targets, "all", "robot", "obstacle"), field("probability", &D::probability),
                 field("half_range", &D::half_range), field("range_softness", &D::range_softness),
                 field("occlusion", &D::occlusion), field("min_visible", &D::min_visible),
                 field("position_std", &D::position_std), field("velocity_std", &D::velocity_std),
                 field("false_tracks", &D::false_tracks), field("false_radius", &D::false_radius),
                 field("id_switches", &D::id_switches), field("keep", &D::keep), field("max_tracks", &D::max_tracks));
  }
};

/// The memory of a track, world frame: the numbers of `Track`, and how long ago it was detected [s].
constexpr int kTrackMemory = kTrack + 1;

inline std::vector<double> beams(const DetectorOptions&) { return {}; }
inline int readings(const DetectorOptions& o) { return kTrack * o.max_tracks; }
/// The next id, and the tracks.
inline int memory(const DetectorOptions& o) { return kGaugeMemory + 1 + kTrackMemory * o.max_tracks; }

/// Updates the tracks of one detector in one step.
class Tracker {
 public:
  Tracker(const DetectorOptions& o, const Sensing& s)
      : o_(o), s_(s), next_id_(s.memory[kGaugeMemory]), tracks_(s.memory + kGaugeMemory + 1) {
    const double heading = s.pose.theta + o.offset[2];
    eye_ = s.pose.position() + rotate({o.offset[0], o.offset[1]}, s.direction);
    sector_ = {eye_, heading, o.angle_range >= kTurn ? kPi : 0.5 * o.angle_range, o.range_max};
  }

  void start() {
    next_id_ = 0.0;
    for (int k = 0; k < o_.max_tracks; ++k) drop(k);
  }
  /// Move all tracks on, and drop the ones that were not detected for too long.
  void coast(double dt) {
    for (int k = 0; k < o_.max_tracks; ++k) {
      double* const track = at(k);
      if (std::isnan(track[kTrackId])) continue;
      track[kTrackX] += dt * track[kTrackSpeedX], track[kTrackY] += dt * track[kTrackSpeedY];
      track[kTrack] += dt;
      if (track[kTrack] > o_.keep + 1e-9) drop(k);
    }
  }
  void detect() {
    for (const int i : s_.world.moving) {
      if (i == s_.mount.object || !is_target(i) || s_.state.absent(s_.w * s_.world.objects + i)) continue;
      const auto [centre, radius] = s_.bounds(i);
      if (norm(centre - eye_) - radius > o_.range_max) continue;
      const std::uint64_t draw = s_.scan_number() << 20U | static_cast<std::uint64_t>(s_.world.number[i]);
      if (s_.draws(1).uniforms(draw)[0] >= chance(norm(centre - eye_)) || !is_in_sight(i)) continue;
      const auto noise = s_.draws().normals(draw);
      const double factor = s_.noise();
      const Vec2 place = centre + Vec2{noise[0], noise[1]} * (factor * o_.position_std);
      const Vec2 velocity = s_.object_velocities[i] + Vec2{noise[2], noise[3]} * (factor * o_.velocity_std);
      note(i, place, velocity, radius);
    }
  }
  /// Begin a track of nothing, and let two near ones change their ids, where it is time for that.
  void mistake(double dt) {
    const auto chance = s_.draws(2).uniforms(s_.scan_number());
    if (chance[0] < 1.0 - std::exp(-o_.false_tracks * dt)) {
      const double far = o_.range_max * std::sqrt(chance[1]), aside = sector_.half * (2.0 * chance[2] - 1.0);
      note(-1, eye_ + unit(sector_.middle + aside) * far, {}, o_.false_radius);
    }
    if (chance[3] < 1.0 - std::exp(-o_.id_switches * dt)) change_nearest();
  }
  /// Report the tracks in the frame of the carrier.
  void report() const {
    for (int k = 0; k < o_.max_tracks; ++k) {
      const double* const track = at(k);
      double* const out = s_.readings + static_cast<std::ptrdiff_t>(k) * kTrack;
      std::copy_n(track, static_cast<int>(kTrack), out);
      const Vec2 place = unrotate(Vec2{track[kTrackX], track[kTrackY]} - s_.pose.position(), s_.direction);
      const Vec2 velocity = unrotate(Vec2{track[kTrackSpeedX], track[kTrackSpeedY]}, s_.direction);
      out[kTrackX] = place.x, out[kTrackY] = place.y;
      out[kTrackSpeedX] = velocity.x, out[kTrackSpeedY] = velocity.y;
    }
  }

 private:
  double* at(int k) const { return tracks_ + static_cast<std::ptrdiff_t>(k) * kTrackMemory; }
  void drop(int k) { std::fill_n(at(k), kTrackMemory, kNone); }
  bool is_target(int i) const { return has_role(s_.world, static_cast<int>(o_.targets), i); }
  double chance(double distance) const {
    if (!(o_.half_range > 0.0)) return o_.probability;
    if (!(o_.range_softness > 0.0)) return distance <= o_.half_range ? o_.probability : 0.0;
    return o_.probability / (1.0 + std::exp((distance - o_.half_range) / o_.range_softness));
  }
  bool is_in_sight(int i) const {
    if (!meets(s_.state.footprint(s_.world, s_.w, i), sector_)) return false;
    return !o_.occlusion || visible_share(s_, eye_, i) >= o_.min_visible;
  }
  double distance(int k) const { return norm(Vec2{at(k)[kTrackX], at(k)[kTrackY]} - eye_); }
  /// Update the track of an object, or begin one: in a free slot, or in place of the farthest one if that is farther.
  void note(int object, Vec2 place, Vec2 velocity, double radius) {
    int slot = -1, farthest = 0;
    for (int k = 0; k < o_.max_tracks; ++k) {
      if (object >= 0 && at(k)[kTrackSource] == object) {
        slot = k;
        break;
      }
      if (slot < 0 && std::isnan(at(k)[kTrackId])) slot = k;
      if (!std::isnan(at(k)[kTrackId]) && !(distance(k) <= distance(farthest))) farthest = k;
    }
    if (slot < 0) {
      if (distance(farthest) <= norm(place - eye_)) return;
      drop(slot = farthest);
    }
    double* const track = at(slot);
    if (std::isnan(track[kTrackId]) || track[kTrackSource] != object) track[kTrackId] = next_id_++;
    track[kTrackX] = place.x, track[kTrackY] = place.y;
    track[kTrackSpeedX] = velocity.x, track[kTrackSpeedY] = velocity.y;
    track[kTrackRadius] = radius, track[kTrackSource] = object, track[kTrack] = 0.0;
  }
  void change_nearest() {
    int one = -1, two = -1;
    double least = kInfinity;
    for (int a = 0; a < o_.max_tracks; ++a) {
      for (int b = a + 1; b < o_.max_tracks; ++b) {
        const double apart = std::hypot(at(a)[kTrackX] - at(b)[kTrackX], at(a)[kTrackY] - at(b)[kTrackY]);
        if (apart < least) least = apart, one = a, two = b;
      }
    }
    if (one >= 0) std::swap(at(one)[kTrackId], at(two)[kTrackId]);
  }

  const DetectorOptions& o_;
  const Sensing& s_;
  double& next_id_;
  double* tracks_;
  Vec2 eye_;
  Sector sector_;
};

inline void detector(const DetectorOptions& o, const Sensing& s) {
  Travel travel;
  const Due due = take_note(s, travel);
  if (due == Due::no) return;
  Tracker tracker(o, s);
  const double dt = s.world.step_time;
  if (due == Due::start) {
    tracker.start();
  } else {
    tracker.coast(dt);
  }
  if (!s.measures()) return;
  tracker.detect();
  if (due == Due::step) tracker.mistake(dt * static_cast<double>(s.steps));
  tracker.report();
}

}  // namespace irsim

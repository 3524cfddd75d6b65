// Loads worlds with the official parser of SDF and says what it found: one line of numbers for each file.
#include <iostream>
#include <sdf/sdf.hh>

namespace {

int visuals_of(const sdf::Link& link, int& empty) {
  for (uint64_t k = 0; k < link.VisualCount(); ++k)
    empty += link.VisualByIndex(k)->Geom()->Type() == sdf::GeometryType::EMPTY;
  for (uint64_t k = 0; k < link.CollisionCount(); ++k)
    empty += link.CollisionByIndex(k)->Geom()->Type() == sdf::GeometryType::EMPTY;
  return static_cast<int>(link.VisualCount());
}

bool check(const char* path) {
  sdf::Root root;
  const sdf::Errors errors = root.Load(path);
  for (const auto& error : errors) std::cerr << error.Message() << "\n";
  std::cout << "errors " << errors.size();
  if (errors.empty() && root.WorldCount() == 1) {
    const sdf::World& world = *root.WorldByIndex(0);
    int visuals = 0, empty = 0, sensors = 0, beams = 0, waypoints = 0;
    for (uint64_t m = 0; m < world.ModelCount(); ++m)
      for (uint64_t k = 0; k < world.ModelByIndex(m)->LinkCount(); ++k) {
        const sdf::Link& link = *world.ModelByIndex(m)->LinkByIndex(k);
        visuals += visuals_of(link, empty);
        for (uint64_t s = 0; s < link.SensorCount(); ++s) {
          const sdf::Lidar* lidar = link.SensorByIndex(s)->LidarSensor();
          if (lidar != nullptr) ++sensors, beams += static_cast<int>(lidar->HorizontalScanSamples());
        }
      }
    for (uint64_t a = 0; a < world.ActorCount(); ++a) {
      const sdf::Actor& actor = *world.ActorByIndex(a);
      for (uint64_t k = 0; k < actor.LinkCount(); ++k) visuals += visuals_of(*actor.LinkByIndex(k), empty);
      for (uint64_t t = 0; t < actor.TrajectoryCount(); ++t)
        waypoints += static_cast<int>(actor.TrajectoryByIndex(t)->WaypointCount());
    }
    std::cout << " models " << world.ModelCount() << " actors " << world.ActorCount() << " visuals " << visuals
              << " empty " << empty << " lidars " << sensors << " beams " << beams << " waypoints " << waypoints;
  }
  std::cout << "\n";
  return errors.empty();
}

}  // namespace

int main(int count, char** paths) {
  bool good = count > 1;
  for (int k = 1; k < count; ++k) good = check(paths[k]) && good;
  return good ? 0 : 1;
}

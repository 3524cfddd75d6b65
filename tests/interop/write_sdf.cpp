// Writes three worlds with libsdformat, the official library of SDF, into the folder that is named.
#include <string>

#include <sdf/sdf.hh>

namespace {

using ignition::math::Pose3d;
using ignition::math::Vector3d;
using sdf::ElementPtr;

ElementPtr named(ElementPtr parent, const std::string& tag, const std::string& name) {
  ElementPtr element = parent->AddElement(tag);
  element->GetAttribute("name")->Set(name);
  return element;
}

ElementPtr model(ElementPtr parent, const std::string& name, const Pose3d& pose, bool still = true) {
  ElementPtr element = named(parent, "model", name);
  element->GetElement("pose")->Set(pose);
  element->GetElement("static")->Set(still);
  return element;
}

// The geometry of a collision of a link of its own; what is seen of it is larger than what is touched.
ElementPtr geometry(ElementPtr model, const std::string& name, const Pose3d& pose = Pose3d::Zero) {
  ElementPtr link = named(model, "link", name);
  ElementPtr seen = named(link, "visual", "seen")->GetElement("geometry")->AddElement("box");
  seen->GetElement("size")->Set(Vector3d(30, 30, 3));
  ElementPtr touched = named(link, "collision", "touched");
  touched->GetElement("pose")->Set(pose);
  return touched->GetElement("geometry");
}

void box(ElementPtr geometry, double x, double y, double z) {
  geometry->AddElement("box")->GetElement("size")->Set(Vector3d(x, y, z));
}

void cylinder(ElementPtr geometry, double radius, double length) {
  ElementPtr shape = geometry->AddElement("cylinder");
  shape->GetElement("radius")->Set(radius);
  shape->GetElement("length")->Set(length);
}

void rooms(ElementPtr world) {
  box(geometry(model(world, "south", {5, 0.1, 1, 0, 0, 0}), "l"), 10, 0.2, 2);
  box(geometry(model(world, "north", {5, 7.9, 1, 0, 0, 0}), "l"), 10, 0.2, 2);
  box(geometry(model(world, "west", {0.1, 4, 1, 0, 0, 1.5707963267948966}), "l"), 7.6, 0.2, 2);
  box(geometry(model(world, "east", {9.9, 4, 1, 0, 0, 0}), "l"), 0.2, 7.6, 2);
  box(geometry(model(world, "slanted", {5, 4, 1, 0, 0, 0.6}), "l"), 4, 0.15, 2);
  box(geometry(model(world, "lintel", {2, 2, 2.5, 0, 0, 0}), "l"), 3, 3, 1);
}

void round(ElementPtr world) {
  cylinder(geometry(model(world, "post", {1, 1, 0.5, 0, 0, 0}), "l"), 0.5, 1);
  ElementPtr ball = geometry(model(world, "ball", {4, 1, 0.6, 0, 0, 0}, false), "l")->AddElement("sphere");
  ball->GetElement("radius")->Set(0.6);
  ElementPtr egg = geometry(model(world, "egg", {7, 1, 0.8, 0, 0, 0.4}), "l")->AddElement("ellipsoid");
  egg->GetElement("radii")->Set(Vector3d(1, 0.5, 0.7));
  cylinder(geometry(model(world, "lying", {4, 5, 0.8, 1.5707963267948966, 0, 0.3}), "l"), 0.4, 3);
}

void nested(ElementPtr world) {
  ElementPtr outer = model(world, "outer", {3, 3, 0, 0, 0, 1});
  cylinder(geometry(outer, "base", {0, 0, 0.5, 0, 0, 0}), 0.3, 1);
  box(geometry(model(outer, "inner", {2, 0, 0, 0, 0, 0.5}), "l", {0, 1, 0.5, 0, 0, 0}), 1, 0.5, 1);
  ElementPtr corner = geometry(model(world, "corner", {8, 2, 0, 0, 0, 0.3}), "l")->AddElement("polyline");
  const double points[][2] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const auto& point : points) corner->AddElement("point")->Set(ignition::math::Vector2d(point[0], point[1]));
  corner->GetElement("height")->Set(1.0);
}

}  // namespace

int main(int, char** argv) {
  const std::pair<const char*, void (*)(ElementPtr)> worlds[] = {{"rooms", rooms}, {"round", round}, {"nested", nested}};
  for (const auto& [name, fill] : worlds) {
    sdf::SDFPtr file(new sdf::SDF());
    sdf::init(file);
    ElementPtr world = file->Root()->AddElement("world");
    world->GetAttribute("name")->Set(std::string(name));
    fill(world);
    file->Write(std::string(argv[1]) + "/" + name + ".sdf");
  }
  return 0;
}

// Where the sensors of a world are mounted, and their places in the arrays of a state.
#pragma once

namespace irsim {

struct ObjectSpec;
struct World;

/// Add the sensors of an object.
void add_scans(World& world, int object, const ObjectSpec& spec);
/// Give measurements on their way their places again, as many as the longest latency and the highest rate need that a
/// scene may draw.
void lay_out_pending(World& world);
/// Add views of the fog with beams so dense that they miss no cell within reach.
void add_fog_beams(World& world);

}  // namespace irsim

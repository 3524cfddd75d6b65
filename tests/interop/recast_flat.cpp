// Builds a navigation mesh of triangles with Recast and the parameters of Habitat, and writes it as Habitat does.
//
// Usage: recast_flat TRIANGLES OUT.navmesh VERSION. TRIANGLES holds 9 floats for each triangle, y up. The walkable cells
// of Recast's own height field after erosion go to OUT.navmesh.cells: x, y, z of each as floats.
#include <recastnavigation/DetourNavMesh.h>
#include <recastnavigation/DetourNavMeshBuilder.h>
#include <recastnavigation/Recast.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

struct SetHeader {
  char magic[4];
  int version;
  int tiles;
  dtNavMeshParams params;
};

// The settings that Habitat writes in version 2; readers need not know them.
struct Settings {
  float numbers[13];
  float bounds[6];
  bool filters[4];
};

void require(bool good, const char* what) {
  if (!good) {
    std::fprintf(stderr, "failed: %s\n", what);
    std::exit(1);
  }
}

}  // namespace

int main(int count, char** words) {
  require(count == 4, "three arguments");
  std::FILE* in = std::fopen(words[1], "rb");
  require(in != nullptr, "open the triangles");
  std::vector<float> points;
  float buffer[9];
  while (std::fread(buffer, sizeof(buffer), 1, in) == 1) points.insert(points.end(), buffer, buffer + 9);
  std::fclose(in);
  const int vertices = static_cast<int>(points.size() / 3);
  std::vector<int> corners(vertices);
  for (int k = 0; k < vertices; ++k) corners[k] = k;

  const float cell = 0.05f, cell_height = 0.2f, height = 1.5f, radius = 0.1f, climb = 0.2f;
  rcConfig config{};
  config.cs = cell;
  config.ch = cell_height;
  config.walkableSlopeAngle = 45.0f;
  config.walkableHeight = static_cast<int>(std::ceil(height / cell_height));
  config.walkableClimb = static_cast<int>(std::floor(climb / cell_height));
  config.walkableRadius = static_cast<int>(std::ceil(radius / cell));
  config.maxEdgeLen = static_cast<int>(12.0f / cell);
  config.maxSimplificationError = 1.3f;
  config.minRegionArea = 20 * 20;
  config.mergeRegionArea = 20 * 20;
  config.maxVertsPerPoly = 6;
  config.detailSampleDist = 6.0f * cell;
  config.detailSampleMaxError = 1.0f * cell_height;
  rcCalcBounds(points.data(), vertices, config.bmin, config.bmax);
  rcCalcGridSize(config.bmin, config.bmax, config.cs, &config.width, &config.height);

  rcContext context(false);
  rcHeightfield* solid = rcAllocHeightfield();
  require(rcCreateHeightfield(&context, *solid, config.width, config.height, config.bmin, config.bmax, config.cs, config.ch),
          "height field");
  std::vector<unsigned char> areas(vertices / 3, 0);
  rcMarkWalkableTriangles(&context, config.walkableSlopeAngle, points.data(), vertices, corners.data(), vertices / 3,
                          areas.data());
  require(rcRasterizeTriangles(&context, points.data(), vertices, corners.data(), areas.data(), vertices / 3, *solid,
                               config.walkableClimb),
          "triangles");
  rcFilterLowHangingWalkableObstacles(&context, config.walkableClimb, *solid);
  rcFilterLedgeSpans(&context, config.walkableHeight, config.walkableClimb, *solid);
  rcFilterWalkableLowHeightSpans(&context, config.walkableHeight, *solid);
  rcCompactHeightfield* open = rcAllocCompactHeightfield();
  require(rcBuildCompactHeightfield(&context, config.walkableHeight, config.walkableClimb, *solid, *open), "compact field");
  require(rcErodeWalkableArea(&context, config.walkableRadius, *open), "erosion");

  std::FILE* cells = std::fopen((std::string(words[2]) + ".cells").c_str(), "wb");
  for (int z = 0; z < open->height; ++z) {
    for (int x = 0; x < open->width; ++x) {
      const rcCompactCell& here = open->cells[x + z * open->width];
      for (unsigned k = here.index; k < here.index + here.count; ++k) {
        if (open->areas[k] == RC_NULL_AREA) continue;
        const float place[3] = {open->bmin[0] + (x + 0.5f) * cell, open->bmin[1] + open->spans[k].y * cell_height,
                                open->bmin[2] + (z + 0.5f) * cell};
        std::fwrite(place, sizeof(place), 1, cells);
      }
    }
  }
  std::fclose(cells);

  require(rcBuildDistanceField(&context, *open), "distances");
  require(rcBuildRegions(&context, *open, 0, config.minRegionArea, config.mergeRegionArea), "regions");
  rcContourSet* contours = rcAllocContourSet();
  require(rcBuildContours(&context, *open, config.maxSimplificationError, config.maxEdgeLen, *contours), "contours");
  rcPolyMesh* mesh = rcAllocPolyMesh();
  require(rcBuildPolyMesh(&context, *contours, config.maxVertsPerPoly, *mesh), "polygons");
  rcPolyMeshDetail* detail = rcAllocPolyMeshDetail();
  require(rcBuildPolyMeshDetail(&context, *mesh, *open, config.detailSampleDist, config.detailSampleMaxError, *detail),
          "details");
  for (int k = 0; k < mesh->npolys; ++k) mesh->flags[k] = 1;

  dtNavMeshCreateParams made{};
  made.verts = mesh->verts;
  made.vertCount = mesh->nverts;
  made.polys = mesh->polys;
  made.polyAreas = mesh->areas;
  made.polyFlags = mesh->flags;
  made.polyCount = mesh->npolys;
  made.nvp = mesh->nvp;
  made.detailMeshes = detail->meshes;
  made.detailVerts = detail->verts;
  made.detailVertsCount = detail->nverts;
  made.detailTris = detail->tris;
  made.detailTriCount = detail->ntris;
  made.walkableHeight = height;
  made.walkableRadius = radius;
  made.walkableClimb = climb;
  std::memcpy(made.bmin, mesh->bmin, sizeof(made.bmin));
  std::memcpy(made.bmax, mesh->bmax, sizeof(made.bmax));
  made.cs = cell;
  made.ch = cell_height;
  made.buildBvTree = true;
  unsigned char* data = nullptr;
  int size = 0;
  require(dtCreateNavMeshData(&made, &data, &size), "Detour's data");
  dtNavMesh navigation;
  require(dtStatusSucceed(navigation.init(data, size, DT_TILE_FREE_DATA)), "Detour's mesh");

  std::FILE* out = std::fopen(words[2], "wb");
  require(out != nullptr, "open the output");
  SetHeader header{{'T', 'E', 'S', 'M'}, std::atoi(words[3]), 0, *navigation.getParams()};
  const dtNavMesh& built = navigation;
  for (int k = 0; k < built.getMaxTiles(); ++k) header.tiles += built.getTile(k)->header != nullptr;
  std::fwrite(&header, sizeof(header), 1, out);
  if (header.version >= 2) {
    Settings settings{{cell, cell_height, height, radius, climb, 45.0f}, {}, {true, true, true, false}};
    std::fwrite(&settings, sizeof(settings), 1, out);
  }
  for (int k = 0; k < built.getMaxTiles(); ++k) {
    const dtMeshTile* tile = built.getTile(k);
    if (tile->header == nullptr) continue;
    const unsigned head[2] = {static_cast<unsigned>(built.getTileRef(tile)), static_cast<unsigned>(tile->dataSize)};
    std::fwrite(head, sizeof(head), 1, out);
    std::fwrite(tile->data, tile->dataSize, 1, out);
  }
  std::fclose(out);
  std::printf("%d polygons\n", mesh->npolys);
  return 0;
}

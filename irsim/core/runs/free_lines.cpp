#include "runs/free_lines.hpp"

#include "collision/touch.hpp"

namespace irsim {

void free_lines(const World& world, const Shapes& shapes, const Fixed& fixed, const Vec2* start, const Vec2* end,
                std::size_t count, const std::uint8_t* blocking, std::uint8_t* out) {
  const Part part{Kind::linestring, 0, 1, 0.0, 0.0};
  int last = -1;  // what blocked the line before, and probably blocks this one, too
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 ends[2] = {start[k], end[k]};
    Box box;
    box.include(ends[0]);
    box.include(ends[1]);
    const Footprint line{&part, 1, ends, &box, box, {}, 0.0};
    const auto blocks = [&](int i) {
      return blocking[i] && world.is_static[i] && touch(line, fixed.outlines.footprint(shapes, i));
    };
    const bool finite = std::isfinite(ends[0].x + ends[0].y + ends[1].x + ends[1].y);
    bool free = !finite || last < 0 || !blocks(last);
    if (finite && free) {
      fixed.grid.query(box, [&](int i) {
        if (free && blocks(i)) free = false, last = i;
      });
    }
    out[k] = free;
  }
}

}  // namespace irsim

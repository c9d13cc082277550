#include "render/gl_shaders.h"

namespace trapeze {
namespace {

// Coordinates named "local" are pixels counted from the corner of a whole pixel beside the side or
// trapezoid, so that single precision is relative to that and not to the picture.
constexpr const char* kVertexCommon = R"(#version 430 core
layout(binding = 0) uniform isamplerBuffer trapezoids;
uniform dvec2 origin;           // of the picture, in cells
uniform double pixels_per_cell;
uniform dvec2 size;             // of the picture, in pixels
uniform float first_row;        // of the picture, in the target

struct Side {
  double x_top;
  double x_bottom;
  double slope;  // pixels east for each one south
};

Side cut(ivec2 upper, ivec2 lower, double top, double bottom) {
  dvec2 from = dvec2(upper);
  dvec2 along = dvec2(lower) - from;
  double slope = along.x / along.y;
  dvec2 start = (from - origin) * pixels_per_cell;
  return Side(start.x + (top - start.y) * slope, start.x + (bottom - start.y) * slope, slope);
}

// The same line seen from a point in the picture: x, y and slope. A side that passes the picture is
// replaced by a vertical line beyond its border, which covers the same pixels.
vec3 anchored(Side side, double top, double bottom, dvec2 begin) {
  double x = clamp(side.x_top, -1.0LF, size.x + 1.0LF);
  double y = top;
  double slope = side.slope;
  if (x != side.x_top) {
    double down = (x - side.x_top) / slope;
    if (down >= 0.0LF && down <= bottom - top) {
      y += down;
    } else {
      slope = 0.0LF;
    }
  }
  return vec3(x - begin.x, y - begin.y, slope);
}

// Top and bottom of the trapezoid, cut to the picture.
dvec2 levels_of(int first) {
  dvec2 levels = (dvec2(texelFetch(trapezoids, first).xy) - origin.y) * pixels_per_cell;
  return dvec2(max(levels.x, 0.0LF), min(levels.y, size.y));
}

vec4 on_target(vec2 position) {
  return vec4(position / vec2(size) * 2.0 - 1.0, 0.0, 1.0);
}

const vec4 kNowhere = vec4(-2.0, -2.0, 0.0, 1.0);
)";

constexpr const char* kSideVertex = R"(
flat out vec3 side;    // a point of the line and its slope; local
flat out vec3 extent;  // top, bottom, and the sign of what lies east of the side; local
flat out vec2 corner;  // where local coordinates begin, on the target

const float kFarOff = 4096.0;  // pixels beyond the picture where a slanted strip is given up

// Where the strip begins and ends in x, at its top and its bottom. It holds the centres of the
// pixels touched and of their eastern neighbours: so it keeps half a pixel and half a row's slant
// away from the side; a little more makes up for the grid of the rasterizer. What lies west of the
// picture counts in its first column, so a side that comes from there takes the whole width.
vec4 strip(Side line, double top, double bottom) {
  vec2 x = vec2(line.x_top, line.x_bottom);
  float low = min(x.x, x.y);
  float high = max(x.x, x.y);
  float width = float(size.x);
  if (ceil(bottom) - floor(top) > 2.0LF && low > 0.0 && high < width + kFarOff) {
    float slope = float(line.slope);
    float margin = 0.51 + 0.5 * abs(slope);
    x += vec2(floor(top) - top, ceil(bottom) - bottom) * slope;
    return vec4(x - margin, x + margin + 1.0);
  }
  low = low > 0.51 ? low - 0.51 : -0.5;
  high = max(min(high, width) + 1.51, 1.0);
  return vec4(low, low, high, high);
}

void main() {
  int first = (gl_VertexID >> 3) * 5;
  bool is_right_side = (gl_VertexID & 4) != 0;
  bool is_lower = (gl_VertexID & 2) != 0;
  bool is_east = (gl_VertexID & 1) != 0;
  dvec2 levels = levels_of(first);
  gl_Position = kNowhere;
  side = extent = vec3(0.0);
  corner = vec2(0.0);
  if (levels.x >= levels.y) return;

  int ends = first + (is_right_side ? 3 : 1);
  Side line = cut(texelFetch(trapezoids, ends).xy, texelFetch(trapezoids, ends + 1).xy, levels.x,
                  levels.y);
  if (min(line.x_top, line.x_bottom) >= size.x) return;

  dvec2 begin = floor(dvec2(clamp(line.x_top, 0.0LF, size.x), levels.x));
  side = anchored(line, levels.x, levels.y, begin);
  extent = vec3(levels - begin.y, is_right_side ? -1.0 : 1.0);
  corner = vec2(begin) + vec2(0.0, first_row);
  vec4 x = strip(line, levels.x, levels.y);
  vec2 ends_x = is_east ? x.zw : x.xy;
  gl_Position = on_target(vec2(is_lower ? ends_x.y : ends_x.x,
                               is_lower ? ceil(levels.y) : floor(levels.x)));
}
)";

constexpr const char* kPointVertex = R"(
flat out vec4 left_side;   // a point of the line, its slope, and the trapezoid's top; local
flat out vec4 right_side;  // a point of the line, its slope, and the trapezoid's bottom; local
flat out vec3 corner;      // where local coordinates begin, on the target; the sign of the area

void main() {
  int first = gl_VertexID * 5;
  dvec2 levels = levels_of(first);
  gl_Position = kNowhere;
  gl_PointSize = 1.0;
  left_side = right_side = vec4(0.0);
  corner = vec3(0.0);
  if (levels.x >= levels.y) return;

  Side left = cut(texelFetch(trapezoids, first + 1).xy, texelFetch(trapezoids, first + 2).xy,
                  levels.x, levels.y);
  Side right = cut(texelFetch(trapezoids, first + 3).xy, texelFetch(trapezoids, first + 4).xy,
                   levels.x, levels.y);
  // Where left and right have changed places, the area counts negative.
  float sign = 1.0;
  if (left.x_top + left.x_bottom > right.x_top + right.x_bottom) {
    Side west = right;
    right = left;
    left = west;
    sign = -1.0;
  }
  double low = min(left.x_top, left.x_bottom);
  double high = max(right.x_top, right.x_bottom);
  if (high <= 0.0LF || low >= size.x) return;

  dvec2 begin = dvec2(floor(clamp(low, 0.0LF, size.x)), floor(levels.x));
  corner = vec3(vec2(begin) + vec2(0.0, first_row), sign);
  left_side = vec4(anchored(left, levels.x, levels.y, begin), levels.x - begin.y);
  right_side = vec4(anchored(right, levels.x, levels.y, begin), levels.y - begin.y);

  // The square holds all pixels touched and their eastern neighbours, and stays on the picture.
  vec2 end = vec2(min(floor(high) + 2.0LF, size.x), ceil(levels.y));
  float length = max(end.x - float(begin.x), end.y - float(begin.y));
  vec2 from = max(min(vec2(begin), vec2(size) - length), vec2(0.0));
  gl_PointSize = length;
  gl_Position = on_target(from + 0.5 * length);
}
)";

// What lies east of a side covers, in a row in which the side is at x, all pixels east of it and a
// part of the pixel that holds it. From one pixel to the next that differs by a tent: it rises from
// nothing, where the side is a pixel west of the pixel's own place, to one and falls again. So the
// difference is the mean of the tent over the rows' positions of the side: a difference of two
// integrals.
constexpr const char* kFragmentCommon = R"(#version 430 core
out float difference;

// The integral of the tent from 0 to u. Before the first column there is nothing to differ from:
// there what lies west of the picture counts as a whole.
float tent_integral(float u, bool is_first) {
  float within = clamp(u, -1.0, 1.0);
  float integral = within - 0.5 * within * abs(within);
  return is_first && u < 0.0 ? u : integral;
}

// Of the pixel whose corner is at x, between two heights of the side; all local.
float difference_at(vec3 side, float x, float from_y, float to_y) {
  float from = side.x + (from_y - side.y) * side.z - x;
  float to = side.x + (to_y - side.y) * side.z - x;
  bool is_first = gl_FragCoord.x < 1.0;
  float span = to - from;
  // There the quotient loses more digits than the bend of the tent is worth.
  if (abs(span) < 1e-3) {
    float middle = from + 0.5 * span;
    return max(0.0, 1.0 - (is_first ? max(middle, 0.0) : abs(middle)));
  }
  return (tent_integral(to, is_first) - tent_integral(from, is_first)) / span;
}
)";

constexpr const char* kSideFragment = R"(
flat in vec3 side;
flat in vec3 extent;
flat in vec2 corner;

void main() {
  vec2 pixel = gl_FragCoord.xy - 0.5 - corner;
  float from_y = max(pixel.y, extent.x);
  float to_y = min(pixel.y + 1.0, extent.y);
  difference = extent.z * max(to_y - from_y, 0.0) * difference_at(side, pixel.x, from_y, to_y);
}
)";

constexpr const char* kPointFragment = R"(
flat in vec4 left_side;
flat in vec4 right_side;
flat in vec3 corner;

void main() {
  vec2 pixel = gl_FragCoord.xy - 0.5 - corner.xy;
  float from_y = max(pixel.y, left_side.w);
  float to_y = min(pixel.y + 1.0, right_side.w);
  difference = corner.z * max(to_y - from_y, 0.0) *
               (difference_at(left_side.xyz, pixel.x, from_y, to_y) -
                difference_at(right_side.xyz, pixel.x, from_y, to_y));
}
)";

}  // namespace

std::string side_vertex_shader() {
  return std::string(kVertexCommon) + kSideVertex;
}
std::string side_fragment_shader() {
  return std::string(kFragmentCommon) + kSideFragment;
}
std::string point_vertex_shader() {
  return std::string(kVertexCommon) + kPointVertex;
}
std::string point_fragment_shader() {
  return std::string(kFragmentCommon) + kPointFragment;
}

}  // namespace trapeze

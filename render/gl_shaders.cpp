#include "render/gl_shaders.h"

namespace trapeze {
namespace {

// The picture is cut into bands of rows. Coordinates named "local" are pixels counted from the
// corner of a whole pixel beside the side, so that single precision is relative to that and not to
// the picture.
constexpr const char* kSide = R"(
layout(std430, binding = TRAPEZOIDS) readonly buffer Trapezoids { ivec2 trapezoids[]; };
layout(std430, binding = CHOSEN) readonly buffer Chosen { uint chosen[]; };
layout(std430, binding = DIFFERENCES) buffer Differences { int differences[]; };

uniform uint first;             // of the chosen
uniform uint count;             // of them
uniform dvec2 origin;           // of the picture, in cells
uniform double pixels_per_cell;
uniform double first_row;       // of the band, in the picture
uniform ivec2 size;             // of the band, in pixels
uniform int place;              // of its first pixel among the differences

// Of a row in which the side runs from low to high: the part of the pixel at `column` and of all
// west of it that lies east of the side, as a share of the row's height. All local.
float share_up_to(float column, float low, float high) {
  float span = high - low;
  // There the quotient loses more digits than the bend is worth.
  if (span < 1e-3) return clamp(column + 1.0 - 0.5 * (low + high), 0.0, 1.0);
  vec2 u = vec2(column + 1.0) - vec2(low, high);
  vec2 within = clamp(u, 0.0, 1.0);
  vec2 integral = 0.5 * within * within + max(u - 1.0, 0.0);
  return (integral.x - integral.y) / span;
}

void main() {
  uint invocation = gl_GlobalInvocationID.x;
  if (invocation >= 2u * count) return;
  uint trapezoid = chosen[first + (invocation >> 1)];
  uint integers = trapezoid * 5u;
  bool is_right_side = (invocation & 1u) != 0u;

  // Top and bottom, cut to the picture.
  dvec2 levels = (dvec2(trapezoids[integers]) - origin.y) * pixels_per_cell - first_row;
  levels = dvec2(max(levels.x, 0.0LF), min(levels.y, double(size.y)));
  if (levels.x >= levels.y) return;

  integers += is_right_side ? 3u : 1u;
  dvec2 from = dvec2(trapezoids[integers]);
  dvec2 along = dvec2(trapezoids[integers + 1u]) - from;
  double slope = along.x / along.y;
  dvec2 start = (from - origin) * pixels_per_cell - dvec2(0.0LF, first_row);
  double x_top = start.x + (levels.x - start.y) * slope;
  double x_bottom = start.x + (levels.y - start.y) * slope;
  double width = double(size.x);
  if (min(x_top, x_bottom) >= width) return;

  // A line that comes from beyond the picture is followed from where it enters; one that never does
  // is replaced by a vertical line along the border.
  double x = clamp(x_top, -1.0LF, width + 1.0LF);
  double y = levels.x;
  if (x != x_top) {
    double down = (x - x_top) / slope;
    if (down >= 0.0LF && down <= levels.y - levels.x) {
      y += down;
    } else {
      slope = 0.0LF;
    }
  }
  ivec2 begin = ivec2(floor(clamp(x, 0.0LF, width)), floor(levels.x));
  float line_x = float(x - double(begin.x));
  float line_y = float(y - double(begin.y));
  float line_slope = float(slope);
  float top = float(levels.x - double(begin.y));
  float end = float(levels.y - double(begin.y));

  float dither = float((trapezoid * 2654435769u) >> 8) * (1.0 / 16777216.0);
  int sign = is_right_side ? -1 : 1;
  int west = -begin.x;
  int east = size.x - begin.x;
  int cells = place + begin.y * size.x + begin.x;
  float row_x = line_x + (top - line_y) * line_slope;
  while (top < end) {
    float bottom = min(floor(top) + 1.0, end);
    float next_x = line_x + (bottom - line_y) * line_slope;
    float height = (bottom - top) * UNITS;
    float low = min(row_x, next_x);
    float high = max(row_x, next_x);
    int column = int(clamp(floor(low), float(west), float(east)));
    int last = int(clamp(floor(high), float(west), float(east)));
    if (column < east) {
      int whole = int(height + dither);
      int sum = int(height * share_up_to(float(column), low, high) + dither);
      atomicAdd(differences[cells + column], sign * sum);
      for (++column; column <= last && column < east; ++column) {
        int next = int(height * share_up_to(float(column), low, high) + dither);
        atomicAdd(differences[cells + column], sign * (next - sum));
        sum = next;
      }
      if (column < east) atomicAdd(differences[cells + column], sign * (whole - sum));
    }
    cells += size.x;
    top = bottom;
    row_x = next_x;
  }
}
)";

std::string define(const char* name, const std::string& value) {
  return std::string("#define ") + name + ' ' + value + '\n';
}

}  // namespace

std::string side_shader() {
  return "#version 430 core\n" + define("UNITS", std::to_string(kGlUnitsPerPixel) + ".0") +
         define("TRAPEZOIDS", std::to_string(kGlTrapezoidsBinding)) +
         define("CHOSEN", std::to_string(kGlChosenBinding)) +
         define("DIFFERENCES", std::to_string(kGlDifferencesBinding)) +
         "layout(local_size_x = " + std::to_string(kGlGroup) + ") in;\n" + kSide;
}

}  // namespace trapeze

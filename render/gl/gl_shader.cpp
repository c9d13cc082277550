#include "render/gl/gl_shader.h"

#include "render/mask/resolve_row.h"

namespace trapeze::gl_shader {
namespace {

// A span contains the y of a top and of a bottom, in pixels from the top of the band of rows that
// is drawn. "Local" coordinates are in pixels from the corner of a pixel next to the side, so that
// errors of single precision are relative to that distance and not to the size of the picture.
constexpr const char* kTrapezoid = R"(
layout(binding = 0) uniform isamplerBuffer trapezoids;
layout(std430, binding = INDICES) readonly buffer Indices { uint indices[]; };
layout(std430, binding = DIFFERENCES) buffer Differences { int differences[]; };

uniform uint first;             // of the indices
uniform uint count;             // of them
uniform dvec2 origin;           // of the picture, in cells
uniform dvec2 pixels_per_cell;
uniform double first_row;       // of the band, in the picture
uniform ivec2 size;             // of the band, in pixels
uniform int place;              // of its first pixel among the differences

struct Side {
  float x;      // a point of the line; local
  float y;
  float slope;  // pixels east for each one south
  int column;   // where local coordinates begin
};

// A line that begins beyond the border of the picture is followed from where it enters the picture.
// One that never enters is replaced by a vertical line beyond the border, with the same area to its
// east.
Side side_at(int ends, dvec2 span, double row) {
  dvec2 upper = dvec2(texelFetch(trapezoids, ends).xy);
  dvec2 along = dvec2(texelFetch(trapezoids, ends + 1).xy) - upper;
  double slope = along.x / along.y * (pixels_per_cell.x / pixels_per_cell.y);
  dvec2 start = (upper - origin) * pixels_per_cell - dvec2(0.0LF, first_row);
  double x_top = start.x + (span.x - start.y) * slope;
  double x = clamp(x_top, -1.0LF, double(size.x) + 1.0LF);
  double y = span.x;
  if (x != x_top) {
    double down = (x - x_top) / slope;
    if (down >= 0.0LF && down <= span.y - span.x) {
      y += down;
    } else {
      slope = 0.0LF;
    }
  }
  double column = floor(clamp(x, 0.0LF, double(size.x)));
  return Side(float(x - column), float(y - row), float(slope), int(column));
}

float x_at(Side side, float y) {
  return side.x + (y - side.y) * side.slope;
}

// Of a row in which a side runs from low to high: the part of the pixel at `column` and of all west
// of it that lies east of the side, as a share of the row's height. All local.
float share_up_to(int column, float low, float high) {
  float span = high - low;
  float east = float(column) + 1.0;
  // There the quotient loses more digits than the bend is worth.
  if (span < 1e-3) return clamp(east - 0.5 * (low + high), 0.0, 1.0);
  vec2 u = vec2(east - low, east - high);
  vec2 within = clamp(u, 0.0, 1.0);
  vec2 integral = 0.5 * within * within + max(u - 1.0, 0.0);
  return (integral.x - integral.y) / span;
}

// Adds what lies east of a side in one row. `cells` is where the row begins; `whole` is the height
// of the row that the trapezoid has, in units.
void add_row(Side side, int sign, float from_x, float to_x, int cells, int whole, float rounding) {
  float low = min(from_x, to_x);
  float high = max(from_x, to_x);
  int west_end = -side.column;
  int east_end = size.x - side.column;
  int column = int(clamp(floor(low), float(west_end), float(east_end)));
  int last = int(clamp(floor(high), float(west_end), float(east_end)));
  if (column >= east_end) return;
  cells += side.column;
  float height = float(whole);
  int sum = int(height * share_up_to(column, low, high) + rounding);
  atomicAdd(differences[cells + column], sign * sum);
  for (++column; column <= last && column < east_end; ++column) {
    int next = int(height * share_up_to(column, low, high) + rounding);
    atomicAdd(differences[cells + column], sign * (next - sum));
    sum = next;
  }
  if (column < east_end) atomicAdd(differences[cells + column], sign * (whole - sum));
}

uint mixed(double value) {
  uvec2 bits = unpackDouble2x32(value);
  uint product = (bits.x ^ bits.y) * 2654435769u;
  return (product ^ product >> 15) * 3266489917u;
}

// From 0 to 1.
float threshold_of(uint mixed_bits) {
  return float(mixed_bits >> 8) * (1.0 / 16777216.0);
}

// Of a place between the north of a row, 0, and its south, 1.
int units_of(double place) {
  return int(place * UNITS + double(threshold_of(mixed(place))));
}

void main() {
  if (gl_GlobalInvocationID.x >= 2u * count) return;
  uint index = indices[first + (gl_GlobalInvocationID.x >> 1)];
  bool is_right = (gl_GlobalInvocationID.x & 1u) != 0u;
  int sign = is_right ? -1 : 1;
  int texel = int(index) * 5;
  ivec2 top_and_bottom = texelFetch(trapezoids, texel).xy;
  dvec2 span = (dvec2(top_and_bottom) - origin.y) * pixels_per_cell.y - first_row;
  span = dvec2(max(span.x, 0.0LF), min(span.y, double(size.y)));
  if (span.x >= span.y) return;

  double row = floor(span.x);
  double last_row = ceil(span.y) - 1.0LF;
  Side side = side_at(texel + (is_right ? 3 : 1), span, row);
  float rounding = threshold_of(mixed(fract(span.x)) + 3u * mixed(fract(span.y)));
  int cells = place + int(row) * size.x;
  int last = int(last_row - row);
  int from = units_of(span.x - row);
  int to = units_of(span.y - last_row);
  float x = x_at(side, float(span.x - row));
  for (int i = 0; i <= last; ++i) {
    float next_y = i < last ? float(i + 1) : float(span.y - row);
    float next_x = x_at(side, next_y);
    int whole = (i < last ? int(UNITS) : to) - from;
    if (whole > 0) add_row(side, sign, x, next_x, cells, whole, rounding);
    from = 0;
    x = next_x;
    cells += size.x;
  }
}
)";

std::string define(const char* name, const std::string& value) {
  return std::string("#define ") + name + ' ' + value + '\n';
}

}  // namespace

std::string source() {
  return "#version 430 core\n" + define("UNITS", std::to_string(kUnitsPerPixel) + ".0") +
         define("INDICES", std::to_string(kIndicesBinding)) +
         define("DIFFERENCES", std::to_string(kDifferencesBinding)) +
         "layout(local_size_x = " + std::to_string(kGroup) + ") in;\n" + kTrapezoid;
}

}  // namespace trapeze::gl_shader

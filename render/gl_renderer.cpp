#include "render/gl_renderer.h"

#include <algorithm>
#include <stdexcept>

namespace trapeze {
namespace {

// Vertices are four to a trapezoid, and a run of that many has 16-bit indices.
constexpr std::uint32_t kQuadsPerRun = 16384;
constexpr std::uint32_t kIndicesPerQuad = 6;
constexpr std::uint32_t kVerticesPerQuad = 4;

// Coordinates named "local" are pixels counted from the corner of a whole pixel beside the
// trapezoid, so that single precision is relative to the trapezoid and not to the picture.
constexpr const char* kVertexShader = R"(#version 430 core
layout(binding = 0) uniform isamplerBuffer trapezoids;
uniform dvec2 origin;           // of the picture, in cells
uniform double pixels_per_cell;
uniform dvec2 size;             // of the picture, in pixels

// A side is the line through (x, y), going `slope` pixels east for each one south.
flat out vec4 left_side;   // x, y, slope, and the trapezoid's top; local
flat out vec4 right_side;  // x, y, slope, and the trapezoid's bottom; local
flat out vec3 corner;      // where local coordinates begin, and the sign of the area

const float kFarOff = 4096.0;  // pixels beyond the picture where a slanted quad is given up

struct Side {
  double x_top;
  double x_bottom;
  double slope;
};

Side cut(ivec2 upper, ivec2 lower, double top, double bottom) {
  dvec2 from = dvec2(upper);
  dvec2 along = dvec2(lower) - from;
  double slope = along.x / along.y;
  dvec2 start = (from - origin) * pixels_per_cell;
  return Side(start.x + (top - start.y) * slope, start.x + (bottom - start.y) * slope, slope);
}

// The same line seen from a point in the picture. A side that passes the picture is replaced by a
// vertical line beyond its border, which covers the same pixels.
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

// The quad keeps half a pixel and half a row's slant away from the sides, so that it holds the
// centre of every pixel touched; a little more makes up for the grid of the rasterizer. `outward`
// is -1 for the left and 1 for the right side. Returns x where the quad begins and where it ends.
// Towards a point of the trapezoid the sides of the quad may cross; in the middles of all rows,
// where it counts, they have not crossed yet, and beyond nothing is covered.
vec2 quad_side(Side side, double top, double bottom, double rows, float outward) {
  vec2 x = vec2(side.x_top, side.x_bottom);
  float widest = outward > 0.0 ? max(x.x, x.y) : min(x.x, x.y);
  float width = float(size.x);
  bool is_slanted = rows > 2.0LF && all(greaterThan(x, vec2(-kFarOff))) &&
                    all(lessThan(x, vec2(width + kFarOff)));
  if (!is_slanted) return vec2(clamp(widest + outward * 0.51, -1.0, width + 1.0));
  float slope = float(side.slope);
  float margin = 0.51 + 0.5 * abs(slope);
  vec2 overhang = vec2(floor(top) - top, ceil(bottom) - bottom) * slope;
  return x + overhang + outward * margin;
}

void main() {
  int first = (gl_VertexID >> 2) * 5;
  ivec2 levels = texelFetch(trapezoids, first).xy;
  double top = max((double(levels.x) - origin.y) * pixels_per_cell, 0.0LF);
  double bottom = min((double(levels.y) - origin.y) * pixels_per_cell, size.y);
  gl_Position = vec4(-2.0, -2.0, 0.0, 1.0);
  left_side = right_side = vec4(0.0);
  corner = vec3(0.0);
  if (top >= bottom) return;

  Side left = cut(texelFetch(trapezoids, first + 1).xy, texelFetch(trapezoids, first + 2).xy,
                  top, bottom);
  Side right = cut(texelFetch(trapezoids, first + 3).xy, texelFetch(trapezoids, first + 4).xy,
                   top, bottom);
  // Where left and right have changed places, the area counts negative.
  float sign = 1.0;
  if (left.x_top + left.x_bottom > right.x_top + right.x_bottom) {
    Side west = right;
    right = left;
    left = west;
    sign = -1.0;
  }
  if (max(right.x_top, right.x_bottom) <= 0.0LF || min(left.x_top, left.x_bottom) >= size.x) return;

  dvec2 begin = floor(dvec2(clamp(left.x_top, 0.0LF, size.x), top));
  corner = vec3(begin, sign);
  left_side = vec4(anchored(left, top, bottom, begin), top - begin.y);
  right_side = vec4(anchored(right, top, bottom, begin), bottom - begin.y);

  bool is_lower = (gl_VertexID & 2) != 0;
  bool is_right = (gl_VertexID & 1) != 0;
  double rows = ceil(bottom) - begin.y;
  vec2 x = is_right ? quad_side(right, top, bottom, rows, 1.0)
                    : quad_side(left, top, bottom, rows, -1.0);
  vec2 position = vec2(is_lower ? x.y : x.x, is_lower ? ceil(bottom) : begin.y);
  gl_Position = vec4(position / vec2(size) * 2.0 - 1.0, 0.0, 1.0);
}
)";

constexpr const char* kFragmentShader = R"(#version 430 core
flat in vec4 left_side;
flat in vec4 right_side;
flat in vec3 corner;
out float covered;

// The mean of clamp(u, 0, 1) for u going evenly from `a` to `b`.
float mean_clamped(float a, float b) {
  float low = min(a, b);
  float high = max(a, b);
  float span = high - low;
  // Below this the quotient loses more digits than the bend of the clamp is worth.
  if (span < 1e-3) return clamp(0.5 * (low + high), 0.0, 1.0);
  float from = clamp(low, 0.0, 1.0);
  float to = clamp(high, 0.0, 1.0);
  return (0.5 * (to - from) * (to + from) + max(high, 1.0) - max(low, 1.0)) / span;
}

// How much of the pixel's width lies left of the side, on average between two heights.
float left_of(vec4 side, float pixel_x, float from_y, float to_y) {
  return mean_clamped(side.x + (from_y - side.y) * side.z - pixel_x,
                      side.x + (to_y - side.y) * side.z - pixel_x);
}

void main() {
  vec2 pixel = gl_FragCoord.xy - 0.5 - corner.xy;
  float from_y = max(pixel.y, left_side.w);
  float to_y = min(pixel.y + 1.0, right_side.w);
  float width = left_of(right_side, pixel.x, from_y, to_y) -
                left_of(left_side, pixel.x, from_y, to_y);
  covered = corner.z * max(to_y - from_y, 0.0) * max(width, 0.0);
}
)";

GLuint compile(const GlFunctions& gl, GLenum type, const char* source) {
  const GLuint shader = gl.CreateShader(type);
  gl.ShaderSource(shader, 1, &source, nullptr);
  gl.CompileShader(shader);
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<char, 1024> log{};
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  gl.DeleteShader(shader);
  throw std::runtime_error(std::string("the GL device rejects a shader: ") + log.data());
}

std::string_view gl_error_name(GLenum error) {
  switch (error) {
    case GL_OUT_OF_MEMORY:
      return "out of memory";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "invalid framebuffer operation";
    case GL_CONTEXT_LOST:
      return "context lost";
    default:
      return "error";
  }
}

// A lost context may report its error for ever.
void throw_on_gl_error(const GlFunctions& gl, const char* what) {
  const GLenum error = gl.GetError();
  if (error == GL_NO_ERROR) return;
  for (int i = 0; i < 8 && gl.GetError() != GL_NO_ERROR; ++i) {
  }
  throw std::runtime_error(std::string("OpenGL: ") + std::string(gl_error_name(error)) + " while " +
                           what);
}

}  // namespace

GlRenderer::GlRenderer(std::unique_ptr<GlContext> context, std::shared_ptr<GlMeshStore> store)
    : context_(std::move(context)), store_(std::move(store)), gl_(context_->gl()) {
  const CurrentContext current(*context_);
  gl_.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &longest_side_);
  try {
    make_program();
    make_quad_indices();
    gl_.Enable(GL_BLEND);
    gl_.BlendFunc(GL_ONE, GL_ONE);
    throw_on_gl_error(gl_, "setting the renderer up");
  } catch (...) {
    delete_objects();
    throw;
  }
}

GlRenderer::~GlRenderer() {
  try {
    const CurrentContext current(*context_);
    delete_objects();
    store_->delete_forgotten(gl_);
  } catch (const std::exception&) {
    // The context is lost, and its objects with it.
  }
}

std::string_view GlRenderer::name() const {
  return context_->info().candidate.path == ContextPath::osmesa ? "osmesa" : "egl";
}

void GlRenderer::make_program() {
  const GLuint vertex_shader = compile(gl_, GL_VERTEX_SHADER, kVertexShader);
  GLuint fragment_shader = 0;
  try {
    fragment_shader = compile(gl_, GL_FRAGMENT_SHADER, kFragmentShader);
  } catch (...) {
    gl_.DeleteShader(vertex_shader);
    throw;
  }
  program_ = gl_.CreateProgram();
  gl_.AttachShader(program_, vertex_shader);
  gl_.AttachShader(program_, fragment_shader);
  gl_.LinkProgram(program_);
  gl_.DeleteShader(vertex_shader);
  gl_.DeleteShader(fragment_shader);
  GLint linked = GL_FALSE;
  gl_.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::array<char, 1024> log{};
    gl_.GetProgramInfoLog(program_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("the GL device rejects the program: ") + log.data());
  }
  origin_location_ = gl_.GetUniformLocation(program_, "origin");
  pixels_per_cell_location_ = gl_.GetUniformLocation(program_, "pixels_per_cell");
  size_location_ = gl_.GetUniformLocation(program_, "size");
  gl_.UseProgram(program_);
}

void GlRenderer::make_quad_indices() {
  std::vector<std::uint16_t> indices;
  indices.reserve(std::size_t{kQuadsPerRun} * kIndicesPerQuad);
  for (std::uint32_t quad = 0; quad < kQuadsPerRun; ++quad) {
    for (const std::uint32_t vertex : {0u, 1u, 2u, 2u, 1u, 3u}) {
      indices.push_back(static_cast<std::uint16_t>(quad * kVerticesPerQuad + vertex));
    }
  }
  gl_.GenVertexArrays(1, &vertex_array_);
  gl_.BindVertexArray(vertex_array_);
  gl_.GenBuffers(1, &quad_indices_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, quad_indices_);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(indices.size() * sizeof(indices[0])), indices.data(),
                 GL_STATIC_DRAW);
}

void GlRenderer::delete_objects() noexcept {
  for (const Target& target : targets_) {
    gl_.DeleteFramebuffers(1, &target.framebuffer);
    gl_.DeleteRenderbuffers(1, &target.renderbuffer);
  }
  gl_.DeleteBuffers(1, &quad_indices_);
  gl_.DeleteVertexArrays(1, &vertex_array_);
  gl_.DeleteProgram(program_);
}

void GlRenderer::draw(std::span<const MeshPart> parts, const View& view, Coverage& out) {
  view.check();
  const CurrentContext current(*context_);
  store_->delete_forgotten(gl_);
  bind_target(view.width, view.height);
  set_view(view);
  for (const MeshPart& part : parts) draw_part(part);
  out.resize(view.width, view.height);
  read_back(out);
  throw_on_gl_error(gl_, "drawing");
}

void GlRenderer::bind_target(int width, int height) {
  const auto found = std::find_if(targets_.begin(), targets_.end(), [&](const Target& target) {
    return target.width == width && target.height == height;
  });
  if (found != targets_.end()) {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, found->framebuffer);
  } else {
    Target& target = targets_[next_target_];
    next_target_ = (next_target_ + 1) % targets_.size();
    make_target(target, width, height);
  }
  gl_.Viewport(0, 0, width, height);
  const std::array<float, 4> nothing{};
  gl_.ClearBufferfv(GL_COLOR, 0, nothing.data());
}

void GlRenderer::make_target(Target& target, int width, int height) {
  if (std::max(width, height) > longest_side_) {
    throw std::runtime_error("the GL device draws at most " + std::to_string(longest_side_) +
                             " pixels a side");
  }
  gl_.DeleteFramebuffers(1, &target.framebuffer);
  gl_.DeleteRenderbuffers(1, &target.renderbuffer);
  target = {};
  gl_.GenRenderbuffers(1, &target.renderbuffer);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, target.renderbuffer);
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_R32F, width, height);
  gl_.GenFramebuffers(1, &target.framebuffer);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                              target.renderbuffer);
  throw_on_gl_error(gl_, "making a target");
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("the GL device cannot draw into 32-bit floats");
  }
  target.width = width;
  target.height = height;
}

void GlRenderer::set_view(const View& view) {
  gl_.Uniform2d(origin_location_, static_cast<double>(view.origin_x),
                static_cast<double>(view.origin_y));
  gl_.Uniform1d(pixels_per_cell_location_, 1.0 / view.cells_per_pixel);
  gl_.Uniform2d(size_location_, view.width, view.height);
}

// Cuts the ranges at the borders of chunks and into runs that the quad indices reach.
void GlRenderer::draw_part(const MeshPart& part) {
  std::uint32_t batch_chunk = 0;
  for (const TrapezoidRange& range : part.ranges) {
    std::uint32_t first = range.first;
    std::uint32_t left = range.count;
    while (left > 0) {
      const std::uint32_t chunk = first / store_->chunk_size();
      const std::uint32_t in_chunk = first % store_->chunk_size();
      const std::uint32_t count = std::min({left, kQuadsPerRun, store_->chunk_size() - in_chunk});
      if (chunk != batch_chunk) draw_batch(part.mesh, batch_chunk);
      batch_chunk = chunk;
      index_counts_.push_back(static_cast<GLsizei>(count * kIndicesPerQuad));
      base_vertices_.push_back(static_cast<GLint>(in_chunk * kVerticesPerQuad));
      first += count;
      left -= count;
    }
  }
  draw_batch(part.mesh, batch_chunk);
}

void GlRenderer::draw_batch(const MeshView& mesh, std::uint32_t chunk) {
  if (index_counts_.empty()) return;
  // If it is forgotten meanwhile, GL keeps what the commands given here still need.
  const GlMeshStore::ChunkPointer trapezoids = store_->chunk(gl_, mesh, chunk);
  gl_.BindTexture(GL_TEXTURE_BUFFER, trapezoids->texture);
  index_offsets_.resize(std::max(index_offsets_.size(), index_counts_.size()), nullptr);
  gl_.MultiDrawElementsBaseVertex(GL_TRIANGLES, index_counts_.data(), GL_UNSIGNED_SHORT,
                                  index_offsets_.data(), static_cast<GLsizei>(index_counts_.size()),
                                  base_vertices_.data());
  index_counts_.clear();
  base_vertices_.clear();
}

void GlRenderer::read_back(Coverage& out) {
  sums_.resize(out.pixels().size());
  gl_.ReadPixels(0, 0, out.width(), out.height(), GL_RED, GL_FLOAT, sums_.data());
  to_levels(sums_, out.row_begin(0));
}

}  // namespace trapeze

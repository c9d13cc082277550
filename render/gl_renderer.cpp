#include "render/gl_renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "render/gl_shaders.h"
#include "render/stopwatch.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kVerticesPerTrapezoid = 8;  // of sides

// Trapezoids that measure less are drawn as points: beyond it, a square has more pixels than the
// strips along two sides are worth.
constexpr double kPointPixels = 16;
constexpr int kLargestPoint = 20;  // with neighbours, and cut to whole pixels

// Pictures below this size on a side have no room for points.
constexpr int kSmallestWithPoints = 32;

// Heights of targets are rounded up to this many pictures, so that few different ones are needed.
constexpr std::size_t kMostInPass = 64;
std::size_t rounded_pictures(std::size_t count) {
  if (count <= 4) return count;
  const std::size_t step = std::bit_floor(count) / 4;
  return (count + step - 1) / step * step;
}

// Trapezoids of at most this size, as the mesh store has it, are drawn as points.
std::uint8_t largest_point_size(const View& view) {
  if (std::min(view.width, view.height) < kSmallestWithPoints) return 0;
  const double cells = std::max(1.0, kPointPixels * view.cells_per_pixel);
  return static_cast<std::uint8_t>(std::floor(std::log2(cells)));
}

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
  std::array<GLint, 2> point_sizes{};
  gl_.GetIntegerv(GL_POINT_SIZE_RANGE, point_sizes.data());
  can_draw_points_ = point_sizes[1] >= kLargestPoint;
  try {
    point_program_ = make_program(point_vertex_shader(), point_fragment_shader());
    side_program_ = make_program(side_vertex_shader(), side_fragment_shader());
    make_vertex_array();
    gl_.Enable(GL_PROGRAM_POINT_SIZE);
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

GlRenderer::Program GlRenderer::make_program(const std::string& vertex_source,
                                             const std::string& fragment_source) {
  const GLuint vertex_shader = compile(gl_, GL_VERTEX_SHADER, vertex_source.c_str());
  GLuint fragment_shader = 0;
  try {
    fragment_shader = compile(gl_, GL_FRAGMENT_SHADER, fragment_source.c_str());
  } catch (...) {
    gl_.DeleteShader(vertex_shader);
    throw;
  }
  Program program;
  program.name = gl_.CreateProgram();
  gl_.AttachShader(program.name, vertex_shader);
  gl_.AttachShader(program.name, fragment_shader);
  gl_.LinkProgram(program.name);
  gl_.DeleteShader(vertex_shader);
  gl_.DeleteShader(fragment_shader);
  GLint linked = GL_FALSE;
  gl_.GetProgramiv(program.name, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::array<char, 1024> log{};
    gl_.GetProgramInfoLog(program.name, static_cast<GLsizei>(log.size()), nullptr, log.data());
    gl_.DeleteProgram(program.name);
    throw std::runtime_error(std::string("the GL device rejects the program: ") + log.data());
  }
  program.origin = gl_.GetUniformLocation(program.name, "origin");
  program.pixels_per_cell = gl_.GetUniformLocation(program.name, "pixels_per_cell");
  program.size = gl_.GetUniformLocation(program.name, "size");
  program.first_row = gl_.GetUniformLocation(program.name, "first_row");
  return program;
}

void GlRenderer::make_vertex_array() {
  gl_.GenVertexArrays(1, &vertex_array_);
  gl_.BindVertexArray(vertex_array_);
  gl_.GenBuffers(1, &index_buffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_);
}

void GlRenderer::delete_objects() noexcept {
  for (const Target& target : targets_) {
    gl_.DeleteFramebuffers(1, &target.framebuffer);
    gl_.DeleteRenderbuffers(1, &target.renderbuffer);
  }
  gl_.DeleteBuffers(1, &index_buffer_);
  gl_.DeleteVertexArrays(1, &vertex_array_);
  gl_.DeleteProgram(point_program_.name);
  gl_.DeleteProgram(side_program_.name);
}

DrawTimes GlRenderer::draw(std::span<const CoverageTask> tasks) {
  DrawTimes times;
  for (const CoverageTask& task : tasks) task.view.check();
  const CurrentContext current(*context_);
  store_->delete_forgotten(gl_);
  while (!tasks.empty()) {
    const View& view = tasks.front().view;
    const auto fitting = static_cast<std::size_t>(std::max(1, longest_side_ / view.height));
    std::size_t count = 1;
    while (count < std::min({tasks.size(), fitting, kMostInPass}) &&
           tasks[count].view.width == view.width && tasks[count].view.height == view.height) {
      ++count;
    }
    draw_pass(tasks.first(count), times);
    tasks = tasks.subspan(count);
  }
  return times;
}

void GlRenderer::draw_pass(std::span<const CoverageTask> tasks, DrawTimes& times) {
  const View& view = tasks.front().view;
  const auto rows = static_cast<int>(rounded_pictures(tasks.size())) * view.height;
  {
    const Stopwatch stopwatch(times.draw_ms);
    bind_target(view.width, std::min(rows, std::max(longest_side_, view.height)));
    collect(tasks);
    upload_indices();
    draw_batches(tasks, point_program_, point_batches_, GL_POINTS, 0);
    draw_batches(tasks, side_program_, side_batches_, GL_TRIANGLES, point_indices_.size());
    point_batches_.clear();
    side_batches_.clear();
    gl_.Finish();
  }
  {
    const Stopwatch stopwatch(times.read_ms);
    read_back(tasks);
    throw_on_gl_error(gl_, "drawing");
  }
  const Stopwatch stopwatch(times.resolve_ms);
  resolve(tasks);
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

// Fills indices and batches with what the tasks draw.
void GlRenderer::collect(std::span<const CoverageTask> tasks) {
  point_indices_.clear();
  side_indices_.clear();
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    const std::uint8_t largest_point = can_draw_points_ ? largest_point_size(tasks[task].view) : 0;
    for (const MeshPart& part : tasks[task].parts) {
      GlMeshStore::ChunkPointer chunk;
      std::uint32_t chunk_number = 0;
      for (TrapezoidRange range : part.ranges) {
        while (range.count > 0) {
          const std::uint32_t number = range.first / store_->chunk_size();
          if (chunk == nullptr || number != chunk_number) {
            end_batches(task, chunk);
            chunk = store_->chunk(gl_, part.mesh, number);
            chunk_number = number;
          }
          const std::uint32_t first = range.first % store_->chunk_size();
          const std::uint32_t count = std::min(range.count, store_->chunk_size() - first);
          collect_run(*chunk, first, count, largest_point);
          range.first += count;
          range.count -= count;
        }
      }
      end_batches(task, chunk);
    }
  }
}

void GlRenderer::collect_run(const GlMeshStore::Chunk& chunk, std::uint32_t first,
                             std::uint32_t count, std::uint8_t largest_point) {
  for (std::uint32_t i = first; i < first + count; ++i) {
    const std::uint8_t size = chunk.sizes[i];
    if (size <= largest_point) {
      point_indices_.push_back(i);
    } else if (size != GlMeshStore::kNoSize) {
      const std::uint32_t vertex = i * kVerticesPerTrapezoid;
      for (const std::uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u, 4u, 5u, 6u, 6u, 5u, 7u}) {
        side_indices_.push_back(vertex + corner);
      }
    }
  }
}

// What was collected since the last ends is drawn from that chunk.
void GlRenderer::end_batches(std::size_t task, const GlMeshStore::ChunkPointer& chunk) {
  const auto end = [&](std::vector<Batch>& batches, std::size_t indices) {
    const std::size_t first = batches.empty() ? 0 : batches.back().first + batches.back().count;
    if (indices > first) batches.push_back({task, chunk, first, indices - first});
  };
  end(point_batches_, point_indices_.size());
  end(side_batches_, side_indices_.size());
}

void GlRenderer::upload_indices() {
  const auto bytes = [](std::size_t indices) {
    return static_cast<GLsizeiptr>(indices * sizeof(std::uint32_t));
  };
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, bytes(point_indices_.size() + side_indices_.size()),
                 nullptr, GL_STREAM_DRAW);
  gl_.BufferSubData(GL_ELEMENT_ARRAY_BUFFER, 0, bytes(point_indices_.size()),
                    point_indices_.data());
  gl_.BufferSubData(GL_ELEMENT_ARRAY_BUFFER, bytes(point_indices_.size()),
                    bytes(side_indices_.size()), side_indices_.data());
}

void GlRenderer::draw_batches(std::span<const CoverageTask> tasks, const Program& program,
                              const std::vector<Batch>& batches, GLenum mode,
                              std::size_t first_index) {
  if (batches.empty()) return;
  gl_.UseProgram(program.name);
  std::size_t last_task = tasks.size();
  for (const Batch& batch : batches) {
    if (batch.task != last_task) set_task(program, tasks[batch.task].view, batch.task);
    last_task = batch.task;
    gl_.BindTexture(GL_TEXTURE_BUFFER, batch.chunk->texture);
    const std::size_t offset = (first_index + batch.first) * sizeof(std::uint32_t);
    gl_.DrawElements(mode, static_cast<GLsizei>(batch.count), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(offset));
  }
}

void GlRenderer::set_task(const Program& program, const View& view, std::size_t task) {
  const int first_row = static_cast<int>(task) * view.height;
  gl_.Viewport(0, first_row, view.width, view.height);
  gl_.Uniform2d(program.origin, static_cast<double>(view.origin_x),
                static_cast<double>(view.origin_y));
  gl_.Uniform1d(program.pixels_per_cell, 1.0 / view.cells_per_pixel);
  gl_.Uniform2d(program.size, view.width, view.height);
  gl_.Uniform1f(program.first_row, static_cast<float>(first_row));
}

void GlRenderer::read_back(std::span<const CoverageTask> tasks) {
  const View& view = tasks.front().view;
  const auto width = static_cast<std::size_t>(view.width);
  const auto height = static_cast<std::size_t>(view.height);
  differences_.resize(width * height * tasks.size());
  gl_.ReadPixels(0, 0, view.width, view.height * static_cast<int>(tasks.size()), GL_RED, GL_FLOAT,
                 differences_.data());
}

void GlRenderer::resolve(std::span<const CoverageTask> tasks) const {
  const float* row_begin = differences_.data();
  for (const CoverageTask& task : tasks) {
    const View& view = task.view;
    const auto width = static_cast<std::size_t>(view.width);
    task.out->resize(view.width, view.height);
    for (int row = 0; row < view.height; ++row, row_begin += width) {
      sum_to_levels({row_begin, width}, task.out->row_begin(row));
    }
  }
}

}  // namespace trapeze

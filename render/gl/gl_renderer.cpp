#include "render/gl/gl_renderer.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "render/gl/gl_program.h"
#include "render/gl/gl_shader.h"
#include "render/mask/resolve_row.h"
#include "render/mask/stopwatch.h"

namespace trapeze {
namespace {

// In one pass, in pixels: a few dozen tiles.
constexpr std::size_t kMostPixels = std::size_t{1} << 22;

template <class Element>
GLsizeiptr bytes_of(std::size_t elements) {
  return static_cast<GLsizeiptr>(elements * sizeof(Element));
}

// Adds the sums of the shader to wider ones and resets them to 0.
void take_units(std::span<std::int32_t> units, std::span<std::int64_t> sums) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += std::exchange(units[i], 0);
}

std::string_view gl_error_name(GLenum error) {
  switch (error) {
    case GL_OUT_OF_MEMORY:
      return "out of memory";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_CONTEXT_LOST:
      return "context lost";
    default:
      return "error";
  }
}

// A lost context may report its error forever.
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
    : context_(std::move(context)),
      store_(std::move(store)),
      gl_(context_->gl()),
      gains_by_batching_(!context_->info().is_software()) {
  const CurrentContext current(*context_);
  GLint block_size = 0;
  gl_.GetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block_size);
  room_ = std::min(kMostPixels, static_cast<std::size_t>(block_size) / sizeof(std::int32_t));
  if (room_ < kMaxPicturePixels) {
    throw std::runtime_error("the GL device has no room for a row of a picture");
  }
  try {
    program_ = make_program();
    gl_.GenBuffers(1, &index_buffer_);
    gl_.GenBuffers(1, &differences_buffer_);
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

GlRenderer::Program GlRenderer::make_program() {
  Program program;
  program.name = make_compute_program(gl_, gl_shader::source());
  const auto location = [&](const char* name) {
    return gl_.GetUniformLocation(program.name, name);
  };
  program.first = location("first");
  program.count = location("count");
  program.origin = location("origin");
  program.pixels_per_cell = location("pixels_per_cell");
  program.first_row = location("first_row");
  program.size = location("size");
  program.place = location("place");
  return program;
}

void GlRenderer::delete_objects() noexcept {
  gl_.DeleteBuffers(1, &index_buffer_);
  gl_.DeleteBuffers(1, &differences_buffer_);
  gl_.DeleteProgram(program_.name);
}

DrawTimes GlRenderer::draw(std::span<const MaskTask> tasks) {
  DrawTimes times;
  for (const MaskTask& task : tasks) task.view.check();
  const CurrentContext current(*context_);
  store_->delete_forgotten(gl_);
  // Left over from a draw that failed.
  if (used_ > 0) differences_size_ = 0;
  bands_.clear();
  batches_.clear();
  indices_.clear();
  sums_.clear();
  used_ = 0;
  for (const MaskTask& task : tasks) {
    draw_task(task, times);
    if (!gains_by_batching_) finish_pass(times);
  }
  finish_pass(times);
  return times;
}

void GlRenderer::release_memory() {
  // {} would assign an empty list, which keeps the memory of a vector.
  indices_ = std::vector<std::uint32_t>();
  batches_ = std::vector<Batch>();
  bands_ = std::vector<Band>();
  sums_ = std::vector<std::int64_t>();
  try {
    release_device_memory();
  } catch (const std::exception&) {
    // The context is lost, and its objects with it: the next draw reports it.
  }
}

// A picture of most of a layer needs chunks many times larger than its masks; other pictures upload
// the few chunks that they need within milliseconds.
void GlRenderer::release_device_memory() {
  store_->forget_uploads(this);
  const CurrentContext current(*context_);
  store_->delete_forgotten(gl_);
  for (const GLuint buffer : {index_buffer_, differences_buffer_}) {
    gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
    gl_.BufferData(GL_SHADER_STORAGE_BUFFER, 0, nullptr, GL_STREAM_DRAW);
  }
  gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
  differences_size_ = 0;
}

void GlRenderer::draw_task(const MaskTask& task, DrawTimes& times) {
  task.out->begin(task.view.width, task.view.height);
  const int most_rows = static_cast<int>(room_) / task.view.width;
  for (int row = 0; row < task.view.height; row += most_rows) {
    draw_band({&task, row, std::min(most_rows, task.view.height - row), 0}, times);
  }
}

// Adds the trapezoids of the band to the pass. If the pass is full, it is finished first. The same
// happens if the band may have more trapezoids than its sums can hold; the band then continues in
// the next pass.
void GlRenderer::draw_band(Band band, DrawTimes& times) {
  if (band.task->cancellation != nullptr) band.task->cancellation->check();
  if (used_ + band.pixels() > room_) finish_pass(times);
  band.place = used_;
  used_ += band.pixels();
  bands_.push_back(band);
  std::uint32_t in_pass = 0;
  for (const MeshPart& part : band.task->parts) {
    for (TrapezoidRange range : part.ranges) {
      while (range.count > 0) {
        if (in_pass == kMostTrapezoids) {
          set_last_band_aside(times);
          in_pass = 0;
        }
        const std::uint32_t number = range.first / store_->chunk_size();
        const std::uint32_t first = range.first % store_->chunk_size();
        const std::uint32_t count =
            std::min({range.count, store_->chunk_size() - first, kMostTrapezoids - in_pass});
        choose(part.mesh, number, first, count, times);
        in_pass += count;
        range.first += count;
        range.count -= count;
      }
    }
  }
}

void GlRenderer::choose(const MeshView& mesh, std::uint32_t number, std::uint32_t first,
                        std::uint32_t count, DrawTimes& times) {
  const std::size_t band = bands_.size() - 1;
  if (batches_.empty() || batches_.back().band != band || batches_.back().mesh_id != mesh.id ||
      batches_.back().number != number) {
    const Stopwatch stopwatch(times.draw_ms);  // the chunk may have to be uploaded
    batches_.push_back(
        {band, mesh.id, number, store_->chunk(gl_, mesh, number, this), indices_.size(), 0});
  }
  batches_.back().count += count;
  for (std::uint32_t i = first; i < first + count; ++i) indices_.push_back(i);
}

// Draws the batches of the pass and maps the buffer of differences.
void GlRenderer::run_pass(DrawTimes& times) {
  {
    const Stopwatch stopwatch(times.draw_ms);
    prepare_buffers();
    run_batches();
    gl_.Finish();
  }
  const Stopwatch stopwatch(times.read_ms);
  batches_.clear();
  indices_.clear();
  auto* differences = static_cast<std::int32_t*>(
      gl_.MapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, bytes_of<std::int32_t>(used_),
                         GL_MAP_READ_BIT | GL_MAP_WRITE_BIT));
  throw_on_gl_error(gl_, "drawing");
  if (differences == nullptr)
    throw std::runtime_error("OpenGL: the buffer of areas cannot be mapped");
  differences_ = {differences, used_};
}

void GlRenderer::unmap() {
  differences_ = {};
  if (gl_.UnmapBuffer(GL_SHADER_STORAGE_BUFFER) != GL_TRUE) {
    throw std::runtime_error("OpenGL: the buffer of areas was lost while it was mapped");
  }
}

void GlRenderer::finish_pass(DrawTimes& times) {
  if (bands_.empty()) return;
  run_pass(times);
  const Stopwatch stopwatch(times.resolve_ms);
  for (const Band& band : bands_) resolve(band);
  unmap();
  bands_.clear();
  used_ = 0;
}

// Finishes the pass except for its last band, which continues in a pass of its own.
void GlRenderer::set_last_band_aside(DrawTimes& times) {
  run_pass(times);
  const Stopwatch stopwatch(times.resolve_ms);
  Band last = bands_.back();
  bands_.pop_back();
  for (const Band& band : bands_) resolve(band);
  sums_.resize(last.pixels());
  take_units(differences_.subspan(last.place, last.pixels()), sums_);
  unmap();
  last.place = 0;
  bands_.assign(1, last);
  used_ = last.pixels();
}

void GlRenderer::prepare_buffers() {
  gl_.UseProgram(program_.name);
  gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, gl_shader::kIndicesBinding, index_buffer_);
  gl_.BufferData(GL_SHADER_STORAGE_BUFFER, bytes_of<std::uint32_t>(indices_.size()),
                 indices_.data(), GL_STREAM_DRAW);
  gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, gl_shader::kDifferencesBinding, differences_buffer_);
  if (differences_size_ >= used_) return;
  gl_.BufferData(GL_SHADER_STORAGE_BUFFER, bytes_of<std::int32_t>(used_), nullptr, GL_STREAM_COPY);
  gl_.ClearBufferSubData(GL_SHADER_STORAGE_BUFFER, GL_R32I, 0, bytes_of<std::int32_t>(used_),
                         GL_RED_INTEGER, GL_INT, nullptr);
  differences_size_ = used_;
}

void GlRenderer::run_batches() {
  std::size_t last_band = bands_.size();
  for (const Batch& batch : batches_) {
    if (batch.band != last_band) set_band(bands_[batch.band]);
    last_band = batch.band;
    gl_.BindTexture(GL_TEXTURE_BUFFER, batch.chunk->texture);
    gl_.Uniform1ui(program_.first, static_cast<GLuint>(batch.first));
    const auto count = static_cast<GLuint>(batch.count);
    gl_.Uniform1ui(program_.count, count);
    gl_.DispatchCompute((2 * count + gl_shader::kGroup - 1) / gl_shader::kGroup, 1, 1);
  }
  gl_.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, differences_buffer_);
}

void GlRenderer::set_band(const Band& band) const {
  const View& view = band.task->view;
  gl_.Uniform2d(program_.origin, static_cast<double>(view.origin_x),
                static_cast<double>(view.origin_y));
  gl_.Uniform2d(program_.pixels_per_cell, 1.0 / view.cells_per_pixel, 1.0 / view.cells_per_row());
  gl_.Uniform1d(program_.first_row, view.first_row + band.first_row);
  gl_.Uniform2i(program_.size, view.width, band.rows);
  gl_.Uniform1i(program_.place, static_cast<GLint>(band.place));
}

// Sums of earlier passes belong to the band that is resolved first.
void GlRenderer::resolve(const Band& band) {
  const auto width = static_cast<std::size_t>(band.task->view.width);
  const std::span<std::int32_t> differences = differences_.subspan(band.place, band.pixels());
  for (int row = 0; row < band.rows; ++row) {
    const auto of_row = differences.subspan(static_cast<std::size_t>(row) * width, width);
    if (sums_.empty()) {
      resolve_row(of_row, *band.task->out);
      continue;
    }
    const auto sums = std::span(sums_).subspan(static_cast<std::size_t>(row) * width, width);
    take_units(of_row, sums);
    resolve_row(sums, *band.task->out);
  }
  sums_.clear();
}

}  // namespace trapeze

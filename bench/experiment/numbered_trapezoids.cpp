#include "bench/experiment/numbered_trapezoids.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "render/gl/gl_program.h"

namespace trapeze::experiment {
namespace {

// Writes TrapezoidRecords.
constexpr const char* kShader = R"(#version 430 core
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Vertices { ivec2 vertices[]; };
layout(std430, binding = 1) readonly buffer Numbers { uint numbers[]; };
layout(std430, binding = 2) writeonly buffer Records { ivec2 records[]; };
uniform uint count;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  records[5 * i] = ivec2(vertices[numbers[6 * i]].y, vertices[numbers[6 * i + 1]].y);
  for (uint k = 1; k < 5; ++k) records[5 * i + k] = vertices[numbers[6 * i + 1 + k]];
}
)";
constexpr GLuint kGroup = 64;

}  // namespace

NumberedTrapezoids::NumberedTrapezoids(Screen& screen, std::span<const Point> vertices)
    : screen_(screen), trapezoids_(screen) {
  const CurrentContext current(screen.context());
  const GlFunctions& gl = screen.context().gl();
  program_ = make_compute_program(gl, kShader);
  count_location_ = gl.GetUniformLocation(program_, "count");
  gl.GenBuffers(1, &vertices_);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, vertices_);
  gl.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()),
                vertices.data(), GL_STATIC_DRAW);
  gl.GenBuffers(1, &numbers_);
}

NumberedTrapezoids::~NumberedTrapezoids() {
  const CurrentContext current(screen_.context());
  const GlFunctions& gl = screen_.context().gl();
  gl.DeleteBuffers(1, &vertices_);
  gl.DeleteBuffers(1, &numbers_);
  gl.DeleteProgram(program_);
}

void NumberedTrapezoids::send(std::span<const VertexNumbers> numbers) {
  if (numbers.empty()) return;
  const CurrentContext current(screen_.context());
  const GlFunctions& gl = screen_.context().gl();
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, numbers_);
  if (room_ < numbers.size_bytes()) {
    room_ = 2 * numbers.size_bytes();
    gl.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(room_), nullptr,
                  GL_STREAM_DRAW);
  }
  void* room =
      gl.MapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(numbers.size_bytes()),
                        GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_RANGE_BIT | GL_MAP_UNSYNCHRONIZED_BIT);
  if (room == nullptr) throw std::runtime_error("the device gives no access to its memory");
  std::memcpy(room, numbers.data(), numbers.size_bytes());
  gl.UnmapBuffer(GL_SHADER_STORAGE_BUFFER);

  gl.UseProgram(program_);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, vertices_);
  for (std::size_t first = 0; first < numbers.size(); first += trapezoids_.chunk_size()) {
    const std::size_t count =
        std::min<std::size_t>(numbers.size() - first, trapezoids_.chunk_size());
    const GLuint records = trapezoids_.buffer(first);
    const auto bind = [&](GLuint binding, GLuint buffer, std::size_t from, std::size_t bytes) {
      gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer, static_cast<GLintptr>(from),
                         static_cast<GLsizeiptr>(bytes));
    };
    bind(1, numbers_, first * sizeof(VertexNumbers), count * sizeof(VertexNumbers));
    bind(2, records, 0, count * sizeof(TrapezoidRecord));
    gl.Uniform1ui(count_location_, static_cast<GLuint>(count));
    gl.DispatchCompute((static_cast<GLuint>(count) + kGroup - 1) / kGroup, 1, 1);
  }
  gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  gl.Finish();
}

}  // namespace trapeze::experiment

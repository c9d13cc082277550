#include "render/gl/gl_program.h"

#include <array>
#include <stdexcept>

namespace trapeze {
namespace {

GLuint compile(const GlFunctions& gl, const char* source) {
  const GLuint shader = gl.CreateShader(GL_COMPUTE_SHADER);
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

}  // namespace

GLuint make_compute_program(const GlFunctions& gl, const std::string& source) {
  const GLuint shader = compile(gl, source.c_str());
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, shader);
  gl.LinkProgram(program);
  gl.DeleteShader(shader);
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  std::array<char, 1024> log{};
  gl.GetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  gl.DeleteProgram(program);
  throw std::runtime_error(std::string("the GL device rejects the program: ") + log.data());
}

}  // namespace trapeze

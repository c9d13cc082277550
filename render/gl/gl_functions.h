// The OpenGL functions that the renderer calls, loaded by name from the library that created the
// context. Nothing links to libGL, so EGL and OSMesa can be used in one process.
//
// Thread-safety: immutable once loaded.
#pragma once

#include <GL/glcorearb.h>

// TYPE is the middle of the function pointer's type name, NAME follows "gl".
#define TRAPEZE_GL_FUNCTIONS(F)             \
  F(ATTACHSHADER, AttachShader)             \
  F(BINDBUFFER, BindBuffer)                 \
  F(BINDBUFFERBASE, BindBufferBase)         \
  F(BINDBUFFERRANGE, BindBufferRange)       \
  F(BINDTEXTURE, BindTexture)               \
  F(BUFFERDATA, BufferData)                 \
  F(BUFFERSUBDATA, BufferSubData)           \
  F(CLEARBUFFERSUBDATA, ClearBufferSubData) \
  F(COMPILESHADER, CompileShader)           \
  F(CREATEPROGRAM, CreateProgram)           \
  F(CREATESHADER, CreateShader)             \
  F(DELETEBUFFERS, DeleteBuffers)           \
  F(DELETEPROGRAM, DeleteProgram)           \
  F(DELETESHADER, DeleteShader)             \
  F(DELETETEXTURES, DeleteTextures)         \
  F(DISPATCHCOMPUTE, DispatchCompute)       \
  F(FINISH, Finish)                         \
  F(GENBUFFERS, GenBuffers)                 \
  F(GENTEXTURES, GenTextures)               \
  F(GETERROR, GetError)                     \
  F(GETINTEGERV, GetIntegerv)               \
  F(GETPROGRAMINFOLOG, GetProgramInfoLog)   \
  F(GETPROGRAMIV, GetProgramiv)             \
  F(GETSHADERINFOLOG, GetShaderInfoLog)     \
  F(GETSHADERIV, GetShaderiv)               \
  F(GETSTRING, GetString)                   \
  F(GETUNIFORMLOCATION, GetUniformLocation) \
  F(LINKPROGRAM, LinkProgram)               \
  F(MAPBUFFERRANGE, MapBufferRange)         \
  F(MEMORYBARRIER, MemoryBarrier)           \
  F(SHADERSOURCE, ShaderSource)             \
  F(TEXBUFFER, TexBuffer)                   \
  F(UNIFORM1D, Uniform1d)                   \
  F(UNIFORM1I, Uniform1i)                   \
  F(UNIFORM1UI, Uniform1ui)                 \
  F(UNIFORM2D, Uniform2d)                   \
  F(UNIFORM2I, Uniform2i)                   \
  F(UNMAPBUFFER, UnmapBuffer)               \
  F(USEPROGRAM, UseProgram)

namespace trapeze {

struct GlFunctions {
#define TRAPEZE_GL_MEMBER(TYPE, NAME) PFNGL##TYPE##PROC NAME = nullptr;
  TRAPEZE_GL_FUNCTIONS(TRAPEZE_GL_MEMBER)
#undef TRAPEZE_GL_MEMBER

  using AnyFunction = void (*)();
  using Lookup = AnyFunction (*)(const char* name);

  /// Throws std::runtime_error that names the function if one is missing.
  static GlFunctions load(Lookup lookup);
};

}  // namespace trapeze

// The OpenGL functions that the renderer calls, loaded by name from whichever library made the
// context. Nothing links to libGL, so EGL and OSMesa can live in one process.
//
// Thread-safety: immutable once loaded.
#pragma once

#include <GL/glcorearb.h>

// TYPE is the middle of the function pointer's type name, NAME follows "gl".
#define TRAPEZE_GL_FUNCTIONS(F)                       \
  F(ATTACHSHADER, AttachShader)                       \
  F(BINDBUFFER, BindBuffer)                           \
  F(BINDFRAMEBUFFER, BindFramebuffer)                 \
  F(BINDRENDERBUFFER, BindRenderbuffer)               \
  F(BINDTEXTURE, BindTexture)                         \
  F(BINDVERTEXARRAY, BindVertexArray)                 \
  F(BLENDFUNC, BlendFunc)                             \
  F(BUFFERDATA, BufferData)                           \
  F(BUFFERSUBDATA, BufferSubData)                     \
  F(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)   \
  F(CLEARBUFFERFV, ClearBufferfv)                     \
  F(COMPILESHADER, CompileShader)                     \
  F(CREATEPROGRAM, CreateProgram)                     \
  F(CREATESHADER, CreateShader)                       \
  F(DELETEBUFFERS, DeleteBuffers)                     \
  F(DELETEFRAMEBUFFERS, DeleteFramebuffers)           \
  F(DELETEPROGRAM, DeleteProgram)                     \
  F(DELETERENDERBUFFERS, DeleteRenderbuffers)         \
  F(DELETESHADER, DeleteShader)                       \
  F(DELETETEXTURES, DeleteTextures)                   \
  F(DELETEVERTEXARRAYS, DeleteVertexArrays)           \
  F(DRAWELEMENTS, DrawElements)                       \
  F(ENABLE, Enable)                                   \
  F(FINISH, Finish)                                   \
  F(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer) \
  F(GENBUFFERS, GenBuffers)                           \
  F(GENFRAMEBUFFERS, GenFramebuffers)                 \
  F(GENRENDERBUFFERS, GenRenderbuffers)               \
  F(GENTEXTURES, GenTextures)                         \
  F(GENVERTEXARRAYS, GenVertexArrays)                 \
  F(GETERROR, GetError)                               \
  F(GETINTEGERV, GetIntegerv)                         \
  F(GETPROGRAMINFOLOG, GetProgramInfoLog)             \
  F(GETPROGRAMIV, GetProgramiv)                       \
  F(GETSHADERINFOLOG, GetShaderInfoLog)               \
  F(GETSHADERIV, GetShaderiv)                         \
  F(GETSTRING, GetString)                             \
  F(GETUNIFORMLOCATION, GetUniformLocation)           \
  F(LINKPROGRAM, LinkProgram)                         \
  F(MAPBUFFERRANGE, MapBufferRange)                   \
  F(READPIXELS, ReadPixels)                           \
  F(RENDERBUFFERSTORAGE, RenderbufferStorage)         \
  F(SHADERSOURCE, ShaderSource)                       \
  F(TEXBUFFER, TexBuffer)                             \
  F(UNIFORM1D, Uniform1d)                             \
  F(UNIFORM1F, Uniform1f)                             \
  F(UNIFORM2D, Uniform2d)                             \
  F(UNMAPBUFFER, UnmapBuffer)                         \
  F(USEPROGRAM, UseProgram)                           \
  F(VIEWPORT, Viewport)

namespace trapeze {

struct GlFunctions {
#define TRAPEZE_GL_MEMBER(TYPE, NAME) PFNGL##TYPE##PROC NAME = nullptr;
  TRAPEZE_GL_FUNCTIONS(TRAPEZE_GL_MEMBER)
#undef TRAPEZE_GL_MEMBER

  using AnyFunction = void (*)();
  using Lookup = AnyFunction (*)(const char* name);

  /// Throws std::runtime_error, naming the function, if one is missing.
  static GlFunctions load(Lookup lookup);
};

}  // namespace trapeze

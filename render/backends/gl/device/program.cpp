#include "render/backends/gl/device/program.h"

#include <array>

#include "core/base/error.h"

namespace lodestone {
namespace {

std::string shader_log(GLuint shader) {
  std::array<GLchar, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  return log.data();
}

std::string program_log(GLuint program) {
  std::array<GLchar, 1024> log{};
  glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  return log.data();
}

// Compiles and attaches; the program keeps the shader alive.
void attach(const GlProgram& program, const GlStage& stage) {
  const GLuint shader = glCreateShader(stage.stage);
  const std::array<const char*, 2> text{"#version 450 core\n", stage.source.c_str()};
  glShaderSource(shader, static_cast<GLsizei>(text.size()), text.data(), nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  const std::string log = compiled ? "" : shader_log(shader);
  glAttachShader(program.name(), shader);
  glDeleteShader(shader);
  if (!compiled)
    throw UnsupportedError(describe("", "OpenGL", "the driver refuses a shader: " + log, "use --backend soft"));
}

}  // namespace

GlProgram link_program(std::span<const GlStage> stages) {
  GlProgram program;
  for (const GlStage& stage : stages) attach(program, stage);
  glLinkProgram(program.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (!linked)
    throw UnsupportedError(
        describe("", "OpenGL", "the driver refuses a program: " + program_log(program.name()), "use --backend soft"));
  return program;
}

GlProgram make_screen_program(std::string_view fragment_source) {
  const std::array<GlStage, 2> stages{
      GlStage{GL_VERTEX_SHADER,
              "void main() {\n"
              "  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
              "  gl_Position = vec4(corner, 0.0, 1.0);\n"
              "}\n"},
      GlStage{GL_FRAGMENT_SHADER, std::string(fragment_source)}};
  return link_program(stages);
}

void draw_screen(const GlVertexArray& nothing) {
  glBindVertexArray(nothing.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lodestone

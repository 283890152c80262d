// A model in a bare OpenGL window: selected and morphed on the CPU, drawn from client memory.
// usage: window MODEL.lode [FRAMES]
#include <GLFW/glfw3.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "lodestone/runtime.h"

using namespace lodestone;

namespace {

constexpr double degrees = 3.14159265358979323846 / 180, field = 45 * degrees;

// A camera that looks along -z from the eye, as glFrustum and glTranslate have it.
void set_camera(Vec3f eye, double aspect) {
  const double near = 0.01, top = near * std::tan(field / 2);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glFrustum(-top * aspect, top * aspect, -top, top, near, 20);
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glTranslatef(-eye.x, -eye.y, -eye.z);
}

void draw(const Hierarchy& model, const Radii& radii, Vec3f eye) {
  static Selection selection;
  static std::vector<MorphedVertex> vertices;
  static std::vector<Triangle> widened;  // of cells with short indices
  select_cells(model, radii, eye, {}, selection);
  const MorphContext context{&model, &radii, Blend::smoothstep, eye};
  for (const SelectedCell& selected : selection.cells) {
    const Cell& cell = model.cells[selected.cell];
    vertices.resize(cell.positions.size());
    morph_cell_vertices(context, selected.cell, vertices);
    glVertexPointer(3, GL_FLOAT, sizeof(MorphedVertex), &vertices[0].position);
    glNormalPointer(GL_FLOAT, sizeof(MorphedVertex), &vertices[0].normal);
    const auto triangles = cell.triangles.widened(widened);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles.size()), GL_UNSIGNED_INT, triangles.data());
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return std::fputs("usage: window MODEL.lode [FRAMES]\n", stderr), 2;
  const long frames = argc > 2 ? std::atol(argv[2]) : -1;
  const Hierarchy model = open_lode(argv[1]);
  if (!glfwInit()) return std::fputs("no display\n", stderr), 77;
  GLFWwindow* window = glfwCreateWindow(960, 720, "lodestone::runtime", nullptr, nullptr);
  if (!window) return glfwTerminate(), std::fputs("no window\n", stderr), 77;
  glfwMakeContextCurrent(window);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_LIGHTING);
  glEnable(GL_LIGHT0);
  glLightModeli(GL_LIGHT_MODEL_TWO_SIDE, 1);
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_NORMAL_ARRAY);
  unsigned char pixel[3] = {};
  for (long frame = 0; frame != frames && !glfwWindowShouldClose(window); ++frame) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    glViewport(0, 0, width, height);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const double aspect = static_cast<double>(width) / height;
    const Radii radii = make_radii(
        model,
        {.image_height = height, .vertical_fov = static_cast<float>(field), .aspect = static_cast<float>(aspect)});
    // To the model and back again.
    const Vec3f eye{0.5f, 0.5f, 2.5f + 1.5f * static_cast<float>(std::cos(0.01 * static_cast<double>(frame)))};
    set_camera(eye, aspect);
    draw(model, radii, eye);
    glReadPixels(width / 2, height / 2, 1, 1, GL_RGB, GL_UNSIGNED_BYTE, pixel);
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  std::printf("the middle of the last frame is %d %d %d\n", pixel[0], pixel[1], pixel[2]);
  glfwTerminate();
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}

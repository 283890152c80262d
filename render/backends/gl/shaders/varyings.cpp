#include "render/backends/gl/shaders/varyings.h"

#include <algorithm>
#include <optional>
#include <sstream>

namespace lodestone {
namespace {

std::optional<GlVarying> varying_on(const std::string& line, std::string_view direction) {
  std::istringstream words(line);
  std::string word;
  GlVarying varying;
  while (words >> word && (word == "flat" || word == "centroid" || word == "noperspective"))
    varying.qualifiers += word + " ";
  if (word != direction || !(words >> varying.type >> varying.name) || !varying.name.ends_with(';')) return {};
  varying.name.pop_back();
  return varying;
}

template <class Visit>
void for_each_line(std::string_view source, const Visit& visit) {
  std::istringstream lines{std::string(source)};
  for (std::string line; std::getline(lines, line);) visit(line);
}

// "layout(location = 3) ", or nothing for a varying that the order does not have.
std::string location(const GlVarying& varying, const std::vector<GlVarying>& order) {
  const auto found = std::ranges::find(order, varying.name, &GlVarying::name);
  if (found == order.end()) return {};
  return "layout(location = " + std::to_string(found - order.begin()) + ") ";
}

}  // namespace

std::vector<GlVarying> varyings_of(std::string_view source, std::string_view direction) {
  std::vector<GlVarying> all;
  for_each_line(source, [&](const std::string& line) {
    if (auto varying = varying_on(line, direction)) all.push_back(std::move(*varying));
  });
  return all;
}

std::string with_locations(std::string_view source, std::string_view direction, const std::vector<GlVarying>& order) {
  std::string out;
  for_each_line(source, [&](const std::string& line) {
    if (const auto varying = varying_on(line, direction)) out += location(*varying, order);
    out += line + "\n";
  });
  return out;
}

std::string geometry_source(const std::vector<GlVarying>& from_vertices, const std::vector<GlVarying>& order,
                            std::string_view declarations, std::string_view calls) {
  std::string in, out, copies;
  for (const GlVarying& v : from_vertices) {
    in += location(v, order) + v.qualifiers + "in " + v.type + " from_" + v.name + "[];\n";
    out += location(v, order) + v.qualifiers + "out " + v.type + " to_" + v.name + ";\n";
    copies += "    to_" + v.name + " = from_" + v.name + "[i];\n";
  }
  return "layout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\ninvariant gl_Position;\n" + in + out +
         with_locations(declarations, "out", order) + "void main() {\n  for (int i = 0; i < 3; ++i) {\n" + copies +
         std::string(calls) +
         "    gl_Position = gl_in[i].gl_Position;\n#ifdef CLIPPED\n    gl_ClipDistance[0] = "
         "gl_in[i].gl_ClipDistance[0];\n#endif\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n";
}

}  // namespace lodestone

#include "core/mesh/hard/hard_cases.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "core/base/error.h"
#include "core/mesh/hard/makers.h"

namespace lodestone {
namespace {

constexpr std::string_view no_triangle = "no triangle";

constexpr std::array cases{
    HardCase{"not-finite", "NaN and infinity among the coordinates", "", 2'000, true, hard::not_finite},
    HardCase{"zero-area", "triangles with equal corners, or corners on a line", "", 2'000, true, hard::zero_area},
    HardCase{"duplicate-faces", "triangles that are there twice or thrice", "", 2'000, true, hard::duplicate_faces},
    HardCase{"opposite-faces", "every triangle once from each side", "", 2'000, true, hard::opposite_faces},
    HardCase{"unused-vertices", "vertices without a triangle, some far away", "", 2'000, true, hard::unused_vertices},
    HardCase{"soup", "vertices of its own for every triangle", "", 2'000, true, hard::soup},
    HardCase{"misoriented", "a third of the triangles turned over", "", 2'000, true, hard::misoriented},
    HardCase{"inside-out", "closed, all triangles turned over", "", 2'000, true, hard::inside_out},
    HardCase{"holes", "every tenth triangle missing", "", 2'000, true, hard::holes},
    HardCase{"needles", "triangles of aspect 1e6 over more than half of the model", "", 2'000, true, hard::needles},
    HardCase{"crossing", "three balls through each other", "", 6'000, true, hard::crossing},
    HardCase{"fins", "edges of three to seven triangles", "", 2'000, true, hard::fins},
    HardCase{"bow-ties", "vertices in which separate fans meet", "", 2'000, true, hard::bow_ties},
    HardCase{"moebius", "a Moebius strip", "", 2'000, true, hard::moebius},
    HardCase{"klein", "a Klein bottle, through itself", "", 2'000, true, hard::klein},
    HardCase{"plane", "a square without any relief", "", 2'000, true, hard::plane},
    HardCase{"flat", "a large flat region around a small bump", "", 100'000, true, hard::flat},
    HardCase{"cylinder", "a tube of straight lines", "", 2'000, true, hard::cylinder},
    HardCase{"crease", "two planes along a straight fold", "", 2'000, true, hard::crease},
    HardCase{"cone", "a tip of many triangles", "", 2'000, true, hard::cone},
    HardCase{"wheel", "one vertex of as many triangles as there are", "", 100'000, true, hard::wheel},
    HardCase{"comb", "one polygon of 10,000 corners, not convex", "", 10'000, true, hard::comb},
    HardCase{"spiral", "one polygon of 10,000 corners, wound up", "", 10'000, true, hard::spiral},
    HardCase{"leaf", "two sheets that touch nearly everywhere", "", 2'000, true, hard::leaf},
    HardCase{"one-triangle", "one triangle", "", 1, false, hard::one_triangle},
    HardCase{"on-a-line", "all points on one line", "", 100, true, hard::on_a_line},
    HardCase{"in-a-point", "all points in one place", no_triangle, 100, true, hard::in_a_point},
    HardCase{"nothing", "no vertex and no triangle", no_triangle, 0, false, hard::nothing},
    HardCase{"grid-faces", "triangles with their middles on the faces of cells", "", 3'000, true, hard::grid_faces},
    HardCase{"negative", "all coordinates negative", "", 2'000, true, hard::negative},
    HardCase{"outlier", "one triangle a million times as far away as the rest is wide", "", 2'000, true, hard::outlier},
    HardCase{"long-triangles", "a few triangles across a fine surface", "", 4'000, true, hard::long_triangles},
    HardCase{"far-away", "detail of 1e-3 at an offset of 1e7", "", 2'000, true, hard::far_away},
    HardCase{"tiny", "a model of 1e-12", "", 2'000, true, hard::tiny},
    HardCase{"huge", "a model of 1e12", "", 2'000, true, hard::huge},
    HardCase{"denormal", "coordinates below the smallest normal float32", "", 2'000, true, hard::denormal},
    HardCase{"confetti", "triangles of which no two touch", "", 20'000, true, hard::confetti},
    HardCase{"uneven", "all triangles but a few in one corner of the model", "", 20'000, true, hard::uneven},
};

template <class Number>
void put(std::string& to, Number number) {
  std::array<char, sizeof(Number)> bytes;
  std::memcpy(bytes.data(), &number, sizeof(Number));
  to.append(bytes.data(), bytes.size());
}

}  // namespace

std::span<const HardCase> hard_cases() { return cases; }

const HardCase& hard_case(std::string_view name) {
  const auto found = std::ranges::find(cases, name, &HardCase::name);
  if (found != cases.end()) return *found;
  std::string known;
  for (const HardCase& c : cases) known += (known.empty() ? "" : ", ") + std::string(c.name);
  throw InputError("unknown hard case '" + std::string(name) + "'; known are " + known);
}

std::string hard_ply(const PolygonMesh& mesh) {
  std::size_t most = 0, at = 0;
  for (const std::size_t end : mesh.ends) most = std::max(most, end - std::exchange(at, end));
  const bool is_short = most < 256;
  std::string file = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.positions.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(mesh.polygon_count()) + "\nproperty list " + (is_short ? "uchar" : "uint") +
                     " int vertex_indices\nend_header\n";
  for (const Vec3d& p : mesh.positions) put(file, p.x), put(file, p.y), put(file, p.z);
  at = 0;
  for (const std::size_t end : mesh.ends) {
    const auto count = static_cast<std::uint32_t>(end - at);
    is_short ? put(file, static_cast<std::uint8_t>(count)) : put(file, count);
    for (; at < end; ++at) put(file, mesh.corners[at]);
  }
  return file;
}

}  // namespace lodestone

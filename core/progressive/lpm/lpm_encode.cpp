// The collapses of a progressive mesh, repeated from the finest level down, give the splits in reverse.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/math/round_up.h"
#include "core/progressive/collapse/ring_mesh.h"
#include "core/progressive/lpm/lpm.h"
#include "core/progressive/lpm/lpm_format.h"
#include "core/progressive/lpm/split_order.h"
#include "core/progressive/mesh/activation.h"

namespace lodestone {
namespace {

using namespace progressive;

[[noreturn]] void fail_order(const std::string& why) {
  throw InputError(describe("", "", "the collapses of the model cannot be undone one by one: " + why,
                            "write a .glb file, which does not need it"));
}

// The groups of a mesh, numbered.
struct Groups {
  std::vector<std::uint32_t> start, number;  // first vertex by group; group by vertex
  std::uint32_t base = 0;
  explicit Groups(const ProgressiveMesh& mesh) : number(group_starts(mesh)) {
    for (std::uint32_t v = 0; v < number.size(); ++v) {
      if (number[v] == v) start.push_back(v);
      if (v < mesh.base_vertices) base = static_cast<std::uint32_t>(start.size());
      number[v] = static_cast<std::uint32_t>(start.size()) - 1;
    }
  }
  [[nodiscard]] std::uint32_t size(std::uint32_t group, std::uint32_t vertices) const {
    return (group + 1 < start.size() ? start[group + 1] : vertices) - start[group];
  }
};

// Splits by group, added last first. Wedges take most of the place of a SplitMesh::Split, and a mesh without them needs
// none of it: its codec knows all of that.
class SplitList {
 public:
  SplitList(bool has_wedges, std::size_t count) : has_wedges_(has_wedges) {
    plain_.reserve(count);
    if (has_wedges) wedges_.reserve(count);
  }

  void add(const SplitMesh::Split& s) {
    plain_.push_back({s.parent, s.neighbour, s.between << 2 | static_cast<std::uint32_t>(s.side)});
    if (!has_wedges_) return;
    ids_.insert(ids_.end(), s.parents.begin(), s.parents.end());
    const auto middle = static_cast<std::uint32_t>(ids_.size());
    ids_.insert(ids_.end(), s.sectors.begin(), s.sectors.end());
    wedges_.push_back({middle, static_cast<std::uint32_t>(ids_.size()), s.wedge_a, s.wedge_b});
  }
  [[nodiscard]] std::size_t size() const { return plain_.size(); }
  [[nodiscard]] std::uint32_t parent(std::size_t split) const { return plain_[size() - 1 - split].parent; }
  [[nodiscard]] SplitMesh::Split operator[](std::size_t split) const {
    const std::size_t at = size() - 1 - split;
    const Plain& p = plain_[at];
    SplitMesh::Split s;
    s.parent = p.parent, s.neighbour = p.neighbour;
    s.between = p.between_and_side >> 2, s.side = static_cast<SplitMesh::Side>(p.between_and_side & 3);
    if (!has_wedges_) return s;
    const Wedges& w = wedges_[at];
    const auto ids = [&](std::size_t begin, std::size_t end) {
      return std::vector(ids_.begin() + static_cast<std::ptrdiff_t>(begin),
                         ids_.begin() + static_cast<std::ptrdiff_t>(end));
    };
    s.parents = ids(at > 0 ? wedges_[at - 1].sectors_end : 0, w.parents_end);
    s.sectors = ids(w.parents_end, w.sectors_end);
    s.wedge_a = w.a, s.wedge_b = w.b;
    return s;
  }

 private:
  struct Plain {
    std::uint32_t parent, neighbour, between_and_side;
  };
  struct Wedges {
    std::uint32_t parents_end, sectors_end;  // in ids_
    std::uint32_t a, b;
  };
  bool has_wedges_;
  std::vector<Plain> plain_;
  std::vector<Wedges> wedges_;
  std::vector<std::uint32_t> ids_;
};

class SplitRecorder {
 public:
  SplitRecorder(const ProgressiveMesh& mesh, const Groups& groups) : mesh_(mesh), groups_(groups) {
    plain_.positions = mesh.positions;
    plain_.triangles = mesh.triangles;
    for (const std::uint32_t g : groups.number) plain_.wedges.vertex.push_back(groups.start[g]);
    rings_.emplace(plain_);
    rings_->list_corners();
    rings_->make_rings(0, mesh.positions.size(), arena_);
    rings_->cut_open();
    if (rings_->cut_vertices() > 0) fail_order("the surface is not a manifold");
    plain_.triangles = std::vector<Triangle>();  // the rings have all of it
  }

  // Leaves the base.
  SplitList splits() {
    const std::size_t count = groups_.start.size() - groups_.base;
    SplitList out(rings_->has_wedges(), count);
    stars_.reserve(7 * count), star_sizes_.reserve(count);  // the average is six
    for (std::size_t g = groups_.start.size(); g-- > groups_.base;) out.add(take_back(groups_.start[g]));
    return out;
  }

  // The input of order_in_batches(); call it after splits().
  [[nodiscard]] SplitSequence sequence(const SplitList& splits) {
    SplitSequence out{.base = groups_.base, .parents = {}, .star_ends = {}, .stars = std::move(stars_)};
    std::ranges::reverse(out.stars);  // they came last first
    std::ranges::reverse(star_sizes_);
    out.parents.reserve(splits.size()), out.star_ends.reserve(splits.size());
    for (std::size_t k = 0; k < splits.size(); ++k) {
      out.parents.push_back(splits.parent(k));
      out.star_ends.push_back((k > 0 ? out.star_ends.back() : 0) + star_sizes_[k]);
    }
    return out;
  }

  [[nodiscard]] SplitMesh base() const {
    SplitMesh base;
    for (std::uint32_t g = 0; g < groups_.base; ++g) {
      const Ring& ring = rings_->ring(groups_.start[g]);
      if (ring.size == 0) fail_order("a vertex of the base has no triangle");
      SplitMesh::Star star{{}, ring.open != 0, groups_.start[g], groups_.size(g, mesh_.base_vertices)};
      for (std::uint32_t k = 0; k < ring.size; ++k)  // the last of an open star has no sector
        star.spokes.push_back(
            {groups_.number[ring.ids[k]], k < ring.sectors() ? wedge(groups_.start[g], k) : star.first_wedge});
      base.stars.push_back(std::move(star));
    }
    base.wedge_count = mesh_.base_vertices;
    return base;
  }

 private:
  [[nodiscard]] std::uint32_t wedge(Id v, std::uint32_t k) const {
    return rings_->has_wedges() ? rings_->ring(v).wedge(k) : v;
  }

  SplitMesh::Split take_back(Id v) {
    const Id u = groups_.start[groups_.number[mesh_.parents[v]]];
    if (rings_->ring(v).find(u) == rings_->ring(v).size) fail_order("a vertex and its parent share no edge");
    Collapse c{.vertex = v, .target = u};
    if (!rings_->allows(c)) fail_order("one of them changes the shape of the surface");
    const Ring& ring = rings_->ring(v);
    SplitMesh::Split split;
    split.parent = groups_.number[u];
    split.side = ring.open == 0 ? SplitMesh::Side::inside : c.at == 0 ? SplitMesh::Side::back : SplitMesh::Side::front;
    split.between = ring.open == 0 ? ring.size - 3 : ring.size - 2;
    if (rings_->has_wedges()) add_wedges(c, split);
    for (const Id x : ring.neighbours()) stars_.push_back(groups_.number[x]);
    star_sizes_.push_back(ring.size);
    const bool front = split.side == SplitMesh::Side::front;
    split.neighbour = groups_.number[ring.ids[front ? ring.previous(c.at) : ring.next(c.at)]];
    (void)rings_->apply(c, arena_);
    return split;
  }

  void add_wedges(const Collapse& c, SplitMesh::Split& split) const {
    const Id v = c.vertex;
    const Ring& ring = rings_->ring(v);
    const std::uint32_t count = groups_.size(groups_.number[v], mesh_.vertex_count());
    split.parents.assign(mesh_.parents.begin() + v, mesh_.parents.begin() + v + count);
    const std::uint32_t first = split.side == SplitMesh::Side::front ? 0 : c.at;
    for (std::uint32_t n = 0, k = first; n < ring.sectors(); ++n, k = ring.next(k))
      split.sectors.push_back(wedge(v, k) - v);
    if (split.side != SplitMesh::Side::front) split.wedge_a = across(ring.ids[ring.next(c.at)], v);
    if (split.side != SplitMesh::Side::back) split.wedge_b = across(ring.ids[ring.previous(c.at)], c.target);
  }

  // The wedge of x in its triangle with `next` after it.
  [[nodiscard]] std::uint32_t across(Id x, Id next) const { return rings_->wedge_of(x, next); }

  const ProgressiveMesh& mesh_;
  const Groups& groups_;
  IndexedMesh plain_;
  std::optional<RingMesh> rings_;
  RingArena arena_;
  std::vector<std::uint32_t> stars_, star_sizes_;  // of the splits, last first
};

struct Recorded {
  SplitList splits;
  SplitSequence sequence;
  SplitMesh base;
};

// The base and the splits after it; the rings are freed.
Recorded record(const ProgressiveMesh& mesh, const Groups& groups) {
  SplitRecorder recorder(mesh, groups);
  SplitList splits = recorder.splits();
  SplitSequence sequence = recorder.sequence(splits);
  return {std::move(splits), std::move(sequence), recorder.base()};
}

// Splits and values with other numbers, by group. Splits are given in their new order, one by one.
class Renumbering {
 public:
  Renumbering(const Groups& groups, std::vector<std::uint32_t> number, std::uint32_t vertices)
      : groups_(groups), number_(std::move(number)), old_(number_.size()), wedge_(vertices), old_wedge_(vertices) {
    for (std::uint32_t g = 0; g < number_.size(); ++g) old_[number_[g]] = g;
    std::uint32_t wedge = 0;
    for (const std::uint32_t g : old_)
      for (std::uint32_t k = 0; k < groups.size(g, vertices); ++k, ++wedge) {
        wedge_[groups.start[g] + k] = wedge;
        old_wedge_[wedge] = groups.start[g] + k;
      }
  }

  [[nodiscard]] SplitMesh::Split split(const SplitList& splits, std::size_t k) const {
    SplitMesh::Split s = splits[old_[groups_.base + k] - groups_.base];
    s.parent = number_[s.parent], s.neighbour = number_[s.neighbour];
    for (std::uint32_t& parent : s.parents) parent = wedge_[parent];
    s.wedge_a = wedge_[s.wedge_a], s.wedge_b = wedge_[s.wedge_b];
    return s;
  }

  // Errors are the largest of those of the vertices that come in later, as they tell of a mesh without all of these.
  void apply(LatticeValues& values) const {
    take(old_, values.positions), take(old_, values.errors);
    take(old_wedge_, values.uv), take(old_wedge_, values.colours), take(old_wedge_, values.materials);
    for (std::size_t g = old_.size(); g-- > std::max<std::size_t>(groups_.base, 1);)
      values.errors[g - 1] = std::max(values.errors[g - 1], values.errors[g]);
  }

 private:
  template <class Value>
  static void take(const std::vector<std::uint32_t>& from, std::vector<Value>& values) {
    if (values.empty()) return;
    std::vector<Value> out;
    out.reserve(values.size());
    for (const std::uint32_t k : from) out.push_back(values[k]);
    values = std::move(out);
  }

  const Groups& groups_;
  std::vector<std::uint32_t> number_, old_;       // of groups: by old number, by new number
  std::vector<std::uint32_t> wedge_, old_wedge_;  // likewise of wedges
};

// Quantization as coarse as the error of the finer levels would show in them: a smooth surface of many triangles needs
// more bits than one of few.
std::uint32_t enough_bits(const ProgressiveMesh& mesh, const Groups& groups) {
  constexpr std::uint32_t least = 12, most = 16;
  if (groups.start.empty()) return least;
  const float error = mesh.errors[groups.start[groups.start.size() / 2]];
  std::uint32_t bits = least;
  while (bits < most && std::ldexp(1.0, -static_cast<int>(bits)) > error) ++bits;
  return bits;
}

LpmHeader make_header(const ProgressiveMesh& mesh, const Groups& groups, const LpmConfig& config,
                      std::span<const Texture> thumbnails) {
  LpmHeader h;
  const WedgeAttributes& wedges = mesh.wedges;
  const std::uint32_t position_bits = config.position_bits > 0 ? config.position_bits : enough_bits(mesh, groups);
  h.settings = {position_bits,      config.uv_bits,         groups.start.size() < mesh.positions.size(),
                !wedges.uv.empty(), !wedges.colour.empty(), !wedges.material.empty()};
  h.vertices = mesh.vertex_count();
  h.groups = static_cast<std::uint32_t>(groups.start.size());
  h.base_groups = groups.base;
  h.transform = mesh.transform;
  h.transform.lattice = {};
  h.materials = wedges.materials;
  h.object_normals = mesh.object_normals;
  h.geometry_images = mesh.geometry_images;
  h.octahedral = mesh.octahedral;
  for (const Texture& t : wedges.textures)
    h.textures.push_back({t.name, t.media_type, t.wrap_u, t.wrap_v, {}, t.mag_filter, t.min_filter});
  for (const Texture& t : thumbnails) h.thumbnails.push_back(t.bytes.empty() ? "" : t.media_type);
  if (wedges.uv.empty()) return h;
  Vec2f lo = wedges.uv.front(), hi = lo;
  for (const Vec2f uv : wedges.uv) {
    lo = {std::min(lo.x, uv.x), std::min(lo.y, uv.y)};
    hi = {std::max(hi.x, uv.x), std::max(hi.y, uv.y)};
  }
  const double steps = static_cast<double>(1u << config.uv_bits);
  h.uv_low = {lo.x, lo.y};
  h.uv_step = {(double{hi.x} - lo.x) / steps, (double{hi.y} - lo.y) / steps};
  return h;
}

LatticeValues quantize(const ProgressiveMesh& mesh, const Groups& groups, const LpmHeader& h) {
  LatticeValues values;
  const double steps = static_cast<double>(1u << h.settings.position_bits);
  const auto nearest = [](double x) { return static_cast<std::int32_t>(std::floor(x + 0.5)); };
  for (const std::uint32_t v : groups.start) {
    const Vec3f p = mesh.positions[v];
    values.positions.push_back({nearest(p.x * steps), nearest(p.y * steps), nearest(p.z * steps)});
    values.errors.push_back(static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(mesh.errors[v]) + 0xffff) >> 16));
  }
  const auto step = [](double x, double low, double size) { return size > 0 ? (x - low) / size : 0; };
  for (const Vec2f uv : mesh.wedges.uv)
    values.uv.push_back(
        {nearest(step(uv.x, h.uv_low[0], h.uv_step[0])), nearest(step(uv.y, h.uv_low[1], h.uv_step[1]))});
  values.colours = mesh.wedges.colour;
  values.materials = mesh.wedges.material;
  return values;
}

// A bound of how far quantization moves a vertex: no point of a triangle moves farther than its corners.
double largest_move(const ProgressiveMesh& mesh, const Groups& groups, const LatticeValues& values,
                    std::uint32_t bits) {
  const double step = std::ldexp(1.0, -static_cast<int>(bits));
  double largest = 0;
  for (std::size_t g = 0; g < groups.start.size(); ++g) {
    const auto& to = values.positions[g];
    const Vec3d moved{to[0] * step, to[1] * step, to[2] * step};
    largest = std::max(largest, length_up(moved - to_double(mesh.positions[groups.start[g]])));
  }
  return largest;
}

void append(std::vector<std::byte>& out, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::byte>(value >> (8 * k)));
}

void append_frame(std::vector<std::byte>& out, std::span<const std::byte> bytes, std::uint32_t vertices) {
  append(out, static_cast<std::uint32_t>(bytes.size()));
  append(out, crc32(bytes));
  append(out, vertices);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace

LpmBytes encode_lpm(const ProgressiveMesh& mesh, const LpmConfig& config, std::span<const Texture> thumbnails) {
  const Groups groups(mesh);
  auto [splits, sequence, base] = record(mesh, groups);
  LpmHeader header = make_header(mesh, groups, config, thumbnails);
  LatticeValues source = quantize(mesh, groups, header);
  header.finest_error = sum_up(mesh.finest_error, largest_move(mesh, groups, source, header.settings.position_bits));
  const Renumbering renumbering(groups, order_in_batches(std::exchange(sequence, {}), config.batch),
                                mesh.vertex_count());
  renumbering.apply(source);
  LpmBytes out;
  out.finest_error = header.finest_error;
  const std::string text = to_json(header).dump();
  for (const char* c = lpm_magic; *c != 0; ++c) out.bytes.push_back(static_cast<std::byte>(*c));
  append(out.bytes, static_cast<std::uint32_t>(text.size()));
  append(out.bytes, crc32(std::as_bytes(std::span(text))));
  const auto text_bytes = std::as_bytes(std::span(text));
  out.bytes.insert(out.bytes.end(), text_bytes.begin(), text_bytes.end());
  const std::size_t header_end = out.bytes.size();
  for (const Texture& t : thumbnails)
    if (!t.bytes.empty()) append_frame(out.bytes, std::as_bytes(std::span(t.bytes)), 0);
  const std::size_t thumbnail_bytes = out.bytes.size() - header_end;

  SplitMesh growing;
  growing.stars.reserve(groups.start.size());
  LatticeValues values;
  SplitCodec<RangeEncoder> codec(header.settings, growing, values);
  RangeEncoder coder;
  codec.code_base(coder, base, source, header.base_groups);
  append_frame(out.bytes, coder.finish(), growing.wedge_count);
  out.base = out.bytes.size();
  for (std::size_t k = 0; k < splits.size();) {
    const auto groups_now = static_cast<std::uint32_t>(growing.stars.size());
    const std::size_t end = std::min<std::size_t>(splits.size(), k + splits_in_frame(groups_now));
    for (; k < end; ++k) codec.code(coder, renumbering.split(splits, k), source);
    append_frame(out.bytes, coder.finish(), growing.wedge_count);
  }
  out.geometry = out.bytes.size() - thumbnail_bytes;
  for (std::size_t k = 0; k < mesh.wedges.textures.size(); ++k) {
    const std::vector<char>& bytes = mesh.wedges.textures[k].bytes;
    const bool known = k < thumbnails.size() && thumbnails[k].bytes == bytes;
    append_frame(out.bytes, std::as_bytes(known ? std::span<const char>() : std::span(bytes)), growing.wedge_count);
  }
  return out;
}

}  // namespace lodestone

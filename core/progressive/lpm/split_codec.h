// The code of a vertex split: its effect on the mesh, and the position of the vertex.
//
// The parent is one of the vertices so far, as its distance from the parent before, which is small in the order of
// split_order.h; the rest is determined by the triangles around it, so that a parent,
// a neighbour and a count replace three index lists (hoppe1998's vertex splits). Positions and texture coordinates are
// differences from their predictions (split_prediction.h).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/attributes.h"
#include "core/progressive/lpm/range_coder.h"
#include "core/progressive/lpm/split_prediction.h"
#include "core/progressive/mesh/split_mesh.h"

namespace lodestone::progressive {

struct CodecSettings {
  std::uint32_t position_bits = 12, uv_bits = 12;
  bool wedges = false, uv = false, colours = false, materials = false;
};

// Both directions. `values` and `mesh` grow with the splits; the encoder takes new values from `source`.
template <class Coder>
class SplitCodec {
 public:
  SplitCodec(const CodecSettings& settings, SplitMesh& mesh, LatticeValues& values)
      : settings_(settings), mesh_(mesh), values_(values) {}

  // One split; a decoder ignores `split` and `source`. Throws InputError for anything that no encoder writes.
  void code(Coder& coder, SplitMesh::Split split, const LatticeValues& source) {
    if constexpr (std::is_same_v<Coder, RangeEncoder>) {
      const std::size_t at = mesh_.stars[split.parent].find(split.neighbour);
      split.at = static_cast<std::uint32_t>(at);
    }
    code_place(coder, split);
    if (!mesh_.fits(split)) fail();
    SplitMesh::Star star = mesh_.star_of(split);
    split.sectors.resize(star.sectors());
    code_wedges(coder, split, star);
    const std::size_t group = mesh_.stars.size();
    code_values(coder, split, star, source, group);
    mesh_.apply(split, std::move(star));
  }

  // The base: stars and values without prediction.
  void code_base(Coder& coder, const SplitMesh& base, const LatticeValues& source, std::uint32_t count) {
    for (std::uint32_t v = 0; v < count; ++v) {
      const std::uint32_t wedges = numbers_[0].code(coder, v < base.stars.size() ? base.stars[v].wedges : 0);
      if (wedges == 0 || wedges > max_wedges) fail();
      mesh_.stars.push_back({{}, false, mesh_.wedge_count, wedges});
      mesh_.wedge_count += wedges;
      values_.positions.push_back(v < source.positions.size() ? source.positions[v] : std::array<std::int32_t, 3>{});
      for (std::int32_t& x : values_.positions.back())
        x = static_cast<std::int32_t>(coder.direct(settings_.position_bits + 1, static_cast<std::uint32_t>(x)));
      code_error(coder, source, v);
      for (std::uint32_t w = 0; w < wedges; ++w) code_base_wedge(coder, source, mesh_.stars.back().first_wedge + w);
    }
    for (std::uint32_t v = 0; v < count; ++v) code_base_star(coder, base, v);
    check_base();
  }

 private:
  static constexpr std::uint32_t max_wedges = 1u << 16, max_spokes = 1u << 20;

  [[noreturn]] static void fail() { throw InputError("inconsistent vertex splits"); }

  static std::uint32_t bits_for(std::uint32_t count) {
    return count < 2 ? 0 : static_cast<std::uint32_t>(std::bit_width(count - 1));
  }

  void code_base_wedge(Coder& coder, const LatticeValues& source, std::size_t wedge) {
    if (settings_.materials) {
      const std::uint32_t material = wedge < source.materials.size() ? source.materials[wedge] + 1 : 0;
      values_.materials.push_back(material_.code(coder, material) - 1);
    }
    if (settings_.uv) {
      values_.uv.push_back(wedge < source.uv.size() ? source.uv[wedge] : std::array<std::int32_t, 2>{});
      for (std::int32_t& x : values_.uv.back())
        x = static_cast<std::int32_t>(coder.direct(settings_.uv_bits + 1, static_cast<std::uint32_t>(x)));
    }
    if (!settings_.colours) return;
    values_.colours.push_back(wedge < source.colours.size() ? source.colours[wedge] : Rgba8{});
    Rgba8& c = values_.colours.back();
    for (std::uint8_t* x : {&c.r, &c.g, &c.b, &c.a}) *x = static_cast<std::uint8_t>(coder.direct(8, *x));
  }

  void code_base_star(Coder& coder, const SplitMesh& base, std::uint32_t v) {
    const auto known = [&] { return v < base.stars.size(); };
    SplitMesh::Star& star = mesh_.stars[v];
    star.open = coder.direct(1, known() && base.stars[v].open ? 1 : 0) != 0;
    const std::uint32_t size =
        numbers_[1].code(coder, known() ? static_cast<std::uint32_t>(base.stars[v].spokes.size()) : 0);
    if (size < 2 || size > max_spokes) fail();
    const std::uint32_t bits = bits_for(static_cast<std::uint32_t>(mesh_.stars.size()));
    for (std::uint32_t k = 0; k < size; ++k) {
      SplitMesh::Spoke spoke = known() ? base.stars[v].spokes[k] : SplitMesh::Spoke{};
      spoke.vertex = coder.direct(bits, spoke.vertex);
      if (spoke.vertex >= mesh_.stars.size()) fail();
      const std::uint32_t wedge = coder.direct(bits_for(star.wedges), spoke.wedge - star.first_wedge);
      if (wedge >= star.wedges) fail();
      spoke.wedge = star.first_wedge + wedge;
      star.spokes.push_back(spoke);
    }
  }

  // Every spoke must have one that leads back: splits look for it.
  void check_base() const {
    for (std::uint32_t v = 0; v < mesh_.stars.size(); ++v)
      for (const SplitMesh::Spoke& spoke : mesh_.stars[v].spokes) {
        if (spoke.vertex == v) fail();
        (void)mesh_.stars[spoke.vertex].find(v);
      }
  }

  void code_place(Coder& coder, SplitMesh::Split& s) {
    const auto count = static_cast<std::uint32_t>(mesh_.stars.size());
    if (count == 0) fail();
    const std::uint32_t steps = steps_.code(coder, (s.parent + count - last_parent_) % count);
    if (steps >= count) fail();
    s.parent = last_parent_ = (last_parent_ + steps) % count;
    const SplitMesh::Star& u = mesh_.stars[s.parent];
    const auto size = static_cast<std::uint32_t>(u.spokes.size());
    s.side = SplitMesh::Side::inside == s.side || u.open ? s.side : SplitMesh::Side::inside;
    if (u.open) {
      const auto side = static_cast<std::uint32_t>(s.side);
      if (coder.bit(side_[0], side != 0 ? 1 : 0) == 0) {
        s.side = SplitMesh::Side::inside;
      } else {
        s.side = static_cast<SplitMesh::Side>(1 + coder.bit(side_[1], side == 2 ? 1 : 0));
      }
    }
    s.between = between_[std::min(size, 11u)].code(coder, s.between);
    if (s.side == SplitMesh::Side::front) {
      s.at = s.between;
    } else if (s.side == SplitMesh::Side::back) {
      s.at = size - std::min(size, s.between + 1);
    } else if (size <= 16) {
      s.at = at_[size - 1].code(coder, s.at);
    } else {
      s.at = coder.direct(bits_for(size), s.at);
    }
  }

  // The number of wedges of the vertex, the parent and the sectors of each; and the wedges of a and b.
  void code_wedges(Coder& coder, SplitMesh::Split& s, SplitMesh::Star& star) {
    const SplitMesh::Star& u = mesh_.stars[s.parent];
    if (!settings_.wedges) {
      s.parents.assign(1, u.first_wedge);
      std::fill(s.sectors.begin(), s.sectors.end(), 0);
      finish_wedges(s, star);
      return;
    }
    const std::uint32_t count =
        count_[std::min(u.wedges, 3u)].code(coder, static_cast<std::uint32_t>(s.parents.size()));
    if (count == 0 || count > max_wedges) fail();
    s.parents.resize(count);
    for (std::uint32_t& p : s.parents) p = u.first_wedge + code_local(coder, u.wedges, p - u.first_wedge, from_);
    std::uint32_t before = 0;
    for (std::uint32_t& sector : s.sectors) {
      if (count > 1) {
        if (coder.bit(same_, sector == before ? 1 : 0) != 0) {
          sector = before;
        } else {
          sector = code_local(coder, count, sector, which_);
        }
      } else {
        sector = 0;
      }
      before = sector;
    }
    finish_wedges(s, star);
    if (s.side != SplitMesh::Side::front) {
      const SplitMesh::Star& a = mesh_.stars[star.spokes[1].vertex];
      const std::size_t at = a.find(s.parent);
      s.wedge_a = code_beside(coder, a, at, s.wedge_a, beside_a_);
    }
    if (s.side != SplitMesh::Side::back) {
      const std::size_t b_at = s.side == SplitMesh::Side::front ? s.between : star.spokes.size() - 1;
      const SplitMesh::Star& b = mesh_.stars[star.spokes[b_at].vertex];
      s.wedge_b = code_beside(coder, b, b.find(s.parent), s.wedge_b, beside_b_);
    }
  }

  void finish_wedges(SplitMesh::Split& s, SplitMesh::Star& star) {
    for (std::size_t k = 0; k < star.spokes.size(); ++k)
      star.spokes[k].wedge = star.first_wedge + s.sectors[std::min(k, s.sectors.size() - 1)];
    if (settings_.wedges) return;
    const std::size_t b_at = s.side == SplitMesh::Side::front ? s.between : star.spokes.size() - 1;
    s.wedge_a = mesh_.stars[star.spokes[std::min<std::size_t>(1, b_at)].vertex].first_wedge;
    s.wedge_b = mesh_.stars[star.spokes[b_at].vertex].first_wedge;
  }

  // One of `count`.
  std::uint32_t code_local(Coder& coder, std::uint32_t count, std::uint32_t value, BitModel& first) {
    if (count < 2) return 0;
    if (coder.bit(first, value != 0 ? 1 : 0) == 0) return 0;
    const std::uint32_t out = 1 + coder.direct(bits_for(count - 1), value - 1);
    if (out >= count) fail();
    return out;
  }

  // The wedge of a or b in the new triangle: mostly that on either side of the edge to the parent.
  std::uint32_t code_beside(Coder& coder, const SplitMesh::Star& star, std::size_t at, std::uint32_t wedge,
                            std::array<BitModel, 2>& model) {
    if (star.wedges < 2) return star.first_wedge;
    const bool last = star.open && at + 1 == star.spokes.size(), first = star.open && at == 0;
    const std::uint32_t behind = star.spokes[last ? star.previous(at) : at].wedge;
    const std::uint32_t before = star.spokes[first ? at : star.previous(at)].wedge;
    if (coder.bit(model[0], wedge == behind ? 0 : 1) == 0) return behind;
    if (coder.bit(model[1], wedge == before ? 0 : 1) == 0) return before;
    const std::uint32_t local = coder.direct(bits_for(star.wedges), wedge - star.first_wedge);
    if (local >= star.wedges) fail();
    return star.first_wedge + local;
  }

  void code_error(Coder& coder, const LatticeValues& source, std::size_t group) {
    const std::uint32_t before = values_.errors.empty() ? 0x7f80 : values_.errors.back();
    const std::uint32_t drop = group < source.errors.size() ? before - source.errors[group] : 0;
    const std::uint32_t coded = error_.code(coder, drop);
    if (coded > before) fail();
    values_.errors.push_back(static_cast<std::uint16_t>(before - coded));
  }

  static std::int32_t rounded(double x) { return static_cast<std::int32_t>(std::floor(x + 0.5)); }

  void code_values(Coder& coder, const SplitMesh::Split& s, const SplitMesh::Star& star, const LatticeValues& source,
                   std::size_t group) {
    code_error(coder, source, group);
    StarFit f = fit_star(star, values_.positions);
    std::array<std::int32_t, 3> p{};  // not in f: the compiler keeps it in registers
    const std::array<std::int32_t, 3> goal = group < source.positions.size() ? source.positions[group] : p;
    const std::uint32_t scale = std::min(f.scale, 15u);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = f.axis[k];
      double guess = f.middle[i] + (k == 2 ? 0.5 : 0.25) * f.bend[i];
      if (k == 2 && f.normal[i] != 0) {
        double slope = 0;
        for (std::size_t m = 0; m < 2; ++m)
          slope += f.normal[f.axis[m]] * (p[f.axis[m]] - f.middle[f.axis[m]] - 0.5 * f.bend[f.axis[m]]);
        guess -= slope / f.normal[i];
      }
      const std::int32_t most = 1 << settings_.position_bits;
      const std::int32_t from = rounded(std::min(std::max(guess, 0.0), static_cast<double>(most)));
      p[i] = from + position_[k == 2 ? 1 : 0][scale].code(coder, goal[i] - from);
      if (p[i] < 0 || p[i] > most) fail();
    }
    values_.positions.push_back(p);
    f.position = p;
    for (std::uint32_t w = 0; w < s.parents.size(); ++w) code_wedge_values(coder, s, star, source, f, w);
  }

  // The corners of the neighbours in the sectors of a wedge.
  void list_corners(const SplitMesh::Star& star, std::uint32_t wedge) {
    corners_.clear();
    for (std::size_t k = 0; k < star.sectors(); ++k) {
      if (star.spokes[k].wedge != wedge) continue;
      const std::size_t m = star.next(k);
      corners_.push_back({star.spokes[k].vertex, corner_of(star, k, m, true)});
      corners_.push_back({star.spokes[m].vertex, corner_of(star, k, m, false)});
    }
  }

  // The wedge of spoke k or m of the new star in the triangle between them. That triangle is there already, at the
  // parent, unless the parent is one of the two.
  [[nodiscard]] std::uint32_t corner_of(const SplitMesh::Star& star, std::size_t k, std::size_t m, bool first) const {
    const std::uint32_t x = star.spokes[k].vertex, y = star.spokes[m].vertex;
    if (x == split_parent_) return first ? split_parents_[star.spokes[k].wedge - star.first_wedge] : wedge_a_;
    if (y == split_parent_) return first ? wedge_b_ : split_parents_[star.spokes[k].wedge - star.first_wedge];
    const SplitMesh::Star& sx = mesh_.stars[first ? x : y];
    return sx.spokes[sx.find(first ? y : split_parent_)].wedge;
  }

  void code_wedge_values(Coder& coder, const SplitMesh::Split& s, const SplitMesh::Star& star,
                         const LatticeValues& source, const StarFit& f, std::uint32_t w) {
    const std::size_t wedge = star.first_wedge + w;
    if (settings_.materials) values_.materials.push_back(values_.materials[s.parents[w]]);
    if (settings_.uv) {
      split_parent_ = s.parent, split_parents_ = s.parents, wedge_a_ = s.wedge_a, wedge_b_ = s.wedge_b;
      list_corners(star, static_cast<std::uint32_t>(wedge));
      const bool whole = !star.open && corners_.size() == 2 * star.spokes.size();
      const std::array<double, 2> guess =
          guess_uv(f, corners_, values_, s.parents[w], whole ? StarCover::whole : StarCover::part);
      std::array<std::int32_t, 2> uv{};
      const std::int32_t most = 1 << settings_.uv_bits;
      for (std::size_t i = 0; i < 2; ++i) {
        const std::int32_t from = rounded(std::min(std::max(guess[i], 0.0), static_cast<double>(most)));
        const std::int32_t goal = wedge < source.uv.size() ? source.uv[wedge][i] : 0;
        uv[i] = from + uv_[std::min(f.scale, 15u)].code(coder, goal - from);
        if (uv[i] < 0 || uv[i] > most) fail();
      }
      values_.uv.push_back(uv);
    }
    if (!settings_.colours) return;
    Rgba8 c = values_.colours[s.parents[w]];
    const Rgba8 goal = wedge < source.colours.size() ? source.colours[wedge] : c;
    const auto code = [&](std::uint8_t& x, std::uint8_t to, std::size_t channel) {
      x = static_cast<std::uint8_t>(x + colour_[channel].code(coder, static_cast<std::int8_t>(to - x)));
    };
    code(c.r, goal.r, 0), code(c.g, goal.g, 1), code(c.b, goal.b, 2), code(c.a, goal.a, 3);
    values_.colours.push_back(c);
  }

  CodecSettings settings_;
  SplitMesh& mesh_;
  LatticeValues& values_;
  std::vector<StarCorner> corners_;
  std::uint32_t split_parent_ = 0, wedge_a_ = 0, wedge_b_ = 0;
  std::vector<std::uint32_t> split_parents_;

  std::array<NumberModel, 2> numbers_;  // of the base: wedges, spokes
  std::uint32_t last_parent_ = 0;
  NumberModel steps_;  // from one parent to the next
  std::array<BitModel, 2> side_;
  std::array<NumberModel, 12> between_;
  std::array<TreeModel<4>, 16> at_;
  std::array<NumberModel, 4> count_;
  BitModel same_, from_, which_;
  std::array<BitModel, 2> beside_a_, beside_b_;
  NumberModel error_, material_;
  std::array<std::array<SignedModel, 16>, 2> position_;
  std::array<SignedModel, 16> uv_;
  std::array<SignedModel, 4> colour_;
};

}  // namespace lodestone::progressive

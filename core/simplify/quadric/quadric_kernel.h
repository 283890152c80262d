// The quadric kernel: half-edge collapse on rings of 16-bit ids with a lazy queue (decision 0002).
//
// Based on quadric error metrics (garland1997), half-edge collapses under the link condition (dey1999) and a bucket
// queue. Different from the usual: no triangle list, every test of a vertex in eight lanes at once, and costs that are
// computed only when a vertex comes up. The template parameter is the kind of lanes; both kinds give the same bytes.
#pragma once

#include "core/simplify/quadric/quadric_block.h"
#include "core/simplify/quadric/quadric_piles.h"
#include "core/simplify/quadric/quadric_seams.h"

namespace lodestone::quadric {

// A collapse may leave a triangle this share of its height over the edge that stays, seen along its old normal.
inline constexpr float least_height = 0;
// Added to every quadric: weight * this * squared distance to where the vertex started. Flat and cylindrical parts get
// a minimum, and short edges go first where nothing else decides. Ten times more would outweigh the error itself on
// models of flat faces, ten times less would be lost in rounding.
inline constexpr float stiffness = 1e-6f;
// Planes that hold borders of the surface and seams, relative to its triangles.
inline constexpr float border_weight = 8;
// Of the displacement bound: single precision must not promise what double precision would refuse.
inline constexpr float bound_margin = 1 - 1e-5f;

// More than a few roundings take off.
inline constexpr float rounded_up = 1 + 1e-6f;
// Buckets that a cost may have risen by since its vertex was queued: a quarter of it. Twice as many are a little faster
// and make larger maxima, one is 3 % slower.
inline constexpr unsigned patience = 4;
// Vertices that are evaluated side by side. More overlap better but spoil one another's rings: of four 2 % have to be
// evaluated again.
inline constexpr unsigned batch_size = 4;

template <class L>
class BlockKernel {
 public:
  // seams: null for a mesh without wedges.
  BlockKernel(const SimplifyInput& input, Placement placement, Arrays& arrays, Piles& piles, Seams* seams,
              SimplifyResult& result)
      : input_(input),
        placement_(placement),
        a_(arrays),
        piles_(piles),
        seams_(seams),
        result_(result),
        count_(static_cast<unsigned>(input.positions.size())) {}

  void run() {
    place_points();
    link_triangles();
    start_vertices();
    collapse_to_target();
    if (placement_ == Placement::optimal) relocate_survivors();
    measure_distances();
    result_.triangles = live_;
    if (seams_ != nullptr) seams_->resolve(input_, result_.parent, result_.wedge_parent);
  }

 private:
  using Float = typename L::Float;
  using Points = typename L::Points;
  using Ids = typename L::Ids;

  static constexpr unsigned turn_front = 16;  // lanes in front, for loads that begin early

  // The ring of a vertex in lanes: G groups of eight, relative to the vertex.
  template <int G>
  struct Star {
    Float x[G], y[G], z[G];
  };
  // The triangles of a star. Moving the vertex by t keeps the normal of triangle k within 90 degrees iff
  // t . turn_k < size_k, since the normal is linear in t.
  template <int G>
  struct Faces {
    Float nx[G], ny[G], nz[G];
    Float size[G];  // squared length of the normal
    Float turn_x[G], turn_y[G], turn_z[G];
  };
  // A vertex that has come up, and where it would like to go.
  template <int G>
  struct Candidate {
    Star<G> star;
    Float error[G];              // of each target
    Ids ring;                    // as it was when the errors were computed
    Id around[turn_front + 32];  // the ring twice from turn_front on: it can be read from any neighbour on
    Id v;
    unsigned allowed;    // lanes that are left
    unsigned near;       // lanes known to be within the bound of every member
    unsigned lane;       // the cheapest of the allowed; 32 or more where none is left
    unsigned bucket;     // of its cost
    std::int64_t scale;  // what the errors are divided by, as a logarithm
  };
  struct Shift {
    float x, y, z;
  };
  // The nearest point of a star: in triangle `lane` of the vertex, or on its border.
  struct Foot {
    float squared;
    Id vertex;
    unsigned lane;
  };

  // quadric_star.h
  [[nodiscard]] unsigned degree(Id v) const { return Ids::load(a_.ring[v].lane).find(none); }
  template <int G>
  [[nodiscard, gnu::always_inline]] Star<G> load_star(Id v) const;
  template <int G>
  [[nodiscard, gnu::always_inline]] Faces<G> faces_of(const Star<G>& star, unsigned n) const;
  template <int G>
  [[nodiscard, gnu::always_inline]] unsigned flipped(const Faces<G>& faces, Shift t) const;
  template <int G>
  [[gnu::always_inline]] static void next_in_ring(const Float (&a)[G], unsigned n, Float (&next)[G]);
  [[gnu::always_inline]] static Float quadratic_form(const Body& q, const Float& x, const Float& y, const Float& z);

  // quadric_setup.h
  void place_points();
  void link_triangles();
  [[gnu::always_inline]] void add_link(std::uint32_t v, std::uint32_t from, std::uint32_t to);
  [[gnu::always_inline]] void add_planes(const Id (&corner)[3][8]);
  void start_vertices();
  [[gnu::always_inline]] void make_ring(Id v);
  [[gnu::noinline]] void make_other_ring(Id v, unsigned n);
  [[nodiscard]] static Ids starts_of(const Link& link);
  [[nodiscard]] static Ids ends_of(const Link& link);
  [[nodiscard]] unsigned close_ring(Id v, unsigned n, Id* ring) const;
  [[nodiscard]] unsigned open_ring(Id v, unsigned n, Id* ring) const;
  [[nodiscard]] unsigned pile_ring(Id v, unsigned n, Id* ring) const;
  [[gnu::always_inline]] void start_quadric(Id v);
  void push_eight(unsigned first);
  template <int G>
  [[nodiscard, gnu::always_inline]] Float first_errors(Id v, unsigned n) const;
  void add_edge_plane(Id v, unsigned lane, unsigned beside, Body& body) const;
  void add_seam_planes(Id v, unsigned n, Body& body) const;

  // quadric_collapse.h
  void collapse_to_target();
  void push(Id v, unsigned bucket);
  [[nodiscard]] unsigned take(unsigned bucket, Id (&batch)[batch_size]);
  [[gnu::noinline]] void visit_crowded(Id v, unsigned n, unsigned bucket);
  static std::int64_t scale_of(float weight);
  static unsigned bucket_of(float error, std::int64_t scale);
  template <int G>
  [[gnu::always_inline]] void survey(Id v, unsigned n, Candidate<G>& c) const;
  template <int G>
  [[gnu::always_inline]] void rate(Candidate<G>& c) const;
  template <int G>
  [[gnu::always_inline]] static void choose(Candidate<G>& c);
  template <int G>
  [[gnu::always_inline]] void decide(unsigned n, Candidate<G>& c, unsigned bucket);
  template <int G>
  [[nodiscard, gnu::always_inline]] unsigned within_bound(Id v, const Star<G>& star) const;
  [[nodiscard, gnu::always_inline]] bool joinable(Id v, unsigned n, unsigned lane) const;
  [[nodiscard]] bool makes_locked_chord(const Ring& ring, unsigned n, unsigned lane) const;
  [[gnu::always_inline]] void collapse(Id v, unsigned n, unsigned lane, const Id* behind, Shift t, unsigned bucket);
  void requeue(Id v, unsigned bucket);
  [[gnu::always_inline]] void merge_bodies(Id v, Id u, Shift t);

  // quadric_pile_collapse.h
  [[gnu::noinline]] void visit_pile(Id v, unsigned bucket);
  [[nodiscard]] unsigned pile_lanes(Id v, unsigned n) const;
  [[nodiscard]] unsigned border_lanes(Id v, unsigned n) const;
  [[nodiscard]] bool pile_flips(Id v, Id u) const;
  [[nodiscard]] bool pile_joinable(Id v, Id u) const;
  [[nodiscard]] unsigned shared_triangles(Id v, Id u, Id w) const;
  [[nodiscard]] unsigned uses(Id u, Id w) const;
  [[nodiscard]] bool has_triangle(Id u, Id a, Id b) const;
  void add_pile_planes(Id v, unsigned n, Body& body) const;
  void collapse_pile(Id v, Id u, unsigned bucket);
  void begin_pile(Id u);
  [[gnu::noinline]] void follow_piles(Id v, Id u, const Ring& ring);
  void heal(Id v);

  // quadric_relocate.h
  void relocate_survivors();
  template <int G>
  void relocate(Id v, unsigned n);
  static Shift minimum_of(const Body& body);
  [[nodiscard]] Shift to_lattice(Id v, Shift t) const;
  [[nodiscard]] bool members_reach(Id v, const Vec3f& position) const;

  // quadric_error.h
  struct Lane3 {
    Float x, y, z;
  };
  // A star for distances: side_k . o is the barycentric coordinate of the next neighbour, times the squared normal.
  template <int G>
  struct Sides {
    Star<G> star;
    Faces<G> faces;
    Float side_x[G], side_y[G], side_z[G];
    unsigned spokes, real;  // lanes with a neighbour, lanes with a triangle
  };
  void measure_distances();
  template <int G>
  void measure_members(Id v, unsigned n, float& known);
  void measure_members_apart(Id v, float& known);
  [[nodiscard]] bool is_unmoved(Id v) const;
  [[nodiscard]] Shift start_of(Id v) const;
  void settle(Id v, Id parent, float squared);
  template <int G>
  [[nodiscard, gnu::always_inline]] Sides<G> sides_of(Id v, unsigned n) const;
  template <int G>
  [[nodiscard, gnu::always_inline]] static unsigned feet(const Sides<G>& s, int g, const Float& x, const Float& y,
                                                         const Float& z);
  template <int G>
  [[nodiscard, gnu::always_inline]] static float above(const Sides<G>& s, Shift o);
  [[nodiscard, gnu::always_inline]] static Float from_segment(const Lane3& o, const Lane3& a, const Lane3& e);
  template <int G>
  [[nodiscard]] Foot around(Id v, const Sides<G>& s, Shift o) const;
  [[nodiscard]] Foot around(Id v, Shift q) const;
  [[nodiscard]] static Foot nearer(const Foot& a, const Foot& b) { return b.squared < a.squared ? b : a; }
  [[nodiscard]] float walk(Foot nearest, Shift q, float known) const;

  const SimplifyInput& input_;
  Placement placement_;
  Arrays& a_;
  Piles& piles_;
  Seams* seams_;
  SimplifyResult& result_;
  unsigned count_;
  float scale_ = 1;                      // from input coordinates to those of the block, a power of two
  float bound_ = 0, squared_bound_ = 0;  // in block coordinates
  std::size_t live_ = 0;                 // triangles
  std::size_t movable_ = 0;              // fans that may move, in the input
  std::size_t pile_corners_ = 0;         // triangles of the piles that may
  bool piles_move_ = false;              // some of them are piles
};

}  // namespace lodestone::quadric

#include "core/simplify/quadric/quadric_collapse.h"
#include "core/simplify/quadric/quadric_error.h"
#include "core/simplify/quadric/quadric_pile_collapse.h"
#include "core/simplify/quadric/quadric_relocate.h"
#include "core/simplify/quadric/quadric_setup.h"
#include "core/simplify/quadric/quadric_star.h"

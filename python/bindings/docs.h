// The docstrings. The first line of a function's is its signature, with the defaults, which is kept equal to the stub
// (lodestone/_lodestone.pyi) by a test; what all long functions take is said by the package (lodestone/__init__.py).
#pragma once

namespace lodestone::python::doc {

inline constexpr const char* mesh =
    R"(Mesh(positions, triangles, *, uv=None, normals=None, colours=None, up=None)

A triangle mesh in its own units, in double precision. Nothing in it changes.

positions: array (n, 3) of finite or other numbers; triangles: (m, 3) of indices below n, counter-clockwise seen
from outside. By vertex, or None: uv (n, 2), (0, 0) being the upper left corner of the image; normals (n, 3), of
unit length or zero; colours (n, 4), sRGB and linear alpha, 0 to 255. up: the axis that is up, 'x', 'y', 'z', '-x',
'-y' or '-z'. The arrays are copied. Raises InputError for other shapes, an index out of range, or a mesh without
triangles.

As properties: positions float64 (n, 3), triangles uint32 (m, 3), uv float32 (k, 2), normals float32 (k, 3), colours
uint8 (k, 4), corners uint32 (m, 3), materials uint32 (m,), up, and warnings, a list of what was left out. An
attribute that there is not is None. Those of a file are by wedge: corners are the wedges at the corners of the
triangles; None: the vertices.)";

inline constexpr const char* mesh_save =
    R"(save(path)

Writes a .ply, .obj, .stl or .glb file, completely or not at all. Returns what the format loses, a line each. Raises
UnsupportedError for another extension, FileError if the file cannot be written.)";

inline constexpr const char* read =
    R"(read(path, *, attributes=True, fill_voids=False, allow_outside=False, up=None, threads=0, progress=None)

Reads a mesh file of any format that `lodestone build` reads. attributes: also normals, colours, texture coordinates
and materials; fill_voids: of height grids; allow_outside: files that a model names, outside of its folder, too; up:
as of Mesh, instead of what the format says. Returns a Mesh. Raises InputError for a malformed file, FileError for
one that cannot be read, UnsupportedError for an unknown format, ResourceError for one too large.)";

inline constexpr const char* generate =
    R"(generate(shape, *, triangles=1000000, seed=1, threads=0, progress=None)

A surface in closed form: shape is 'sphere', 'terrain', 'torus', 'box' or 'pile'. triangles: 12 to 2e9, the nearest
regular grid is taken; seed: of the displacement. Returns a Mesh, the same on every machine. Raises InputError for
another shape or a number out of range.)";

inline constexpr const char* build =
    R"(build(mesh, *, sigma0=0.4, cell_triangles=1200, finest_level=-1, half_levels=False, simplifier='quadric',
    placement=None, strategy='graph', refine=False, refine_limit=10.0, measure_errors=False, texture_levels=False,
    compress=False, lattice_bits=0, threads=0, progress=None)

Builds the hierarchical level of detail of a Mesh (which is copied) or of a file, as `lodestone build` does: saved,
it has the same bytes, for any number of threads.

sigma0: a vertex moves by at most sigma0 h / 2 to its parent, h being the side of a cell; in (0, 2]. cell_triangles:
mean of an occupied finest cell, at least 1, from which the number of levels follows; finest_level: that instead, 0
to 15, or -1. half_levels: levels of a half of the triangles instead of a quarter. simplifier: 'quadric', 'cluster', 'openmesh' or 'meshopt'. placement: 'optimal' or 'endpoint'; None:
as fits the simplifier. strategy: 'graph', 'levels' or 'serial'. refine: split edges longer than sigma0 h, into at
most refine_limit times the triangles. measure_errors: bounds instead of estimates. texture_levels: textures of
coarser levels. compress: vertices on a lattice and cells reordered, as save(compress=True) needs it; lattice_bits:
1 to 24, the lattice; 0: none, or chosen. Returns a Hierarchy. Raises InputError for an invalid mesh or value, and
what read raises.)";

inline constexpr const char* load =
    R"(load(path, *, threads=0, progress=None)

Opens a .lode file and checks all of it. A plain file is used in place: it must not be shortened meanwhile. Returns
a Hierarchy. Raises FileError, InputError for a file that is truncated, altered or foreign, UnsupportedError for a
newer one.)";

inline constexpr const char* verify =
    R"(verify(hierarchy, *, input=None, threads=0, progress=None)

Checks every invariant independently of the builder, as `lodestone verify` does. input: the Mesh or file that it was
built from, with which the finest level is compared triangle by triangle. About a second per million triangles;
Ctrl-C counts at the next of its steps, four and one per level. Returns a dict: 'valid'; 'checks', a list of dicts
with 'name', 'passed' and 'detail'; 'sampled_over_error', by level the largest distance found over the level's error.
Raises what read raises.)";

inline constexpr const char* hierarchy =
    R"(Levels of detail of a mesh on a cubic grid, from build or load. Nothing in it changes.

Level 0 is the root, level `finest` the input; cell_count; levels: a list of dicts, the figures of `lodestone build`
by level; sigma0; half_levels; lattice_bits: 0 without a lattice; warnings: what was left out. origin: float64 (3,); scale. Cells
and viewpoints are in normalised space, the unit cube: a point p there is origin + scale * p in the space of the
model.)";

inline constexpr const char* hierarchy_mesh =
    R"(mesh(level)

A whole level as a Mesh in the space of the model; copies of a vertex in several cells become one. Raises InputError
if there is no such level.)";

inline constexpr const char* hierarchy_cell =
    R"(cell(index)

One cell, by its index below cell_count; cells are sorted by level and then in Morton order. Returns a Cell. Raises
IndexError.)";

inline constexpr const char* hierarchy_save =
    R"(save(path, *, compress=False, threads=0, progress=None)

Writes a .lode file, completely or not at all. compress: about a sixth as large; the hierarchy must have a lattice,
as build(compress=True) gives it. Returns the size in bytes. Raises FileError if it cannot be written, InputError
without a lattice.)";

inline constexpr const char* cell =
    R"(One cell of a hierarchy. Its arrays share the memory of the hierarchy and cannot be written, except for
normals, a copy.

positions: float32 (n, 3), normalised, those of vertices that other cells use last; triangles: uint32 (m, 3) of
indices into them; parents: uint32 (n,), the vertex of the parent cell that each becomes, empty at the root;
shared_ids: uint32, of the last positions, a number that names the vertex in all cells; normals: float32 (n, 3);
bounds: a pair of float64 (3,); error: distance from the finest level, normalised; level; parent: an index or None;
children: a range of indices.)";

inline constexpr const char* compare =
    R"(compare(a, b, *, area_points=0, threads=0, progress=None)

Distances between two surfaces, each a Mesh or a file, as `lodestone compare` measures them. area_points: samples on
each; 0: four per triangle, at most 1,000,000, at least 10,000. Returns a dict: 'rms', 'error_max', 'error_mean' and
'error_p99' in % of 'diagonal', the larger of both directions; 'forward' and 'backward' with 'max', 'rms', 'mean'
and 'p99' in units of the model. Raises InputError for a mesh without triangles or with a point that is not finite.)";

inline constexpr const char* reconstruct =
    R"(reconstruct(mesh, *, resolution=256.0, triangles=0, attributes=False, backend='soft', detail=2.0,
    merge='stitch', projection='orthographic', threads=0, progress=None)

A new mesh from rendered position maps of a Mesh or a file, as `lodestone reconstruct` makes it. resolution: pixels
along the longest side of the bounding box; triangles: about so many instead, where not 0. detail: 1 to 16, maps are
drawn so much finer. merge: 'stitch', 'concatenate', or 'shell', one closed surface of all that is seen from
outside. projection: 'orthographic' or 'perspective'. attributes: of the mesh, too. Returns a Mesh. Raises
InputError when nothing is seen or for a value out of range, UnsupportedError for a backend that this machine lacks.)";

inline constexpr const char* camera =
    R"(Camera(position, target, up=(0, 0, 1), vertical_fov=0.7853981633974483)

A camera in the space of the model. position, target, up: three numbers each; vertical_fov: radians, in (0, pi).)";

inline constexpr const char* camera_path =
    R"(camera_path(hierarchy, path, *, frames=120, size=(1280, 720))

The path of `lodestone render --camera`: 'orbit', 'fly-in', 'walk', 'wander', or a file of key frames (.json). size:
(width, height) of the pictures. Returns a list of Cameras. Raises InputError and FileError for a file.)";

inline constexpr const char* select =
    R"(select(hierarchy, camera, *, size=(1280, 720), samples=1, radii=None, metric='euclidean', kappa0=None,
    pixel_error=1.0, beta=0.5, delta=0.0, blend='smoothstep', effects='auto', tint=False)

The cells that are drawn from a camera. size: (width, height) of the picture. pixel_error: tolerance in pixels;
kappa0: radius over cell size instead. radii: 'adaptive' (a radius for every cell, the rule of pixel_error),
'per-level' (that of kappa0) or 'uniform' (which needs kappa0); metric: 'euclidean' or 'chebyshev'; beta: least width of
a morph band over the cell size, above 0; delta: guard for a viewpoint that is stale by so many cell sizes; blend: 'linear', 'smoothstep', 'smootherstep', 'cosine', 'early', 'late' or 'step'.
samples, effects and tint are for pictures alone. Returns a Selection. Raises InputError for a value out of range.)";

inline constexpr const char* selection =
    R"(The cells drawn from a camera, a partition of the finest level; those outside the picture are among them.

By selected cell: cells uint32 (n,), its index; levels uint8 (n,); visible bool (n,); morphing bool (n,), false
where no vertex moves. admissible: no crack and no pop can be; viewpoint: three numbers, normalised.)";

inline constexpr const char* selection_positions =
    R"(positions(index)

The vertices of the selected cell of this number where they are drawn: float32 (n, 3), normalised, in the order of
Cell.positions. Raises IndexError.)";

inline constexpr const char* selection_mesh =
    R"(mesh()

The surface as it is drawn, culled cells included, as a Mesh in the space of the model; each cell has its own copies
of shared vertices. Raises ResourceError beyond 2^32 vertices.)";

inline constexpr const char* cracks =
    R"(cracks(selection, *, threads=0, progress=None)

The proof that the drawn surface has no crack, as a dict with the names of `lodestone render`: 'surface_triangles',
'open_edges' (0: no crack), 'gap_max' in % of the model's extent. Raises ResourceError beyond 2^32 copies of
vertices.)";

inline constexpr const char* pops =
    R"(pops(before, after, *, threads=0, progress=None)

The jump of the drawn surface between two selections of a hierarchy, as a dict: that of cracks(after), and
'jump_max' and 'viewpoint_step' in % of the extent, 'jump_pixels', 'jump_over_bound' (above 1: a pop), absent where
there is no bound, and 'jump_bound_vacuous' (the step is too long to tell). Raises UsageError for two hierarchies.)";

inline constexpr const char* render =
    R"(render(hierarchy, camera, *, backend='soft', size=(1280, 720), samples=1, radii=None,
    metric='euclidean', kappa0=None, pixel_error=1.0, beta=0.5, delta=0.0, blend='smoothstep', effects='auto',
    tint=False, threads=0, progress=None)

A picture: uint8 (height, width, 3), sRGB, rows from the top. backend: 'soft' or 'gl'. samples: 1 or 4 per pixel.
effects: 'auto', 'all', 'none' or names separated by commas; tint: colour by level. The other options are those of
select. Raises UnsupportedError for a backend that this machine lacks, InputError for a value out of range.)";

inline constexpr const char* fly =
    R"(fly(hierarchy, cameras, *, measure=True, on_frame=None, backend='soft', size=(1280, 720), samples=1,
    radii=None, metric='euclidean', kappa0=None, pixel_error=1.0, beta=0.5, delta=0.0, blend='smoothstep',
    effects='auto', tint=False, threads=0, progress=None)

Draws the frames of a list of Cameras. measure: prove each, as cracks and pops do. on_frame: called with the number
of the frame and its picture, as of render; it may raise. Returns the dict of `lodestone render --json` with its
'frames'; lengths in % of the extent. Raises InputError without a camera, and what render raises.)";

inline constexpr const char* compare_pictures =
    R"(compare_pictures(reference, picture, *, pixels_per_degree=67.0206432765, threads=0, progress=None)

Differences of two pictures, uint8 (height, width, 3 or 4). pixels_per_degree: of the eye, for FLIP, in (0, 1000].
Returns a dict: 'psnr' in decibels, 'ssim', 'mean_absolute' in [0, 1], and 'absolute' and 'flip', each with 'mean',
'p50', 'p99', 'max' and 'share_above' over the pixels. Raises InputError for different sizes.)";

inline constexpr const char* progressive =
    R"(progressive(mesh, *, metric=None, base_triangles=0, finest_triangles=0, normals=True, threads=0,
    progress=None)

Makes a Mesh or a file progressive, as `lodestone progressive` does. metric: 'quadric', 'attribute-quadric',
'parametric', or None, the one that fits the attributes. base_triangles: to stop at; 0: when nothing can collapse;
finest_triangles: at most; 0: all. normals: False for an .lpm, which has none. Returns a Progressive. Raises
InputError where the metric measures what the mesh lacks, and what read raises.)";

inline constexpr const char* load_progressive =
    R"(load_progressive(path)

Opens an .lpm or .glb of progressive. Returns a Progressive. Raises FileError, and InputError with the place.)";

inline constexpr const char* levels =
    R"(A progressive mesh: vertices in the order in which they come in, each with the one that it came from.

positions: float32 (n, 3), normalised; parents: uint32 (n,), below the vertex's own number, 0 in the base; errors:
float32 (n,), estimated distance from the input while the vertex is missing, normalised; triangles: uint32 (m, 3),
of the finest level; base_vertices; finest_error: bound of the distance of the finest level from the input, in units
of the model.)";

inline constexpr const char* levels_level =
    R"(level(*, vertices=None, triangles=None, error=None, threads=0, progress=None)

A level as a Mesh: the finest of at most so many vertices or triangles, or about the coarsest that is everywhere
within error, in units of the model. Raises UsageError unless one of them is given, InputError where no level is so
near.)";

inline constexpr const char* levels_save =
    R"(save(path, *, position_bits=0, uv_bits=12, compress=False, threads=0, progress=None)

Writes an .lpm or a .glb, completely or not at all. position_bits: 4 to 20, of an .lpm; 0: chosen; uv_bits: 4 to 20;
compress: the .glb. Returns the size in bytes. Raises UnsupportedError for another extension, FileError if it cannot
be written.)";

inline constexpr const char* experiments =
    R"(experiments()

The experiments: a dict of name and question. Raises nothing.)";

inline constexpr const char* run_experiment =
    R"(run_experiment(name, parameters, directory, *, input=None, progress=None)

As lodestone.run_experiment, with a folder that exists, for scratch files and pictures. Raises what that raises.)";

}  // namespace lodestone::python::doc

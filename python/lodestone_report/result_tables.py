"""What the pages of docs/results show: tables of each standard study, as columns of its sweeps."""

from dataclasses import dataclass, field

MB = 1e6


@dataclass(frozen=True)
class Table:
    """`columns`: heading, parameter or column, and what its numbers are divided by. `where`: values of the settings shown."""

    title: str
    sweeps: tuple
    columns: list
    note: str = ""
    where: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Correlation:
    """How far these columns, (heading, column), agree; a path is what has equal values of `path`."""

    title: str
    sweeps: tuple
    columns: list
    path: tuple


@dataclass(frozen=True)
class Page:
    """`notes`: what a reader has to know beside the columns' meanings; without measured numbers, which would go stale."""

    study: str
    tables: list
    notes: str = ""
    correlation: Correlation | None = None
    model: bool = False  # with what distributed.py predicts


DATA, TRIANGLES = ("data", "data"), ("triangles", "triangles")
INPUT = ("triangles", "input_triangles")
CPU, SECONDS = ("CPU seconds", "cpu_seconds"), ("seconds", "seconds")
RMS, MAX, NORMALS = ("RMS, %", "rms"), ("max, %", "error_max"), ("normals, degrees", "normal_mean")
CRACKS, GAP = ("residual edges", "open_edges"), ("gap, pixels", "gap_pixels")
CRACKED, TORN = ("cracked frames, %", "cracked_frames"), ("torn pixels", "torn_pixels")
JUMP, BOUND = ("jump, pixels", "jump_pixels"), ("jump / bound", "jump_over_bound")
# The steps of the viewpoint, and the frames in which they are too long for the bound of a jump to tell anything.
STEP, VACUOUS = ("step, %", "viewpoint_step"), ("vacuous frames, %", "vacuous_frames")
JUMPS = [JUMP, STEP, BOUND, VACUOUS]
FRAME, WORST, FRAME_CPU = ("ms a frame", "frame_ms"), ("slowest, ms", "frame_ms_worst"), ("CPU ms", "frame_cpu_ms")
IMAGE, FLIP = ("image error, %", "image_error"), ("FLIP", "flip")
POP, FLIP_POP, AREA = ("pop p99, %", "pop_p99"), ("FLIP pop p99", "flip_pop_p99"), ("FLIP pop area", "flip_pop_area")
VISIBLE, VISIBLE_AREA = ("visible pop p99, thresholds", "visible_pop_p99"), ("visible pop area", "visible_pop_area")
SURFACE, DRAWN = ("surface triangles", "surface_triangles"), ("triangles drawn", "triangles")
CELL, SELECT, OVER_BORDER = ("cell triangles", "cell_triangles"), ("select, ms", "select_ms"), ("kappa0 / rho", "over_border")
RATE, STORED = ("Mtri per core-second", "mtri_per_core_second"), ("stored / input", "stored_ratio")
FLIGHT = [DATA, ("camera", "camera"), OVER_BORDER, SURFACE, DRAWN, SELECT,
          CRACKS, *JUMPS]
STAGES = ("clean", "route", "finest", "levels", "write")  # of a job of several ranks
TABLE = [("stands for", "model"), ("limit, GiB", "memory_limit"), INPUT, ("HLOD triangles", "stored_triangles"),
         ("seconds", "file_seconds"), ("CPU seconds", "file_cpu_seconds"), ("of which building", "cpu_seconds"), RATE,
         ("peak MB", "peak_bytes", MB),
         ("scratch MB", "scratch_bytes", MB), ("file MB", "file_bytes", MB), ("verified", "valid")]

PAGES = [
    Page("build", [
        Table("Models", ("models",),
              [DATA, INPUT, ("levels", "levels"), STORED, ("rho", "rho"), ("D", "diameter"), ("e", "e"), SECONDS, CPU,
               RATE, ("peak MB", "peak_bytes", MB), ("verified", "valid")]),
        Table("Plain and compressed files", ("compressed",),
              [DATA, ("compressed", "compress"), ("stored triangles", "stored_triangles"),
               ("stored vertices", "stored_vertices"), ("bytes per stored triangle", "bytes_per_stored_triangle"), ("e", "e"),
               ("write, s", "write_seconds"), CPU, ("verified", "valid")]),
        Table("Split edges: the hierarchy", ("refine",),
              [DATA, ("split", "refine"), ("triangles of the finest level", "input_triangles"), ("levels", "levels"),
               ("long half-edges", "long_edges"), ("longest edge / h_L", "max_edge_ratio"), ("rho", "rho"), ("D", "diameter"),
               ("verified", "valid")]),
        Table("Split edges: a fly-in at one pixel", ("refine_drawn",), [DATA, ("split", "refine"), SURFACE, DRAWN, CRACKS, *JUMPS],
              "Splitting bounds the reach; it makes pictures no cheaper: a plane of two triangles becomes many."),
        Table("sigma0 and cell size: the hierarchy", ("defaults",),
              [DATA, ("sigma0", "sigma0"), CELL, ("levels", "levels"), STORED, ("rho", "rho"), ("e", "e"), RATE]),
        Table("sigma0 and cell size: a fly-in", ("defaults_drawn",),
              [DATA, ("sigma0", "sigma0"), CELL, ("pixel error", "pixel_error"), SURFACE, DRAWN],
              "`lodestone build --help` names the defaults; the number of levels changes in steps of about four in triangles."),
    ], "Small models pay for fixed tables in memory. Long triangles reach far out of their cells (rho), which the rule by level "
       "pays for on the level concerned alone; see [the guarantee](guarantee.md)."),
    Page("guarantee", [
        Table("By level, one pixel", ("one_pixel",), FLIGHT),
        Table("Uniform radii, 1.05 rho", ("uniform",), FLIGHT),
        Table("By level, the least admissible radii", ("least",), FLIGHT,
              "These runs cross the most borders between levels: the hardest case."),
        Table("Uniform radii below the border: cracks appear", ("below",),
              [DATA, OVER_BORDER, ("viewpoints", "frame_count"), CRACKS, CRACKED, GAP, TORN]),
        Table("A step instead of a blend: vertices jump", ("step",),
              [DATA, OVER_BORDER, CRACKS, *JUMPS]),
    ], "A run of the first three tables fails if one frame has a residual edge or one vertex jumps beyond its bound. The finer "
       "course of the border is in [the ablation](ablation.md)."),
    Page("accuracy", [
        Table("At equal triangles: own families, and libraries on the whole mesh", ("families",),
              [DATA, ("level", "level"), ("family", "family"), TRIANGLES, SECONDS, CPU, ("all levels at once", "all_levels"),
               RMS, MAX, ("p99, %", "error_p99"), NORMALS, ("slivers, %", "slivers"), ("manifold", "manifold")],
              "meshoptimizer (`meshopt_simplify`) and OpenMesh (`DecimaterT`, quadrics and normal flipping) get the whole mesh "
              "and know neither blocks nor bounds nor parents."),
        Table("Stated errors and distances found, over the cell size of the level", ("errors",),
              [DATA, ("level", "level"), ("triangles", "level_triangles"), ("measured", "measure_error"), ("e", "level_e"),
               ("largest distance found", "level_distance"), ("measuring, CPU s", "measure_cpu_seconds"), ("verified", "valid")],
              "A measured e is a bound for every point of both surfaces, at most 5 % too large; an estimate is taken at vertices "
              "of the next finer level. Samples may miss the place that a bound covers."),
        Table("Simplifiers under the same contract: the level two above the finest", ("simplifiers", "optimal"),
              [DATA, ("simplifier", "simplifier"), ("placement", "placement"), ("sigma0", "sigma0"), CPU, RATE, STORED,
               ("triangles", "level_triangles"), RMS, MAX, NORMALS, ("verified", "valid")]),
    ]),
    Page("progressive", [
        Table("Shapes", ("shapes",),
              [DATA, ("input", "input_triangles"), ("ktri per core-second", "ktri_per_core_second"),
               ("bytes / vertex", "bytes_per_vertex"), ("base", "base_triangles"), TRIANGLES, RMS, MAX, NORMALS,
               ("residual edges", "residual_edges"), ("cut vertices", "cut_vertices")]),
        Table("With texture coordinates, by metric", ("textured",),
              [DATA, ("metric", "metric"), ("input", "input_triangles"), ("ktri per core-second", "ktri_per_core_second"),
               ("bytes / vertex", "bytes_per_vertex"), ("base", "base_triangles"), TRIANGLES, RMS, MAX, NORMALS,
               ("residual edges", "residual_edges")],
              "`attribute-quadric` and `parametric` keep texture coordinates in place, which RMS does not see."),
    ], "`bytes / vertex` are those of the `.lpm` of the whole ladder; `base` is what is left when nothing can collapse. Edges of "
       "more than two triangles are cut apart, and flaps are in the levels finer than they are."),
    Page("spherical", [
        Table("Models", ("models",),
              [DATA, ("input", "input_triangles"), ("components", "components"), ("handles", "handles"), ("holes", "holes"),
               ("efficiency", "efficiency"), ("flips", "flips"), ("slivers", "slivers"), ("colours, dB", "colour_psnr"),
               ("normals, dB", "normal_psnr"), ("cut's exposure", "cut_exposure"), ("residual edges", "residual_edges")]),
        Table("Where the seconds and bytes go", ("models",),
              [DATA, ("close, CPU s", "closing_cpu_seconds"), ("map", "map_cpu_seconds"),
               ("ktri per core-second", "map_ktri_per_core_second"), ("images", "resample_cpu_seconds"),
               ("encode", "encode_cpu_seconds"), ("collapse", "collapse_cpu_seconds"), CPU,
               ("colours, kB", "colour_bytes", 1e3), ("normals, kB", "normal_bytes", 1e3),
               ("geometry, kB", "geometry_bytes", 1e3)]),
        Table("Effort of the map", ("effort",),
              [DATA, ("effort", "effort"), ("efficiency", "efficiency"), ("slivers", "slivers"), ("map, CPU s", "map_cpu_seconds"),
               ("ktri per core-second", "map_ktri_per_core_second")]),
        Table("Size and quality of the images", ("images",),
              [DATA, ("pixels a side", "texture"), ("quality", "quality"), ("colours, kB", "colour_bytes", 1e3),
               ("colours, dB", "colour_psnr"), ("normals, kB", "normal_bytes", 1e3), ("normals, dB", "normal_psnr"), CPU]),
        Table("Geometry images", ("geometry",),
              [DATA, ("samples", "geometry_image_samples"), ("kB", "geometry_image_bytes", 1e3), ("RMS, %", "geometry_image_rms"),
               ("max, %", "geometry_image_max")]),
    ], "Efficiency is 1 for a map without stretch, by the split measure, with a guard of the weight that `lodestone spherical --json` "
       "prints. 100 dB: no difference. Geometry is that of the `.lpm`."),
    Page("reconstruction", [
        Table("Models", ("models",),
              [DATA, ("pixels", "resolution"), ("views", "view_count"), ("inside", "inside_views"), TRIANGLES,
               ("seen, %", "seen_coverage"), ("coverage, %", "coverage"), ("slivers, %", "slivers"),
               ("border edges", "border_edges"),
               ("of a closed input", "input_closed"), ("Euler", "euler"), ("holes filled", "holes_filled"),
               ("manifold", "manifold"), RMS, ("of what is visible", "visible_rms"), MAX, CPU]),
        Table("Where the seconds go", ("models",),
              [DATA, ("pixels", "resolution"), ("views, s", "views_seconds"), ("draw", "draw_seconds"),
               ("connect", "connect_seconds"), ("merge", "merge_seconds"), ("sharpen", "sharpen_seconds"),
               ("simplify", "simplify_seconds"), ("Mpixels per core-second", "mpixels_per_core_second")]),
        Table("Views, merge and detail", ("settings",),
              [DATA, ("pixels", "resolution"), ("views", "views"), ("drawn", "view_count"), ("merge", "merge"),
               ("detail", "detail"), TRIANGLES, ("coverage, %", "coverage"), ("manifold", "manifold"),
               ("slivers, %", "slivers"), RMS, MAX, CPU],
              "views 0: as many as the surface needs. Six views and `concatenate` are what is published."),
        Table("Closed shells beside simplifiers", ("shells",),
              [DATA, ("input", "input_triangles"), ("family", "family"), TRIANGLES, CPU, ("seen, %", "seen_coverage"),
               ("seen, RMS, %", "seen_rms"), ("shown, RMS, %", "shown_rms"), ("closed", "closed"), ("manifold", "manifold"),
               ("components", "components")],
              "`shell` is `--outside-only`; the others are functions of meshoptimizer: `meshopt_simplify`, "
              "`meshopt_simplifySloppy`, and `meshopt_remesh` (in version 1.2), at as many voxels as the shell has samples, or "
              "twice as many until there are enough triangles, 256 at most, then simplified. `seen`: distance of what pictures of the input show from the result; `shown`: of what "
              "pictures of the result show from the input. meshoptimizer runs on one thread."),
    ], "`seen` is the share of pixels of pictures from all directions whose point has the result within a sample's spacing; "
       "coverage counts all that any of 582 directions sees alike, however few see it. "
       "`inside`: views whose near plane lies beyond what is in the way."),
    Page("rendering", [
        Table("Tolerance and backend", ("tolerance",),
              [DATA, ("backend", "backend"), ("pixel error", "pixel_error"), DRAWN, FRAME, WORST, FRAME_CPU,
               ("on the screen, pixels", "screen_error"), IMAGE, ("PSNR, dB", "psnr"), ("SSIM", "ssim"), FLIP]),
        Table("Distance of the drawn surface from the full one on the screen", ("screen",),
              [DATA, ("camera", "camera"), ("measured errors", "measure_error"), ("pixel error", "pixel_error"),
               ("on the screen, pixels", "screen_error"), DRAWN]),
        Table("Size of the model", ("size",),
              [DATA, ("camera", "camera"), ("pixel error", "pixel_error"), ("input", "input_triangles"), DRAWN,
               SELECT, FRAME, WORST, FRAME_CPU]),
    ], "Both backends draw the same picture; `gl` without a graphics card is Mesa's llvmpipe, which draws on the processor (the "
       "manifests name it)."),
    Page("effects", [
        Table("Effects", ("soft", "gl"),
              [("scene", "data"), ("backend", "backend"), ("effects", "effects"), FRAME, FRAME_CPU, ("gain, ms", "gain_ms"),
               ("gain, CPU ms", "gain_cpu_ms"), ("gain, %", "gain"), ("same picture", "same_picture"),
               ("differing, %", "differing")]),
    ], "`planned` runs what the scene calls for; `everything` draws the same picture with nothing left out, and its gain is "
       "negative where planning saves time; the other rows leave out one planned effect, and their gain is its cost. Without its light there is "
       "no shadow either."),
    Page("scaling", [
        Table("Strong and weak scaling", ("strong", "weak"),
              [DATA, ("task", "task"), ("mode", "mode"), ("workers", "workers"), ("processors", "processors"), SECONDS, CPU,
               ("speed-up", "speedup"), ("efficiency, %", "efficiency"), ("Karp-Flatt", "karp_flatt"), ("busy, %", "busy"),
               ("idle, s", "idle"), ("same result", "same")]),
        Table("Strategies of the build", ("strategies",),
              [DATA, CELL, ("strategy", "strategy"), ("workers", "workers"), SECONDS, ("speed-up", "speedup"),
               ("efficiency, %", "efficiency"), ("idle, s", "idle"), ("idle tail, s", "idle_tail"), ("same result", "same")]),
        Table("Beyond the machine", ("schedule",),
              [DATA, ("task", "task"), ("workers", "workers"), ("predicted, s", "predicted"), ("measured, s", "measured"),
               ("error, %", "error"), ("speed-up", "speedup"), ("efficiency, %", "efficiency"),
               ("ceiling of streaming work", "streaming_speedup"), ("parallelism", "parallelism"),
               ("the span consists of", "critical"), ("workers are idle during", "limit")]),
    ], "The numbers of workers take turns within a run. `weak`: two workers have two models, or twice the pixels. Beyond the "
       "machine, list scheduling replays what one worker did; what workers take from each other is measured by copies of the "
       "job that run at once."),
    Page("distributed", [
        Table("Jobs of several ranks", ("strong", "weak_1", "weak_2", "weak_4"),
              [DATA, INPUT, ("ranks", "ranks"), ("threads of each", "rank_threads"), ("processors", "processors"), SECONDS, CPU,
               ("million triangles per second", "mtri_per_second"), ("rate / that of one rank", "over_one"),
               ("bytes per triangle", "bytes_per_triangle"), ("rounds", "rounds_of_messages"),
               ("imbalance of triangles", "imbalance_triangles"), ("of CPU time", "imbalance_cpu"),
               ("of memory", "imbalance_memory"), ("peak MB at rank 0", "first_peak_bytes", MB),
               ("at another", "peak_bytes", MB), ("same file", "same")]),
        Table("Stages: seconds of the slowest rank, and bytes that all send", ("strong",),
              [DATA, ("ranks", "ranks"), ("threads of each", "rank_threads"),
               *((f"{stage}, {what}", f"{stage}_{column}", *divisor) for stage in STAGES
                 for what, column, *divisor in (("s", "seconds"), ("MB", "bytes", MB)))]),
        Table("Finest blocks dealt out to virtual ranks", ("plans",),
              [DATA, CELL, ("blocks", "level_blocks"), ("ranks", "ranks"), ("busy ranks", "busy_ranks"),
               ("imbalance", "level_imbalance"), ("vertices between ranks", "border_vertices"),
               ("MB of tables at rank 0", "first_rank_bytes", MB)],
              "The triangles by which borders are chosen are spread evenly over the cells.", {"coarser": 0, "seed": 0}),
    ], "Each job takes turns with one rank of as many threads as its ranks have together, or as there are processors: `rate / that "
       "of one rank`. Messages between ranks of one machine go through its memory.", model=True),
    Page("systems", [
        Table("Systems on the same path", ("scans", "generated", "orbit", "others", "paths", "terrain"),
              [DATA, ("path", "camera"), ("pixel error", "pixel_error"), ("system", "system"), CRACKS, CRACKED, GAP, TORN, *JUMPS,
               ("screen error, pixels", "screen_error"), ("shift, pixels", "shift_pixels"), IMAGE, FLIP, POP, FLIP_POP, AREA, VISIBLE,
               SURFACE, FRAME, WORST, ("drawn MB", "drawn_bytes", MB), ("peak MB", "peak_bytes", MB),
               ("to make, CPU s", "make_cpu_seconds")]),
        Table("Measures of pops, of a step of known size", ("calibration",),
              [DATA, ("part of the orbit", "to"), ("step, pixels", "pixel_error"), JUMP, POP, ("pop area, pixels", "pop_area"), FLIP_POP,
               AREA, VISIBLE, ("largest, thresholds", "visible_pop_max"), VISIBLE_AREA],
              "`known-step` draws the finest level, which steps aside in about half of the frames; all frames are on the same part "
              "of the orbit, so that the longer one is the quicker one."),
    ], "`discrete`: levels exchanged by cell without morph; `cross-fade`: two whole levels blended. Jumps of all systems are "
       "compared with the bound of the morph. `cluster-dag`: clusters that are exchanged in groups, by meshoptimizer's or by "
       "measured errors; the others are in decision 60. Every system is a run of its own, and repetitions take turns.",
       Correlation("How far measures of pops agree", ("scans", "generated", "orbit", "others", "paths", "terrain"),
                   [JUMP, ("shift, pixels", "shift_pixels"), POP, ("pop area, pixels", "pop_area"), FLIP_POP, AREA,
                    VISIBLE, VISIBLE_AREA, ("FLIP", "flip"), ("screen error, pixels", "screen_error")], ("data", "camera", "pixel_error"))),
    Page("ablation", [
        Table("Below and above the admissible border", ("border",),
              [DATA, ("viewpoints", "camera"), OVER_BORDER, ("admissible", "admissible"), CRACKS, CRACKED, GAP,
               ("T-junctions", "t_junctions"), TORN, *JUMPS]),
        Table("Euclidean and Chebyshev distance", ("metrics",),
              [DATA, ("metric", "metric"), ("rho", "rho"), OVER_BORDER, SURFACE, CRACKS, CRACKED, *JUMPS]),
        Table("Radii: uniform and by level", ("radii",),
              [DATA, ("radii", "radii"), OVER_BORDER, SURFACE, DRAWN, SELECT, CRACKS, *JUMPS]),
        Table("Adaptive radii: the share of their constraint that is kept", ("constraint",),
              [DATA, ("share", "constraint"), ("admissible", "admissible"), SURFACE, CRACKS, CRACKED, GAP, *JUMPS]),
        Table("Blending functions", ("blend",),
              [DATA, ("blend", "blend"), *JUMPS, ("jump p99, pixels", "jump_p99_pixels"), IMAGE, POP,
               ("pop area, pixels", "pop_area"), FLIP_POP, AREA, CRACKS]),
        Table("sigma0", ("sigma0",),
              [DATA, ("sigma0", "sigma0"), ("rho", "rho"), SURFACE, DRAWN, FRAME, IMAGE, FLIP, *JUMPS, CRACKS]),
        Table("Width of the band", ("band",),
              [DATA, ("blend", "blend"), ("beta", "beta"), SURFACE, ("jump / step", "jump_per_step"), *JUMPS, CRACKS]),
    ], "Adversarial viewpoints are made to crack; random ones hardly do near the border. Torn pixels are counted on closed "
       "models. A blend that is continuous keeps its jumps within the bound, `step` does not."),
    Page("published", [
        Table("Stand-ins for the published models", ("size_1", "size_2", "size_3", "size_4"),
              [*TABLE, ("published", "published")]),
        Table("Within a limit of memory", ("limits",), TABLE),
    ], "Seconds are from file to file. Generated surfaces take the place of the published models: in the full form of as many "
       "triangles, in the standard form of a tenth."),
]
STUDIES = [page.study for page in PAGES]

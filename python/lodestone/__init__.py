"""Levels of detail of large triangle surfaces: build, view, measure, reconstruct, refine progressively.

    import lodestone
    hierarchy = lodestone.build("scan.ply", progress=print)
    hierarchy.save("scan.lode")
    camera = lodestone.camera_path(hierarchy, "orbit", frames=1)[0]
    picture = lodestone.render(hierarchy, camera, size=(640, 480))      # a numpy array
    lodestone.cracks(lodestone.select(hierarchy, camera))               # {'open_edges': 0, ...}

Names, units and bytes are those of the command `lodestone`. Arrays that are returned share memory with their object where
they can, and cannot be written then.

Long functions take `threads`, the number of threads (0: all of the machine), and `progress`, which is called in the calling
thread as progress(step, share) with the share of the step that is done, in [0, 1], some thirty times a second. Other
threads of Python run meanwhile. Ctrl-C stops the work (KeyboardInterrupt), as does whatever `progress` raises; nothing
unfinished is left behind.

Errors are kinds of Error; `exit_status` is the status with which the command ends: UsageError (which is an InputError) 2,
InputError 3, FileError 4, UnsupportedError 5, ResourceError 6, NegativeResult 1.
"""

from ._lodestone import (
    Camera,
    Cell,
    Error,
    FileError,
    Hierarchy,
    InputError,
    Mesh,
    NegativeResult,
    Progressive,
    ResourceError,
    Selection,
    UnsupportedError,
    UsageError,
    __version__,
    build,
    camera_path,
    compare,
    compare_pictures,
    cracks,
    experiments,
    fly,
    generate,
    load,
    load_progressive,
    pops,
    progressive,
    read,
    reconstruct,
    render,
    select,
    verify,
)
from .sweeps import load_sweep, run_experiment

__all__ = [
    "Camera", "Cell", "Error", "FileError", "Hierarchy", "InputError", "Mesh", "NegativeResult", "Progressive",
    "ResourceError", "Selection", "UnsupportedError", "UsageError", "__version__", "build", "camera_path", "compare",
    "compare_pictures", "cracks", "experiments", "fly", "generate", "load", "load_progressive", "load_sweep", "pops",
    "progressive", "read", "reconstruct", "render", "run_experiment", "select", "verify",
]

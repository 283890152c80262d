"""What the tests of the house share: the tracked files of a source tree."""

import pathlib
import subprocess

CODE = {".h", ".cpp", ".glsl", ".vert", ".frag", ".comp", ".py", ".sh", ".cmake", ".txt"}


def files(root):
    """Relative paths of the files that belong to the tree: what git tracks or would add; outside git, all but build*."""
    root = pathlib.Path(root)
    try:
        listing = subprocess.run(
            ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            check=True, capture_output=True,
        ).stdout.decode()
        paths = [pathlib.PurePosixPath(name) for name in listing.split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        paths = [pathlib.PurePosixPath(p.relative_to(root).as_posix()) for p in root.rglob("*") if p.is_file()]
        paths = [p for p in paths if not p.parts[0].startswith(("build", ".git"))]
    return sorted(p for p in set(paths) if (root / p).is_file())


def is_code(path):
    """C++, shaders, Python, CMake, and the scripts without extension."""
    return path.suffix in CODE or (path.suffix == "" and path.parts[0] in {"scripts", ".ci"})


def text(root, path):
    """The file's text; None for a binary one."""
    try:
        return (pathlib.Path(root) / path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None

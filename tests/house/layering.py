"""The layers of the source tree, and what breaks them.

    core <- parallel <- render <- experiments        (bench and tests may see all)

Quoted includes give a path from the repository's root and go with the arrow; a few libraries may be named in a few
places only. Comments do not count.
"""

import argparse
import pathlib
import re
import sys
from dataclasses import dataclass

import sources

LAYERS = ["core", "parallel", "render", "experiments"]
SEES_ALL = ["bench", "tests"]


@dataclass(frozen=True)
class Confined:
    """Something that only some files may name: `pattern` is searched in code without comments."""

    what: str
    pattern: str
    allowed: str  # regular expression on the relative path

    def violated_by(self, path, code):
        return not re.match(self.allowed, str(path)) and re.search(self.pattern, code)


CONFINED = [
    Confined("oneTBB", r"#\s*include\s*<(oneapi/)?tbb/|\btbb::", r"parallel/(\w+/)*\w+\.cpp$"),
    Confined("threads of the standard library",
             r"#\s*include\s*<(thread|future|execution|omp\.h|pthread\.h)>", r"(parallel|tests|bench)/"),
    Confined("locks", r"#\s*include\s*<(mutex|shared_mutex|condition_variable|semaphore)>",
             r"(parallel|render|experiments|tests|bench)/"),
    Confined("OpenGL, EGL or epoxy", r"#\s*include\s*<(GL|GLES\d?|EGL|KHR|epoxy)/",
             r"(render/(backends/gl|viewer)|tests/render/backends/test_gl)[/_.]"),
    Confined("GLFW", r"#\s*include\s*<GLFW/", r"render/(backends/gl|viewer)[/_.]"),
    Confined("Dear ImGui", r"#\s*include\s*[<\"]imgui", r"render/viewer[/_.]"),
    Confined("GLM", r"#\s*include\s*<glm/", r"(render|experiments|tests|bench)/"),
    Confined("OpenMesh", r"#\s*include\s*<OpenMesh/", r"(core/(\w+/)*half_edge\w*[/.]|tests/|bench/)"),
    Confined("CLI11", r"#\s*include\s*<CLI/", r"(experiments|tests)/"),
    Confined("Google Benchmark", r"#\s*include\s*<benchmark/", r"bench/"),
    Confined("GoogleTest or rapidcheck", r"#\s*include\s*<(gtest|gmock|rapidcheck)[/.]", r"tests/"),
    Confined("standard output", r"#\s*include\s*<iostream>|\bstd::(cout|cerr|printf)\b", r"(experiments|tests|bench)/"),
]

# The same for link lines: a library that CMake links where no source may include it.
CONFINED_LINKS = [
    Confined("oneTBB", r"\bTBB::", r"(parallel/|cmake/)"),
    Confined("OpenGL or GLFW", r"\b(OpenGL::|glfw\b|PkgConfig::(EPOXY|epoxy))", r"(tests/)?(render/|cmake/)"),
    Confined("OpenMesh", r"\bOpenMesh(Core|Tools)", r"(core/|tests/|bench/|cmake/)"),
]

# Comments, or literals that are kept so that "//" inside a string is no comment.
COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\\n])*")', re.DOTALL)


def without_comments(code):
    return COMMENT_OR_STRING.sub(lambda match: match.group(1) or " ", code)


def visible_from(folder):
    """Top folders whose headers a file of this one may include."""
    if folder in LAYERS:
        return LAYERS[: LAYERS.index(folder) + 1]
    return [*LAYERS, folder]


def include_violations(root, path, code):
    for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', code, re.MULTILINE):
        target = pathlib.PurePosixPath(name)
        if not (root / target).is_file():
            yield f'{path}: includes "{name}", which is no file of the tree; give the path from its root'
        elif target.parts[0] not in visible_from(path.parts[0]):
            yield f'{path}: includes "{name}"; {path.parts[0]} may see only {", ".join(visible_from(path.parts[0]))}'


def violations(root):
    """One line for every violation of the layering below `root`."""
    root = pathlib.Path(root)
    for path in sources.files(root):
        if path.parts[0] not in [*LAYERS, *SEES_ALL] or "consumer" in path.parts:
            continue
        if path.suffix in {".h", ".cpp"}:
            code = without_comments(sources.text(root, path))
            yield from include_violations(root, path, code)
            rules = CONFINED
        elif path.name == "CMakeLists.txt":
            code = re.sub(r"#[^\n]*", "", sources.text(root, path))
            rules = CONFINED_LINKS
        else:
            continue
        yield from (f"{path}: names {rule.what}, which belongs to {rule.allowed}"
                    for rule in rules if rule.violated_by(path, code))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", help="top folder of the source tree")
    found = list(violations(parser.parse_args().root))
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

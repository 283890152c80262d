"""The layers and folders of the source tree, and what breaks them.

    core <- parallel <- render <- experiments        (bench, tests and python may see all)

Quoted includes give a path from the repository's root and go with the arrow. Includes form no circle between folders,
whether each folder is taken alone or each child of a parent with all that is below it. A few libraries may be named in
a few places only. Comments do not count. Each folder says what it is and holds a limited number of subjects.
"""

import argparse
import collections
import graphlib
import pathlib
import re
import sys
from dataclasses import dataclass

import sources

LAYERS = ["core", "parallel", "render", "experiments"]
SEES_ALL = ["bench", "tests", "python"]
MAX_SUBJECTS = 25  # a pair of .h and .cpp is one


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
    Confined("MPI", r"#\s*include\s*<mpi\.h>|\bMPI_[A-Z]\w*", r"parallel/distributed/messages/mpi_transport\.cpp$"),
    Confined("threads of the standard library",
             r"#\s*include\s*<(thread|future|execution|omp\.h|pthread\.h)>", r"(parallel|tests|bench)/"),
    Confined("locks", r"#\s*include\s*<(mutex|shared_mutex|condition_variable|semaphore)>",
             r"(parallel|render|experiments|python|tests|bench)/"),
    Confined("OpenGL, EGL or epoxy", r"#\s*include\s*<(GL|GLES\d?|EGL|KHR|epoxy)/",
             r"(render/(backends/gl|viewer)|tests/render/backends/(test_gl|soak))[/_.]"),
    Confined("GLFW", r"#\s*include\s*<GLFW/", r"render/(backends/gl|viewer)[/_.]"),
    Confined("Dear ImGui", r"#\s*include\s*[<\"]imgui", r"render/viewer[/_.]"),
    Confined("GLM", r"#\s*include\s*<glm/", r"(render|experiments|tests|bench)/"),
    Confined("OpenMesh", r"#\s*include\s*<OpenMesh/", r"(core/(\w+/)*half_edge\w*[/.]|tests/|bench/)"),
    Confined("CLI11", r"#\s*include\s*<CLI/", r"experiments/commands/parser\.cpp$"),
    Confined("Google Benchmark", r"#\s*include\s*<benchmark/", r"bench/"),
    Confined("GoogleTest or rapidcheck", r"#\s*include\s*<(gtest|gmock|rapidcheck)[/.]", r"tests/"),
    Confined("standard output", r"#\s*include\s*<iostream>|\bstd::(cout|cerr|printf)\b", r"(experiments|tests|bench)/"),
]

# The same for link lines: a library that CMake links where no source may include it.
CONFINED_LINKS = [
    Confined("oneTBB", r"\bTBB::", r"(parallel/|cmake/)"),
    Confined("MPI", r"\bMPI::", r"(parallel/distributed/|cmake/)"),
    Confined("OpenGL or GLFW", r"\b(OpenGL::|glfw\b|PkgConfig::(EPOXY|epoxy))", r"(tests/)?(render/|cmake/)"),
    Confined("OpenMesh", r"\bOpenMesh(Core|Tools)", r"(core/|tests/|bench/|cmake/)"),
]

# Comments, or literals that are kept so that "//" inside a string is not a comment.
COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\\n])*")', re.DOTALL)


def without_comments(code):
    return COMMENT_OR_STRING.sub(lambda match: match.group(1) or " ", code)


def quoted(code):
    """Paths of the quoted includes."""
    return [pathlib.PurePosixPath(name) for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', code, re.MULTILINE)]


def visible_from(folder):
    """Top folders whose headers a file of this one may include."""
    if folder in LAYERS:
        return LAYERS[: LAYERS.index(folder) + 1]
    return [*LAYERS, folder]


def include_violations(root, path, code):
    for target in quoted(code):
        if not (root / target).is_file():
            yield f'{path}: includes "{target}", which is not a file of the tree; give the path from its root'
        elif target.parts[0] not in visible_from(path.parts[0]):
            yield f'{path}: includes "{target}"; {path.parts[0]} may see only {", ".join(visible_from(path.parts[0]))}'


def circles(includes):
    """Circles between folders that `includes`, pairs of paths, form at any depth; at most one for each parent."""
    arrows = collections.defaultdict(lambda: collections.defaultdict(set))
    for file, included in includes:
        a, b = file.parts[:-1], included.parts[:-1]
        if a == b:
            continue
        arrows["the tree"]["/".join(a)].add("/".join(b))
        shared = next(i for i, (x, y) in enumerate(zip([*a, ""], [*b, ""])) if x != y)
        # Files of the parent itself count as a child of its own, "parent/".
        arrows["/".join(a[:shared])]["/".join([*a, ""][:shared + 1])].add("/".join([*b, ""][:shared + 1]))
    for parent, graph in arrows.items():
        try:
            graphlib.TopologicalSorter(graph).prepare()
        except graphlib.CycleError as error:
            yield f"{parent}: includes form a circle: {' <- '.join(error.args[1])}"


def folder_violations(root, files):
    """Folders of C++ files that do not say what they are in one line, or hold too many subjects."""
    subjects = collections.defaultdict(set)
    for path in files:
        if path.suffix in {".h", ".cpp"}:
            subjects[path.parent].add(path.stem)
    for folder, held in subjects.items():
        if len(held) > MAX_SUBJECTS:
            yield f"{folder}: holds {len(held)} subjects; at most {MAX_SUBJECTS}"
        listing = folder / "CMakeLists.txt"
        if not (root / listing).is_file():
            yield f"{folder}: has no CMakeLists.txt"
        elif not re.match(r"# [^\n]*\.\n(?!#)", sources.text(root, listing)):
            yield f"{listing}: does not open with one comment line on what the folder is"


def twins(headers):
    """Types of one name in one namespace, from (path, code) of headers: the linker takes the functions of either for both."""
    homes = collections.defaultdict(list)
    for path, code in headers:
        space = ""
        for line in code.splitlines():
            if found := re.match(r"namespace ?([\w:]*) ?\{", line):
                space = found[1] or "unnamed"
            found = re.match(r"(?:template ?<.*> ?)?(?:struct|class)(?: \[\[\w+\]\])? (\w+)(?: final)?(?: ?:[^:].*)? ?\{", line)
            if found and path.parts[0] in LAYERS and space.startswith("lodestone"):
                homes[space, found[1]].append(str(path))
    for (space, name), paths in homes.items():
        if len(set(paths)) > 1:
            yield f"{space}::{name}: is declared in {' and '.join(sorted(set(paths)))}"


def violations(root):
    """One line for every violation of the layering below `root`."""
    root = pathlib.Path(root)
    files = [path for path in sources.files(root)
             if path.parts[0] in [*LAYERS, *SEES_ALL] and not {"consumer", "component"}.intersection(path.parts)]
    yield from folder_violations(root, files)
    includes, headers = [], []
    for path in files:
        if path.suffix in {".h", ".cpp"}:
            code = without_comments(sources.text(root, path))
            if path.suffix == ".h":
                headers.append((path, code))
            yield from include_violations(root, path, code)
            includes += [(path, included) for included in quoted(code)]
            rules = CONFINED
        elif path.name == "CMakeLists.txt":
            code = re.sub(r"#[^\n]*", "", sources.text(root, path))
            rules = CONFINED_LINKS
        else:
            continue
        yield from (f"{path}: names {rule.what}, which belongs to {rule.allowed}"
                    for rule in rules if rule.violated_by(path, code))
    yield from circles(includes)
    yield from twins(headers)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", help="top folder of the source tree")
    found = list(violations(parser.parse_args().root))
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

"""Functions that are too long or take too many parameters, bools side by side, and comments that are not plain English."""

import bisect
import re

import sources

MAX_LINES, MAX_PARAMETERS = 60, 6
GIVEN = {"on_message", "__libc_start_main"}  # OpenGL and the C library call them with parameters of their own choice

# Functions that are too large today, and today's count of places that are not plain English. Both may only become fewer.
KNOWN_LARGE = {
    "render/backends/soft/layers_kernel.h cover",
    "render/backends/soft/raster_kernel.h cover",
}
MAX_NOT_PLAIN = 0

# Literals and comments, whose braces and commas do not count; preprocessor lines likewise.
NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"'
                     r"|'(?:\\.|[^'\\\n])'", re.DOTALL | re.MULTILINE)
SCOPE = re.compile(r"\b(namespace|class|struct|union|enum|extern)\b")
NAME = re.compile(r"(~?[\w:]+|operator\s*\S+?)\s*\(")
INNER = re.compile(r"<[^<>]*>|\([^()]*\)|\{[^{}]*\}|\[[^\[\]]*\]")


def without_literals(code):
    """The code without literals and comments; the lines keep their numbers."""
    return NO_CODE.sub(lambda match: "\n" * match.group().count("\n"), code)


def functions(code):
    """(line, name, number of lines, number of parameters) of each C++ function; a declaration has no lines."""
    code = without_literals(code)
    newlines = [match.start() for match in re.finditer("\n", code)]
    depth, nested, start, body, found = 0, 0, 0, None, None
    for mark in re.finditer(r"[{};]", code):
        head = code[start:mark.start()]
        # A default argument or an initialiser; before the brace of a body there is a space.
        if body is None and (nested or head.count("(") > head.count(")") or mark.group() == "{" and head[-1:].strip()):
            nested += {"{": 1, "}": -1, ";": 0}[mark.group()]
            continue
        if mark.group() == "{":
            if body is None and not SCOPE.search(INNER.sub("", head)) and (found := signature(head)):
                body, line = depth, bisect.bisect(newlines, start + len(head) - len(head.lstrip())) + 1
            depth += 1
        elif mark.group() == "}":
            depth -= 1
            if body == depth:
                yield line, found[0], bisect.bisect(newlines, mark.start()) + 2 - line, found[1]
                body = None
        elif body is None and (found := signature(head)):
            yield bisect.bisect(newlines, start + len(head) - len(head.lstrip())) + 1, found[0], 0, found[1]
        if body is None or body == depth - 1:
            start = mark.end()


def signature(head):
    """(name, number of parameters) of what may be a function up to its body or semicolon; None where it is none."""
    match = NAME.search(head)
    if not match or "=" in head[:match.start()]:
        return None
    if re.fullmatch(r"[A-Z][A-Z0-9_]+", match.group(1)):  # TEST(Suite, Name) {
        return match.group(1), 0
    level, end = 1, match.end()
    while level and end < len(head):
        level += {"(": 1, ")": -1}.get(head[end], 0)
        end += 1
    inner = head[match.end():end - 1]
    while (shorter := INNER.sub("", inner)) != inner:
        inner = shorter
    return match.group(1), inner.count(",") + 1 if inner.strip() else 0


def large_functions(root):
    for path in sources.files(root):
        if path.suffix not in {".h", ".cpp"}:
            continue
        for line, name, lines, parameters in functions(sources.text(root, path)):
            if f"{path} {name}" in KNOWN_LARGE:
                continue
            if lines > MAX_LINES:
                yield f"{path}:{line}: {name} has {lines} lines; at most {MAX_LINES}"
            if parameters > MAX_PARAMETERS and name not in GIVEN:
                yield f"{path}:{line}: {name} takes {parameters} parameters; at most {MAX_PARAMETERS}"


# Bools side by side, of which a caller cannot tell which is which; {false, true} to go through both is fine.
BOOLS = re.compile(r"\bbool(?: \w+)?(?: = \w+)?,\s*(?:const )?bool\b|(?<!: \{)\b(?:true|false),\s*(?:true|false)\b")


def adjacent_bools(root):
    for path in sources.files(root):
        if path.suffix in {".h", ".cpp"}:
            code = without_literals(sources.text(root, path))
            for match in BOOLS.finditer(code):
                line = code.count("\n", 0, match.start()) + 1
                yield f"{path}:{line}: {match.group()}: two bools side by side; name them in a struct or an enum"


# Plain integers in headers that bear the name of an id (core/base/id.h), and those that cannot be confused with another
# one. Other folders hold kernels of one mesh with numbers of their own.
BARE_ID = re.compile(r"\bstd::(?:uint32_t|size_t) (cell|vertex|triangle)\s*[,)]")
ID_FOLDERS = ("core/hierarchy/", "parallel/", "render/", "experiments/")
KNOWN_BARE_IDS = {
    "parallel/clean/cleaning.h vertex",
    "parallel/mesh/vertex_sharing.h cell",
}


def bare_ids(root):
    for path in sources.files(root):
        if path.suffix == ".h" and str(path).startswith(ID_FOLDERS):
            code = without_literals(sources.text(root, path))
            for match in BARE_ID.finditer(code):
                if f"{path} {match.group(1)}" not in KNOWN_BARE_IDS:
                    line = code.count("\n", 0, match.start()) + 1
                    yield f"{path}:{line}: {match.group()}: take a CellId, VertexId or TriangleId"


# A comment that begins without a subject, on its first line; "Where it is flat, nothing moves" is a sentence.
FRAGMENT = re.compile(r"(?:^|[;{})\],]\s+)(?://|#) ?(?:(?:Of|Whether|Who|Whoever|How (?:far|much|many|long)) "
                      r"|What [^?]*$|Where [^,]*$)")
NOT_PLAIN = re.compile(r"\b(?<!here )(?:is|are|was|were) no (?!longer|more|less|other|larger|smaller|greater|finer|coarser)"
                       r"|\bwhoever\b", re.IGNORECASE)


def plain_english(root):
    """Places where comments, help or messages are not plain English."""
    for path in sources.files(root):
        if not sources.is_code(path) or path.parts[:2] == ("tests", "house"):
            continue
        within = False  # a comment that began on an earlier line
        for number, text in enumerate((sources.text(root, path) or "").splitlines(), 1):
            line = text.strip()
            if (not within and FRAGMENT.search(line)) or NOT_PLAIN.search(line):
                yield f"{path}:{number}: {line}"
            within = line.startswith(("//", "# ")) and line not in {"//", "#"}

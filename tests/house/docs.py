"""What documents promise, compared with the tree: commands, options, links, names, sizes, citations."""

import json
import pathlib
import re
import subprocess

import sources

MAX_BYTES = 1_000_000
LISTED_LINES, MAX_LINES = 400, 500

# A folder of one machine has no place in the repository.
LOCAL_PATH = re.compile(r"(?<![\w./}~*-])/(?:work|root|home)(?:/\w|\b(?!/))")


def links(root, path, text):
    """Relative links of a Markdown file that lead nowhere, anchors included."""
    body = re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)
    for target in re.findall(r"\]\(<?([^)\s>]+)>?\)", body):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (root / path.parent / name).resolve() if name else root / path
        if not file.exists():
            yield f"{path}: link to {target}: no such file"
        elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text()):
            yield f"{path}: link to {target}: no such heading"


def anchors(markdown):
    headings = re.findall(r"^#+\s+(.*)$", markdown, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def shell_lines(markdown):
    """Command lines of the ```sh blocks, continuation lines joined, comments and prompts taken off."""
    for block in re.findall(r"```sh\n(.*?)```", markdown, re.DOTALL):
        for line in block.replace("\\\n", " ").splitlines():
            line = re.sub(r"\s#.*", "", line).strip()
            if line and not line.startswith("#"):
                yield line


def known_options(help_text):
    return set(re.findall(r"(?<![\w-])(--?[A-Za-z][\w-]*)", help_text))


class Help:
    """--help of the program and its subcommands, asked once each."""

    def __init__(self, program):
        self.program, self.answers = program, {}

    def __call__(self, *subcommand):
        if subcommand not in self.answers:
            done = subprocess.run([self.program, *subcommand, "--help"], capture_output=True, text=True, timeout=60)
            self.answers[subcommand] = done.stdout if done.returncode == 0 else None
        return self.answers[subcommand]


def commands(root, path, text, help_of):
    """Commands of a Markdown file that do not exist; `help_of` may be None where the program is not built."""
    presets = {preset["name"] for preset in json.loads((root / "CMakePresets.json").read_text())["configurePresets"]}
    for line in shell_lines(text):
        words = line.split()
        program = words[0]
        if program.startswith(("scripts/", ".ci/")):
            if not (root / program).is_file() or not (root / program).stat().st_mode & 0o100:
                yield f"{path}: `{line}`: no such script, or not executable"
        elif program in {"cmake", "ctest"}:
            for preset in re.findall(r"--preset[ =](\S+)", line):
                if preset not in presets:
                    yield f"{path}: `{line}`: no such preset"
        elif program == "lodestone" and help_of:
            yield from lodestone_command(path, line, words, help_of)


def lodestone_command(path, line, words, help_of):
    if len(words) < 2 or words[1].startswith("-"):
        known = help_of()
        subcommand = []
    else:
        # The program answers `nonsense --help` with its own help: look for the name there.
        listed = re.search(rf"^\s+{re.escape(words[1])}\b", help_of() or "", re.MULTILINE)
        known = help_of(words[1]) if listed else None
        subcommand = [words[1]]
    if known is None:
        yield f"{path}: `{line}`: no such subcommand"
        return
    for word in words[1 + len(subcommand):]:
        option = word.strip("[]|").split("=")[0]
        if re.match(r"--?[A-Za-z]", option) and option not in known_options(known):
            yield f"{path}: `{line}`: unknown option {option}"


def sizes(root):
    """Files too large to belong in the repository, and code too long to hold one subject."""
    for path in sources.files(root):
        size = (root / path).stat().st_size
        if size > MAX_BYTES:
            yield f"{path}: {size:,} bytes; at most {MAX_BYTES:,}"
        lines = line_count(root, path)
        if lines > MAX_LINES:
            yield f"{path}: {lines} lines hold two subjects; at most {MAX_LINES}"


def line_count(root, path):
    return len(sources.text(root, path).splitlines()) if sources.is_code(path) else 0


def long_files(root):
    """(lines, path) of the code files that are worth a second look."""
    counted = [(line_count(root, path), str(path)) for path in sources.files(root)]
    return sorted((entry for entry in counted if entry[0] > LISTED_LINES), reverse=True)


def test_names(root):
    """Tests that are not called test_SUBJECT: one form, so that a subject's test is found by its name."""
    for path in sources.files(root):
        if path.parts[0] == "tests" and path.stem.endswith("_test") and path.suffix in {".cpp", ".py"}:
            yield f"{path}: call it test_{path.stem.removesuffix('_test')}{path.suffix}"


def local_paths(root):
    for path in sources.files(root):
        for number, line in enumerate((sources.text(root, path) or "").splitlines(), 1):
            if LOCAL_PATH.search(line):
                yield f"{path}:{number}: names a folder of one machine: {line.strip()}"


def names(root, path, text):
    """Functions, types, fields and files that a Markdown file names in backticks and the sources do not have."""
    tree = [p for p in sources.files(root) if p.suffix in {".h", ".cpp", ".txt", ".json", ".py"}]
    words = set(re.findall(r"\w+", "\n".join(sources.text(root, p) for p in tree)))
    for name in re.findall(r"`([A-Za-z][\w:./]*)`", text):
        if "/" in name and not name.startswith("build/"):
            if not (root / name).exists() and not list(root.glob(name + ".*")):
                yield f"{path}: names `{name}`, which is not a file of the tree"
        elif re.search(r"[a-z]_[a-z]|[a-z][A-Z]|::", name) and not set(re.split("::|[.]", name)) - {""} <= words:
            yield f"{path}: names `{name}`, which the sources do not have"


PATH = re.compile(r"(?<![\w./-])((?:core|parallel|render|experiments|python|bench|tests|scripts)/[\w/.-]*\w)")


def paths(root, path, text):
    """Paths of the source tree, with or without extension, that a Markdown file names and the tree does not have."""
    for name in sorted(set(PATH.findall(text))):
        if not (root / name).exists() and not list(root.glob(name + ".*")):
            yield f"{path}: names {name}, which is not a file of the tree"


CITATION = re.compile(r"\b([A-Z][a-z]+)(?: (?:et al\.|(?:&|and) [A-Z][a-z]+),?)? \(?((?:19|20)\d\d)\b")
KEY = re.compile(r"\b[a-z]{3,}(?:19|20)\d\d\b")
MONTHS = {"January", "February", "March", "April", "May", "June", "July", "August", "September", "October", "November",
          "December"}


def citations(root):
    """Papers named in code or documents, by author and year or by key, that docs/bibliography.bib does not hold."""
    keys = set(re.findall(r"^@\w+\{([^,]+),", (root / "docs/bibliography.bib").read_text(), re.MULTILINE))
    for path in sources.files(root):
        if path.suffix not in {".h", ".cpp", ".md"}:
            continue
        text = sources.text(root, path)
        for key in set(KEY.findall(text)) - keys:
            yield f"{path}: cites {key}, which docs/bibliography.bib does not hold"
        for author, year in CITATION.findall(text):
            if author not in MONTHS and not any(key.startswith((author + year).lower()) for key in keys):
                yield f"{path}: cites {author} {year}, which docs/bibliography.bib does not hold"

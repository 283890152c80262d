"""Small faults to plant in the sources: what scripts/mutate changes, and how it chooses."""

import dataclasses
import pathlib
import random
import re

FOLDERS = ("core", "parallel", "render", "experiments/metrics")

# (kind, pattern, replacement); the sources are formatted, so that binary operators stand between blanks, and the
# brackets of templates do not.
RULES = [
    ("comparison", r" < ", " <= "), ("comparison", r" <= ", " < "),
    ("comparison", r" > ", " >= "), ("comparison", r" >= ", " > "),
    ("comparison", r" == ", " != "), ("comparison", r" != ", " == "),
    ("sign", r" \+ (?!1\b(?!\.))", " - "), ("sign", r" - (?!1\b(?!\.))", " + "), ("sign", r" \+= ", " -= "),
    ("bound", r" [+-] 1\b(?!\.)", ""),
    ("bound", r"\bstd::min\(", "std::max("), ("bound", r"\bstd::max\(", "std::min("),
    ("bound", r"\bstd::ceil\(", "std::floor("), ("bound", r"\bstd::floor\(", "std::ceil("),
    ("bound", r"\blower_bound\(", "upper_bound("), ("bound", r"\bupper_bound\(", "lower_bound("),
    ("logic", r" && ", " || "), ("logic", r" \|\| ", " && "), ("logic", r"(?<=\()!(?=[\w(])", ""),
    ("logic", r"(?<=return )true(?=;)", "false"), ("logic", r"(?<=return )false(?=;)", "true"),
    ("flow", r"(?<= )continue(?=;)", ""), ("flow", r"(?<= )break(?=;)", ""),
    ("lock", r"(?:const )?\bstd::(?:scoped_lock|lock_guard)(?:<[^;]*>)? \w+[({][^;]*;", ""),
]


@dataclasses.dataclass(frozen=True)
class Mutant:
    file: str
    line: int
    kind: str
    start: int    # offsets in the file
    end: int
    new: str

    def apply(self, text):
        return text[:self.start] + self.new + text[self.end:]


def code_alone(text):
    """The text with comments, strings, preprocessor lines, assertions and messages blanked, every offset kept."""
    blank = lambda found: re.sub(r"[^\n]", "\0", found[0])  # noqa: E731
    text = re.sub(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*.*?\*/', blank, text,
                  flags=re.DOTALL)
    return re.sub(r"(?m)^\s*#.*$|\b(?:static_)?assert\(.*?\);", blank, text)


def mutants_of(file, text):
    code = code_alone(text)
    for kind, pattern, new in RULES:
        for found in re.finditer(pattern, code):
            yield Mutant(file, text.count("\n", 0, found.start()) + 1, kind, found.start(), found.end(), new)


def all_mutants(root):
    root = pathlib.Path(root)
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.cpp")):
            yield from mutants_of(path.relative_to(root).as_posix(), path.read_text())


def choose(mutants, seed):
    """An order in which to try them: kinds in turn, at random within a kind, so that any beginning is a fair sample."""
    groups = {}
    for mutant in mutants:
        groups.setdefault(mutant.kind, []).append(mutant)
    order = random.Random(seed)
    for group in groups.values():
        order.shuffle(group)
    # Locks are few, and each is worth trying; the others take turns.
    while any(groups.values()):
        for kind in sorted(groups):
            if groups[kind]:
                yield groups[kind].pop()
